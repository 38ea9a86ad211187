#include "kernels/base/sums.hpp"

namespace planish {

double pairwise_sum(In<double> value) {
  constexpr std::size_t kLeaf = 64;  // below this a plain loop; part of the promised tree
  if (value.size() <= kLeaf) {
    double sum = 0;
    for (double x : value) sum += x;
    return sum;
  }
  const std::size_t half = value.size() / 2;
  return pairwise_sum(value.first(half)) + pairwise_sum(value.subspan(half));
}

double dot(In<Vec2> a, In<Vec2> b) {
  constexpr std::size_t kUnrolled = 4;
  Vec2 sum[kUnrolled];
  std::size_t i = 0;
  for (; i + kUnrolled <= a.size(); i += kUnrolled) {
    for (std::size_t k = 0; k < kUnrolled; ++k) {
      sum[k].x += a[i + k].x * b[i + k].x;
      sum[k].y += a[i + k].y * b[i + k].y;
    }
  }
  for (; i < a.size(); ++i) sum[0] += Vec2{a[i].x * b[i].x, a[i].y * b[i].y};
  const Vec2 all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  return all.x + all.y;
}

}  // namespace planish
