#include "engine/solve/winding.hpp"

#include "kernels/exact/orient2.hpp"

namespace planish {
namespace {

/// +1 where the step from a to b crosses the positive x axis upwards, -1 downwards, exactly.
int crossing(Vec2 centre, Vec2 a, Vec2 b) {
  const bool a_below = a.y < centre.y, b_below = b.y < centre.y;
  if (a_below == b_below) return 0;
  const int side = orient2(a, b, centre);
  if (a_below) return side > 0 ? 1 : 0;
  return side < 0 ? -1 : 0;
}

/// Directions in [0, pi), such that opposite ones differ.
bool is_upward(Vec2 from, Vec2 to) { return to.y > from.y || (to.y == from.y && to.x > from.x); }

}  // namespace

bool is_interior(const ArapEnergy& mesh, Index v) {
  const In<Index> star = slice(mesh.star_corner, mesh.stars.group(v));
  if (star.empty()) return false;
  for (std::size_t k = 0; k < star.size(); ++k) {
    const Index before = star[k > 0 ? k - 1 : star.size() - 1];
    if (mesh.corner_vertex[next_corner(star[k])] != mesh.corner_vertex[previous_corner(before)]) return false;
  }
  return true;
}

Winding::Winding(const Exec& exec, const ArapEnergy& mesh)
    : exec_(exec),
      mesh_(mesh),
      boundary_(select(exec, mesh.num_vertices(), [&](Index v) { return !is_interior(mesh, v); })) {}

bool Winding::is_single(In<Vec2> uv) const {
  const auto num_boundary = static_cast<Index>(boundary_.size());
  std::vector<Offset> half_turns(Exec::num_blocks(num_boundary, kBlock));
  exec_.for_blocks(num_boundary, kBlock, [&](Index block, Range r) {
    for (const Index v : slice(In<Index>(boundary_), r)) {
      for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(v))) {
        half_turns[block] += is_upward(uv[v], uv[mesh_.corner_vertex[next_corner(c)]]) !=
                             is_upward(uv[v], uv[mesh_.corner_vertex[previous_corner(c)]]);
      }
    }
  });
  Offset inside = mesh_.num_triangles();
  for (const Offset turns : half_turns) inside -= turns;
  return inside == Offset{2} * (mesh_.num_vertices() - num_boundary);
}

std::vector<Index> overwound_vertices(const Exec& exec, const ArapEnergy& mesh, In<Vec2> uv) {
  return select(exec, mesh.num_vertices(), [&](Index v) {
    if (!is_interior(mesh, v)) return false;
    int turns = 0;
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(v)))
      turns +=
          crossing(uv[v], uv[mesh.corner_vertex[next_corner(c)]], uv[mesh.corner_vertex[previous_corner(c)]]);
    return turns > 1;
  });
}

}  // namespace planish
