// How the templates of bodies lie nearest to a given map.
#pragma once

#include "engine/constraints/compile.hpp"
#include "engine/constraints/fit.hpp"
#include "engine/constraints/poses.hpp"

namespace planish {

/// The similarity that takes each body's template nearest to the images of its vertices: an isometry where its scale is
/// given. A line with free lengths has its vertices where their images project to, in their order.
///   uv [V] units of the ordered mesh;  result [bodies]   Cost: O(vertices of the bodies).   Ref: Procrustes.
std::vector<BodyFit> fit_bodies(const Compiled& compiled, In<Vec2> uv);

/// Sum of squared distances between a template that lies nearest and the images.
double misfit(const Body& body, In<Vec2> shape, In<Vec2> uv);

}  // namespace planish
