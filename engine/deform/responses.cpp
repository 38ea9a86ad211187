#include "engine/deform/responses.hpp"

#include <algorithm>
#include <cmath>

#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

/// One pin goes two ways; what is older says less of how the map is now.
constexpr std::size_t kMostKnown = 4;
/// A way that newer ones span but for so much of its length is left out.
constexpr double kNew = 0.05;
/// Ways several times as long as those known are not guessed.
constexpr double kMostCoefficient = 3;

double product(In<Vec2> a, In<Vec2> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

double norm_of(In<Vec2> a) { return std::sqrt(product(a, a)); }

void subtract(double scale, In<Vec2> b, Out<Vec2> a) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] - scale * b[i];
}

}  // namespace

void Responses::learn(std::vector<Vec2> held, std::vector<Vec2> map) {
  if (!(product(held, held) > 0)) return;
  if (known_.size() == kMostKnown) known_.pop_back();
  known_.insert(known_.begin(), {std::move(held), std::move(map)});
}

double Responses::follow(In<Vec2> held, Out<Vec2> uv) const {
  const double length = norm_of(held);
  if (!(length > 0)) return 0;
  // Gram-Schmidt, newest first: way[k] = direction[k] + sum of share[k][j] direction[j] over the newer j that were taken.
  std::vector<std::vector<Vec2>> direction;
  std::vector<std::vector<double>> share;
  std::vector<std::size_t> taken;
  std::vector<Vec2> rest(held.begin(), held.end());
  std::vector<double> along;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    std::vector<Vec2> d = known_[k].held;
    const double whole = product(d, d);
    std::vector<double> shares;
    for (const std::vector<Vec2>& newer : direction) {
      shares.push_back(product(newer, d) / product(newer, newer));
      subtract(shares.back(), newer, d);
    }
    const double own = product(d, d);
    if (!(own > kNew * kNew * whole)) continue;
    along.push_back(product(d, rest) / own);
    subtract(along.back(), d, rest);
    direction.push_back(std::move(d));
    share.push_back(std::move(shares));
    taken.push_back(k);
  }
  if (taken.empty()) return 1;
  std::vector<Scaled> terms = {{1, uv}};
  std::vector<double> coefficient = along;
  for (std::size_t k = taken.size(); k-- > 0;) {
    for (std::size_t j = k + 1; j < taken.size(); ++j) coefficient[k] -= share[j][k] * coefficient[j];
    if (std::abs(coefficient[k]) > kMostCoefficient) return 1;
    terms.push_back({coefficient[k], known_[taken[k]].map});
  }
  std::vector<Vec2> followed(uv.size());
  combine(exec_, terms, followed);
  std::ranges::copy(followed, uv.begin());
  return norm_of(rest) / length;
}

}  // namespace planish
