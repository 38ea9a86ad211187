// Features over the flat panel: chains as coloured lines, regions hatched, ideal lines and circles, names.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "io/canvas.hpp"
#include "io/feature_labels.hpp"
#include "io/placed_feature.hpp"

namespace planish {

/// The panel as it is drawn.
struct FlatPanel {
  In<Index> corner_vertex;  ///< [3 T]
  In<Vec2> point;           ///< [V] pixels from the panel's corner
  Vec2 corner;              ///< upper left, pixels of the page
  int height = 0;           ///< pixels
  int page_width = 0;       ///< pixels
  bool named = true;        ///< whether names are drawn

  double unit() const { return page_width / 1600.0; }
};

/// Fails: IndexOutOfRange, with the name of the feature.
Result<void> check_features(In<PlacedFeature> features, Index num_vertices, Index num_triangles);

/// Draws all features, and their names where they have any; ideal figures go as far as names do, a part of the margin around the panel.
/// Fails: never where check_features() does not.   Cost: O(chains + sizes of the regions + length in pixels).
void draw_features(const Exec& exec, Canvas& canvas, In<PlacedFeature> features, const FlatPanel& panel);

/// The list below the panel, at its upper left corner.
void draw_list_of(Canvas& canvas, In<PlacedFeature> features, Vec2 corner, double width, double unit);

}  // namespace planish
