#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/commands.hpp"
#include "app/featured.hpp"
#include "app/flat_result.hpp"
#include "engine/blame.hpp"
#include "engine/cut.hpp"
#include "engine/features/parted.hpp"
#include "engine/flatten.hpp"
#include "engine/price.hpp"
#include "io/file.hpp"
#include "io/mesh_files.hpp"
#include "io/picture.hpp"
#include "io/report_json.hpp"

namespace planish {
namespace {

class FlattenCommand {
 public:
  FlattenCommand(const CommonArgs& common, const FlattenArgs& args)
      : common_(common),
        args_(args),
        exec_(common.threads),
        progress_(progress_style(common)),
        monitor_(monitor_of(progress_)) {}

  Result<int> operator()() {
    return check_outputs({{args_.output, {"ply", "obj"}},
                          {args_.flat, {"ply", "obj"}},
                          {args_.picture, {"png", "svg"}},
                          {args_.report, {}}})
        .and_then([&] { return read(); })
        .and_then([&] { return open(); })
        .and_then([&] { return args_.dry_run ? look_ahead() : solve_and_write(); });
  }

 private:
  Result<void> read() {
    auto featured = read_featured(exec_, args_.mesh, args_.constraints, args_.repair, monitor_, stopwatch_);
    if (!featured) return fail(featured.error());
    featured_ = std::move(*featured);
    warnings_ = featured_.mesh.warnings;
    return {};
  }

  Result<void> open() {
    if (featured_.set.seams.empty() && args_.cut == CutMode::None) return {};
    progress_.show({.phase = Phase::Cut});
    auto opened = stopwatch_(Phase::Cut, [&] {
      return cut(mesh().surface(), embedded_features(), featured_.set.seams,
                 {.mode = args_.cut, .threads = exec_.threads()});
    });
    if (!opened) {
      const bool of_seam = !opened.error().place.pointer.empty();
      return fail(in_file(opened.error(), of_seam ? args_.constraints : args_.mesh));
    }
    cut_ = std::move(*opened);
    if (!features()) return {};
    auto parted = features_on_cut(exec_, mesh().surface(), *cut_, *features(), featured_.set);
    if (!parted) return fail(in_file(parted.error(), args_.constraints));
    parted_ = std::move(*parted);
    return {};
  }

  Result<int> solve_and_write() {
    return solve()
        .and_then([&] { return find_price(); })
        .and_then([&] { return write(); })
        .and_then([&] { return blame(); })
        .map([&] { return conclude(); });
  }

  /// Contradictions, unknowns and memory; nothing is solved or written.
  Result<int> look_ahead() {
    if (!args_.output.empty() || !args_.flat.empty() || !args_.picture.empty() || !args_.report.empty() ||
        args_.price)
      return fail(ErrorCode::BadUsage,
                  "--dry-run solves and writes nothing: leave out the outputs and --price");
    const auto planned = plan(flat_surface(), constraints(), args_.options, monitor_);
    if (!planned) return fail(placed(planned.error()));
    progress_.finish();
    const ConstraintFacts& facts = planned->facts;
    fmt::print(
        "{} triangles, {} unknown positions; {} features of prescribed shape in {} assemblies and {} "
        "clusters, {} free scales, directions and places\n",
        planned->mesh.triangles, planned->unknowns, facts.bodies, facts.assemblies, facts.clusters,
        facts.border_unknowns);
    fmt::print("no contradiction found; factor of {} entries, about {:.2f} GB of memory\n",
               facts.factor_nonzeros, static_cast<double>(planned->memory_bytes) * 1e-9);
    return 0;
  }

  Result<void> find_price() {
    if (!args_.price) return {};
    auto found = price(flat_surface(), constraints(), flattening_, args_.options, monitor_);
    if (!found) return fail(placed(found.error()));
    price_ = std::move(*found);
    return {};
  }

  bool has_flips() const {
    const Certificate& c = flattening_.certificate;
    return c.flipped_triangles > 0 || c.overwound_vertices > 0;
  }

