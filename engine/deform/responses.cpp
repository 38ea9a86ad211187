#include "engine/deform/responses.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>

namespace planish {
namespace {

/// One pin has five terms up to second order; what is older says less of how the map is now.
constexpr std::size_t kMostKnown = 6;
/// Ways several times as long as those known are not guessed.
constexpr double kMostShare = 4;
/// The second order is fitted with what freedom the first one leaves: its weight, which the first one pays for.
constexpr double kSecondOrder = 1e-6;
/// Of the largest pivot: what depends on the rest but for rounding.
constexpr double kRidge = 1e-13;

double product(In<Vec2> a, In<Vec2> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

}  // namespace

void Responses::learn(std::vector<Vec2> held, std::vector<Vec2> map) {
  if (!(product(held, held) > 0)) return;
  if (known_.size() == kMostKnown) known_.pop_back();
  known_.insert(known_.begin(), {std::move(held), std::move(map)});
}

/// How often each known change is added. The minima before this one have what is held at places q_j from here; sought are c_j
/// with sum c_j q_j = held and, by least squares, sum c_j q_j q_j^T = held held^T. All that enters are products of places.
std::vector<double> Responses::shares(In<Vec2> held, double second_order, double& left) const {
  const std::size_t n = known_.size();
  std::vector<std::vector<Vec2>> place;
  std::vector<Vec2> at(held.size());
  for (const Response& known : known_) {
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = at[i] - known.held[i];
    place.push_back(at);
  }
  const double squared = product(held, held);
  const auto kernel = [&](In<Vec2> a, In<Vec2> b) {
    const double first = product(a, b) / squared;
    return first + second_order * first * first;
  };
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd matrix(size, size);
  Eigen::VectorXd rhs(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) matrix(i, j) = kernel(place[i], place[j]);
    rhs[i] = kernel(place[i], held);
  }
  matrix.diagonal().array() += kRidge * matrix.diagonal().maxCoeff();
  const Eigen::VectorXd solution = matrix.ldlt().solve(rhs);
  std::vector<double> share(solution.begin(), solution.end());
  std::vector<Vec2> rest(held.begin(), held.end());
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = rest[i] - share[j] * place[j][i];
  }
  left = std::sqrt(product(rest, rest) / squared);
  for (std::size_t j = n; j-- > 0;) share[j] = -share[j] + (j + 1 < n ? share[j + 1] : 0);
  return share;
}

double Responses::follow(In<Vec2> held, Out<Vec2> uv) const {
  if (!(product(held, held) > 0)) return 0;
  if (known_.empty()) return 1;
  for (const double second_order : {kSecondOrder, 0.0}) {
    double left = 1;
    const std::vector<double> share = shares(held, second_order, left);
    if (!std::ranges::all_of(share, [](double s) { return std::abs(s) <= kMostShare; })) continue;
    exec_.for_blocks(static_cast<Index>(uv.size()), kBlock, [&](Index, Range r) {
      for (std::size_t k = 0; k < share.size(); ++k) {
        for (Index v = r.begin; v < r.end; ++v) uv[v] += share[k] * known_[k].map[v];
      }
    });
    return left;
  }
  return 1;
}

}  // namespace planish
