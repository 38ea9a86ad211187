#include "app/commands.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "app/interrupt.hpp"
#include "app/progress.hpp"
#include "engine/flatten.hpp"
#include "engine/prepare/repair.hpp"
#include "engine/prepare/validate.hpp"
#include "io/file.hpp"
#include "io/mesh_files.hpp"
#include "io/picture.hpp"
#include "io/report_json.hpp"
#include "io/sample_features_json.hpp"

namespace planish {
namespace {

Offset peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<Offset>(usage.ru_maxrss) * 1024;
}

ProgressStyle progress_style(const CommonArgs& common) {
  if (common.quiet) return ProgressStyle::None;
  if (common.progress) return ProgressStyle::Lines;
  return isatty(STDERR_FILENO) ? ProgressStyle::OneLine : ProgressStyle::None;
}

/// Refuses an output name before any work is done.
Result<void> check_format(const std::string& path, std::initializer_list<const char*> formats) {
  if (path.empty()) return {};
  const std::string format = format_of(path);
  std::string known;
  for (const char* f : formats) {
    if (format == f) return {};
    known += (known.empty() ? "." : " or .") + std::string(f);
  }
  return fail(ErrorCode::BadUsage, path + " cannot be written: its name must end in " + known);
}

/// A mesh as read, mended where asked for, with what has to be said about it.
struct Input {
  Mesh mesh;
  std::vector<Mending> mendings;
  std::vector<Index> triangle_origin;         // empty unless mended
  std::vector<Index> vertex_origin_triangle;  // likewise
  std::vector<Vec3> vertex_barycentric;
};

/// Where each vertex of the mended mesh lies in the input: a corner of one of its triangles.
void locate_vertices(const Mesh& original, const Repair& repaired, Input& input) {
  std::vector<Index> corner_at(original.position.size(), kNone);
  for (std::size_t c = original.corner_vertex.size(); c-- > 0;) {
    corner_at[original.corner_vertex[c]] = static_cast<Index>(c);
  }
  constexpr std::array<Vec3, 3> kCorner = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (const Index origin : repaired.vertex_origin) {
    const Index c = corner_at[origin];
    input.vertex_origin_triangle.push_back(c == kNone ? kNone : c / 3);
    input.vertex_barycentric.push_back(c == kNone ? Vec3{} : kCorner[c % 3]);
  }
}

Result<Input> read_input(const Exec& exec, const std::string& path, bool mend) {
  auto mesh = read_mesh(exec, path);
  if (!mesh) return fail(mesh.error());
  Input input;
  if (!mend) {
    input.mesh = std::move(*mesh);
    return input;
  }
  auto repaired = repair(*mesh);
  if (!repaired) return fail(repaired.error());
  if (!repaired->mendings.empty()) {
    locate_vertices(*mesh, *repaired, input);
    input.triangle_origin = std::move(repaired->triangle_origin);
  }
  input.mendings = std::move(repaired->mendings);
  input.mesh = std::move(repaired->mesh);
  return input;
}

void say_mendings(const std::vector<Mending>& mendings) {
  for (const Mending& mending : mendings) fmt::print("repaired: {} {}\n", mending.count, mending.what);
}

void say_warnings(const CommonArgs& common, const std::vector<std::string>& warnings) {
  if (common.quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "planish: warning: {}\n", warning);
}

/// With the file named, where the engine could not know it.
Error in_file(Error error, const std::string& path) {
  if (error.place.file.empty()) error.place.file = path;
  return error;
}

class FlattenCommand {
 public:
  FlattenCommand(const CommonArgs& common, const FlattenArgs& args)
      : common_(common), args_(args), exec_(common.threads), progress_(progress_style(common)) {}

  Result<int> operator()() {
    return check_outputs()
        .and_then([&] { return read(); })
        .and_then([&] { return solve(); })
        .and_then([&] { return write(); })
        .map([&] { return conclude(); });
  }

