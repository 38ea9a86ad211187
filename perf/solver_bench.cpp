// The solver against CHOLMOD, METIS and the memory: each benchmark proves its answer, then takes both sides in turns and
// states the ratio of the medians. Names are the keys of perf/README.md.
//
// usage: solver_bench [Google Benchmark's options]     PLANISH_PERF_MESH: another mesh
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>

#include "engine/exec/large_array.hpp"
#include "engine/solve/cholesky_analysis.hpp"
#include "engine/solve/local_phase.hpp"
#include "perf/scene.hpp"
#include "tests/support/cholmod_reference.hpp"

namespace {

using namespace planish;
using perf::require;

constexpr Index kTriangles = 909'000, kNewtonTriangles = 227'000;
constexpr int kSolves = 20;

double seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Both in turns; the ratio is other / own unless the own time is measured over a limit.
enum class Ratio { OtherOverOwn, OwnOverOther };

void in_turns(benchmark::State& state, Ratio kind, const std::function<void()>& own,
              const std::function<void()>& other) {
  std::vector<double> own_s, other_s;
  for (auto _ : state) {
    own_s.push_back(seconds(own));
    other_s.push_back(seconds(other));
    state.SetIterationTime(own_s.back());
  }
  const double a = median(own_s), b = median(other_s);
  state.counters["ratio"] = kind == Ratio::OtherOverOwn ? b / a : a / b;
  state.counters["own_s"] = a;
  state.counters["other_s"] = b;
}

struct Scene {
  Exec exec;
  Workpiece piece;
  SymmetricMatrix laplacian;
  std::vector<Index> own, metis;
  std::vector<Vec2> rhs;
  std::unique_ptr<GlobalPhase> global;        // with the own order
  std::unique_ptr<CholmodReference> cholmod;  // with METIS's

  Scene() {
    const Mesh mesh = perf::perf_mesh(exec, kTriangles);
    auto made = make_workpiece(exec, mesh.surface());
    require(made.has_value(), "mesh");
    piece = std::move(*made);
    laplacian = perf::held_laplacian(exec, piece);
    own = *fill_reducing_order(exec, laplacian);
    metis = CholmodReference::metis(laplacian);
    rhs.resize(laplacian.size());
    for (Index i = 0; i < laplacian.size(); ++i) rhs[i] = {std::sin(0.37 * i), std::cos(0.11 * i)};
    global = std::make_unique<GlobalPhase>(std::move(*GlobalPhase::factor(exec, laplacian, own)));
    cholmod = std::make_unique<CholmodReference>(laplacian, metis);
    require(cholmod->factor(), "CHOLMOD");
  }

  static Scene& get() {
    static Scene scene;
    return scene;
  }
};

double largest_difference(In<Vec2> a, In<Vec2> b) {
  double worst = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, norm(a[i] - b[i]));
    size = std::max(size, norm(b[i]));
  }
  return worst / size;
}

std::vector<Vec2> solved(const GlobalPhase& global, const Exec& exec, In<Vec2> rhs) {
  std::vector<Vec2> x(rhs.size());
  global.solve(exec, rhs, x);
  return x;
}

/// Adds up all of it, on every thread: nothing can read it faster.
double read_all(const Exec& exec, const double* value, Offset size) {
  constexpr Index kChunk = 1 << 16;
  return exec.sum_blocks(static_cast<Index>(size / kChunk), 1, [&](Range r) {
    const double* p = value + static_cast<Offset>(r.begin) * kChunk;
    std::array<double, 16> sum{};
    for (Index k = 0; k < kChunk; k += 16) {
      for (Index l = 0; l < 16; ++l) sum[l] += p[k + l];
    }
    return pairwise_sum(sum);
  });
}

/// Memory of a size, written and then read as a limit.
struct Ballast {
  LargeArray<double> value;
  explicit Ballast(Offset size) : value(size) { std::fill_n(value.data(), size, 1.0); }
};