  /// What has been written stays whatever this finds.
  Result<void> blame() {
    constexpr double kSeconds = 60;
    const bool asked = args_.options.flips == Flips::Untangle && !args_.options.paper;
    if (!has_flips() || !asked || args_.constraints.empty()) return {};
    auto found = find_blame(flat_surface(), constraints(), solved_, args_.options, kSeconds, monitor_);
    if (!found) return fail(placed(found.error()));
    blame_ = std::move(*found);
    return {};
  }

  /// With the file at fault.
  Error placed(const Error& error) const {
    return in_file(error, error.place.pointer.empty() ? args_.mesh : args_.constraints);
  }

  Result<void> solve() {
    auto result = flatten(flat_surface(), constraints(), args_.options, monitor_);
    if (!result) return fail(placed(result.error()));
    flattening_ = std::move(*result);
    solved_.certificate = flattening_.certificate;
    if (cut_) number_before_cut(*cut_, parted_, flattening_);
    warn_of_unwelded();
    return {};
  }

  /// Without a constraint file there is nothing to meet.
  Constraints constraints() const {
    if (args_.constraints.empty()) return {};
    Constraints constraints{.set = &featured_.set, .features = cut_ ? &parted_ : &embedded_features()};
    if (cut_) constraints.vertex_origin = cut_->vertex_origin;
    return constraints;
  }

  const std::vector<Feature>& embedded_features() const {
    static const std::vector<Feature> kNone;
    return features() ? *features() : kNone;
  }

  const Mesh& mesh() const { return featured_.mesh; }
  const std::vector<Feature>* features() const {
    return featured_.embedding ? &featured_.embedding->features : nullptr;
  }
  /// What is flattened: the mesh, or its copy that was opened.
  Surface flat_surface() const { return cut_ ? cut_->surface() : mesh().surface(); }

  void warn_of_unwelded() {
    const MeshFacts& facts = flattening_.mesh;
    if (facts.duplicate_positions == 0 || cut_) return;
    warnings_.push_back(
        fmt::format("{} components were flattened each on its own, but {} vertices lie at the position of "
                    "another one; if they are one surface, use --repair to merge them",
                    facts.components, facts.duplicate_positions));
  }

  /// The report goes last: it states the others' times.
  Result<void> write() {
    progress_.show({.phase = Phase::Write});
    auto written = stopwatch_(Phase::Write, [&] {
      return write_output().and_then([&] { return write_flat(); }).and_then([&] { return draw(); });
    });
    return written ? write_report() : written;
  }

  Result<void> write_output() {
    if (args_.output.empty()) return {};
    return write_flattened(exec_, args_.output, featured_, cut_ ? &*cut_ : nullptr, flattening_.uv,
                           warnings_);
  }

  Result<void> write_flat() {
    if (args_.flat.empty()) return {};
    Mesh flat;
    flat.corner_vertex.assign(flat_surface().corner_vertex.begin(), flat_surface().corner_vertex.end());
    for (const Vec2 z : flattening_.uv) flat.position.push_back({z.x, z.y, 0});
    return write_mesh(exec_, args_.flat, {.mesh = &flat}, warnings_);
  }

  Result<void> draw() {
    if (args_.picture.empty()) return {};
    const std::vector<PlacedFeature> placed =
        placed_features(cut_ ? parted_ : embedded_features(), flattening_.constraints);
    PictureOptions options;
    options.title = file_name(args_.mesh);
    options.features = placed;
    return write_picture(exec_, args_.picture, flat_surface(), flattening_.uv, flattening_.certificate,
                         options);
  }

  Result<void> write_report() {
    if (args_.report.empty()) return {};
    std::optional<CutFacts> facts;
    if (cut_) facts = {.cut_edges = cut_->edges, .cut_length = cut_->length, .charts = cut_->charts};
    return write_file(args_.report,
                      report_json(flattening_,
                                  {.input = args_.mesh,
                                   .command = common_.command_line,
                                   .mendings = featured_.input.mendings,
                                   .warnings = warnings_,
                                   .extra_timings = stopwatch_.times(),
                                   .peak_memory_bytes = peak_memory_bytes()},
                                  {.embedding = featured_.embedding ? &*featured_.embedding : nullptr,
                                   .cut = facts ? &*facts : nullptr,
                                   .price = price_ ? &*price_ : nullptr}));
  }

