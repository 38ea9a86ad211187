#include "engine/solve/quasi_newton.hpp"

#include <algorithm>

#include "kernels/base/offsets.hpp"
#include "kernels/base/sums.hpp"

namespace planish {

std::vector<double> dots(const Exec& exec, const std::vector<std::pair<In<Vec2>, In<Vec2>>>& pairs) {
  if (pairs.empty()) return {};
  const auto n = static_cast<Index>(pairs.front().first.size());
  const Index num_blocks = Exec::num_blocks(n, kBlock);
  std::vector<double> partial(pairs.size() * num_blocks);  // one row a pair
  exec.for_blocks(n, kBlock, [&](Index block, Range r) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      partial[k * num_blocks + block] = dot(slice(pairs[k].first, r), slice(pairs[k].second, r));
    }
  });
  std::vector<double> result(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    result[k] = pairwise_sum(In<double>(partial).subspan(k * num_blocks, num_blocks));
  }
  return result;
}

double dot(const Exec& exec, In<Vec2> a, In<Vec2> b) { return dots(exec, {{a, b}}).front(); }

void combine(const Exec& exec, const std::vector<Scaled>& terms, Out<Vec2> sum) {
  exec.for_blocks(static_cast<Index>(sum.size()), kBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) sum[i] = terms.front().scale * terms.front().vector[i];
    for (std::size_t k = 1; k < terms.size(); ++k) {
      for (Index i = r.begin; i < r.end; ++i) sum[i] += terms[k].scale * terms[k].vector[i];
    }
  });
}

void QuasiNewton::drop_oldest() {
  pairs_.erase(pairs_.begin());
  for (Pair& pair : pairs_) {
    pair.step_with.erase(pair.step_with.begin());
    pair.with_step.erase(pair.with_step.begin());
    pair.curvature_with.erase(pair.curvature_with.begin());
  }
}

void QuasiNewton::add(std::vector<Vec2> step, std::vector<Vec2> force_change,
                      std::vector<Vec2> solved_change) {
  if (memory_ == 0) return;
  if (pairs_.size() == static_cast<std::size_t>(memory_)) drop_oldest();
  pairs_.push_back({std::move(step), std::move(force_change), std::move(solved_change), {}, {}, {}});
  Pair& added = pairs_.back();
  std::vector<std::pair<In<Vec2>, In<Vec2>>> products;
  for (const Pair& pair : pairs_) {
    products.emplace_back(added.step, pair.force_change);
    products.emplace_back(pair.step, added.force_change);
    products.emplace_back(added.force_change, pair.solved_change);
  }
  const std::vector<double> product = dots(exec_, products);
  for (std::size_t k = 0; k < product.size(); k += 3) {
    added.step_with.push_back(product[k]);
    added.with_step.push_back(product[k + 1]);
    added.curvature_with.push_back(product[k + 2]);
  }
  if (!(added.curvature() > 0)) pairs_.pop_back();
}

double QuasiNewton::step_times_change(std::size_t i, std::size_t j) const {
  return i >= j ? pairs_[i].step_with[j] : pairs_[j].with_step[i];
}

double QuasiNewton::change_times_solved(std::size_t i, std::size_t j) const {
  return pairs_[std::max(i, j)].curvature_with[std::min(i, j)];  // L^-1 is symmetric
}

void QuasiNewton::direction(In<Vec2> force, In<Vec2> d, Out<Vec2> direction) const {
  const std::size_t m = pairs_.size();
  std::vector<std::pair<In<Vec2>, In<Vec2>>> products;
  for (const Pair& pair : pairs_) {
    products.emplace_back(pair.step, force);
    products.emplace_back(pair.force_change, d);
  }
  const std::vector<double> product = dots(exec_, products);

  // First loop: q = f - sum alpha_j y_j; then -L^-1 q = d + sum alpha_j L^-1 y_j.
  std::vector<double> alpha(m), slope(m);
  for (std::size_t i = m; i-- > 0;) {
    double s_q = product[2 * i];
    for (std::size_t j = i + 1; j < m; ++j) s_q -= alpha[j] * step_times_change(i, j);
    alpha[i] = s_q / pairs_[i].curvature();
  }
  // The energy curves less than the Laplacian, down to half as much where triangles turn: the scale follows the
  // newest pair, which halves the number of steps (perf/README.md).
  const double scale = m > 0 ? pairs_[m - 1].curvature() / change_times_solved(m - 1, m - 1) : 1;
  std::vector<Scaled> terms = {{scale, d}};
  for (std::size_t j = 0; j < m; ++j) terms.push_back({scale * alpha[j], pairs_[j].solved_change});
  // Second loop: direction += slope_k s_k.
  for (std::size_t k = 0; k < m; ++k) {
    double y_direction = scale * product[2 * k + 1];
    for (std::size_t j = 0; j < m; ++j) y_direction += scale * alpha[j] * change_times_solved(k, j);
    for (std::size_t j = 0; j < k; ++j) y_direction += slope[j] * step_times_change(j, k);
    slope[k] = -alpha[k] - y_direction / pairs_[k].curvature();
    terms.push_back({slope[k], pairs_[k].step});
  }
  combine(exec_, terms, direction);
}

}  // namespace planish
