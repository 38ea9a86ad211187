// Solves with one panel of strips, once for each instruction set: strip_panel.cpp includes this text inside a namespace that has
// Simd, with the compiler set to those instructions. No include guard, and nothing from other headers is defined here.

/// Strips are short and many: the processor does not foresee the next one. Asks for the entries from p on.
PLANISH_INLINE void prefetch(const std::int16_t* p, Offset count) {
  constexpr Offset kLine = 64 / sizeof(std::int16_t);
  for (Offset i = 0; i < count; i += kLine) __builtin_prefetch(p + i);
}

/// Eight numbers, once for each coordinate.
PLANISH_INLINE Rows twice(const float* p) {
  const Eight e = *reinterpret_cast<const Eight*>(p);
  return __builtin_shufflevector(e, e, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
}

PLANISH_INLINE Rows each(float x, float y) {
  const Eight a = Eight{} + x, b = Eight{} + y;
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

PLANISH_INLINE Rows& rows_at(float* scratch, Index group) {
  return *reinterpret_cast<Rows*>(scratch + kGroup * group);
}

PLANISH_INLINE Two two_points(const FloatVec2& a, const FloatVec2& b) {
  return __builtin_shufflevector(reinterpret_cast<const Point&>(a), reinterpret_cast<const Point&>(b), 0, 1,
                                 2, 3);
}

PLANISH_INLINE Eight four_points(const FloatVec2* y, const Index* row) {
  return __builtin_shufflevector(two_points(y[row[0]], y[row[1]]), two_points(y[row[2]], y[row[3]]), 0, 2, 4,
                                 6, 1, 3, 5, 7);
}

/// Coordinates of eight points behind one another.
PLANISH_INLINE Rows gathered(const FloatVec2* y, const Index* row) {
  return __builtin_shufflevector(four_points(y, row), four_points(y, row + 4), 0, 1, 2, 3, 8, 9, 10, 11, 4, 5,
                                 6, 7, 12, 13, 14, 15);
}

/// The same where there are `count`; fewer than eight are filled up with any.
PLANISH_INLINE Rows gathered(const FloatVec2* y, const Index* row, Index count) {
  if (count >= kStripRows) return gathered(y, row);
  Index known[kStripRows];
  for (Index i = 0; i < kStripRows; ++i) known[i] = row[i < count ? i : 0];
  return gathered(y, known);
}

/// Coordinates as points.
PLANISH_INLINE Rows points_of(Rows rows) {
  return __builtin_shufflevector(rows, rows, 0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
}

/// The first `count` of eight rows of one, the others of the other.
PLANISH_INLINE Rows blend(Index count, Rows first, Rows rest) {
  static constexpr float kOnes[2 * kStripRows] = {1, 1, 1, 1, 1, 1, 1, 1};
  return twice(kOnes + kStripRows - count) != Rows{} ? first : rest;
}

/// The first `columns` rows times a number of each.
PLANISH_INLINE void scale_first(float* scratch, Index columns, const float* factor) {
  for (Index k = 0; k < num_groups(columns); ++k) {
    const Rows rows = rows_at(scratch, k);
    rows_at(scratch, k) =
        blend(std::min(columns - kStripRows * k, kStripRows), rows * twice(factor + kStripRows * k), rows);
  }
}

/// Rows of scratch from the strip's first on <- those below plus G times the strip's.
template <int W>
PLANISH_INLINE void forward_strip(const std::int16_t* g, const StripColumns<const float>& column,
                                  Index groups, float* scratch) {
  prefetch(g + kAhead, Offset{W} * kStripRows * groups);
  Rows x[W];
  for (int w = 0; w < W; ++w)
    x[w] = each(scratch[w] * column.scale[w], scratch[kStripRows + w] * column.scale[w]);
  scale_first(scratch, W, column.diagonal);
  for (Index k = 0; k < groups; ++k, g += W * kStripRows) {
    Rows sum = rows_at(scratch, k);
    for (int w = 0; w < W; ++w) sum = Simd::add_column(g + w * kStripRows, x[w], sum);
    rows_at(scratch, k) = sum;
  }
}

/// Sums of neighbouring pairs of lanes, those of two vectors in turns, within every four lanes.
PLANISH_INLINE Rows sums_of_two(const Rows& a, const Rows& b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29) +
         __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
}

/// Sums over every four lanes of four vectors.
PLANISH_INLINE Rows sums_of_four(const Rows* column) {
  const Rows a = sums_of_two(column[0], column[1]), b = sums_of_two(column[2], column[3]);
  return __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29) +
         __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
}

/// The strip's rows <- G^T times those of it and below.
template <int W>
PLANISH_INLINE void backward_strip(const std::int16_t* g, const StripColumns<const float>& column,
                                   Index groups, float* scratch) {
  prefetch(g - kAhead, Offset{W} * kStripRows * groups);
  Rows sum[kStripColumns] = {};
  for (Index k = 0; k < groups; ++k, g += W * kStripRows) {
    const Rows rows = rows_at(scratch, k);
    for (int w = 0; w < W; ++w) sum[w] = Simd::add_column(g + w * kStripRows, rows, sum[w]);
  }
  const Rows near = sums_of_four(sum), far = W > 4 ? sums_of_four(sum + 4) : Rows{};
  const Rows products =
      __builtin_shufflevector(near, far, 0, 1, 2, 3, 16, 17, 18, 19, 8, 9, 10, 11, 24, 25, 26, 27) +
      __builtin_shufflevector(near, far, 4, 5, 6, 7, 20, 21, 22, 23, 12, 13, 14, 15, 28, 29, 30, 31);
  const Rows before = rows_at(scratch, 0);
  const Rows solved = before * twice(column.diagonal) + products * twice(column.scale);
  rows_at(scratch, 0) = blend(W, solved, before);
}

/// Calls strip(W) with the width as a constant.
template <class Strip>
PLANISH_INLINE void with_strip_width(Index width, Strip&& strip) {
  switch (width) {
    case 8: return strip.template operator()<8>();
    case 7: return strip.template operator()<7>();
    case 6: return strip.template operator()<6>();
    case 5: return strip.template operator()<5>();
    case 4: return strip.template operator()<4>();
    case 3: return strip.template operator()<3>();
    case 2: return strip.template operator()<2>();
    default: return strip.template operator()<1>();
  }
}

void forward(const StripPanel& panel, const Index* row, Index inside, FloatVec2* y, float* scratch) {
  const Index groups = num_groups(panel.rows), own = num_groups(panel.columns);
  for (Index k = 0; k < own; ++k) {
    const Index left = panel.columns - kStripRows * k;
    rows_at(scratch, k) = blend(std::min(left, kStripRows), gathered(y, row + kStripRows * k, left), Rows{});
  }
  for (Index k = own; k < groups; ++k) rows_at(scratch, k) = Rows{};
  const std::int16_t* g = panel.entry;
  for (Index j = 0; j < panel.columns; j += kStripColumns) {
    const Index width = std::min(kStripColumns, panel.columns - j), left = groups - j / kStripRows;
    with_strip_width(width, [&]<int W>() {
      forward_strip<W>(g, panel.column.from(j), left, scratch + kGroup * (j / kStripRows));
    });
    g += Offset{width} * kStripRows * left;
  }
  scale_first(scratch, panel.columns, panel.column.inverse);
  for (Index k = 0; k < groups; ++k) rows_at(scratch, k) = points_of(rows_at(scratch, k));
  const auto* points = reinterpret_cast<const Point*>(scratch);
  auto* const own_y = reinterpret_cast<Point*>(y + row[0]);  // contiguous
  for (Index i = 0; i < panel.columns; ++i) own_y[i] = points[i];
  for (Index i = panel.columns; i < panel.columns + inside; ++i)
    reinterpret_cast<Point&>(y[row[i]]) += points[i];
}

void backward(const StripPanel& panel, const Index* row, FloatVec2* y, float* scratch) {
  const Index groups = num_groups(panel.rows), own = num_groups(panel.columns);
  for (Index k = 0; k < groups; ++k)
    rows_at(scratch, k) = gathered(y, row + kStripRows * k, panel.rows - kStripRows * k);
  scale_first(scratch, panel.columns, panel.column.inverse);
  const std::int16_t* g = panel.entry + strips_size(panel.columns, panel.rows);
  for (Index j = kStripColumns * (own - 1); j >= 0; j -= kStripColumns) {
    const Index width = std::min(kStripColumns, panel.columns - j), left = groups - j / kStripRows;
    g -= Offset{width} * kStripRows * left;
    with_strip_width(width, [&]<int W>() {
      backward_strip<W>(g, panel.column.from(j), left, scratch + kGroup * (j / kStripRows));
    });
  }
  for (Index k = 0; k < own; ++k) rows_at(scratch, k) = points_of(rows_at(scratch, k));
  const auto* points = reinterpret_cast<const Point*>(scratch);
  auto* const own_y = reinterpret_cast<Point*>(y + row[0]);
  for (Index i = 0; i < panel.columns; ++i) own_y[i] = points[i];
}

inline constexpr StripSolves kStripSolves = {forward, backward};
