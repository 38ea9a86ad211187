#include "engine/solve/unwind.hpp"

#include <numeric>

#include "engine/solve/patches.hpp"

namespace planish {
namespace {

/// Gauss and Seidel's sweeps; near the rim's scale is near enough, for untangling goes on from there.
constexpr int kSweeps = 200;

Vec2 middle_of_neighbours(const ArapEnergy& mesh, Index v, In<Vec2> uv) {
  Vec2 sum;
  const In<Index> star = slice(mesh.star_corner, mesh.stars.group(v));
  for (const Index c : star)
    sum += uv[mesh.corner_vertex[next_corner(c)]] + uv[mesh.corner_vertex[previous_corner(c)]];
  return (0.5 / static_cast<double>(star.size())) * sum;
}

}  // namespace

void unwind(const ArapEnergy& mesh, In<Index> vertex, int rings, Out<Vec2> uv) {
  std::vector<std::uint8_t> movable(mesh.num_vertices());
  for (Index v = 0; v < mesh.num_vertices(); ++v) movable[v] = !mesh.fixed[v];
  std::vector<Index> rank(mesh.num_vertices()), seeds;
  std::iota(rank.begin(), rank.end(), 0);
  for (const Index v : vertex) {
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) seeds.push_back(c / 3);
  }
  for (const Patch& patch : grow_patches(mesh, seeds, rings, movable, rank)) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Index i = 0; i < patch.num_free; ++i)
        uv[patch.vertex[i]] = middle_of_neighbours(mesh, patch.vertex[i], uv);
    }
  }
}

}  // namespace planish
