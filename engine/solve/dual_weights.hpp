// Weights of the dual edges in the norm of the rotation problem.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/solve/start.hpp"
#include "kernels/intrinsic/cotangents.hpp"

namespace planish {

/// Residual of a rotation row that is still rounding, radians.
inline constexpr double kLargestRotationResidual = 1e-9;
/// Of the mean weight, so that obtuse pairs do not turn weights negative.
inline constexpr double kLeastWeightShare = 1e-3;

/// Cotangent weights of edges, floored at a share of their mean.
class FlooredWeights {
 public:
  FlooredWeights(const Exec& exec, const StartInput& input) : input_(input) {
    const auto num_corners = static_cast<Index>(input.corner_vertex.size());
    const double total = exec.sum_blocks(num_corners, kBlock, [&](Range r) {
      double sum = 0;
      for (Index c = r.begin; c < r.end; ++c) sum += 0.5 * input.cotangent[c];
      return sum;
    });
    least_ = kLeastWeightShare * std::abs(total) / std::max<double>(1, input.topology->num_edges);
  }
  double operator()(Index c) const { return std::max(plain(c), least_); }

 private:
  double plain(Index c) const { return edge_cotangent(input_.cotangent, c, input_.topology->corner_twin[c]); }
  const StartInput& input_;
  double least_ = 0;
};

}  // namespace planish
