// Solves with one supernode of a Cholesky factor in 16 bits an entry, its columns in strips with inverses.
#pragma once

#include "kernels/sparse/supernode.hpp"

namespace planish {

struct FloatVec2 {
  float x = 0, y = 0;
};

inline constexpr Index kStripColumns = 8, kStripRows = 8;

/// Three numbers a column beside its entries.
template <class Number>
struct StripColumns {
  Number* scale = nullptr;     ///< times an entry is its value; of the largest entry 32767
  Number* diagonal = nullptr;  ///< 1 but for what rounding took from the sum of the column's entries
  Number* inverse = nullptr;   ///< 1 / L_jj

  StripColumns from(Index j) const { return {scale + j, diagonal + j, inverse + j}; }
};

/// A panel of a factor L made for many solves with few bytes. Columns stand in strips of at most 8, the last one narrower. With
/// T D the triangle of a strip, T's diagonal 1, and E D its rows below, kept is G = [T^-1; -E T^-1]: substitutions are products
/// with G and its transpose, without chains of divisions. Entries off the diagonal are integers times a scale of their
/// column, the diagonal takes over what this leaves of their sum: G^T 1 stays what it is, so that smooth functions, whose energy
/// is a small difference, keep theirs. Whatever the rounding, forward and backward stay each other's transposes, so a
/// solve is a product with one symmetric positive definite matrix.
/// Rows in groups of 8, the last one filled up with zeros; of a group one column stands behind the other.
///   Ref: partitioned inverses, Alvarado and Schreiber 1993.
struct StripPanel {
  Index columns = 0;
  Index rows = 0;
  const std::int16_t* entry = nullptr;
  StripColumns<const float> column;  ///< of the panel's first; 7 more numbers may be read behind its last
};

/// Entries that a panel of so many columns and rows has as strips; a multiple of 8.
Offset strips_size(Index columns, Index rows);

///   entry [strips_size] out;  column [columns] out, from the panel's first;  scratch [rows + 7]
/// Cost: O(8 rows columns)
void make_strips(const Panel& panel, std::int16_t* entry, StripColumns<float> column, double* scratch);

/// Floats of scratch for solves with such a panel.
inline Offset strip_scratch(Index rows) {
  return Offset{2} * kStripRows * ((rows + kStripRows - 1) / kStripRows);
}

/// Solves with one such panel and two right-hand sides.
struct StripSolves {
  /// y <- the part of L^-1 y that this supernode makes: its own columns solved, what they take from the rows below added to
  /// these.
  ///   row [rows]: places in y, the panel's own columns first and one behind the other
  ///   inside: of the rows below, the first so many are added
  ///   scratch [strip_scratch(rows)], on 64 bytes, out: points, those of the rows below are what they have to receive
  void (*forward)(const StripPanel& panel, const Index* row, Index inside, FloatVec2* y, float* scratch);
  /// y at the panel's own columns <- L11^-T (y there - L21^T y below).
  void (*backward)(const StripPanel& panel, const Index* row, FloatVec2* y, float* scratch);
};

/// Pre: the processor has the instructions.
const StripSolves& strip_solves(InstructionSet set);

}  // namespace planish
