#include "kernels/intrinsic/cotangents.hpp"

#include <algorithm>

namespace planish {

Cotangents cotangents(const RestFrame& frame) {
  const auto edge = edge_vectors(frame);
  const std::array<double, 3> squared = {dot(edge[0], edge[0]), dot(edge[1], edge[1]), dot(edge[2], edge[2])};
  const auto base = static_cast<int>(std::max_element(squared.begin(), squared.end()) - squared.begin());
  const int next = (base + 1) % 3,
            apex = (base + 2) % 3;  // base edge runs from corner `base` to corner `next`
  const double length = std::sqrt(squared[base]);
  const double foot = -dot(edge[apex], edge[base]) / length;  // of the apex along the base edge
  const double altitude = frame.x1 * frame.y2 / length;
  const double least = kLeastAltitude * length;
  const double h = std::max(altitude, least);
  Cotangents result{.at = {}, .mollified = altitude < least};
  result.at[base] = foot / h;
  result.at[next] = (length - foot) / h;
  result.at[apex] = (h * h - foot * (length - foot)) / (length * h);
  return result;
}

void cotangents(Range triangles, In<RestFrame> frame, Out<double> cotangent, Out<std::uint8_t> mollified) {
  for (Index t = triangles.begin; t < triangles.end; ++t) {
    const Cotangents c = cotangents(frame[t]);
    for (int i = 0; i < 3; ++i) cotangent[3 * t + i] = c.at[i];
    mollified[t] = c.mollified ? 1 : 0;
  }
}

}  // namespace planish
