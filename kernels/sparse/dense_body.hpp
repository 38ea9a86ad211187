// The dense kernels, once for each instruction set: dense.cpp includes this text inside a namespace that has Simd, with the
// compiler set to those instructions. No include guard, and nothing from other headers is defined here.

#include "kernels/sparse/with_width.hpp"

/// Sums of a tile: R vectors of rows, the last of them with `count` rows in use, times W columns.
template <int R, int W>
struct Tile {
  typename Simd::Vector sum[R][W];
};

template <int R, bool Whole>
PLANISH_INLINE void load_rows(const double* p, Index count, typename Simd::Vector (&rows)[R]) {
  for (int r = 0; r < R - 1; ++r) rows[r] = Simd::load(p + r * Simd::kLanes);
  const double* last = p + (R - 1) * Simd::kLanes;
  rows[R - 1] = Whole ? Simd::load(last) : Simd::load_part(last, count);
}

template <int R, int W, bool Whole>
PLANISH_INLINE void load_tile(ColumnMajor c, Index count, Tile<R, W>& tile) {
  for (int w = 0; w < W; ++w) {
    typename Simd::Vector column[R];
    load_rows<R, Whole>(c.value + w * c.stride, count, column);
    for (int r = 0; r < R; ++r) tile.sum[r][w] = column[r];
  }
}

template <int R, int W, bool Whole>
PLANISH_INLINE void store_tile(ColumnMajor c, Index count, const Tile<R, W>& tile) {
  for (int w = 0; w < W; ++w) {
    double* column = c.value + w * c.stride;
    for (int r = 0; r < R - 1; ++r) Simd::store(column + r * Simd::kLanes, tile.sum[r][w]);
    double* last = column + (R - 1) * Simd::kLanes;
    if constexpr (Whole) {
      Simd::store(last, tile.sum[R - 1][w]);
    } else {
      Simd::store_part(last, tile.sum[R - 1][w], count);
    }
  }
}

/// tile -= a b^T over k columns.
template <int R, int W, bool Whole>
PLANISH_INLINE void subtract_columns(const double* a, Offset a_stride, const double* b, Offset b_stride,
                                     Index k, Index count, Tile<R, W>& tile) {
  for (Index j = 0; j < k; ++j, a += a_stride, b += b_stride) {
    typename Simd::Vector rows[R];
    load_rows<R, Whole>(a, count, rows);
    for (int w = 0; w < W; ++w) {
      const typename Simd::Vector factor = Simd::all(b[w]);
      for (int r = 0; r < R; ++r) tile.sum[r][w] = Simd::subtract_product(rows[r], factor, tile.sum[r][w]);
    }
  }
}

/// tile <- tile L^-T for the W x W factor at l, whose diagonal is inverted in `inverse`.
template <int R, int W>
PLANISH_INLINE void solve_tile(ColumnMajor l, const double* inverse, Tile<R, W>& tile) {
  for (int w = 0; w < W; ++w) {
    for (int r = 0; r < R; ++r) tile.sum[r][w] = Simd::times(tile.sum[r][w], Simd::all(inverse[w]));
    for (int next = w + 1; next < W; ++next) {
      const typename Simd::Vector factor = Simd::all(l.value[next + w * l.stride]);
      for (int r = 0; r < R; ++r)
        tile.sum[r][next] = Simd::subtract_product(tile.sum[r][w], factor, tile.sum[r][next]);
    }
  }
}

/// Calls tile(R, Whole, first row, count) over rows r, in tiles of up to kTileVectors vectors.
template <class Body>
PLANISH_INLINE void for_row_tiles(Index begin, Index end, Body&& body) {
  constexpr Index kRows = Simd::kTileVectors * Simd::kLanes;
  Index i = begin;
  for (; i + kRows <= end; i += kRows)
    body.template operator()<Simd::kTileVectors, true>(i, Index{Simd::kLanes});
  const Index left = end - i;
  if (left <= 0) return;
  if (left <= Simd::kLanes) {
    body.template operator()<1, false>(i, left);
  } else if (left <= 2 * Simd::kLanes) {
    body.template operator()<2, false>(i, left - Simd::kLanes);
  } else {
    body.template operator()<Simd::kTileVectors, false>(i, left - (Simd::kTileVectors - 1) * Simd::kLanes);
  }
}

/// Rows r of columns [j, j + W) of a panel whose square at (j, j) is factored: what columns [first, j) give is subtracted,
/// then the square applied.
template <int W>
void solve_strip(ColumnMajor panel, Index first, Index j, Index begin, Index end) {
  const ColumnMajor square{panel.at(j, j), panel.stride};
  double inverse[W];
  for (int w = 0; w < W; ++w) inverse[w] = 1 / square.value[w + w * square.stride];
  for_row_tiles(begin, end, [&]<int R, bool Whole>(Index i, Index count) {
    const ColumnMajor c{panel.at(i, j), panel.stride};
    Tile<R, W> tile;
    load_tile<R, W, Whole>(c, count, tile);
    subtract_columns<R, W, Whole>(panel.at(i, first), panel.stride, panel.at(j, first), panel.stride,
                                  j - first, count, tile);
    solve_tile<R, W>(square, inverse, tile);
    store_tile<R, W, Whole>(c, count, tile);
  });
}

