#include "io/picture_sheet.hpp"

#include <algorithm>

namespace planish {
namespace {

constexpr double kBetween = 0.06;                       // of the widest map
constexpr double kPanelWidth = 1504, kLineHeight = 30;  // pixels of a picture of 1600

Vec2 size_of(const UvBox& box) { return box.upper - box.lower; }

/// Cells of one size, row by row; the mesh is u to the right, v up.
struct Grid {
  std::vector<UvBox> box;
  Vec2 cell;
  double gap = 0, head = 0;  ///< head: above each map, for its caption
  Index columns = 1;

  Index rows() const { return (static_cast<Index>(box.size()) + columns - 1) / columns; }
  double width() const { return columns * cell.x + (columns - 1) * gap; }
  double height() const { return rows() * (cell.y + head) + (rows() - 1) * gap; }
  /// Lower left corner of a cell, its head above it.
  Vec2 corner(Index k) const {
    const Index row = k / columns, column = k % columns;
    return {column * (cell.x + gap), height() - (row + 1) * (cell.y + head) - row * gap};
  }
  /// By how much a map is moved to the middle of its cell.
  Vec2 shift(Index k) const { return corner(k) + 0.5 * cell - 0.5 * (box[k].lower + box[k].upper); }
};

Grid lay_out(const Surface& surface, In<SheetMap> maps) {
  Grid grid;
  std::size_t lines = 0;
  for (const SheetMap& map : maps) {
    grid.box.push_back(UvBox().with(surface.corner_vertex, map.uv));
    const Vec2 size = size_of(grid.box.back());
    grid.cell = {std::max(grid.cell.x, size.x), std::max(grid.cell.y, size.y)};
    lines = std::max(lines, map.caption.size());
  }
  grid.gap = kBetween * grid.cell.x;
  const auto set_columns = [&](Index columns) {
    grid.columns = columns;
    grid.head = static_cast<double>(lines) * kLineHeight * grid.width() / kPanelWidth;
  };
  set_columns(static_cast<Index>(maps.size()));
  if (lines == 0) return grid;
  constexpr double kWanted = 1.5;
  Index best = 1;
  double least = kInfinity;
  for (Index columns = 1; columns <= static_cast<Index>(maps.size()); ++columns) {
    set_columns(columns);
    const double off = std::abs(std::log(grid.width() / grid.height() / kWanted));
    if (off < least) least = off, best = columns;
  }
  set_columns(best);
  return grid;
}

/// Copies of the surface, the elements of one after those of the other.
struct Copies {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;
  Surface surface() const { return {position, corner_vertex}; }
};

Copies copies_of(const Surface& surface, In<SheetMap> maps, const Grid& grid) {
  Copies all;
  for (Index k = 0; k < static_cast<Index>(maps.size()); ++k) {
    all.position.insert(all.position.end(), surface.position.begin(), surface.position.end());
    for (const Index v : surface.corner_vertex) all.corner_vertex.push_back(v + k * surface.num_vertices());
    for (const Vec2 z : maps[k].uv) all.uv.push_back(z + grid.shift(k));
  }
  return all;
}

/// ideals: figures that lines and circles were to become, which go beyond the map, are shown.
std::vector<PlacedFeature> on_copy(In<PlacedFeature> features, const Surface& surface, Index k, bool named,
                                   bool ideals) {
  std::vector<PlacedFeature> moved(features.begin(), features.end());
  for (PlacedFeature& feature : moved) {
    for (Index& v : feature.vertex) v += k * surface.num_vertices();
    for (Index& t : feature.triangle) t += k * surface.num_triangles();
    if (!named) feature.name.clear();
    if (!ideals) feature.ideal = PlacedFeature::Ideal::None;
  }
  return moved;
}

}  // namespace

Result<void> write_picture_sheet(const Exec& exec, const std::string& path, const Surface& surface,
                                 In<SheetMap> maps, PictureOptions options) {
  const auto misses_uv = [&](const SheetMap& map) { return map.uv.size() != surface.position.size(); };
  if (maps.empty() || std::ranges::any_of(maps, misses_uv))
    return fail(ErrorCode::BadUsage, "a sheet of pictures needs maps of one uv a vertex");
  const auto count = static_cast<Offset>(maps.size());
  if (count * 3 * surface.num_triangles() > std::numeric_limits<Index>::max())
    return fail(ErrorCode::TooLarge, "so many maps of so many triangles do not fit on one sheet");
  const Grid grid = lay_out(surface, maps);
  const Copies all = copies_of(surface, maps, grid);
  Certificate certificate = *maps.back().certificate;
  certificate.flipped.clear();
  const bool captioned = std::ranges::any_of(maps, [](const SheetMap& map) { return !map.caption.empty(); });
  for (Index k = 0; k < static_cast<Index>(maps.size()); ++k) {
    for (const Index t : maps[k].certificate->flipped)
      certificate.flipped.push_back(t + k * surface.num_triangles());
    if (k + 1 < static_cast<Index>(maps.size()))
      options.copies.push_back(on_copy(maps[k].features, surface, k, false, !captioned));
    if (maps[k].caption.empty()) continue;
    options.captions.push_back(
        {grid.corner(k) + Vec2{0.5 * grid.cell.x, grid.cell.y + grid.head}, maps[k].caption});
  }
  const std::vector<PlacedFeature> features =
      on_copy(maps.back().features, surface, static_cast<Index>(maps.size()) - 1, true, !captioned);
  options.features = features;
  options.figures = PanelFigures{
      .triangles = surface.num_triangles(), .size = size_of(grid.box.back()), .measured = !captioned};
  options.window = UvBox{{0, 0}, {grid.width(), grid.height()}};
  return write_picture(exec, path, all.surface(), all.uv, certificate, options);
}

}  // namespace planish
