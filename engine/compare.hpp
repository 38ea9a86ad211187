// The facade for comparing: one surface, the same constraints, several methods.
#pragma once

#include "engine/flatten.hpp"
#include "engine/model/comparison.hpp"

namespace planish {

/// Flattens by each method with its defaults, ARAP without constraints where they are to be left out. What a method cannot do is said in its row, and ends nothing.
/// time_limit: seconds that each map may take, looked at where the monitor is called; infinite: any. One that takes longer has no
/// map, and its row says so.
/// Fails: Cancelled; what no method could work on: the defects of diagnose(), BadUsage, IndexOutOfRange.
/// Cost: that of all of them, one after the other.
Result<std::vector<ComparedMethod>> compare(const Surface& surface, const Constraints& constraints,
                                            const std::vector<Contender>& contenders, int threads,
                                            double time_limit = kInfinity, const Monitor& monitor = {});

/// Residual over what is allowed: at most 1 where the constraint is met.
double share_of_allowed(const ConstraintOutcome& outcome);

}  // namespace planish
