#include "engine/solve/relax_around.hpp"

#include "engine/solve/patches.hpp"

namespace planish {
namespace {

/// Flips cost everything, what is compressed nothing more.
constexpr MapDensity kPlainArap = {.kind = MapDensity::Kind::Arap, .barrier = {.weight = 0, .delta = 1e-12}};

/// A Newton step from such a gradient ends near enough to the minimum.
constexpr double kNear = 1e-2;
constexpr int kMostSteps = 2;

Result<void> relax(const Exec& exec, const ArapEnergy& mesh, const Patch& patch, Out<Vec2> uv) {
  const PatchMesh local(mesh, patch);
  std::vector<Vec2> start;
  for (const Index v : patch.vertex) start.push_back(uv[v]);
  NewtonMap map(exec, local.energy(), local.unknowns(), nullptr, std::move(start));
  if (!map.measure().is_injective(map.uv())) return {};
  map.lower(kPlainArap);
  for (int step = 0; step < kMostSteps; ++step) {
    if (auto prepared = map.prepare(); !prepared) {
      if (prepared.error().code != ErrorCode::FactorizationFailed) return prepared;
      break;
    }
    if (!map.advance() || map.gradient() <= kNear) break;
  }
  for (Index i = 0; i < patch.num_free; ++i) uv[patch.vertex[i]] = map.uv()[i];
  return {};
}

}  // namespace

Result<void> relax_around(const Exec& exec, const ArapProblem& problem, In<Index> vertex, int rings,
                          Out<Vec2> uv) {
  const ArapEnergy& mesh = problem.energy;
  const NodeMap& nodes = problem.dof->nodes();
  const Index num_vertices = mesh.num_vertices();
  std::vector<std::uint8_t> movable(num_vertices);
  std::vector<Index> rank(num_vertices);
  exec.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) {
      movable[k] = nodes.node[k] == k;
      rank[problem.order[k]] = k;
    }
  });
  std::vector<Index> seeds;
  for (const Index v : vertex) {
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) seeds.push_back(c / 3);
  }
  for (const Patch& patch : grow_patches(mesh, seeds, rings, movable, rank)) {
    if (auto relaxed = relax(exec, mesh, patch, uv); !relaxed) return relaxed;
  }
  return {};
}

}  // namespace planish
