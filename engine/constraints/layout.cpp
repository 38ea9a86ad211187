#include "engine/constraints/layout.hpp"

#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/intrinsic/transport.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {

double laid_out_rotation(const Layout& layout, const RestSurface& rest, Index c) {
  const In<Index> vertex = rest.mesh->corner_vertex;
  const Index t = c / 3;
  if (layout.fixed_triangle[t]) {
    const std::array<Vec2, 3> image = {layout.point[vertex[3 * t]], layout.point[vertex[3 * t + 1]],
                                       layout.point[vertex[3 * t + 2]]};
    return argument(closest_rotation(image, cotangents(rest.frame[t]).at.data(), rest.frame[t]));
  }
  return edge_rotation(layout, rest, c);
}

double edge_rotation(const Layout& layout, const RestSurface& rest, Index c) {
  return layout.direction(rest.mesh->corner_vertex, c) - edge_direction(rest.frame[c / 3], c % 3);
}

}  // namespace planish
