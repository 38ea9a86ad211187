#include "io/picture_sheet.hpp"

#include <algorithm>
#include <cmath>

#include "io/model_panel.hpp"
#include "kernels/topology/corners.hpp"

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

/// About as wide as high and a half, few cells empty.
void choose_columns(Grid& grid, std::size_t lines) {
  const auto count = static_cast<Index>(grid.box.size());
  const auto set_columns = [&](Index columns) {
    grid.columns = columns;
    grid.head =
        (static_cast<double>(lines) + (lines > 0 ? 0.5 : 0)) * kLineHeight * grid.width() / kPanelWidth;
  };
  set_columns(count);
  if (lines == 0) return;
  constexpr double kWanted = 1.5, kEmptyCost = 4;
  Index best = 1;
  double least = kInfinity;
  for (Index columns = 1; columns <= count; ++columns) {
    set_columns(columns);
    const double filled = static_cast<double>(count) / (grid.rows() * columns);
    const double off = std::abs(std::log(grid.width() / grid.height() / kWanted)) + kEmptyCost * (1 - filled);
    if (off < least) least = off, best = columns;
  }
  set_columns(best);
}

/// first: boxes of what stands before the maps
Grid lay_out(const Surface& surface, In<SheetMap> maps, std::vector<UvBox> first, std::size_t lines) {
  Grid grid;
  grid.box = std::move(first);
  for (const SheetMap& map : maps) {
    grid.box.push_back(UvBox().with(surface.corner_vertex, map.uv));
    lines = std::max(lines, map.caption.size());
  }
  for (const UvBox& box : grid.box) {
    grid.cell = {std::max(grid.cell.x, size_of(box).x), std::max(grid.cell.y, size_of(box).y)};
  }
  grid.gap = kBetween * grid.cell.x;
  choose_columns(grid, lines);
  return grid;
}

/// Copies of the surface, the elements of one after those of the other.
struct Copies {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;
  Surface surface() const { return {position, corner_vertex}; }
};

/// first: cells before those of the maps
Copies copies_of(const Surface& surface, In<SheetMap> maps, const Grid& grid, Index first) {
  Copies all;
  for (Index k = 0; k < static_cast<Index>(maps.size()); ++k) {
    all.position.insert(all.position.end(), surface.position.begin(), surface.position.end());
    for (const Index v : surface.corner_vertex) all.corner_vertex.push_back(v + k * surface.num_vertices());
    for (const Vec2 z : maps[k].uv) all.uv.push_back(z + grid.shift(first + k));
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

/// The map, turned so that its edges are nearest to those that are seen of the model.
std::vector<Vec2> turned_alike(const Surface& surface, In<Vec2> uv, In<Vec3> seen) {
  Vec2 sum;
  for (Index c = 0; c < static_cast<Index>(surface.corner_vertex.size()); ++c) {
    const Index a = surface.corner_vertex[c], b = surface.corner_vertex[next_corner(c)];
    const Vec2 flat = uv[b] - uv[a], wanted{seen[b].x - seen[a].x, seen[b].y - seen[a].y};
    sum += {dot(flat, wanted), cross(flat, wanted)};
  }
  const double size = norm(sum);
  const Vec2 turn = size > 0 ? (1 / size) * sum : Vec2{1, 0};
  std::vector<Vec2> result;
  result.reserve(uv.size());
  for (const Vec2 z : uv) result.push_back({turn.x * z.x - turn.y * z.y, turn.y * z.x + turn.x * z.y});
  return result;
}

class Sheet {
 public:
  Sheet(const Exec& exec, const Surface& surface, In<SheetMap> maps, const std::optional<SheetModel>& model)
      : exec_(exec), surface_(surface), maps_(maps.begin(), maps.end()), model_(model) {
    if (model) see_model();
    grid_ = lay_out(surface, maps_, model ? std::vector<UvBox>{model_box_} : std::vector<UvBox>{},
                    model ? model->caption.size() : 0);
    captioned_ = std::ranges::any_of(maps, [](const SheetMap& map) { return !map.caption.empty(); });
  }

  Result<void> write(const std::string& path, PictureOptions options) const {
    const Copies all = copies_of(surface_, maps_, grid_, first());
    Certificate certificate = *maps_.back().certificate;
    certificate.flipped.clear();
    for (Index k = 0; k < count(); ++k) {
      for (const Index t : maps_[k].certificate->flipped)
        certificate.flipped.push_back(t + k * surface_.num_triangles());
      if (k + 1 < count())
        options.copies.push_back(on_copy(maps_[k].features, surface_, k, false, !captioned_));
      add_caption(options, first() + k, maps_[k].caption);
    }
    const std::vector<PlacedFeature> features =
        on_copy(maps_.back().features, surface_, count() - 1, true, !captioned_);
    options.features = features;
    options.figures = PanelFigures{
        .triangles = surface_.num_triangles(), .size = size_of(grid_.box.back()), .measured = !captioned_};
    options.window = UvBox{{0, 0}, {grid_.width(), grid_.height()}};
    options.named = !model_;
    if (model_) {
      add_caption(options, 0, model_->caption);
      options.model = SeenModel{surface_, view_, model_box_.lower + grid_.shift(0),
                                model_box_.upper + grid_.shift(0), maps_.back().features};
    }
    return write_picture(exec_, path, all.surface(), all.uv, certificate, options);
  }

 private:
  Index count() const { return static_cast<Index>(maps_.size()); }
  Index first() const { return model_ ? 1 : 0; }

  void see_model() {
    view_ = choose_view(exec_, surface_);
    const std::vector<Vec3> seen = seen_from(exec_, view_, surface_.position);
    const SeenBox box = seen_box(surface_, seen);
    model_box_ = {{box.lower.x, box.lower.y}, {box.upper.x, box.upper.y}};
    turned_.reserve(maps_.size());
    for (SheetMap& map : maps_) {
      turned_.push_back(turned_alike(surface_, map.uv, seen));
      map.uv = turned_.back();
    }
  }

  void add_caption(PictureOptions& options, Index cell, const std::vector<std::string>& lines) const {
    if (lines.empty()) return;
    options.captions.push_back(
        {grid_.corner(cell) + Vec2{0.5 * grid_.cell.x, grid_.cell.y + grid_.head}, lines});
  }

  const Exec& exec_;
  Surface surface_;
  std::vector<SheetMap> maps_;  // turned
  const std::optional<SheetModel>& model_;
  View view_;
  UvBox model_box_;  // of what is seen
  std::vector<std::vector<Vec2>> turned_;
  Grid grid_;
  bool captioned_ = false;
};

}  // namespace

Result<void> write_picture_sheet(const Exec& exec, const std::string& path, const Surface& surface,
                                 In<SheetMap> maps, PictureOptions options,
                                 const std::optional<SheetModel>& model) {
  const auto misses_uv = [&](const SheetMap& map) { return map.uv.size() != surface.position.size(); };
  if (maps.empty() || std::ranges::any_of(maps, misses_uv))
    return fail(ErrorCode::BadUsage, "a sheet of pictures needs maps of one uv a vertex");
  const auto count = static_cast<Offset>(maps.size());
  if (count * 3 * surface.num_triangles() > std::numeric_limits<Index>::max())
    return fail(ErrorCode::TooLarge, "so many maps of so many triangles do not fit on one sheet");
  if (model) {
    if (auto checked = check_model(surface, maps.back().features); !checked) return checked;
  }
  return Sheet(exec, surface, maps, model).write(path, std::move(options));
}

}  // namespace planish
