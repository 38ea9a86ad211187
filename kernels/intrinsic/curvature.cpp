#include "kernels/intrinsic/curvature.hpp"

namespace planish {

void angle_sums(Range r, In<double> angle, Offsets stars, In<Index> star_corner, Out<double> angle_sum) {
  for (Index v = r.begin; v < r.end; ++v) {
    double sum = 0;
    for (const Index c : slice(star_corner, stars.group(v))) sum += angle[c];
    angle_sum[v] = sum;
  }
}

}  // namespace planish
