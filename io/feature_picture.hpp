// The surface in space with its features: chains as coloured lines, regions as tinted triangles, and their
// names.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "io/picture.hpp"

namespace planish {

/// Writes .svg or .png by extension. The surface is shaded and seen as choose_view() has it, the nearest in
/// front; what lies behind of a chain is dashed. An SVG holds the surface as an image, everything else as
/// lines and glyph outlines. Of regions that share a triangle the last one colours it. The options' own
/// features are not used.
/// Fails: UnknownFormat for other extensions; BadUsage (width); NonFinitePosition; IndexOutOfRange (corners,
/// features); OutOfMemory; CannotWrite.
/// Cost: O(T + pixels), 100 bytes a triangle.
Result<void> write_feature_picture(const Exec& exec, const std::string& path, const Surface& surface,
                                   const std::vector<Feature>& features, const PictureOptions& options);

}  // namespace planish
