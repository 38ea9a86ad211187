#include "engine/solve/quasi_newton.hpp"

#include <algorithm>

#include "kernels/base/offsets.hpp"
#include "kernels/base/sums.hpp"

namespace planish {

double dot(const Exec& exec, In<Vec2> a, In<Vec2> b) {
  return exec.sum_blocks(static_cast<Index>(a.size()), kBlock,
                         [&](Range r) { return dot(slice(a, r), slice(b, r)); });
}

void combine(const Exec& exec, const std::vector<Scaled>& terms, Out<Vec2> sum) {
  exec.for_blocks(static_cast<Index>(sum.size()), kBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) sum[i] = terms.front().scale * terms.front().vector[i];
    for (std::size_t k = 1; k < terms.size(); ++k) {
      for (Index i = r.begin; i < r.end; ++i) sum[i] += terms[k].scale * terms[k].vector[i];
    }
  });
}

/// Its memory back to the pool.
void QuasiNewton::drop(std::size_t dropped) {
  pool_.give(std::move(pairs_[dropped].step));
  pool_.give(std::move(pairs_[dropped].solved));
  pairs_.erase(pairs_.begin() + static_cast<std::ptrdiff_t>(dropped));
  for (std::size_t i = dropped; i < pairs_.size(); ++i) {
    const auto at = static_cast<std::ptrdiff_t>(dropped);
    pairs_[i].steps_with.erase(pairs_[i].steps_with.begin() + at);
    pairs_[i].solved_with.erase(pairs_[i].solved_with.begin() + at);
  }
}

void QuasiNewton::forget() {
  while (!pairs_.empty()) drop(pairs_.size() - 1);
}

void QuasiNewton::learn(const ForcePoint& before, const ForcePoint& now) {
  if (memory_ == 0) return;
  const auto n = static_cast<Index>(now.position.size());
  if (pairs_.size() == static_cast<std::size_t>(memory_)) drop(0);
  pairs_.push_back({.step = pool_.take(n), .solved = pool_.take(n)});
  Pair& added = pairs_.back();

  // All in one sweep: the new pair, its products with the force before, and all pairs' with the force now.
  std::vector<std::pair<In<Vec2>, In<Vec2>>> factors = {{added.step, before.force},
                                                        {added.solved, before.force}};
  for (const Pair& pair : pairs_) {
    factors.emplace_back(pair.step, now.force);
    factors.emplace_back(pair.solved, now.force);
  }
  const Index num_blocks = Exec::num_blocks(n, kBlock);
  std::vector<double> partial(factors.size() * num_blocks);  // one row a product
  exec_.for_blocks(n, kBlock, [&](Index block, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      added.step[v] = now.position[v] - before.position[v];
      added.solved[v] = before.descent[v] - now.descent[v];
    }
    for (std::size_t k = 0; k < factors.size(); ++k) {
      partial[k * num_blocks + block] = dot(slice(factors[k].first, r), slice(factors[k].second, r));
    }
  });
  const auto product = [&](std::size_t k) {
    return pairwise_sum(In<double>(partial).subspan(k * num_blocks, num_blocks));
  };

  added.step_force = product(0);
  added.solved_force = product(1);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const double step_force = product(2 + 2 * k), solved_force = product(3 + 2 * k);
    added.steps_with.push_back(step_force - pairs_[k].step_force);
    added.solved_with.push_back(solved_force - pairs_[k].solved_force);
    pairs_[k].step_force = step_force;
    pairs_[k].solved_force = solved_force;
  }
  if (!(added.curvature() > 0)) drop(pairs_.size() - 1);
}

double QuasiNewton::solved_product(std::size_t i, std::size_t j) const {
  return pairs_[std::max(i, j)].solved_with[std::min(i, j)];  // L^-1 is symmetric
}

double QuasiNewton::direction(In<Vec2> d, double force_times_d, Out<Vec2> direction) const {
  const std::size_t m = pairs_.size();
  // First loop: q = f - sum alpha_j y_j; then -L^-1 q = d + sum alpha_j L^-1 y_j.
  std::vector<double> alpha(m), slope(m);
  for (std::size_t i = m; i-- > 0;) {
    double s_q = pairs_[i].step_force;
    for (std::size_t j = i + 1; j < m; ++j) s_q -= alpha[j] * pairs_[j].steps_with[i];
    alpha[i] = s_q / pairs_[i].curvature();
  }
  // The energy curves less than the Laplacian, down to half as much where triangles turn: the scale follows the
  // newest pair, which halves the number of steps (perf/README.md).
  const double scale = m > 0 ? pairs_[m - 1].curvature() / solved_product(m - 1, m - 1) : 1;
  double along_force = scale * force_times_d;
  std::vector<Scaled> terms = {{scale, d}};
  for (std::size_t j = 0; j < m; ++j) {
    terms.push_back({scale * alpha[j], pairs_[j].solved});
    along_force += scale * alpha[j] * pairs_[j].solved_force;
  }
  // Second loop: direction += slope_k s_k.
  for (std::size_t k = 0; k < m; ++k) {
    double y_direction = -scale * pairs_[k].solved_force;  // y . d = -L^-1 y . f
    for (std::size_t j = 0; j < m; ++j) y_direction += scale * alpha[j] * solved_product(k, j);
    for (std::size_t j = 0; j < k; ++j) y_direction += slope[j] * pairs_[k].steps_with[j];
    slope[k] = -alpha[k] - y_direction / pairs_[k].curvature();
    terms.push_back({slope[k], pairs_[k].step});
    along_force += slope[k] * pairs_[k].step_force;
  }
  combine(exec_, terms, direction);
  return along_force;
}

}  // namespace planish
