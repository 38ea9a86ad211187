// Layouts given by hand: chains with their images.
#pragma once

#include <algorithm>

#include "engine/constraints/layout.hpp"
#include "engine/features/one_ring.hpp"
#include "tests/engine/constraints/rest.hpp"

namespace planish::tests {

inline Layout empty_layout(const Rest& rest) {
  Layout layout;
  layout.assembly.assign(rest.mesh().num_vertices(), kNone);
  layout.point.resize(rest.mesh().num_vertices());
  layout.fixed_edge.assign(rest.mesh().corner_vertex.size(), 0);
  layout.fixed_triangle.assign(rest.mesh().num_triangles(), 0);
  return layout;
}

/// Fixes a chain's edges, as one more assembly, its vertices at the image's points.
inline void lay(const Rest& rest, const Feature& chain, In<Vec2> image, Layout& layout) {
  REQUIRE(image.size() == chain.vertex.size());
  const std::size_t n = chain.vertex.size();
  const Index assembly = *std::max_element(layout.assembly.begin(), layout.assembly.end()) + 1;
  for (std::size_t i = 0; i < n; ++i) {
    layout.assembly[chain.vertex[i]] = assembly;
    layout.point[chain.vertex[i]] = image[i];
    if (i + 1 == n && !chain.closed) break;
    const Index u = chain.vertex[i], v = chain.vertex[(i + 1) % n];
    for (const Index c : {half_edge(rest.mesh().surface(), rest.topology(), u, v),
                          half_edge(rest.mesh().surface(), rest.topology(), v, u)}) {
      if (c != kNone) layout.fixed_edge[c] = 1;
    }
  }
}

inline std::vector<Vec2> straight(std::size_t n) {
  std::vector<Vec2> image;
  for (std::size_t i = 0; i < n; ++i) image.push_back({0.1 * static_cast<double>(i), 0});
  return image;
}

}  // namespace planish::tests