void solve_vs_cholmod(benchmark::State& state) {
  Scene& s = Scene::get();
  std::vector<Vec2> x = solved(*s.global, s.exec, s.rhs);
  require(largest_difference(x, s.cholmod->solve(s.rhs)) < 1e-8, "solve");
  in_turns(
      state, Ratio::OtherOverOwn, [&] { s.global->solve(s.exec, s.rhs, x); },
      [&] { s.cholmod->solve(s.rhs); });
}

void solve_single_vs_cholmod(benchmark::State& state) {
  Scene& s = Scene::get();
  GlobalPhase rounded = *GlobalPhase::factor(s.exec, s.laplacian, s.own);
  rounded.round(s.exec);
  std::vector<Vec2> x = solved(rounded, s.exec, s.rhs);
  require(largest_difference(x, s.cholmod->solve(s.rhs)) < 1e-2, "solve in single precision");
  in_turns(
      state, Ratio::OtherOverOwn, [&] { rounded.solve(s.exec, s.rhs, x); }, [&] { s.cholmod->solve(s.rhs); });
}

void solve_vs_read_limit(benchmark::State& state) {
  Scene& s = Scene::get();
  std::vector<Vec2> x(s.rhs.size());
  const Ballast ballast(s.global->factor_nonzeros());
  double sum = 0;
  in_turns(
      state, Ratio::OwnOverOther, [&] { s.global->solve(s.exec, s.rhs, x); },
      [&] {
        for (int twice = 0; twice < 2; ++twice)
          sum += read_all(s.exec, ballast.value.data(), ballast.value.size());
      });
  require(sum > 0, "read");
}

void factor_matrix(benchmark::State& state, const Exec& exec, const SymmetricMatrix& matrix,
                   In<Index> order) {
  auto global = GlobalPhase::factor(exec, matrix, order);
  require(global.has_value(), "factor");
  CholmodReference cholmod(matrix, order);
  require(cholmod.factor(), "CHOLMOD");
  std::vector<Vec2> rhs(matrix.size(), Vec2{1, -2});
  require(largest_difference(solved(*global, exec, rhs), cholmod.solve(rhs)) < 1e-8, "factor");
  in_turns(
      state, Ratio::OtherOverOwn, [&] { require(global->refactor(exec, matrix).has_value(), "refactor"); },
      [&] { require(cholmod.factor(), "CHOLMOD"); });
  state.counters["gflop"] = cholmod.flops() * 1e-9;
  state.counters["gflops"] = cholmod.flops() * 1e-9 / state.counters["own_s"];
}

void factor_vs_cholmod(benchmark::State& state) {
  Scene& s = Scene::get();
  factor_matrix(state, s.exec, s.laplacian, s.metis);
}

void newton_factor_vs_cholmod(benchmark::State& state) {
  const Exec exec;
  const Mesh mesh = perf::perf_mesh(exec, kNewtonTriangles);
  const auto piece = make_workpiece(exec, mesh.surface());
  const SymmetricMatrix laplacian = perf::held_laplacian(exec, *piece);
  factor_matrix(state, exec, perf::newton_like(laplacian),
                perf::in_pairs(CholmodReference::metis(laplacian)));
}

/// Analysis, factorization and solves, from the matrix alone.
void whole_solver(const Exec& exec, const Scene& s, Out<Vec2> x) {
  const auto global = GlobalPhase::factor(exec, s.laplacian, *fill_reducing_order(exec, s.laplacian));
  require(global.has_value(), "factor");
  for (int k = 0; k < kSolves; ++k) global->solve(exec, s.rhs, x);
}

