// The figures of the parameterization benchmark under the names that reports and comparisons give them.
#pragma once

#include <array>
#include <utility>

#include "engine/model/flattening.hpp"

namespace planish {

inline std::array<std::pair<const char*, double>, 9> named_figures(const BenchmarkFigures& b) {
  return {{{"max_area_distortion", b.max_area_distortion},
           {"average_area_error", b.average_area_error},
           {"min_singular_value", b.min_singular_value},
           {"max_singular_value", b.max_singular_value},
           {"proportion_flipped_triangles", b.proportion_flipped_triangles},
           {"bijectivity_violation_area", b.bijectivity_violation_area},
           {"max_angle_distortion", b.max_angle_distortion},
           {"average_angle_error", b.average_angle_error},
           {"resolution", b.resolution}}};
}

}  // namespace planish
