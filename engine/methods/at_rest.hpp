// When an iteration of linear solves is done: its steps are small enough, or as small as solves can make them.
#pragma once

#include <algorithm>

#include "kernels/base/types.hpp"

namespace planish {

class AtRest {
 public:
  /// Steps at most `still` end it; so do steps at most `rounding` that have not halved for some time: what solves err by
  /// grows with the mesh.
  AtRest(double still, double rounding) : still_(still), rounding_(rounding) {}

  bool operator()(double step) {
    constexpr int kPatience = 6;
    since_least_ = step < 0.5 * least_ ? 0 : since_least_ + 1;
    least_ = std::min(least_, step);
    return step <= still_ || (step <= rounding_ && since_least_ >= kPatience);
  }

 private:
  double still_, rounding_, least_ = kInfinity;
  int since_least_ = 0;
};

}  // namespace planish