void solver_total_vs_cholmod(benchmark::State& state) {
  Scene& s = Scene::get();
  std::vector<Vec2> x(s.rhs.size());
  in_turns(
      state, Ratio::OtherOverOwn, [&] { whole_solver(s.exec, s, x); },
      [&] {
        CholmodReference cholmod(s.laplacian);
        require(cholmod.factor(), "CHOLMOD");
        for (int k = 0; k < kSolves; ++k) cholmod.solve(s.rhs);
      });
}

void solver_threads2_speedup(benchmark::State& state) {
  Scene& s = Scene::get();
  const Exec one(1), two(2);
  std::vector<Vec2> x(s.rhs.size()), y(s.rhs.size());
  in_turns(
      state, Ratio::OtherOverOwn, [&] { whole_solver(two, s, x); }, [&] { whole_solver(one, s, y); });
  require(x == y, "the same bits on one and two threads");
}

void analyze_vs_metis(benchmark::State& state) {
  Scene& s = Scene::get();
  in_turns(
      state, Ratio::OtherOverOwn,
      [&] {
        require(analyse_cholesky(s.exec, s.laplacian, *fill_reducing_order(s.exec, s.laplacian)).has_value(),
                "analysis");
      },
      [&] { const CholmodReference cholmod(s.laplacian); });
}

void fill_flops_vs_metis(benchmark::State& state) {
  Scene& s = Scene::get();
  const CholmodReference own(s.laplacian, s.own);
  for (auto _ : state) state.SetIterationTime(1);
  state.counters["ratio"] = own.flops() / s.cholmod->flops();
  state.counters["own_gflop"] = own.flops() * 1e-9;
  state.counters["own_entries"] = own.factor_entries();
  state.counters["other_entries"] = s.cholmod->factor_entries();
}

void local_vs_read_limit(benchmark::State& state) {
  Scene& s = Scene::get();
  const Workpiece& piece = s.piece;
  const Index num_vertices = piece.mesh().num_vertices(), num_triangles = piece.mesh().num_triangles();
  const std::vector<std::uint8_t> fixed(num_vertices, 0);
  LocalPhase local(s.exec, {.corner_vertex = piece.mesh().corner_vertex,
                            .stars = piece.topology().stars(),
                            .star_corner = piece.topology().star_corner,
                            .frame = piece.geometry.frame,
                            .cotangent = piece.geometry.cotangent,
                            .fixed = fixed,
                            .area = piece.geometry.area});
  std::vector<Vec2> uv(num_vertices), force(num_vertices);
  for (Index v = 0; v < num_vertices; ++v) uv[v] = {piece.mesh().position[v].x, piece.mesh().position[v].y};
  // What it cannot do without: corners, frames, cotangents and stars once, positions and forces of the vertices.
  const Offset bytes = Offset{num_triangles} * (12 + 24 + 24 + 12) + Offset{num_vertices} * (4 + 16 + 16);
  const Ballast ballast(bytes / 8);
  double sum = 0;
  in_turns(
      state, Ratio::OwnOverOther, [&] { sum += local.evaluate(uv, force); },
      [&] { sum += read_all(s.exec, ballast.value.data(), ballast.value.size()); });
  require(sum > 0, "local");
}

#define PLANISH_BENCH(name, turns) \
  BENCHMARK(name)->Iterations(turns)->UseManualTime()->Unit(benchmark::kMillisecond)
PLANISH_BENCH(solve_vs_cholmod, 15);
PLANISH_BENCH(solve_single_vs_cholmod, 15);
PLANISH_BENCH(solve_vs_read_limit, 15);
PLANISH_BENCH(factor_vs_cholmod, 7);
PLANISH_BENCH(newton_factor_vs_cholmod, 5);
PLANISH_BENCH(solver_total_vs_cholmod, 3);
PLANISH_BENCH(solver_threads2_speedup, 3);
PLANISH_BENCH(analyze_vs_metis, 3);
PLANISH_BENCH(fill_flops_vs_metis, 1);
PLANISH_BENCH(local_vs_read_limit, 15);

}  // namespace

BENCHMARK_MAIN();
