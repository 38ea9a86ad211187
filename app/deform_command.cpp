#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/commands.hpp"
#include "app/featured.hpp"
#include "app/flat_result.hpp"
#include "engine/deform.hpp"
#include "engine/features/parted.hpp"
#include "io/file.hpp"
#include "io/picture_sheet.hpp"
#include "io/report_json.hpp"

namespace planish {
namespace {

class DeformCommand {
 public:
  DeformCommand(const CommonArgs& common, const DeformArgs& args)
      : common_(common),
        args_(args),
        exec_(common.threads),
        progress_(progress_style(common)),
        monitor_(monitor_of(progress_)) {}

  Result<int> operator()() {
    return check_outputs(
               {{args_.output, {"ply", "obj"}}, {args_.picture, {"png", "svg"}}, {args_.report, {}}})
        .and_then([&] { return args_.frames.empty() ? Result<void>() : make_folder(args_.frames); })
        .and_then([&] { return read(); })
        .and_then([&] { return open(); })
        .and_then([&] { return solve(); })
        .and_then([&] { return write(); })
        .map([&] { return conclude(); });
  }

 private:
  Result<void> read() {
    auto featured = read_featured(exec_, args_.mesh, args_.constraints, args_.repair, monitor_, stopwatch_);
    if (!featured) return fail(featured.error());
    featured_ = std::move(*featured);
    warnings_ = featured_.mesh.warnings;
    if (mesh().num_triangles() > 0 && mesh().uv_sets.empty())
      return fail(in_file(no_parameterization(featured_.input.mesh), args_.mesh));
    return {};
  }

  /// Where the map is torn, so is what is deformed.
  Result<void> open() {
    progress_.show({.phase = Phase::Cut});
    auto opened = stopwatch_(Phase::Cut, [&] {
      const In<Vec2> corner_uv = mesh().uv_sets.empty() ? In<Vec2>() : mesh().uv_sets.front().corner_uv;
      return cut_where_torn(mesh().surface(), corner_uv, embedded_features(), featured_.set.seams,
                            exec_.threads());
    });
    if (!opened) return fail(placed(opened.error()));
    uv_ = std::move(opened->uv);
    if (opened->cut.edges == 0) return {};
    cut_ = std::move(opened->cut);
    auto parted = features_on_cut(exec_, mesh().surface(), *cut_, embedded_features(), featured_.set);
    if (!parted) return fail(in_file(parted.error(), args_.constraints));
    parted_ = std::move(*parted);
    return {};
  }

  Result<void> solve() {
    const bool drawn = !args_.frames.empty() || !args_.picture.empty();
    const StepSink keep = [&](DeformStep step) -> Result<void> {
      steps_.push_back(std::move(step));
      return {};
    };
    Constraints constraints{.set = &featured_.set, .features = &flat_features()};
    if (cut_) constraints.vertex_origin = cut_->vertex_origin;
    auto result = deform(flat_surface(), uv_, constraints, {.edit = args_.edit, .solve = args_.solve},
                         monitor_, drawn ? keep : StepSink());
    if (!result) return fail(placed(result.error()));
    deformation_ = std::move(*result);
    deformation_.flattening.method = Method::Deform;
    has_flips_ = certificate().flipped_triangles > 0 || certificate().overwound_vertices > 0;
    return {};
  }

  /// The report goes last: it states the others' times.
  Result<void> write() {
    progress_.show({.phase = Phase::Write});
    auto written = stopwatch_(Phase::Write, [&]() -> Result<void> {
      if (!args_.picture.empty()) {
        if (auto drawn = draw_pair(); !drawn) return drawn;
      }
      if (!args_.frames.empty()) {
        if (auto drawn = draw_frames(); !drawn) return drawn;
      }
      if (cut_) number_before_cut(*cut_, parted_, deformation_.flattening);
      if (args_.output.empty()) return {};
      // The given map is not lost but deformed; where a file can hold both, both are written.
      if (format_of(args_.output) == "obj") featured_.mesh.uv_sets.erase(featured_.mesh.uv_sets.begin());
      return write_flattened(exec_, args_.output, featured_, cut_ ? &*cut_ : nullptr,
                             deformation_.flattening.uv, warnings_);
    });
    return written ? write_report() : written;
  }

  Result<void> draw_pair() {
    const std::vector<PlacedFeature> placed =
        placed_features(flat_features(), deformation_.flattening.constraints);
    const SheetMap pair[] = {
        {.uv = steps_.front().uv, .certificate = &steps_.front().certificate},
        {.uv = deformation_.flattening.uv, .certificate = &certificate(), .features = placed}};
    return write_picture_sheet(exec_, args_.picture, flat_surface(), pair,
                               {.title = file_name(args_.mesh) + ": before, and deformed"});
  }

  /// One window for all, so that what stays does not move from one picture to the next.
  Result<void> draw_frames() {
    const std::vector<PlacedFeature> placed =
        placed_features(flat_features(), deformation_.flattening.constraints);
    UvBox window;
    for (const DeformStep& step : steps_) window = window.with(flat_surface().corner_vertex, step.uv);
    for (const DeformStep& step : steps_) {
      const std::string path = fmt::format("{}/step_{:04}.png", args_.frames, step.step);
      auto drawn = write_picture(
          exec_, path, flat_surface(), step.uv, step.certificate,
          {.title = fmt::format("{}: step {} of {}", file_name(args_.mesh), step.step, args_.solve.steps),
           .features = placed,
           .window = window});
      if (!drawn) return drawn;
    }
    return {};
  }

