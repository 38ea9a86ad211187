// A surface in space in a part of a page: shaded, with its features as coloured lines and tinted triangles.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "io/canvas.hpp"
#include "io/placed_feature.hpp"
#include "io/view.hpp"

namespace planish {

/// Where the surface is drawn.
struct ModelPanel {
  In<Index> corner_vertex;    ///< [3 T]
  std::vector<Vec3> point;    ///< [V] pixels: x right, y down, both inside the panel; z towards the viewer
  Vec2 corner;                ///< upper left, on whole pixels of the page
  int width = 0, height = 0;  ///< pixels
  PixelBox names;             ///< where names may stand, pixels of the page
  double unit = 1;            ///< the page's width / 1600
};

struct SeenBox {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
};

/// Of the vertices that triangles have; at the origin where there are none.
SeenBox seen_box(const Surface& surface, In<Vec3> point);

/// Fails: IndexOutOfRange, with the name of the feature; NonFinitePosition, with the vertices that would be drawn.
Result<void> check_model(const Surface& surface, In<PlacedFeature> features);

/// [V] the vertices as they are seen, mesh units.   Cost: O(V), parallel.
std::vector<Vec3> seen_from(const Exec& exec, const View& view, In<Vec3> position);

/// Draws the surface, the nearest in front, and all features with their names; what lies behind of a chain is dashed. The colour
/// of a feature is that of its number; of regions that share a triangle the last one colours it.
/// Pre: indices in range, finite points.   Cost: O(T + pixels).
void draw_model(const Exec& exec, Canvas& canvas, In<PlacedFeature> features, const ModelPanel& panel);

}  // namespace planish