  int conclude() {
    progress_.finish();
    const Certificate& c = flattening_.certificate;
    say_warnings(common_, warnings_);
    if (!common_.quiet) {
      say_mendings(featured_.input.mendings);
      if (cut_)
        fmt::print("cut {} edges, length {:.6g}, into {} charts\n", cut_->edges, cut_->length, cut_->charts);
      fmt::print(
          "{} triangles, {} iterations, arap {:.6e}, stretch {:.4f} to {:.4f}, flipped {}, overwound {}, "
          "overlapping pairs {}\n",
          flattening_.mesh.triangles, flattening_.iterations, c.arap, c.sigma_min.min, c.sigma_max.max,
          c.flipped_triangles, c.overwound_vertices, c.overlapping_pairs);
      say_constraints(flattening_.constraints);
      if (price_) say_price();
    }
    const bool disordered = say_disorder(args_.mesh, flattening_.constraints),
               unmet = say_unmet(args_.mesh, flattening_.constraints);
    if (!flattening_.converged) say_not_converged();
    if (has_flips()) say_flips();
    const bool overlapping = say_unwanted_overlaps(args_.mesh, flattening_);
    return has_flips() || overlapping || disordered || unmet || !flattening_.converged ? 6 : 0;
  }

  void say_flips() const {
    planish::say_flips(args_.mesh, flattening_.certificate);
    if (!blame_) return;
    if (!blame_->features.empty())
      fmt::print(stderr, "planish: {}: they touch the features \"{}\"\n", args_.constraints,
                 fmt::join(blame_->features, "\", \""));
    if (blame_->constraints.empty()) {
      fmt::print(stderr, "planish: {}: no single one of {} constraints makes the difference\n",
                 args_.constraints, blame_->tried);
    } else {
      fmt::print(stderr, "planish: {}: there are none without \"{}\"; loosen it, or move its feature\n",
                 args_.constraints, fmt::join(blame_->constraints, "\", or without \""));
    }
  }

  void say_price() const {
    fmt::print("arap {:.6e} with all constraints, {:.6e} without any, {:.6e} without refit of directions\n",
               price_->energy, price_->unconstrained, price_->without_refit);
    for (const ConstraintPrice& item : price_->constraints) {
      if (item.reason.empty()) {
        fmt::print("  {:<30} costs {:.3e}\n", item.name, item.cost);
      } else {
        fmt::print("  {:<30} cannot be left out: {}\n", item.name, item.reason);
      }
    }
  }

  void say_not_converged() const {
    const Flips flips = args_.options.flips;
    if (flips == Flips::Untangle && has_flips()) return;  // maps with flips are not minimised
    const bool by_weights = flips == Flips::Weights || flips == Flips::Stiffening;
    if (args_.options.paper || by_weights)
      return;  // these end where no triangle is flipped, and flips are said
    fmt::print(
        stderr,
        "planish: {}: the tolerance {:g} was not met, the gradient is {:.3g} after {} iterations; {}\n",
        args_.mesh, args_.options.tolerance, flattening_.gradient, flattening_.iterations,
        flattening_.iterations < args_.options.max_iterations
            ? "no step lowers the energy any more, use a larger --tolerance"
            : "use a larger --max-iterations");
  }

  const CommonArgs& common_;
  const FlattenArgs& args_;
  Exec exec_;
  ProgressLine progress_;
  Monitor monitor_;
  Stopwatch stopwatch_;
  FeaturedMesh featured_;
  std::optional<Cut> cut_;
  std::vector<Feature> parted_;  // on the opened surface
  std::vector<std::string> warnings_;
  Flattening flattening_;
  Flattening solved_;  // the certificate alone, in the numbers of what was flattened
  std::optional<Blame> blame_;
  std::optional<Price> price_;
};

}  // namespace

Result<int> run_flatten(const CommonArgs& common, const FlattenArgs& args) {
  return FlattenCommand(common, args)();
}

}  // namespace planish
