// One piece of work on one thread, for instructions to be counted: instructions.py runs it under callgrind, which collects
// inside planish_gate() alone.
//
// usage: gate order|analyse|factor|solve|round|solve_rounded|local|read MESH
#include <cstdio>
#include <cstring>

#include "engine/solve/cholesky_analysis.hpp"
#include "engine/solve/local_phase.hpp"
#include "perf/scene.hpp"

using namespace planish;
using perf::require;

/// The work that is counted.
extern "C" [[gnu::noinline]] void planish_gate(const std::function<void()>& work) {
  work();
  asm volatile("" ::: "memory");  // not a tail call
}

namespace {

void count_solver(const char* what, const Exec& exec, const Workpiece& piece) {
  const SymmetricMatrix laplacian = perf::held_laplacian(exec, piece);
  std::vector<Index> order;
  const auto find_order = [&] { order = *fill_reducing_order(exec, laplacian); };
  if (!std::strcmp(what, "order")) return planish_gate(find_order);
  find_order();
  if (!std::strcmp(what, "analyse"))
    return planish_gate([&] { require(analyse_cholesky(exec, laplacian, order).has_value(), "analysis"); });
  auto global = GlobalPhase::factor(exec, laplacian, order);
  require(global.has_value(), "factor");
  if (!std::strcmp(what, "factor"))
    return planish_gate([&] { require(global->refactor(exec, laplacian).has_value(), "refactor"); });
  std::vector<Vec2> x(laplacian.size(), Vec2{1, -2});
  if (!std::strcmp(what, "round")) return planish_gate([&] { global->round(exec); });
  if (!std::strcmp(what, "solve_rounded")) global->round(exec);
  planish_gate([&] { global->solve(exec, x, x); });
}

void count_local(const Exec& exec, const Workpiece& piece) {
  const std::vector<std::uint8_t> fixed(piece.mesh().num_vertices(), 0);
  LocalPhase local(exec, {.corner_vertex = piece.mesh().corner_vertex,
                          .stars = piece.topology().stars(),
                          .star_corner = piece.topology().star_corner,
                          .frame = piece.geometry.frame,
                          .cotangent = piece.geometry.cotangent,
                          .fixed = fixed,
                          .area = piece.geometry.area});
  std::vector<Vec2> uv(fixed.size()), force(fixed.size());
  for (std::size_t v = 0; v < uv.size(); ++v)
    uv[v] = {piece.mesh().position[v].x, piece.mesh().position[v].y};
  double energy = 0;
  planish_gate([&] { energy = local.evaluate(uv, force); });
  require(energy > 0, "local");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const char* const what = argv[1];
  const Exec exec(1);
  if (!std::strcmp(what, "read")) {
    planish_gate([&] { require(read_mesh(exec, argv[2]).has_value(), "read"); });
    return 0;
  }
  const auto mesh = read_mesh(exec, argv[2]);
  require(mesh.has_value(), "mesh");
  const auto piece = make_workpiece(exec, mesh->surface());
  require(piece.has_value(), "workpiece");
  if (!std::strcmp(what, "local")) {
    count_local(exec, *piece);
  } else {
    count_solver(what, exec, *piece);
  }
}
