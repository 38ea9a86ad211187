#include "engine/methods/sizes.hpp"

#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {

void fit_sizes(const Workpiece& piece, In<Pin> pins, bool together, Out<Vec2> uv) {
  const Index num_components = piece.topology().num_components;
  const std::vector<Index>& corner_vertex = piece.mesh().corner_vertex;
  const auto group = [&](Index component) { return together ? 0 : component; };
  // sum A |s J - R|^2 is least at s = sum A (s1 + s2) / sum A (s1^2 + s2^2).
  std::vector<double> sum(num_components, 0), squares(num_components, 0), surface(num_components, 0);
  for (Index t = 0; t < piece.mesh().num_triangles(); ++t) {
    const RestFrame& frame = piece.geometry.frame[t];
    const Index* v = &corner_vertex[3 * static_cast<std::size_t>(t)];
    const SingularValues s = singular_values(jacobian(frame, uv[v[0]], uv[v[1]], uv[v[2]]));
    const Index k = group(piece.component[v[0]]);
    sum[k] += area(frame) * (s.sigma_max + s.sigma_min);
    squares[k] += area(frame) * (s.sigma_max * s.sigma_max + s.sigma_min * s.sigma_min);
    surface[k] += area(frame);
  }
  std::vector<Vec2> centre(num_components);
  std::vector<Index> count(num_components, 0);
  for (const Pin& pin : pins) {
    centre[piece.component[pin.vertex]] = pin.uv;
    ++count[piece.component[pin.vertex]];
  }
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Index component = piece.component[v], k = group(component);
    if (count[component] > 1 || !(squares[k] > 0)) continue;
    // A map that is mostly turned over is as large as its surface.
    const double scale = sum[k] > 0 ? sum[k] / squares[k] : std::sqrt(2 * surface[k] / squares[k]);
    uv[v] = centre[component] + scale * (uv[v] - centre[component]);
  }
}

}  // namespace planish
