#include "kernels/topology/corners.hpp"

namespace planish {

void find_twins(Range r, In<Index> corner_vertex, Offsets stars, In<Index> star_corner, Out<Index> twin,
                Out<EdgeKind> kind) {
  for (Index c = r.begin; c < r.end; ++c) {
    const Index i = corner_vertex[c], j = corner_vertex[next_corner(c)];
    const Range star_i = stars.group(i), star_j = stars.group(j);
    const bool search_i = star_i.end - star_i.begin < star_j.end - star_j.begin;
    const Index center = search_i ? i : j, far = search_i ? j : i;
    const Range star = search_i ? star_i : star_j;
    Index others = 0, other = kNone, same_direction = 0;
    for (Index k = star.begin; k < star.end; ++k) {
      const Index leaving = star_corner[k], arriving = previous_corner(leaving);
      for (const Index half_edge : {leaving, arriving}) {
        const Index end = half_edge == leaving ? next_corner(leaving) : arriving;
        if (half_edge == c || corner_vertex[end] != far) continue;
        ++others;
        other = half_edge;
        same_direction += corner_vertex[half_edge] == i ? 1 : 0;
      }
    }
    twin[c] = others == 1 ? other : kNone;
    kind[c] = others == 0                   ? EdgeKind::Boundary
              : others > 1 || center == far ? EdgeKind::NonManifold
              : same_direction == 1         ? EdgeKind::Inconsistent
                                            : EdgeKind::Interior;
  }
}

}  // namespace planish
