// Solves with one supernode of a Cholesky factor: a dense panel whose columns share their rows.
#pragma once

#include "kernels/sparse/simd.hpp"

namespace planish {

/// Panel of `columns` >= 1 columns and `rows` >= columns rows, column by column; the top square is lower
/// triangular.
struct Panel {
  Index columns = 0;
  Index rows = 0;
  const double* value = nullptr;
};

/// Substitutions with two right-hand sides u and v over the panel's rows.   Cost: reads the panel once.
struct PanelSolves {
  /// u, v [rows] in: right-hand side of the columns, then what was collected for the rows below (0 to start with)
  ///   out: L11^-1 of the first part, and the second part minus L21 times that.
  void (*forward)(const Panel& panel, double* u, double* v);
  /// u, v [rows] in: right-hand side of the columns, then the solution of the rows below
  ///   out: first part L11^-T (right-hand side - L21^T below); second part unchanged.
  void (*backward)(const Panel& panel, double* u, double* v);
};

/// Pre: the processor has the instructions.
const PanelSolves& panel_solves(InstructionSet set);

}  // namespace planish
