#include "engine/constraints/sectors.hpp"

#include <algorithm>

namespace planish {
namespace {

class SectorFinder {
 public:
  SectorFinder(const Topology& topology, In<Index> corner_vertex, In<std::uint8_t> fixed_edge)
      : topology_(topology), corner_vertex_(corner_vertex), fixed_(fixed_edge) {}

  Sectors operator()() {
    const auto num_vertices = static_cast<Index>(topology_.star_begin.size()) - 1;
    result_.num_vertices = num_vertices;
    result_.corner_sector.assign(corner_vertex_.begin(), corner_vertex_.end());
    for (Index v = 0; v < num_vertices; ++v) add_sector(v);
    for (Index v = 0; v < num_vertices; ++v) split(v);
    open();
    return std::move(result_);
  }

 private:
  Index add_sector(Index v) {
    result_.vertex.push_back(v);
    result_.from.push_back(kNone);
    result_.to.push_back(kNone);
    result_.rowless.push_back(0);
    return static_cast<Index>(result_.vertex.size()) - 1;
  }

  /// First edge of corner c at its vertex, counter-clockwise, and the last one.
  bool first_fixed(Index c) const { return fixed_[c] != 0; }
  bool last_fixed(Index c) const { return fixed_[previous_corner(c)] != 0; }

  void split(Index v) {
    const In<Index> star = slice(In<Index>(topology_.star_corner), topology_.stars().group(v));
    const bool boundary = topology_.is_boundary(v);
    const auto n = static_cast<Index>(star.size());
    Index fixed = 0, start = kNone;
    for (Index k = 0; k < n; ++k) {
      if (!first_fixed(star[k])) continue;
      ++fixed;
      if (start == kNone) start = k;
    }
    const bool last = boundary && last_fixed(star[n - 1]);
    if (fixed == 0 && !last) return;
    if (!boundary && fixed == n) {
      result_.rowless[v] = 1;
      return;
    }
    Index sector = v;
    bool first = true;
    for (Index k = 0; k < n; ++k) {
      const Index c = star[boundary ? k : (start + k) % n];
      if (first || first_fixed(c)) {
        if (!first) sector = add_sector(v);
        first = false;
        if (first_fixed(c)) result_.from[sector] = corner_vertex_[next_corner(c)];
        result_.rowless[sector] = 1;
      } else {
        result_.rowless[sector] = 0;  // an edge inside it
      }
      if (last_fixed(c)) result_.to[sector] = corner_vertex_[previous_corner(c)];
      result_.corner_sector[c] = sector;
    }
  }

  void open() {
    Topology& opened = result_.opened;
    const auto num_corners = static_cast<Index>(corner_vertex_.size());
    opened.corner_twin.resize(num_corners);
    for (Index c = 0; c < num_corners; ++c)
      opened.corner_twin[c] = fixed_[c] ? kNone : topology_.corner_twin[c];
    std::vector<Index> count(result_.vertex.size(), 0);
    for (const Index s : result_.corner_sector) ++count[s];
    opened.star_begin = exclusive_scan(count);
    opened.star_corner.resize(num_corners);
    std::vector<Index> next(opened.star_begin.begin(), opened.star_begin.end() - 1);
    for (const Index c : topology_.star_corner) opened.star_corner[next[result_.corner_sector[c]]++] = c;
    opened.num_components = topology_.num_components;
  }

  const Topology& topology_;
  In<Index> corner_vertex_;
  In<std::uint8_t> fixed_;
  Sectors result_;
};

}  // namespace

Sectors find_sectors(const Topology& topology, In<Index> corner_vertex, In<std::uint8_t> fixed_edge) {
  return SectorFinder(topology, corner_vertex, fixed_edge)();
}

std::vector<Index> sector_order(const Sectors& sectors, In<Index> vertex_order) {
  std::vector<Index> extra_of(vertex_order.size(), kNone), next(sectors.vertex.size(), kNone);
  for (Index s = sectors.num_sectors(); s-- > sectors.num_vertices;) {
    next[s] = extra_of[sectors.vertex[s]];
    extra_of[sectors.vertex[s]] = s;
  }
  std::vector<Index> order;
  order.reserve(sectors.vertex.size());
  for (const Index v : vertex_order) {
    order.push_back(v);
    for (Index s = extra_of[v]; s != kNone; s = next[s]) order.push_back(s);
  }
  return order;
}

double prescribed_angle(const Layout& layout, const Sectors& sectors, Index sector, double angle_sum) {
  const Vec2 at = layout.point[sectors.vertex[sector]];
  const Vec2 a = layout.point[sectors.from[sector]] - at, b = layout.point[sectors.to[sector]] - at;
  if (sectors.from[sector] == sectors.to[sector]) return 2 * kPi;
  constexpr double kCoincide = 1e-9;
  const double angle = std::atan2(cross(a, b), dot(a, b));
  if (std::abs(angle) <= kCoincide) return angle_sum > kPi ? 2 * kPi + angle : angle;
  return angle < 0 ? angle + 2 * kPi : angle;
}

}  // namespace planish
