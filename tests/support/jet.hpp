// Second-order forward automatic differentiation: the twin that derivatives in closed form are held against.
#pragma once

#include <array>
#include <cmath>

namespace planish::tests {

/// A value with its gradient and Hessian over N variables.
template <int N>
struct Jet {
  double value = 0;
  std::array<double, N> gradient = {};
  std::array<std::array<double, N>, N> hessian = {};

  Jet(double constant = 0) : value(constant) {}
  static Jet variable(double at, int number) {
    Jet jet(at);
    jet.gradient[number] = 1;
    return jet;
  }
  /// f(*this) from f, f', f'' there.
  Jet chain(double f, double f1, double f2) const {
    Jet jet(f);
    for (int i = 0; i < N; ++i) {
      jet.gradient[i] = f1 * gradient[i];
      for (int k = 0; k < N; ++k) jet.hessian[i][k] = f1 * hessian[i][k] + f2 * gradient[i] * gradient[k];
    }
    return jet;
  }
};

template <int N>
Jet<N> operator+(Jet<N> a, const Jet<N>& b) {
  a.value += b.value;
  for (int i = 0; i < N; ++i) {
    a.gradient[i] += b.gradient[i];
    for (int k = 0; k < N; ++k) a.hessian[i][k] += b.hessian[i][k];
  }
  return a;
}

template <int N>
Jet<N> operator*(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> jet(a.value * b.value);
  for (int i = 0; i < N; ++i) {
    jet.gradient[i] = a.gradient[i] * b.value + a.value * b.gradient[i];
    for (int k = 0; k < N; ++k)
      jet.hessian[i][k] = a.hessian[i][k] * b.value + a.gradient[i] * b.gradient[k] +
                          b.gradient[i] * a.gradient[k] + a.value * b.hessian[i][k];
  }
  return jet;
}

template <int N>
Jet<N> operator-(const Jet<N>& a, const Jet<N>& b) {
  return a + Jet<N>(-1) * b;
}
template <int N>
Jet<N> inverse(const Jet<N>& a) {
  return a.chain(1 / a.value, -1 / (a.value * a.value), 2 / (a.value * a.value * a.value));
}
template <int N>
Jet<N> root(const Jet<N>& a) {
  const double r = std::sqrt(a.value);
  return a.chain(r, 0.5 / r, -0.25 / (r * a.value));
}

}  // namespace planish::tests
