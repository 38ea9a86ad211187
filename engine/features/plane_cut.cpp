#include "engine/features/plane_cut.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "engine/features/feature_error.hpp"
#include "engine/features/nearest.hpp"
#include "engine/features/simple_pieces.hpp"

namespace planish {
namespace {

double largest_coordinate(Vec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

/// Unit vector; scaled first, so that no length overflows or vanishes.
Vec3 direction(Vec3 v) {
  const double scale = largest_coordinate(v);
  const Vec3 scaled{v.x / scale, v.y / scale, v.z / scale};
  return 1 / norm(scaled) * scaled;
}

/// Signed distances of the vertices to the plane; exactly 0 within rounding.
struct Heights {
  std::vector<double> of;  ///< [V] mesh units
  double lowest = kInfinity, highest = -kInfinity;
  bool some_zero = false;
};

Heights heights_over(const Exec& exec, const Surface& surface, const Topology& topology,
                     const PlaneCutSource& source) {
  struct Part {
    double magnitude = 0, lowest = kInfinity, highest = -kInfinity;
    bool some_zero = false;
  };
  const Index num_vertices = surface.num_vertices();
  const auto is_used = [&](Index v) { return topology.star_begin[v] < topology.star_begin[v + 1]; };
  std::vector<Part> part(Exec::num_blocks(num_vertices, kBlock));
  exec.for_blocks(num_vertices, kBlock, [&](Index block, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      if (is_used(v))
        part[block].magnitude = std::max(part[block].magnitude, largest_coordinate(surface.position[v]));
    }
  });
  double magnitude = largest_coordinate(source.point);
  for (const Part& p : part) magnitude = std::max(magnitude, p.magnitude);
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * magnitude;

  Heights heights;
  heights.of.resize(num_vertices);
  const Vec3 normal = direction(source.normal);
  exec.for_blocks(num_vertices, kBlock, [&](Index block, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      if (!is_used(v)) continue;
      const double h = dot(normal, surface.position[v] - source.point);
      heights.of[v] = std::abs(h) <= rounding ? 0 : h;
      part[block].lowest = std::min(part[block].lowest, heights.of[v]);
      part[block].highest = std::max(part[block].highest, heights.of[v]);
      part[block].some_zero |= heights.of[v] == 0;
    }
  });
  for (const Part& p : part) {
    heights.lowest = std::min(heights.lowest, p.lowest);
    heights.highest = std::max(heights.highest, p.highest);
    heights.some_zero |= p.some_zero;
  }
  return heights;
}

/// Follows the plane from triangle to triangle. With every vertex strictly above or below, a triangle that is
/// cut has one edge where the plane comes in (a half-edge that goes down) and one where it leaves (up).
class PlaneTracer {
 public:
  /// zero_is_above: the side to which vertices on the plane count.
  PlaneTracer(const Surface& surface, const Topology& topology, In<double> height, bool zero_is_above)
      : surface_(surface), topology_(topology), height_(height), zero_is_above_(zero_is_above) {}

  /// Appends all curves, open ones first.
  void trace(const Exec& exec, std::vector<WalkPiece>& pieces) {
    const Index num_triangles = surface_.num_triangles();
    cut_.resize(num_triangles);
    exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) cut_[t] = way_in(t) != kNone ? 1 : 0;
    });
    for (const bool open : {true, false}) {
      for (Index t = 0; t < num_triangles; ++t) {
        if (!cut_[t] || (open && topology_.corner_twin[way_in(t)] != kNone)) continue;
        for (WalkPiece& piece : simple_pieces(follow(t))) pieces.push_back(std::move(piece));
      }
    }
  }

 private:
  bool is_above(Index v) const { return height_[v] > 0 || (height_[v] == 0 && zero_is_above_); }

  /// The half-edge of t that goes down through the plane, or kNone.
  Index way_in(Index t) const {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      if (is_above(surface_.corner_vertex[c]) && !is_above(surface_.corner_vertex[next_corner(c)])) return c;
    }
    return kNone;
  }
  /// The half-edge of t that goes up; t is cut.
  Index way_out(Index t) const {
    Index c = 3 * t;
    while (is_above(surface_.corner_vertex[c]) || !is_above(surface_.corner_vertex[next_corner(c)])) ++c;
    return c;
  }

  WalkPiece follow(Index t) {
    WalkPiece walk;
    while (true) {
      cut_[t] = 0;
      append(crossing(way_in(t)), walk);
      const Index out = way_out(t), twin = topology_.corner_twin[out];
      if (twin == kNone) {
        append(crossing(out), walk);
        return walk;
      }
      t = twin / 3;
      if (!cut_[t]) break;
    }
    walk.closed = true;
    if (walk.point.size() > 1 && is_same_vertex(walk.point.back(), walk.point.front())) walk.point.pop_back();
    return walk;
  }

  static bool is_same_vertex(const WalkPoint& a, const WalkPoint& b) {
    return a.vertex != kNone && a.vertex == b.vertex;
  }

  /// Of crossings drawn back to one vertex the last stays: its triangle is the one in which the walk goes on.
  static void append(const WalkPoint& p, WalkPiece& walk) {
    if (!walk.point.empty() && is_same_vertex(walk.point.back(), p)) walk.point.pop_back();
    walk.point.push_back(p);
  }

  /// The point on a half-edge that crosses the plane, the same bits from both of its sides.
  WalkPoint crossing(Index c) const {
    Index upper = c, lower = next_corner(c);
    if (!is_above(surface_.corner_vertex[upper])) std::swap(upper, lower);
    const Index above = surface_.corner_vertex[upper], below = surface_.corner_vertex[lower];
    const double up = std::abs(height_[above]), down = std::abs(height_[below]);
    const double weight[2] = {down / (up + down), up / (up + down)};  // of above, of below
    double barycentric[3] = {0, 0, 0};
    barycentric[upper % 3] = weight[0];
    barycentric[lower % 3] = weight[1];
    WalkPoint p{{c / 3, {barycentric[0], barycentric[1], barycentric[2]}}, {}, kNone};
    if (up == 0 || down == 0) {
      p.vertex = up == 0 ? above : below;
      p.position = surface_.position[p.vertex];
    } else {
      p.position = weight[0] * surface_.position[above] + weight[1] * surface_.position[below];
    }
    return p;
  }

  const Surface& surface_;
  const Topology& topology_;
  In<double> height_;
  bool zero_is_above_;
  std::vector<std::uint8_t> cut_;  ///< [T] cut and not yet followed
};