/// The square [j, j + W)^2 itself. Returns the column of the first pivot that is not positive, or W.
template <int W>
Index factor_square(ColumnMajor panel, Index first, Index j) {
  const ColumnMajor c{panel.at(j, j), panel.stride};
  for_row_tiles(0, W, [&]<int R, bool Whole>(Index i, Index count) {
    const ColumnMajor part{c.at(i, 0), c.stride};
    Tile<R, W> tile;
    load_tile<R, W, Whole>(part, count, tile);
    subtract_columns<R, W, Whole>(panel.at(j + i, first), panel.stride, panel.at(j, first), panel.stride,
                                  j - first, count, tile);
    store_tile<R, W, Whole>(part, count, tile);
  });
  double a[W][W];
  for (int w = 0; w < W; ++w) {
    for (int i = w; i < W; ++i) a[w][i] = *c.at(i, w);
  }
  for (int w = 0; w < W; ++w) {
    if (!(a[w][w] > 0)) return w;
    a[w][w] = Simd::square_root(a[w][w]);
    const double inverse = 1 / a[w][w];
    for (int i = w + 1; i < W; ++i) a[w][i] *= inverse;
    for (int next = w + 1; next < W; ++next) {
      for (int i = next; i < W; ++i) a[next][i] = Simd::subtract_product(a[w][i], a[w][next], a[next][i]);
    }
  }
  for (int w = 0; w < W; ++w) {
    for (int i = w; i < W; ++i) *c.at(i, w) = a[w][i];
  }
  return W;
}

inline Index factor_columns(ColumnMajor panel, Index first, Index last, Index rows) {
  Index bad = kNone;
  for (Index j = first; j < last && bad == kNone; j += Simd::kTileColumns) {
    const Index width = last - j < Simd::kTileColumns ? last - j : Index{Simd::kTileColumns};
    with_width(width, [&]<int W>() {
      const Index good = factor_square<W>(panel, first, j);
      if (good < W) {
        bad = j + good;
      } else if (j + W < rows) {
        solve_strip<W>(panel, first, j, j + W, rows);
      }
    });
  }
  return bad;
}

inline void solve_rows(ColumnMajor panel, Index first, Index last, Range r) {
  for (Index j = first; j < last; j += Simd::kTileColumns) {
    const Index width = last - j < Simd::kTileColumns ? last - j : Index{Simd::kTileColumns};
    with_width(width, [&]<int W>() { solve_strip<W>(panel, first, j, r.begin, r.end); });
  }
}

template <int W, bool Fresh>
PLANISH_INLINE void subtract_strip(ColumnMajor c, ColumnMajor a, const double* b, Offset b_stride,
                                   Index begin, Index m, Index k) {
  for_row_tiles(begin, m, [&]<int R, bool Whole>(Index i, Index count) {
    const ColumnMajor part{c.at(i, 0), c.stride};
    Tile<R, W> tile;
    if constexpr (Fresh) {
      for (int r = 0; r < R; ++r) {
        for (int w = 0; w < W; ++w) tile.sum[r][w] = Simd::all(0);
      }
    } else {
      load_tile<R, W, Whole>(part, count, tile);
    }
    subtract_columns<R, W, Whole>(a.at(i, 0), a.stride, b, b_stride, k, count, tile);
    store_tile<R, W, Whole>(part, count, tile);
  });
}

inline void subtract_products(ColumnMajor c, ColumnMajor a, ColumnMajor b, Index m, Index n, Index k,
                              bool fresh, bool lower) {
  constexpr Index kDepth = 128;  // columns multiplied at once: their rows of a tile stay in the first cache
  Index done = 0;
  do {
    const Index depth = k - done < kDepth ? k - done : kDepth;
    const ColumnMajor a_part{a.at(0, done), a.stride};
    for (Index j = 0; j < n; j += Simd::kTileColumns) {
      const Index width = n - j < Simd::kTileColumns ? n - j : Index{Simd::kTileColumns};
      const ColumnMajor strip{c.at(0, j), c.stride};
      with_width(width, [&]<int W>() {
        if (fresh && done == 0) {
          subtract_strip<W, true>(strip, a_part, b.at(j, done), b.stride, lower ? j : 0, m, depth);
        } else {
          subtract_strip<W, false>(strip, a_part, b.at(j, done), b.stride, lower ? j : 0, m, depth);
        }
      });
    }
    done += depth;
  } while (done < k);
}

inline constexpr DenseKernels kKernels = {factor_columns, solve_rows, subtract_products};
