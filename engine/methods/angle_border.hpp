// Long rows of angle-based flattening: a dense border of the sparse system.
#pragma once

#include "engine/methods/angle_blocks.hpp"
#include "engine/methods/angle_factor.hpp"

namespace planish {

/// Multipliers of the rows and of the long rows together.   factor: of blocks.matrix();  exact: as it was linearised
///   x [rows]: the right-hand side in, the rows' multipliers out;  long_multiplier [long rows] out
/// Fails: ConstraintsConflict (ids: relations) where long rows contradict one another; FactorizationFailed where that is found in an
/// exact system, which may be singular otherwise.   Cost: a solve for every two long rows.
Result<void> solve_bordered(const AngleBlocks& blocks, const AngleFactor& factor, In<LongAngleRow> long_rows,
                            bool exact, std::vector<Vec2>& x, Out<double> long_multiplier);

/// Sum of a long row's terms.
double along(const LongAngleRow& row, In<double> values);

}  // namespace planish
