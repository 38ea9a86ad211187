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

}  // namespace planish
