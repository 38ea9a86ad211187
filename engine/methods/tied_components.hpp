// Components of a surface whose features' directions are tied to one another.
#pragma once

#include <vector>

#include "engine/methods/method.hpp"

namespace planish {

/// Components by groups, each in ascending order, that relations between directions join; a component by itself where none does.
std::vector<std::vector<Index>> tied_components(const MapInput& input);

/// Fails: ConstraintUnsupported where a group of scales joins features of several components, for methods to which each component's
/// size is its own.
Result<void> check_scale_groups(const MapInput& input);

}  // namespace planish
