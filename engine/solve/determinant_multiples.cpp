#include "engine/solve/determinant_multiples.hpp"

#include <algorithm>

#include "engine/solve/winding.hpp"

namespace planish {
namespace {

constexpr double kInside = 2;
constexpr int kRings = 8;

}  // namespace

std::vector<double> determinant_multiples(const ArapEnergy& mesh) {
  std::vector<double> multiple(mesh.num_triangles(), kInside);
  std::vector<int> ring(mesh.num_vertices(), kRings);
  std::vector<Index> reached;
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.fixed[v] || is_interior(mesh, v)) continue;
    ring[v] = 0;
    reached.push_back(v);
  }
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const int at = ring[reached[k]];
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(reached[k]))) {
      multiple[c / 3] = std::min(multiple[c / 3], kInside * at / kRings);
      for (const Index u : {mesh.corner_vertex[next_corner(c)], mesh.corner_vertex[previous_corner(c)]}) {
        if (ring[u] <= at + 1) continue;
        ring[u] = at + 1;
        reached.push_back(u);
      }
    }
  }
  return multiple;
}

}  // namespace planish
