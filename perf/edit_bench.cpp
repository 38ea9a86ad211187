// Times a map editor: the first solve (analysis, factorization, minimum) against those after one pin was moved, on a sample
// panel whose features are constrained and that some pins hold, after proving that the editor ends where a fresh one does.
//
// usage: edit_bench [--triangles N] [--noise A] [--threads N] [--moves N] [--tolerance X]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/edit.hpp"
#include "engine/embed.hpp"
#include "engine/sample/panels.hpp"

namespace {

using namespace planish;

struct Arguments {
  Index triangles = 1'000'000;
  double noise = 0, tolerance = 1e-6;
  int threads = 0, moves = 16;
};

[[noreturn]] void stop(const std::string& why) {
  fmt::print(stderr, "edit_bench: {}\n", why);
  std::exit(1);
}

template <class T>
T value_of(Result<T> result) {
  if (!result) stop(describe(result.error()));
  return std::move(*result);
}

void check(const Result<void>& done) {
  if (!done) stop(describe(done.error()));
}

double seconds_of(const auto& run) {
  const auto begin = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// The panel with the lines among its features in its edges, its free map, and pins at places of that map.
struct Case {
  Embedding embedding;
  ConstraintSet set;
  std::vector<Vec2> map;
  double extent = 0;
  PinConstraint& pins() { return std::get<PinConstraint>(set.constraints.back().rule); }
  Constraints constraints() const { return {.set = &set, .features = &embedding.features}; }
};

Case make_case(const Arguments& args) {
  const Exec exec(args.threads);
  const Sample sample =
      value_of(make_sample(exec, {.kind = "hood", .triangles = args.triangles, .noise = args.noise}));
  Case result;
  for (const SampleConstraint& constraint : sample.constraints) {
    if (constraint.type != "line") continue;
    const std::string& name = constraint.features.front();
    const auto feature =
        std::ranges::find_if(sample.features, [&](const SampleFeature& f) { return f.name == name; });
    result.set.features.push_back(
        {.name = name,
         .source = PolylineSource{
             .point = feature->points, .closed = feature->closed, .max_distance = feature->max_distance}});
    LineConstraint line;
    line.feature = name;
    result.set.constraints.push_back({.name = "line " + name, .type = "line", .rule = line});
  }
  result.embedding = value_of(embed(sample.mesh.surface(), result.set, {.threads = args.threads}));
  result.map = value_of(flatten(result.embedding.surface(), {.tolerance = 1e-4, .threads = args.threads})).uv;
  constexpr Index kPins = 9;
  PinConstraint pins;
  const auto num_vertices = static_cast<Index>(sample.mesh.position.size());
  for (Index k = 0; k < kPins; ++k) {
    pins.vertex.push_back((2 * k + 1) * (num_vertices / (2 * kPins)));
    pins.uv.push_back(result.map[pins.vertex.back()]);
  }
  result.set.constraints.push_back({.name = "pins", .type = "pin", .rule = pins});
  Vec2 lower = result.map[0], upper = lower;
  for (const Vec2 z : result.map) {
    lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
    upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
  }
  result.extent = norm(upper - lower);
  return result;
}

/// One in the middle of the list that is not carried over a line: no map without flips follows it there while lines are held.
std::size_t moved_pin(Case& scene) {
  constexpr double kAway = 0.01;  // of the extent, five times as far as it goes
  for (std::size_t pin = 4; pin < scene.pins().vertex.size(); ++pin) {
    double nearest = kInfinity;
    for (const Feature& feature : scene.embedding.features) {
      for (const Index v : feature.vertex)
        nearest = std::min(nearest, norm(scene.map[v] - scene.pins().uv[pin]));
    }
    if (nearest < kAway * scene.extent) continue;
    fmt::print("pin {} moves, {:.3f} of the extent from the nearest line\n", pin, nearest / scene.extent);
    return pin;
  }
  stop("every pin lies at a line");
}

MapEditor begun(const Case& scene, const Arguments& args) {
  MapEditor editor =
      value_of(MapEditor::begin(scene.embedding.surface(), scene.map, {.threads = args.threads}));
  check(editor.constrain(scene.constraints()));
  return editor;
}

double largest_difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double largest = 0;
  for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, norm(a[v] - b[v]));
  return largest;
}

double seconds_before(const std::vector<StepTime>& times, const std::string& step) {
  const auto found = std::ranges::find_if(times, [&](const StepTime& t) { return t.step == step; });
  return found == times.end() ? 0 : found->seconds;
}

Arguments parse(int argc, char** argv) {
  Arguments args;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--triangles")
      args.triangles = std::atoi(argv[i + 1]);
    else if (name == "--noise")
      args.noise = std::atof(argv[i + 1]);
    else if (name == "--threads")
      args.threads = std::atoi(argv[i + 1]);
    else if (name == "--moves")
      args.moves = std::atoi(argv[i + 1]);
    else if (name == "--tolerance")
      args.tolerance = std::atof(argv[i + 1]);
    else
      stop("unknown option " + name);
  }
  return args;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments args = parse(argc, argv);
  Case scene = make_case(args);
  const SolveOptions options{.tolerance = args.tolerance};
  std::optional<MapEditor> editor;
  const double first = seconds_of([&] {
    editor.emplace(begun(scene, args));
    check(editor->solve(options));
  });
  const Deformation start = editor->measure();
  fmt::print("{} triangles, first solve {:.3f} s, {} iterations, {} flipped\n",
             start.flattening.mesh.triangles, first, start.flattening.iterations,
             start.flattening.certificate.flipped_triangles);

  const std::size_t pin = moved_pin(scene);
  const Index vertex = scene.pins().vertex[pin];
  const Vec2 home = scene.pins().uv[pin];
  std::vector<double> seconds;
  for (int move = 1; move <= args.moves; ++move) {
    const Vec2 to = home + (0.002 * scene.extent) * Vec2{std::cos(2.0 * move), std::sin(2.0 * move)};
    seconds.push_back(seconds_of([&] {
      check(editor->move_pin(vertex, to));
      check(editor->solve(options));
    }));
    scene.pins().uv[pin] = to;
    const Deformation now = editor->measure();
    fmt::print(
        "pin moved, {:.3f} s, {} iterations, {} flipped, worst residual {:.1e}\n", seconds.back(),
        now.flattening.iterations, now.flattening.certificate.flipped_triangles,
        std::ranges::max(now.flattening.constraints.outcome, {}, &ConstraintOutcome::residual).residual);
  }
  for (const StepTime& time : editor->measure().flattening.timings)
    fmt::print("{} {:.3f} s in all, {:.3f} s of them before the moves\n", time.step, time.seconds,
               seconds_before(start.flattening.timings, time.step));
  MapEditor fresh = begun(scene, args);
  check(fresh.solve(options));
  const double apart = largest_difference(fresh.uv(), editor->uv()) / scene.extent;
  if (!(apart < 1e-4))
    stop(fmt::format("the editor ends {:.1e} of the extent from where a fresh one does", apart));
  fmt::print("the same place as a fresh editor's to {:.1e} of the extent\n", apart);
  fmt::print("first solve over solve after a move (median): {:.1f}\n", first / median(seconds));
  return 0;
}
