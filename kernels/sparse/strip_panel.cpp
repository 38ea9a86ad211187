#include "kernels/sparse/strip_panel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/base/sums.hpp"

namespace planish {
namespace {

/// Eight numbers of a kind, and the two coordinates of eight rows behind one another.
using Eight __attribute__((vector_size(32), aligned(4), may_alias)) = float;
using Entries __attribute__((vector_size(16), aligned(2), may_alias)) = std::int16_t;
using Rows __attribute__((vector_size(64), aligned(4), may_alias)) = float;
using Point __attribute__((vector_size(8), aligned(4), may_alias)) = float;
using Two __attribute__((vector_size(16))) = float;

constexpr Index kGroup = 2 * kStripRows;  // floats of scratch
constexpr Offset kAhead = 4096;           // entries

PLANISH_INLINE Index num_groups(Index rows) { return (rows + kStripRows - 1) / kStripRows; }

namespace baseline {
struct Simd {
  /// sum + eight entries of a column times both coordinates of x
  PLANISH_INLINE static Rows add_column(const std::int16_t* p, const Rows& x, const Rows& sum) {
    const Eight e = __builtin_convertvector(*reinterpret_cast<const Entries*>(p), Eight);
    return sum + __builtin_shufflevector(e, e, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7) * x;
  }
};
#include "kernels/sparse/strip_panel_body.hpp"
}  // namespace baseline

#ifdef PLANISH_X86_SETS
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
struct Simd {
  PLANISH_INLINE static Rows add_column(const std::int16_t* p, const Rows& x, const Rows& sum) {
    const __m256 e =
        _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))));
    const __m256 u = _mm256_fmadd_ps(e, __builtin_shufflevector(x, x, 0, 1, 2, 3, 4, 5, 6, 7),
                                     __builtin_shufflevector(sum, sum, 0, 1, 2, 3, 4, 5, 6, 7));
    const __m256 v = _mm256_fmadd_ps(e, __builtin_shufflevector(x, x, 8, 9, 10, 11, 12, 13, 14, 15),
                                     __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15));
    return __builtin_shufflevector(u, v, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
};
#include "kernels/sparse/strip_panel_body.hpp"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,fma,prefer-vector-width=512")
namespace avx512 {
struct Simd {
  PLANISH_INLINE static Rows add_column(const std::int16_t* p, const Rows& x, const Rows& sum) {
    const __m256i both = _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
    return _mm512_fmadd_ps(_mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(both)), x, sum);
  }
};
#include "kernels/sparse/strip_panel_body.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

/// Inverse of a strip's triangle, its diagonal made 1: column j at [j].
using SmallTriangle = std::array<std::array<double, kStripColumns>, kStripColumns>;

PLANISH_INLINE SmallTriangle unit_inverse(const double* corner, Index rows, Index width) {
  SmallTriangle inverse{};
  for (Index j = 0; j < width; ++j) {
    inverse[j][j] = 1;
    for (Index i = j + 1; i < width; ++i) {
      for (Index k = j; k < i; ++k) {
        const double* column = corner + static_cast<Offset>(k) * rows;
        inverse[j][i] -= column[i] / column[k] * inverse[j][k];
      }
    }
  }
  return inverse;
}

/// One column of G off its diagonal place, as integers; returns what their sum lost.
///   g [groups of rows]
PLANISH_INLINE double round_column(In<double> g, std::int16_t* entry, Index stride, float& scale) {
  constexpr double kMost = 32767;
  double most = 0;
  for (const double x : g) most = std::max(most, std::abs(x));
  scale = most < kMost * std::numeric_limits<float>::min() ? 0 : static_cast<float>(most / kMost);
  const double unit = scale, inverse = scale > 0 ? 1 / unit : 0;
  std::array<double, kStripRows> lost{};
  for (std::size_t i = 0; i < g.size(); i += kStripRows, entry += stride) {
    for (std::size_t k = 0; k < kStripRows; ++k) {
      const double q = std::clamp(std::floor(g[i + k] * inverse + 0.5), -kMost, kMost);
      lost[k] += g[i + k] - q * unit;
      entry[k] = static_cast<std::int16_t>(static_cast<std::int32_t>(q));
    }
  }
  return pairwise_sum(lost);
}

/// corner: of the strip's triangle, columns `stride` apart.
PLANISH_INLINE void make_strip(const double* corner, Index stride, Index rows, Index width,
                               std::int16_t* entry, const StripColumns<float>& column, double* g) {
  const SmallTriangle inverse = unit_inverse(corner, stride, width);
  const Index padded = kStripRows * num_groups(rows);
  for (Index j = 0; j < width; ++j) {
    std::fill(g, g + padded, 0.0);
    for (Index k = j; k < width; ++k) {
      const double* from = corner + static_cast<Offset>(k) * stride;
      const double factor = -inverse[j][k] / from[k];
      for (Index i = width; i < rows; ++i) g[i] += factor * from[i];
    }
    for (Index i = j + 1; i < width; ++i) g[i] = inverse[j][i];
    const double lost =
        round_column(In<double>(g, padded), entry + j * kStripRows, width * kStripRows, column.scale[j]);
    column.diagonal[j] = static_cast<float>(1 + lost);
    column.inverse[j] = static_cast<float>(1 / corner[static_cast<Offset>(j) * stride + j]);
  }
}

}  // namespace

const StripSolves& strip_solves(InstructionSet set) {
#ifdef PLANISH_X86_SETS
  if (set == InstructionSet::Avx512) return avx512::kStripSolves;
  if (set == InstructionSet::Avx2) return avx2::kStripSolves;
#endif
  static_cast<void>(set);
  return baseline::kStripSolves;
}

Offset strips_size(Index columns, Index rows) {
  Offset size = 0;
  for (Index j = 0; j < columns; j += kStripColumns)
    size += Offset{std::min(kStripColumns, columns - j)} * kStripRows * num_groups(rows - j);
  return size;
}

PLANISH_CLONES void make_strips(const Panel& panel, std::int16_t* entry, StripColumns<float> column,
                                double* scratch) {
  for (Index j = 0; j < panel.columns; j += kStripColumns) {
    const Index width = std::min(kStripColumns, panel.columns - j), rows = panel.rows - j;
    make_strip(panel.value + static_cast<Offset>(j) * panel.rows + j, panel.rows, rows, width, entry,
               column.from(j), scratch);
    entry += Offset{width} * kStripRows * num_groups(rows);
  }
}

}  // namespace planish
