// The flat panel as a picture: colours by stretch with a legend, wireframe, boundary, features, flipped triangles.
#pragma once

#include <optional>
#include <string>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/mesh.hpp"
#include "io/placed_feature.hpp"
#include "io/view.hpp"

namespace planish {

/// The smallest box that holds points of the plane; nothing at first.
struct UvBox {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  /// The box that holds a map's referenced vertices too: the others lie at 0 0 and are not part of it.
  UvBox with(In<Index> corner_vertex, In<Vec2> uv) const;
};

/// What the strip under a picture says of the panel, where that is not all that is drawn.
struct PanelFigures {
  Index triangles = 0;
  Vec2 size;             ///< mesh units
  bool measured = true;  ///< whether it states what the certificate has
};

/// Words on the panel, line below line, centred; the first one bold.
struct Caption {
  Vec2 top;  ///< mesh units
  std::vector<std::string> lines;
};

/// The surface in space on the panel, at its scale.
struct SeenModel {
  Surface surface;
  View view;
  Vec2 lower, upper;                ///< where the box of what is seen stands, mesh units
  In<PlacedFeature> features = {};  ///< in the colours of the options' features, named where they have names
};

struct PictureOptions {
  int width = 1600;  ///< pixels (SVG: user units), 200 to 8000; the height follows the panel, at most 4 times
                     ///< the width
  std::string title;                 ///< shown above the panel
  In<PlacedFeature> features = {};   ///< shown on the flat panel and listed below it
  bool named = true;                 ///< their names stand on the panel too
  std::optional<UvBox> window = {};  ///< what is shown at least; none: the panel
  std::optional<PanelFigures> figures = {};
  std::vector<Caption> captions = {};
  /// The features again, elsewhere on the panel: in the same colours, not listed, and named where they have names.
  std::vector<std::vector<PlacedFeature>> copies = {};
  std::optional<SeenModel> model = {};
};

/// Writes .svg or .png by extension. The colour of a triangle is the singular value that deviates more from 1
/// (by its logarithm), minus 1. Chains of features are coloured lines with straight edges between their vertices,
/// regions are hatched; over chains that were to be straight or round, the nearest line or circle is dashed. An SVG
/// holds the colours as an image, everything else as lines and glyph outlines.
///   uv [V];  certificate: its numbers are shown, its flipped triangles marked
/// Fails: UnknownFormat for other extensions; BadUsage (width, size of uv); NonFinitePosition (uv, the model);
/// IndexOutOfRange (corners, flipped ids, features); OutOfMemory; CannotWrite.
/// Cost: O(T + pixels + sizes of the features), 100 bytes a triangle.
Result<void> write_picture(const Exec& exec, const std::string& path, const Surface& surface, In<Vec2> uv,
                           const Certificate& certificate, const PictureOptions& options);

}  // namespace planish
