// The solves with one panel, once for each instruction set: supernode.cpp includes this text inside a namespace that has Simd,
// with the compiler set to those instructions. No include guard, and nothing from other headers is defined here.

#include "kernels/sparse/with_width.hpp"

using Vector = typename Simd::Vector;

PLANISH_INLINE const double* column(const Panel& panel, Index j) {
  return panel.value + static_cast<Offset>(j) * panel.rows;
}

/// Asks for the `count` values from p on, before they are needed.
PLANISH_INLINE void prefetch(const double* p, Offset count) {
  constexpr Index kLine = 64 / sizeof(double);
  for (Offset i = 0; i < count; i += kLine) __builtin_prefetch(p + i);
}

/// Calls tile(Whole, first row, count) over rows, a vector at a time.
template <class Body>
PLANISH_INLINE void for_vectors(Index begin, Index end, Body&& body) {
  Index i = begin;
  for (; i + Simd::kLanes <= end; i += Simd::kLanes) body.template operator()<true>(i, Index{Simd::kLanes});
  if (i < end) body.template operator()<false>(i, end - i);
}

template <bool Whole>
PLANISH_INLINE Vector load_rows(const double* p, Index count) {
  return Whole ? Simd::load(p) : Simd::load_part(p, count);
}

template <bool Whole>
PLANISH_INLINE void store_rows(double* p, Vector x, Index count) {
  if constexpr (Whole) {
    Simd::store(p, x);
  } else {
    Simd::store_part(p, x, count);
  }
}

/// Columns [j, j + W): their square, then what they take from the rows below.
template <int W>
PLANISH_INLINE void forward_strip(const Panel& panel, Index j, double* u, double* v) {
  const double* c[W];
  for (int w = 0; w < W; ++w) c[w] = column(panel, j + w);
  prefetch(c[0] + kAhead, Offset{W} * panel.rows);
  double x[W], y[W];
  for (int w = 0; w < W; ++w) x[w] = u[j + w], y[w] = v[j + w];
  for (int w = 0; w < W; ++w) {
    const double inverse = 1 / c[w][j + w];
    u[j + w] = x[w] *= inverse;
    v[j + w] = y[w] *= inverse;
    for (int next = w + 1; next < W; ++next) {
      const double entry = c[w][j + next];
      x[next] = Simd::subtract_product(entry, x[w], x[next]);
      y[next] = Simd::subtract_product(entry, y[w], y[next]);
    }
  }
  Vector xs[W], ys[W];
  for (int w = 0; w < W; ++w) xs[w] = Simd::all(x[w]), ys[w] = Simd::all(y[w]);
  for_vectors(j + W, panel.rows, [&]<bool Whole>(Index i, Index count) {
    Vector a = load_rows<Whole>(u + i, count), b = load_rows<Whole>(v + i, count);
    for (int w = 0; w < W; ++w) {
      const Vector entries = load_rows<Whole>(c[w] + i, count);
      a = Simd::subtract_product(entries, xs[w], a);
      b = Simd::subtract_product(entries, ys[w], b);
    }
    store_rows<Whole>(u + i, a, count);
    store_rows<Whole>(v + i, b, count);
  });
}

template <int W>
PLANISH_INLINE void backward_strip(const Panel& panel, Index j, double* u, double* v) {
  const double* c[W];
  for (int w = 0; w < W; ++w) c[w] = column(panel, j + w);
  prefetch(c[0] - kAhead, Offset{W} * panel.rows);
  Vector xs[W], ys[W];
  for (int w = 0; w < W; ++w) xs[w] = ys[w] = Simd::all(0);
  for_vectors(j + W, panel.rows, [&]<bool Whole>(Index i, Index count) {
    const Vector a = load_rows<Whole>(u + i, count), b = load_rows<Whole>(v + i, count);
    for (int w = 0; w < W; ++w) {
      const Vector entries = load_rows<Whole>(c[w] + i, count);
      xs[w] = Simd::subtract_product(entries, a, xs[w]);
      ys[w] = Simd::subtract_product(entries, b, ys[w]);
    }
  });
  double x[W], y[W];
  for (int w = 0; w < W; ++w) x[w] = u[j + w] + Simd::sum(xs[w]), y[w] = v[j + w] + Simd::sum(ys[w]);
  for (int w = W - 1; w >= 0; --w) {
    const double inverse = 1 / c[w][j + w];
    u[j + w] = x[w] *= inverse;
    v[j + w] = y[w] *= inverse;
    for (int before = 0; before < w; ++before) {
      const double entry = c[before][j + w];
      x[before] = Simd::subtract_product(entry, x[w], x[before]);
      y[before] = Simd::subtract_product(entry, y[w], y[before]);
    }
  }
}

void forward_panel(const Panel& panel, double* u, double* v) {
  for (Index j = 0; j < panel.columns; j += Simd::kTileColumns) {
    const Index left = panel.columns - j;
    with_width(left < Simd::kTileColumns ? left : Index{Simd::kTileColumns},
               [&]<int W>() { forward_strip<W>(panel, j, u, v); });
  }
}

void backward_panel(const Panel& panel, double* u, double* v) {
  const Index last = (panel.columns - 1) / Simd::kTileColumns * Simd::kTileColumns;
  for (Index j = last; j >= 0; j -= Simd::kTileColumns) {
    const Index left = panel.columns - j;
    with_width(left < Simd::kTileColumns ? left : Index{Simd::kTileColumns},
               [&]<int W>() { backward_strip<W>(panel, j, u, v); });
  }
}

inline constexpr PanelSolves kSolves = {forward_panel, backward_panel};
