// The constraint file (DESIGN 4.2) of a sample: its features as polylines, and what a person would ask of
// them.
#pragma once

#include <string>

#include "engine/sample/panels.hpp"

namespace planish {

/// JSON text, one line a feature and a constraint; numbers read back bit for bit.
std::string sample_constraints_json(const Sample& sample);

}  // namespace planish
