// The size of maps that are determined up to a similarity.
#pragma once

#include "engine/constraints/body.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// Scales each component that fewer than two pins hold to the size of least ARAP energy, about its pin where it has one.
///   together: one factor for all components, where features of several are to have one scale;  uv [V] in and out
/// Cost: O(T).
void fit_sizes(const Workpiece& piece, In<Pin> pins, bool together, Out<Vec2> uv);

}  // namespace planish
