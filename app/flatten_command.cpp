#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/commands.hpp"
#include "app/flat_result.hpp"
#include "app/opened.hpp"
#include "engine/blame.hpp"
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
        files_{args.mesh, args.constraints, args.repair, args.cut},
        exec_(common.threads),
        progress_(progress_style(common)),
        monitor_([this, show = monitor_of(progress_)](const Progress& state) {
          if (state.iteration == 0 && state.energy == 0) peaks_.enter(state.phase);  // a step begins
          return show(state);
        }) {}

  Result<int> operator()() {
    return check_outputs({{args_.output, {"ply", "obj"}},
                          {args_.flat, {"ply", "obj"}},
                          {args_.picture, {"png", "svg"}},
                          {args_.report, {}}})
        .and_then([&] { return open_mesh(exec_, files_, monitor_, stopwatch_, opened_, warnings_); })
        .and_then([&] { return args_.dry_run ? look_ahead() : solve_and_write(); });
  }

 private:
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
    const auto planned = plan(opened_.flat_surface(), opened_.constraints(), args_.options, monitor_);
    if (!planned) return fail(files_.placed(planned.error()));
    progress_.finish();
    const ConstraintFacts& facts = planned->facts;
    fmt::print(
        "{} triangles, {} unknown positions; {} features of prescribed shape in {} assemblies and {} "
        "clusters, {} free scales, directions and places\n",
        planned->mesh.triangles, planned->unknowns, facts.bodies, facts.assemblies, facts.clusters,
        facts.border_unknowns);
    fmt::print("no contradiction found; factor of {} entries, about {:.2f} GB of memory",
               facts.factor_nonzeros, static_cast<double>(planned->memory_bytes) * 1e-9);
    if (planned->newton_bytes > 0 && args_.options.flips == Flips::Untangle && !args_.options.paper)
      fmt::print(", {:.2f} GB where flips or overlaps have to be removed",
                 static_cast<double>(planned->newton_bytes) * 1e-9);
    fmt::print("\n");
    return 0;
  }

  Result<void> find_price() {
    if (!args_.price) return {};
    auto found = price(opened_.flat_surface(), opened_.constraints(), flattening_, args_.options, monitor_);
    if (!found) return fail(files_.placed(found.error()));
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
    const bool asked = flattening_.removal.method == Flips::Untangle && !args_.options.paper;
    if (!(has_flips() || has_unwanted_overlaps()) || !asked || args_.constraints.empty()) return {};
    auto found =
        find_blame(opened_.flat_surface(), opened_.constraints(), solved_, args_.options, kSeconds, monitor_);
    if (!found) return fail(files_.placed(found.error()));
    blame_ = std::move(*found);
    return {};
  }

  Result<void> solve() {
    auto result = flatten(opened_.flat_surface(), opened_.constraints(), args_.options, monitor_);
    if (!result) return fail(files_.placed(result.error()));
    flattening_ = std::move(*result);
    solved_.certificate = flattening_.certificate;
    if (opened_.cut) number_before_cut(*opened_.cut, opened_.parted, flattening_);
    for (const std::string& warning :
         {unwelded_warning(opened_, flattening_.mesh), sizes_warning(flattening_)}) {
      if (!warning.empty()) warnings_.push_back(warning);
    }
    return {};
  }

  /// The report goes last: it states the others' times.
  Result<void> write() {
    progress_.show({.phase = Phase::Write});
    peaks_.enter(Phase::Write);
    auto written = stopwatch_(Phase::Write, [&] {
      return write_output().and_then([&] { return write_flat(); }).and_then([&] { return draw(); });
    });
    return written ? write_report() : written;
  }

  Result<void> write_output() {
    if (args_.output.empty()) return {};
    return write_flattened(exec_, args_.output, opened_.featured, opened_.cut ? &*opened_.cut : nullptr,
                           flattening_.uv, warnings_);
  }

  Result<void> write_flat() {
    if (args_.flat.empty()) return {};
    Mesh flat;
    flat.corner_vertex.assign(opened_.flat_surface().corner_vertex.begin(),
                              opened_.flat_surface().corner_vertex.end());
    for (const Vec2 z : flattening_.uv) flat.position.push_back({z.x, z.y, 0});
    return write_mesh(exec_, args_.flat, {.mesh = &flat}, warnings_);
  }

  Result<void> draw() {
    if (args_.picture.empty()) return {};
    const std::vector<PlacedFeature> placed =
        placed_features(opened_.flat_features(), flattening_.constraints);
    PictureOptions options;
    options.title = file_name(args_.mesh);
    options.features = placed;
    return write_picture(exec_, args_.picture, opened_.flat_surface(), flattening_.uv,
                         flattening_.certificate, options);
  }

  Result<void> write_report() {
    if (args_.report.empty()) return {};
    std::optional<CutFacts> facts;
    if (const auto& cut = opened_.cut)
      facts = {.cut_edges = cut->edges, .cut_length = cut->length, .charts = cut->charts};
    return write_file(
        args_.report,
        report_json(flattening_,
                    {.input = args_.mesh,
                     .command = common_.command_line,
                     .mendings = opened_.featured.input.mendings,
                     .warnings = warnings_,
                     .extra_timings = stopwatch_.times(),
                     .peak_memory_bytes = peak_memory_bytes(),
                     .peaks = peaks_.peaks()},
                    {.embedding = opened_.featured.embedding ? &*opened_.featured.embedding : nullptr,
                     .cut = facts ? &*facts : nullptr,
                     .price = price_ ? &*price_ : nullptr}));
  }

  int conclude() {
    progress_.finish();
    const Certificate& c = flattening_.certificate;
    say_warnings(common_, warnings_);
    if (!common_.quiet) {
      say_mendings(opened_.featured.input.mendings);
      if (const auto& cut = opened_.cut)
        fmt::print("cut {} edges, length {:.6g}, into {} charts\n", cut->edges, cut->length, cut->charts);
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
    const bool overlaps = say_unwanted_overlaps(args_.mesh, flattening_);
    if (overlaps && !has_flips()) say_blame();
    return has_flips() || overlaps || disordered || unmet || !flattening_.converged ? 6 : 0;
  }

  bool has_unwanted_overlaps() const {
    return flattening_.overlaps.method == Overlapping::Remove &&
           flattening_.certificate.overlapping_pairs > 0;
  }

  void say_flips() const {
    planish::say_flips(args_.mesh, flattening_.certificate);
    say_blame();
  }

  void say_blame() const {
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
  OpenedFiles files_;
  Exec exec_;
  ProgressLine progress_;
  Monitor monitor_;
  Stopwatch stopwatch_;
  PeakByStep peaks_;
  OpenedMesh opened_;
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