 private:
  Result<void> check_outputs() {
    return check_format(args_.output, {"ply", "obj"})
        .and_then([&] {
          return check_format(args_.flat, {"ply", "obj"});
        })
        .and_then([&] {
          return check_format(args_.picture, {"png", "svg"});
        });
  }

  Result<void> read() {
    progress_.show({.phase = Phase::Read});
    const auto begin = Clock::now();
    auto input = read_input(exec_, args_.mesh, args_.repair);
    if (!input) return fail(in_file(input.error(), args_.mesh));
    input_ = std::move(*input);
    warnings_ = input_.mesh.warnings;
    times_.push_back({name(Phase::Read), seconds_since(begin)});
    return {};
  }

  Result<void> solve() {
    auto result = flatten(input_.mesh.surface(), args_.options, [&](const Progress& progress) {
      progress_.show(progress);
      return stop_requested() ? Verdict::Stop : Verdict::Continue;
    });
    if (!result) return fail(in_file(result.error(), args_.mesh));
    flattening_ = std::move(*result);
    warn_of_unwelded();
    return {};
  }

  void warn_of_unwelded() {
    const MeshFacts& mesh = flattening_.mesh;
    if (mesh.duplicate_positions == 0) return;
    warnings_.push_back(
        fmt::format("{} components were flattened each on its own, but {} vertices lie at the position of "
                    "another one; if they are one surface, use --repair to merge them",
                    mesh.components, mesh.duplicate_positions));
  }

  /// The report goes last: it states the others' times.
  Result<void> write() {
    progress_.show({.phase = Phase::Write});
    const auto begin = Clock::now();
    return write_output()
        .and_then([&] { return write_flat(); })
        .and_then([&] { return draw(); })
        .and_then([&] {
          times_.push_back({name(Phase::Write), seconds_since(begin)});
          return write_report();
        });
  }

  Result<void> write_output() {
    if (args_.output.empty()) return {};
    return write_mesh(exec_, args_.output,
                      {.mesh = &input_.mesh,
                       .uv = flattening_.uv,
                       .triangle_origin = input_.triangle_origin,
                       .vertex_origin_triangle = input_.vertex_origin_triangle,
                       .vertex_barycentric = input_.vertex_barycentric},
                      warnings_);
  }

  Result<void> write_flat() {
    if (args_.flat.empty()) return {};
    Mesh flat;
    flat.corner_vertex = input_.mesh.corner_vertex;
    for (const Vec2 z : flattening_.uv) flat.position.push_back({z.x, z.y, 0});
    return write_mesh(exec_, args_.flat, {.mesh = &flat}, warnings_);
  }

  Result<void> draw() {
    if (args_.picture.empty()) return {};
    const std::string title = args_.mesh.substr(args_.mesh.find_last_of('/') + 1);
    return write_picture(exec_, args_.picture, input_.mesh.surface(), flattening_.uv, flattening_.certificate,
                         {.title = title});
  }

  Result<void> write_report() {
    if (args_.report.empty()) return {};
    return write_file(args_.report, report_json(flattening_, {.input = args_.mesh,
                                                              .command = common_.command_line,
                                                              .mendings = input_.mendings,
                                                              .warnings = warnings_,
                                                              .extra_timings = times_,
                                                              .peak_memory_bytes = peak_memory_bytes()}));
  }

