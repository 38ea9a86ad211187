#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "engine/verify/shape_checks.hpp"
#include "kernels/exact/orient2.hpp"
#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {
namespace {

/// A region's triangles with what their corners are in the mesh and in the template.
class Layout {
 public:
  /// False, and a fault, where the template has another number of points than the region asks for.
  static std::optional<Layout> of(EntryCheck& check, const Feature& feature) {
    Layout layout(*check.evidence().map, feature.triangle, check.entry().shape);
    const std::vector<Index> own = layout.vertices();
    const std::size_t corners = 3 * feature.triangle.size();
    // Where a seam runs through the region its vertices have several points, and the report lists corners.
    layout.by_corner_ = layout.shape_.size() == corners && corners > own.size();
    if (!layout.by_corner_ && !check.has_template(own.size())) return std::nullopt;
    for (std::size_t k = 0; k < own.size(); ++k) layout.place_[own[k]] = k;
    check.hold(own);
    return layout;
  }

  std::size_t size() const { return triangle_.size(); }
  Index triangle(std::size_t k) const { return triangle_[k]; }
  /// The mesh's corner i of the k-th triangle.
  Index corner(std::size_t k, Index i) const { return 3 * triangle_[k] + i; }
  Vec2 point(std::size_t k, Index i) const {
    return by_corner_ ? shape_[3 * k + static_cast<std::size_t>(i)]
                      : shape_[place_.at(map_.vertex(corner(k, i)))];
  }
  RestFrame frame(std::size_t k) const {
    const auto at = [&](Index i) { return map_.position(map_.vertex(corner(k, i))); };
    return rest_frame(at(0), at(1), at(2));
  }
  Mat2 jacobian(std::size_t k) const {
    return planish::jacobian(frame(k), point(k, 0), point(k, 1), point(k, 2));
  }

 private:
  Layout(const WrittenMap& map, In<Index> triangle, In<Vec2> shape)
      : map_(map), triangle_(triangle), shape_(shape) {}

  std::vector<Index> vertices() const {
    std::vector<Index> own;
    for (std::size_t k = 0; k < size(); ++k) {
      for (const Index i : {0, 1, 2}) own.push_back(map_.vertex(corner(k, i)));
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    return own;
  }

  const WrittenMap& map_;
  In<Index> triangle_;
  In<Vec2> shape_;
  bool by_corner_ = false;
  std::map<Index, std::size_t> place_;  // of a vertex in the template
};

void check_orientations(EntryCheck& check, const Layout& layout) {
  std::vector<Index> turned;
  for (std::size_t k = 0; k < layout.size(); ++k) {
    if (orient2(layout.point(k, 0), layout.point(k, 1), layout.point(k, 2)) <= 0)
      turned.push_back(layout.triangle(k));
  }
  if (!turned.empty())
    check.fault(fmt::format("{} triangles of its template are turned over or flat, the first is {}",
                            turned.size(), turned.front()));
}

/// Largest relative change of an edge's length in the template.
double worst_stretch(const Layout& layout) {
  double worst = 0;
  for (std::size_t k = 0; k < layout.size(); ++k) {
    const auto edge = edge_vectors(layout.frame(k));
    for (const Index i : {0, 1, 2}) {
      const Vec2 laid = layout.point(k, (i + 1) % 3) - layout.point(k, i);
      worst = std::max(worst, std::abs(norm(laid) / norm(edge[static_cast<std::size_t>(i)]) - 1));
    }
  }
  return worst;
}

/// How much the template has to be scaled to be as large as the region: 1 of an unrolling, and of the most rigid map, where
/// the derivative of its energy by the scale vanishes.
double size_error(const Layout& layout) {
  double stretch = 0, squared = 0;
  for (std::size_t k = 0; k < layout.size(); ++k) {
    const Mat2 j = layout.jacobian(k);
    const SingularValues s = singular_values(j);
    const double a = area(layout.frame(k));
    stretch += a * (s.sigma_max + s.sigma_min);
    squared += a * squared_norm(j);
  }
  return std::abs(stretch / squared - 1);
}

/// A template that does not stretch is an unrolling; one that does states by how much, and has the region's size.
void check_template(EntryCheck& check, const Layout& layout) {
  constexpr double kSizeAllowed = 1e-4;  // of a map found by iteration
  check_orientations(check, layout);
  const double stretch = worst_stretch(layout), stated = check.entry().planarity.value_or(0);
  if (!(std::abs(stretch - stated) <= kLengthAllowed))
    check.fault(
        fmt::format("its template changes lengths by {:.3g}, the report says {:.3g}", stretch, stated));
  const double off = size_error(layout);
  if (!(off <= kSizeAllowed)) check.fault(fmt::format("its template is {:.3g} too large or too small", off));
}

}  // namespace

std::optional<double> check_region(EntryCheck& check) {
  const Feature* feature = check.feature(check.asked().features.front());
  if (feature == nullptr) return std::nullopt;
  if (feature->triangle.empty()) {
    check.fault("its feature has no triangles");
    return std::nullopt;
  }
  const auto layout = Layout::of(check, *feature);
  if (!layout) return std::nullopt;
  check_template(check, *layout);
  const WrittenMap& map = *check.evidence().map;
  // Corners that say the same twice, once.
  std::map<std::tuple<Index, double, double, double, double>, std::pair<Vec2, Vec2>> distinct;
  double space = 0;
  for (std::size_t k = 0; k < layout->size(); ++k) {
    space += area(layout->frame(k));
    for (const Index i : {0, 1, 2}) {
      const Vec2 p = layout->point(k, i), z = map.uv(layout->corner(k, i));
      distinct[{map.vertex(layout->corner(k, i)), p.x, p.y, z.x, z.y}] = {p, z};
    }
  }
  std::vector<Vec2> shape, image;
  std::vector<std::size_t> kept;
  for (const auto& [key, points] : distinct) {
    if (!std::ranges::binary_search(check.yielded(), std::get<0>(key))) kept.push_back(shape.size());
    shape.push_back(points.first);
    image.push_back(points.second);
  }
  return check.posed(shape, image, kept, std::sqrt(space));
}

}  // namespace planish
