#include "io/stretch_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/raster.hpp"
#include "kernels/intrinsic/lengths.hpp"
#include "kernels/local/jacobians.hpp"

namespace planish {
namespace {

constexpr std::array kLimits{1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4, 8e-4, 1e-3, 2e-3, 3e-3,
                             4e-3, 5e-3, 6e-3, 8e-3, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06,
                             0.08, 0.1,  0.2,  0.3,  0.4,  0.5,  0.6,  0.8,  1.0};

/// Rest area of the triangles up to each limit and above the one before; the last one counts all beyond, too.
using AreaByLimit = std::array<double, kLimits.size()>;

std::size_t limit_of(double deviation) {
  const auto place = std::ranges::lower_bound(kLimits, std::abs(deviation)) - kLimits.begin();
  return std::min(static_cast<std::size_t>(place), kLimits.size() - 1);
}

double choose_limit(const std::vector<AreaByLimit>& partial) {
  constexpr double kShare = 0.99;
  AreaByLimit area{};
  double total = 0;
  for (const AreaByLimit& block : partial) {
    for (std::size_t k = 0; k < area.size(); ++k) area[k] += block[k];
  }
  for (const double a : area) total += a;
  double held = 0;
  for (std::size_t k = 0; k < area.size(); ++k) {
    held += area[k];
    if (held >= kShare * total) return kLimits[k];
  }
  return kLimits.back();
}

}  // namespace

double stretch_deviation(SingularValues sigma) {
  if (!std::isfinite(sigma.sigma_max)) return kInfinity;
  if (sigma.sigma_min <= 0) return -1;
  return sigma.sigma_max * sigma.sigma_min >= 1 ? sigma.sigma_max - 1 : sigma.sigma_min - 1;
}

StretchField stretch_field(const Exec& exec, const Surface& surface, In<Vec2> uv, In<Index> flipped) {
  const Index num_triangles = surface.num_triangles();
  StretchField field{std::vector<float>(num_triangles), 0};
  for (const Index t : flipped) field.value[t] = kFlippedValue;
  std::vector<AreaByLimit> partial(Exec::num_blocks(num_triangles, kBlock), AreaByLimit{});
  exec.for_blocks(num_triangles, kBlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      if (field.value[t] == kFlippedValue) continue;
      const Index i = surface.corner_vertex[3 * t], j = surface.corner_vertex[3 * t + 1],
                  k = surface.corner_vertex[3 * t + 2];
      const RestFrame frame = rest_frame(surface.position[i], surface.position[j], surface.position[k]);
      const double deviation = stretch_deviation(singular_values(jacobian(frame, uv[i], uv[j], uv[k])));
      field.value[t] = static_cast<float>(std::min(deviation, 1.0));
      if (area(frame) > 0) partial[block][limit_of(deviation)] += area(frame);
    }
  });
  field.limit = choose_limit(partial);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      float& value = field.value[t];
      if (value != kFlippedValue) value = static_cast<float>(std::clamp(value / field.limit, -1.0, 1.0));
    }
  });
  return field;
}

}  // namespace planish
