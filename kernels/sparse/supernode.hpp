// Solves with one supernode of a Cholesky factor: a dense panel whose columns share their rows.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Panel of `columns` columns and `rows` >= columns rows, column by column; the top square is lower
/// triangular.
template <class Value>
struct BasicPanel {
  Index columns = 0;
  Index rows = 0;
  const Value* value = nullptr;
};
using Panel = BasicPanel<double>;
using FloatPanel = BasicPanel<float>;  ///< values rounded once; all arithmetic is in double

/// Forward substitution with two right-hand sides u and v over the panel's rows.
///   u, v [rows] in: right-hand side of the columns, then what was collected for the rows below (0 to start
///   with) out: L11^-1 of the first part, and the second part minus L21 times that.
///   Cost: reads the panel
///   once.
void forward_panel(const Panel& panel, Out<double> u, Out<double> v);
void forward_panel(const FloatPanel& panel, Out<double> u, Out<double> v);

/// Backward substitution.
///   u, v [rows] in: right-hand side of the columns, then the solution of the rows below
///   out: first part L11^-T (right-hand side - L21^T below); second part unchanged.
void backward_panel(const Panel& panel, Out<double> u, Out<double> v);
void backward_panel(const FloatPanel& panel, Out<double> u, Out<double> v);

}  // namespace planish