double squared_distance(const WalkPiece& piece, Vec3 near) {
  const auto& point = piece.point;
  double least = kInfinity;
  for (std::size_t i = piece.closed ? 0 : 1; i < point.size(); ++i) {
    const WalkPoint& previous = i == 0 ? point.back() : point[i - 1];
    least = std::min(least, squared_distance_to_segment(near, previous.position, point[i].position));
  }
  return least;
}

SurfaceCurve curve_of(WalkPiece piece, Vec3 near) {
  auto& point = piece.point;
  if (piece.closed) {
    const auto nearer = [&](const WalkPoint& a, const WalkPoint& b) {
      const double da = norm(a.position - near), db = norm(b.position - near);
      return da != db ? da < db : comes_before(a.position, b.position);
    };
    std::rotate(point.begin(), std::min_element(point.begin(), point.end(), nearer), point.end());
  }
  SurfaceCurve curve;
  curve.closed = piece.closed;
  for (const WalkPoint& p : point) {
    curve.at.push_back(p.at);
    curve.position.push_back(p.position);
  }
  return curve;
}

std::optional<Error> fault_of(const std::string& name, const PlaneCutSource& source) {
  const auto broken = [&](const std::string& what) {
    return feature_error(ErrorCode::FeatureBroken, name, what);
  };
  const auto not_finite = [&](const char* key) {
    return broken(std::string("a coordinate of \"") + key + "\" is not a finite number");
  };
  if (!is_finite_point(source.point)) return not_finite("point");
  if (!is_finite_point(source.normal)) return not_finite("normal");
  if (!is_finite_point(source.near)) return not_finite("near");
  if (largest_coordinate(source.normal) == 0) return broken("the \"normal\" of the plane is zero");
  return {};
}

std::string why_no_curve(const Heights& heights) {
  if (heights.lowest > 0 || heights.highest < 0) {
    return "the plane misses the surface by " +
           in_words(heights.lowest > 0 ? heights.lowest : -heights.highest) + " mesh units";
  }
  if (heights.lowest == 0 && heights.highest == 0)
    return "the whole surface lies in the plane, which so cuts no curve";
  return "the plane touches the surface and does not cut it";
}

}  // namespace

Result<SurfaceCurve> plane_cut(const Exec& exec, const Surface& surface, const Topology& topology,
                               const std::string& name, const PlaneCutSource& source) {
  if (auto fault = fault_of(name, source)) return fail(*std::move(fault));
  const Heights heights = heights_over(exec, surface, topology, source);
  std::vector<WalkPiece> pieces;
  PlaneTracer(surface, topology, heights.of, true).trace(exec, pieces);
  if (heights.some_zero) PlaneTracer(surface, topology, heights.of, false).trace(exec, pieces);
  if (pieces.empty()) return fail(feature_error(ErrorCode::FeatureBroken, name, why_no_curve(heights)));
  std::size_t nearest = 0;
  double least = kInfinity;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double d = squared_distance(pieces[i], source.near);
    if (d < least) least = d, nearest = i;
  }
  return curve_of(std::move(pieces[nearest]), source.near);
}

}  // namespace planish