  int conclude() {
    progress_.finish();
    const Certificate& c = flattening_.certificate;
    say_warnings(common_, warnings_);
    if (!common_.quiet) {
      say_mendings(input_.mendings);
      fmt::print(
          "{} triangles, {} iterations, arap {:.6e}, stretch {:.4f} to {:.4f}, flipped {}, overwound {}, "
          "overlapping pairs {}\n",
          flattening_.mesh.triangles, flattening_.iterations, c.arap, c.sigma_min.min, c.sigma_max.max,
          c.flipped_triangles, c.overwound_vertices, c.overlapping_pairs);
    }
    const bool flips = c.flipped_triangles > 0 || c.overwound_vertices > 0;
    if (!flattening_.converged) {
      fmt::print(
          stderr,
          "planish: {}: the tolerance {:g} was not met, the gradient is {:.3g} after {} iterations; {}\n",
          args_.mesh, args_.options.tolerance, flattening_.gradient, flattening_.iterations,
          flattening_.iterations < args_.options.max_iterations
              ? "no step lowers the energy any more, use a larger --tolerance"
              : "use a larger --max-iterations");
    }
    if (flips) {
      fmt::print(stderr, "planish: {}: {} triangles are flipped and {} vertices overwound in the map\n",
                 args_.mesh, c.flipped_triangles, c.overwound_vertices);
    }
    return flips || !flattening_.converged ? 6 : 0;
  }

  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  const CommonArgs& common_;
  const FlattenArgs& args_;
  Exec exec_;
  ProgressLine progress_;
  Input input_;
  std::vector<std::string> warnings_;
  std::vector<StepTime> times_;
  Flattening flattening_;
};

void print_diagnosis(const Diagnosis& d, const std::string& path) {
  constexpr double kDegrees = 180 / kPi;
  fmt::print("{}\n  {} vertices ({} unreferenced, {} at the position of an earlier one), {} triangles\n",
             path, d.vertices, d.unreferenced_vertices, d.duplicate_positions, d.triangles);
  fmt::print("  {} components, {} boundary loops, Euler characteristic {}", d.components, d.boundary_loops,
             d.euler);
  if (d.genus != kNone) fmt::print(", genus {}", d.genus);
  fmt::print("\n  box {:g} x {:g} x {:g}, area {:g}, angles {:.4g} to {:.4g} degrees\n",
             d.upper.x - d.lower.x, d.upper.y - d.lower.y, d.upper.z - d.lower.z, d.area,
             kDegrees * d.min_angle, kDegrees * d.max_angle);
  if (d.usable()) {
    fmt::print("  can be flattened\n");
    return;
  }
  Diagnosis one;
  for (const Defect& defect : d.defects) {
    one.defects.assign(1, defect);
    fmt::print("  cannot be flattened: {}\n", describe(refusal(one)));
  }
}

}  // namespace

Result<int> run_flatten(const CommonArgs& common, const FlattenArgs& args) {
  return FlattenCommand(common, args)();
}

Result<int> run_info(const CommonArgs& common, const InfoArgs& args) {
  const Exec exec(common.threads);
  const auto input = read_input(exec, args.mesh, args.repair);
  if (!input) return fail(in_file(input.error(), args.mesh));
  const auto diagnosis = diagnose(exec, input->mesh.surface());
  if (!diagnosis) return fail(in_file(diagnosis.error(), args.mesh));
  if (args.json) {
    fmt::print("{}\n", diagnosis_json(*diagnosis, args.mesh, input->mendings, input->mesh.warnings));
  } else {
    say_mendings(input->mendings);
    print_diagnosis(*diagnosis, args.mesh);
    say_warnings(common, input->mesh.warnings);
  }
  return 0;
}

Result<int> run_sample(const CommonArgs& common, const SampleArgs& args) {
  if (auto known = check_format(args.output, {"ply", "obj"}); !known) return fail(known.error());
  const Exec exec(common.threads);
  const auto sample = make_sample(exec, args.options);
  if (!sample) return fail(sample.error());
  std::vector<std::string> warnings;
  if (auto done = write_mesh(exec, args.output, {.mesh = &sample->mesh}, warnings); !done)
    return fail(done.error());
  if (!args.features.empty()) {
    if (auto done = write_file(args.features, sample_constraints_json(*sample)); !done)
      return fail(done.error());
  }
  if (!common.quiet) {
    fmt::print("{}: {} vertices, {} triangles\n", args.output, sample->mesh.num_vertices(),
               sample->mesh.num_triangles());
  }
  return 0;
}

}  // namespace planish
