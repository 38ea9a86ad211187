#include "kernels/sparse/supernode.hpp"

#include <array>

#include "kernels/base/lanes.hpp"

namespace planish {
namespace {

// Columns go in groups: each row's entries of u and v are then loaded once for the whole group.
constexpr Index kGroup = 4;
// Panels are short and many: the processor does not foresee the next one. Asking for what comes 4 kB later makes
// solves a third faster.
constexpr Offset kAheadBytes = 4096;

template <class Value>
const Value* column(const BasicPanel<Value>& panel, Index j) {
  return panel.value + static_cast<Offset>(j) * panel.rows;
}

inline const Lanes& lanes(const double* p) { return *reinterpret_cast<const Lanes*>(p); }
inline Lanes& lanes(double* p) { return *reinterpret_cast<Lanes*>(p); }
PLANISH_INLINE Lanes lanes(const float* p) {
  return __builtin_convertvector(*reinterpret_cast<const FloatLanes*>(p), Lanes);
}

inline double sum(const Lanes& x) { return (x[0] + x[1]) + (x[2] + x[3]); }

/// x[rows from `first`] -= sum over the group of c[k] * y[k].
template <class Value>
PLANISH_INLINE void subtract_group(const std::array<const Value*, kGroup>& c, const double* y, Index first,
                                   Index rows, double* __restrict x) {
  const double y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3];
  Index i = first;
  for (; i + kLanes <= rows; i += kLanes) {
    lanes(x + i) -=
        (lanes(c[0] + i) * y0 + lanes(c[1] + i) * y1) + (lanes(c[2] + i) * y2 + lanes(c[3] + i) * y3);
  }
  for (; i < rows; ++i) x[i] -= (c[0][i] * y0 + c[1][i] * y1) + (c[2][i] * y2 + c[3][i] * y3);
}

/// Dot products of the group's columns with x over rows from `first`.
template <class Value>
PLANISH_INLINE std::array<double, kGroup> dot_group(const std::array<const Value*, kGroup>& c, Index first,
                                                    Index rows, const double* x) {
  Lanes s0{}, s1{}, s2{}, s3{};
  Index i = first;
  for (; i + kLanes <= rows; i += kLanes) {
    const Lanes b = lanes(x + i);
    s0 += lanes(c[0] + i) * b;
    s1 += lanes(c[1] + i) * b;
    s2 += lanes(c[2] + i) * b;
    s3 += lanes(c[3] + i) * b;
  }
  std::array<double, kGroup> result = {sum(s0), sum(s1), sum(s2), sum(s3)};
  for (; i < rows; ++i) {
    for (Index k = 0; k < kGroup; ++k) result[k] += c[k][i] * x[i];
  }
  return result;
}

/// Asks for the `count` values from p on, before they are needed.
template <class Value>
PLANISH_INLINE void prefetch(const Value* p, Offset count) {
  constexpr Index kLine = 64 / sizeof(Value);
  for (Offset i = 0; i < count; i += kLine) __builtin_prefetch(p + i);
}

template <class Value>
PLANISH_INLINE void forward_one(const Value* c, Index j, Index last, double* x) {
  x[j] /= c[j];
  for (Index i = j + 1; i < last; ++i) x[i] -= c[i] * x[j];
}

template <class Value>
PLANISH_INLINE void backward_one(const Value* c, Index j, Index last, double* x) {
  double s = x[j];
  for (Index i = j + 1; i < last; ++i) s -= c[i] * x[i];
  x[j] = s / c[j];
}

template <class Value>
PLANISH_INLINE void forward(const BasicPanel<Value>& panel, Out<double> u, Out<double> v) {
  Index j = 0;
  for (; j + kGroup <= panel.columns; j += kGroup) {
    const std::array<const Value*, kGroup> c = {column(panel, j), column(panel, j + 1), column(panel, j + 2),
                                                column(panel, j + 3)};
    prefetch(c[0] + kAheadBytes / Offset{sizeof(Value)}, Offset{kGroup} * panel.rows);
    for (Index k = 0; k < kGroup; ++k) {
      forward_one(c[k], j + k, j + kGroup, u.data());
      forward_one(c[k], j + k, j + kGroup, v.data());
    }
    subtract_group(c, &u[j], j + kGroup, panel.rows, u.data());
    subtract_group(c, &v[j], j + kGroup, panel.rows, v.data());
  }
  for (; j < panel.columns; ++j) {
    forward_one(column(panel, j), j, panel.rows, u.data());
    forward_one(column(panel, j), j, panel.rows, v.data());
  }
}

template <class Value>
PLANISH_INLINE void backward(const BasicPanel<Value>& panel, Out<double> u, Out<double> v) {
  const Index grouped = panel.columns - panel.columns % kGroup;
  for (Index j = panel.columns - 1; j >= grouped; --j) {
    backward_one(column(panel, j), j, panel.rows, u.data());
    backward_one(column(panel, j), j, panel.rows, v.data());
  }
  for (Index j = grouped - kGroup; j >= 0; j -= kGroup) {
    const std::array<const Value*, kGroup> c = {column(panel, j), column(panel, j + 1), column(panel, j + 2),
                                                column(panel, j + 3)};
    prefetch(c[0] - kAheadBytes / Offset{sizeof(Value)}, Offset{kGroup} * panel.rows);
    const auto su = dot_group(c, j + kGroup, panel.rows, u.data());
    const auto sv = dot_group(c, j + kGroup, panel.rows, v.data());
    for (Index k = kGroup - 1; k >= 0; --k) {
      u[j + k] -= su[k];
      v[j + k] -= sv[k];
      backward_one(c[k], j + k, j + kGroup, u.data());
      backward_one(c[k], j + k, j + kGroup, v.data());
    }
  }
}

}  // namespace

PLANISH_CLONES void forward_panel(const Panel& panel, Out<double> u, Out<double> v) { forward(panel, u, v); }
PLANISH_CLONES void forward_panel(const FloatPanel& panel, Out<double> u, Out<double> v) {
  forward(panel, u, v);
}
PLANISH_CLONES void backward_panel(const Panel& panel, Out<double> u, Out<double> v) {
  backward(panel, u, v);
}
PLANISH_CLONES void backward_panel(const FloatPanel& panel, Out<double> u, Out<double> v) {
  backward(panel, u, v);
}

}  // namespace planish