  Result<void> write_report() {
    if (args_.report.empty()) return {};
    std::optional<CutFacts> facts;
    if (cut_) facts = {.cut_edges = cut_->edges, .cut_length = cut_->length, .charts = cut_->charts};
    return write_file(args_.report,
                      report_json(deformation_.flattening,
                                  {.input = args_.mesh,
                                   .command = common_.command_line,
                                   .mendings = featured_.input.mendings,
                                   .warnings = warnings_,
                                   .extra_timings = stopwatch_.times(),
                                   .peak_memory_bytes = peak_memory_bytes()},
                                  {.embedding = featured_.embedding ? &*featured_.embedding : nullptr,
                                   .cut = facts ? &*facts : nullptr,
                                   .deformation = &deformation_.facts}));
  }

  int conclude() {
    progress_.finish();
    const Flattening& flat = deformation_.flattening;
    say_facts();
    say_warnings(common_, warnings_);
    if (!common_.quiet) {
      say_mendings(featured_.input.mendings);
      say_map();
      say_constraints(flat.constraints);
    }
    const bool disordered = say_disorder(args_.mesh, flat.constraints),
               unmet = say_unmet(args_.mesh, flat.constraints);
    if (!flat.converged && !has_flips_) {
      fmt::print(stderr,
                 "planish: {}: the tolerance {:g} was not met, the gradient is {:.3g} after {} iterations; "
                 "use a larger --tolerance or --max-iterations\n",
                 args_.mesh, args_.solve.tolerance, flat.gradient, flat.iterations);
    }
    if (has_flips_) say_flips(args_.mesh, certificate());
    const bool overlapping = say_unwanted_overlaps(args_.mesh, flat);
    return has_flips_ || overlapping || disordered || unmet || !flat.converged ? 6 : 0;
  }

  void say_map() const {
    const Flattening& flat = deformation_.flattening;
    const DeformFacts& facts = deformation_.facts;
    const Certificate& c = certificate();
    fmt::print("given map: arap {:.6e}, flipped {}\n", facts.given_arap, facts.given_flipped);
    fmt::print(
        "{} triangles, {} iterations, arap {:.6e}, stretch {:.4f} to {:.4f}, flipped {}, overwound {}, "
        "overlapping pairs {}\n",
        flat.mesh.triangles, flat.iterations, c.arap, c.sigma_min.min, c.sigma_max.max, c.flipped_triangles,
        c.overwound_vertices, c.overlapping_pairs);
    fmt::print("largest displacement {:.6g}, mean {:.6g}\n", facts.largest_displacement,
               facts.mean_displacement);
    say_way();
    if (cut_) fmt::print("the map is torn along {} edges, {} charts\n", cut_->edges, cut_->charts);
  }

  /// Where steps on the way have flips: the given map had some, or features left no other way.
  void say_way() const {
    std::vector<std::string> faulty;
    for (const StepFacts& step : deformation_.facts.way) {
      const bool between = step.step > 0 && step.step < args_.solve.steps;
      if (between && step.flipped + step.overwound > 0)
        faulty.push_back(fmt::format("{} ({})", step.step, step.flipped + step.overwound));
    }
    if (!faulty.empty())
      fmt::print("steps on the way with flipped triangles and overwound vertices: {}\n",
                 fmt::join(faulty, ", "));
  }

  /// What was done to the map or its features beyond what was asked.
  void say_facts() {
    const DeformFacts& facts = deformation_.facts;
    if (facts.map_scale != 1)
      warnings_.push_back(fmt::format(
          "the given map is not in mesh units, and was multiplied by {:.6g} before it was deformed",
          facts.map_scale));
    if (facts.mirrored > 0)
      warnings_.push_back(fmt::format(
          "{} charts of the given map lay with their back up, and were turned over", facts.mirrored));
    const std::string held = fmt::format("with the features where they lie nearest to the given map {}, so ",
                                         args_.solve.overlaps == Overlapping::Remove
                                             ? "triangles stayed flipped, or parts of it on one another"
                                             : "triangles stayed flipped");
    if (facts.release == Release::Features)
      warnings_.push_back(held + "the features were moved to where the whole is least distorted");
    if (facts.release == Release::Map)
      warnings_.push_back(held + "the whole was flattened anew, and laid onto the given map");
  }

  /// With the file at fault.
  Error placed(const Error& error) const {
    return in_file(error, error.place.pointer.empty() ? args_.mesh : args_.constraints);
  }

  const Certificate& certificate() const { return deformation_.flattening.certificate; }
  const Mesh& mesh() const { return featured_.mesh; }
  const std::vector<Feature>& embedded_features() const {
    static const std::vector<Feature> kNone;
    return featured_.embedding ? featured_.embedding->features : kNone;
  }
  /// What is deformed: the mesh, or its copy that is open where the map is torn, and the features on it.
  Surface flat_surface() const { return cut_ ? cut_->surface() : mesh().surface(); }
  const std::vector<Feature>& flat_features() const { return cut_ ? parted_ : embedded_features(); }

  const CommonArgs& common_;
  const DeformArgs& args_;
  Exec exec_;
  ProgressLine progress_;
  Monitor monitor_;
  Stopwatch stopwatch_;
  FeaturedMesh featured_;
  std::optional<Cut> cut_;
  std::vector<Feature> parted_;  // on the opened surface
  std::vector<Vec2> uv_;         // the given map, one a vertex of what is deformed
  std::vector<DeformStep> steps_;
  Deformation deformation_;
  bool has_flips_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace

Result<int> run_deform(const CommonArgs& common, const DeformArgs& args) {
  return DeformCommand(common, args)();
}

}  // namespace planish
