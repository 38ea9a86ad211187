// Solves with one supernode of a Cholesky factor: a dense panel whose columns share their rows.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Panel of `columns` columns and `rows` >= columns rows, column by column; the top square is lower
/// triangular.
struct Panel {
  Index columns = 0;
  Index rows = 0;
  const double* value = nullptr;
};

/// Forward substitution with two right-hand sides u and v over the panel's rows.
///   u, v [rows] in: right-hand side of the columns, then what was collected for the rows below (0 to start
///   with) out: L11^-1 of the first part, and the second part minus L21 times that.
///   Cost: reads the panel
///   once.
void forward_panel(const Panel& panel, Out<double> u, Out<double> v);

/// Backward substitution.
///   u, v [rows] in: right-hand side of the columns, then the solution of the rows below
///   out: first part L11^-T (right-hand side - L21^T below); second part unchanged.
void backward_panel(const Panel& panel, Out<double> u, Out<double> v);

}  // namespace planish
