// Residuals of the constraints that give a feature a shape (DESIGN 3.8), none where they cannot be had.
#pragma once

#include "engine/verify/entry_check.hpp"

namespace planish {

/// Distance from the best-fit line and from the template, and lengths of edges, over the chain's length; order along it.
std::optional<double> check_line(EntryCheck& check);
/// Distance from the circle of least squares over its radius, from the template and lengths of edges over the chain's
/// length; it turns one way, once around where closed.
std::optional<double> check_circle(EntryCheck& check);
/// Distance from the template over the chain's length; the template is the chain as seen across its plane.
std::optional<double> check_curve(EntryCheck& check);
/// Distance from the template over the square root of the area; the template keeps what the region allows.
std::optional<double> check_region(EntryCheck& check);

}  // namespace planish
