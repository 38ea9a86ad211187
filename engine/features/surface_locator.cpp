#include "engine/features/surface_locator.hpp"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <vector>

namespace planish {
namespace {

/// Boxes lie in [-1, 1]; a margin of this size on each side outweighs their rounding to float.
constexpr double kBoxMargin = 0x1p-22;
/// Relative, for the roundings of Embree's distances; then absolute, so that squares of radii stay normal.
constexpr double kRadiusFactor = 1 + 0x1p-20, kRadiusMargin = 0x1p-40;
/// Queries beyond have squares that overflow in float.
constexpr double kFarthest = 0x1p60;
/// Height over length, squared, and distance from the edges, relative, from which a foot is inside beyond doubt.
constexpr double kWellShaped = 1e-8, kWellInside = 0x1p-20;
/// Of squared coordinates: the square of what rounding makes of a distance 0.
constexpr double kRoundedZero = 0x1p-102;

/// Squares further apart have different roots in double.
constexpr double kSameDistance = 1 + 0x1p-50;

double squared_norm(Vec3 a) { return dot(a, a); }

/// Barycentric coordinates of a point of a triangle and its squared distance from the query.
struct Foot {
  std::array<double, 3> weight{};
  double squared = kInfinity;
};

/// A triangle as the query sees it, from itself as the origin.
struct Seen {
  std::array<Index, 3> vertex;
  std::array<Vec3, 3> corner;
};

Seen seen_from(Vec3 query, const Surface& surface, Index triangle) {
  Seen seen;
  for (int i = 0; i < 3; ++i) {
    seen.vertex[i] = surface.corner_vertex[3 * triangle + i];
    seen.corner[i] = surface.position[seen.vertex[i]] - query;
  }
  return seen;
}

/// The edge runs from its smaller vertex, so that both of its triangles round alike.
Foot foot_on_edge(const Seen& seen, int i, int j) {
  if (seen.vertex[i] > seen.vertex[j]) std::swap(i, j);
  const Vec3 p = seen.corner[i], edge = seen.corner[j] - p;
  const double along = -dot(p, edge), squared_length = squared_norm(edge);
  Foot foot;
  if (along <= 0) {
    foot.weight[i] = 1;
    foot.squared = squared_norm(p);
  } else if (along >= squared_length) {
    foot.weight[j] = 1;
    foot.squared = squared_norm(seen.corner[j]);
  } else {
    const double t = along / squared_length;
    foot.weight[j] = t;
    foot.weight[i] = 1 - t;
    foot.squared = squared_norm(p + t * edge);
  }
  return foot;
}

/// The foot on the plane where it lies inside, with `clear` where neither rounding nor shape puts that in
/// doubt; else a foot at infinity.
Foot foot_inside(const Seen& seen, bool& clear) {
  const Vec3 origin = seen.corner[0], base = seen.corner[1] - origin, side = seen.corner[2] - origin;
  const double squared_base = squared_norm(base);
  double shear = dot(side, base) / squared_base;
  Vec3 height = side - shear * base;
  const double rest = dot(height, base) / squared_base;
  height = height - rest * base;
  shear += rest;
  const double squared_height = squared_norm(height);
  const double t = -dot(origin, height) / squared_height;
  const double s = -dot(origin, base) / squared_base - t * shear;
  Foot foot;
  clear = false;
  if (!(s > 0 && t > 0 && s + t < 1)) return foot;
  foot.weight = {1 - s - t, s, t};
  foot.squared = squared_norm(origin + s * base + t * side);
  clear = std::ranges::min(foot.weight) > kWellInside &&
          squared_height > kWellShaped * std::max(squared_base, squared_norm(side));
  return foot;
}

Foot foot_on_triangle(const Seen& seen) {
  bool clear;
  const Foot inside = foot_inside(seen, clear);
  if (clear) return inside;
  Foot best = foot_on_edge(seen, 0, 1);
  for (const Foot& other : {foot_on_edge(seen, 1, 2), foot_on_edge(seen, 2, 0)}) {
    if (other.squared < best.squared) best = other;
  }
  // What lies on an edge up to rounding is said to lie there.
  const double rounding = kRoundedZero * squared_norm(seen.corner[0]);
  return inside.squared < best.squared - rounding ? inside : best;
}

SurfaceLocator::Hit hit_at(const Surface& surface, Index triangle, const Foot& foot) {
  SurfaceLocator::Hit hit;
  hit.at = {triangle, {foot.weight[0], foot.weight[1], foot.weight[2]}};
  for (int i = 0; i < 3; ++i) {
    if (foot.weight[i] == 0) continue;  // 0 * position could turn -0 into 0
    const Vec3 term = foot.weight[i] * surface.position[surface.corner_vertex[3 * triangle + i]];
    hit.position = i == 0 ? term : hit.position + term;
  }
  hit.distance = std::sqrt(foot.squared);
  return hit;
}

struct Box {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  void add(Vec3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

Box box_of(const Exec& exec, const Surface& surface) {
  const auto num_corners = static_cast<Index>(surface.corner_vertex.size());
  std::vector<Box> part(Exec::num_blocks(num_corners, kBlock));
  exec.for_blocks(num_corners, kBlock, [&](Index k, Range r) {
    for (Index c = r.begin; c < r.end; ++c) part[k].add(surface.position[surface.corner_vertex[c]]);
  });
  Box box;
  for (const Box& b : part) {
    box.add(b.lower);
    box.add(b.upper);
  }
  return box;
}

}  // namespace

SurfaceLocator::Hit closest_point(const Surface& surface, Index triangle, Vec3 query) {
  return hit_at(surface, triangle, foot_on_triangle(seen_from(query, surface, triangle)));
}

struct SurfaceLocator::Tree {
  Surface surface;
  Vec3 centre;
  double scale = 1;  ///< a power of two: mesh units to Embree's
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Tree(const Exec& exec, const Surface& s, Built built);
  ~Tree() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  Vec3 normalized(Vec3 p) const { return scale * (p - centre); }
  Hit nearest(Vec3 query, double radius, In<Index> triangle_group, Index group) const;

 private:
  void build(const Exec& exec, Built built);
  static void bounds(const RTCBoundsFunctionArguments* args);
};

namespace {

/// One search: the best triangle so far. What it ends with does not depend on the order of visits.
struct Search {
  const Surface& surface;
  double scale;
  Vec3 query;
  In<Index> triangle_group;  ///< empty: all triangles
  Index group;
  double query_rounding = 0;                           ///< between the query and Embree's, Embree's units
  Index triangle = std::numeric_limits<Index>::max();  ///< none yet
  double distance = kInfinity;
  Foot foot = {};

  /// True where t is the best so far.
  bool visit(Index t) {
    if (!triangle_group.empty() && triangle_group[t] != group) return false;
    const Foot candidate = foot_on_triangle(seen_from(query, surface, t));
    if (candidate.squared > kSameDistance * foot.squared) return false;
    const double its_distance = std::sqrt(candidate.squared);
    if (its_distance > distance || (its_distance == distance && t > triangle)) return false;
    foot = candidate;
    distance = its_distance;
    triangle = t;
    return true;
  }

  /// A radius of Embree's that leaves out nothing `within` (mesh units).
  float reach(double within) const {
    return static_cast<float>((scale * within + query_rounding) * kRadiusFactor + kRadiusMargin);
  }
};

bool visit_primitive(RTCPointQueryFunctionArguments* args) {
  Search& search = *static_cast<Search*>(args->userPtr);
  if (!search.visit(static_cast<Index>(args->primID))) return false;
  const float reach = search.reach(search.distance);
  if (reach >= args->query->radius) return false;  // Embree allows a radius to shrink only
  args->query->radius = reach;
  return true;
}

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

SurfaceLocator::Tree::Tree(const Exec& exec, const Surface& s, Built built) : surface(s) {
  if (s.num_triangles() == 0) return;
  const Box box = box_of(exec, s);
  centre = 0.5 * box.lower + 0.5 * box.upper;
  const Vec3 half = box.upper - centre;
  int exponent = 0;
  std::frexp(std::max({half.x, half.y, half.z}), &exponent);
  scale = std::ldexp(1.0, -exponent);
  build(exec, built);
}

void SurfaceLocator::Tree::build(const Exec& exec, Built built) {
  device = rtcNewDevice(nullptr);
  if (!device) throw std::bad_alloc();
  scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (scene && geometry) {
    if (built == Built::ForFewQueries) rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(surface.num_triangles()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    // A join builds on the threads of the calling arena: both() enters that of exec.
    exec.both([&] { rtcJoinCommitScene(scene); }, [] {});
  }
  if (geometry) rtcReleaseGeometry(geometry);
  const bool good = scene && geometry && rtcGetDeviceError(device) == RTC_ERROR_NONE;
  if (good) return;
  if (scene) rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  throw std::bad_alloc();  // all arguments are valid, so memory is what lacked
}

void SurfaceLocator::Tree::bounds(const RTCBoundsFunctionArguments* args) {
  const Tree& tree = *static_cast<const Tree*>(args->geometryUserPtr);
  Box box;
  for (int i = 0; i < 3; ++i) {
    box.add(tree.normalized(tree.surface.position[tree.surface.corner_vertex[3 * args->primID + i]]));
  }
  RTCBounds& out = *args->bounds_o;
  out.lower_x = static_cast<float>(box.lower.x - kBoxMargin);
  out.lower_y = static_cast<float>(box.lower.y - kBoxMargin);
  out.lower_z = static_cast<float>(box.lower.z - kBoxMargin);
  out.upper_x = static_cast<float>(box.upper.x + kBoxMargin);
  out.upper_y = static_cast<float>(box.upper.y + kBoxMargin);
  out.upper_z = static_cast<float>(box.upper.z + kBoxMargin);
}

SurfaceLocator::Hit SurfaceLocator::Tree::nearest(Vec3 query, double radius, In<Index> triangle_group,
                                                  Index group) const {
  if (!scene || !is_finite(query) || !(radius >= 0)) return {};
  Search search{
      .surface = surface, .scale = scale, .query = query, .triangle_group = triangle_group, .group = group};
  const Vec3 p = normalized(query);
  if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < kFarthest) {
    RTCPointQuery point{};
    point.x = static_cast<float>(p.x);
    point.y = static_cast<float>(p.y);
    point.z = static_cast<float>(p.z);
    search.query_rounding = norm(p - Vec3{point.x, point.y, point.z});
    point.radius = search.reach(radius);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene, &point, &context, visit_primitive, &search);
  } else {
    for (Index t = 0; t < surface.num_triangles(); ++t) search.visit(t);
  }
  if (!(search.distance <= radius) || search.distance == kInfinity) return {};
  return hit_at(surface, search.triangle, search.foot);
}

SurfaceLocator::SurfaceLocator(const Exec& exec, const Surface& surface, Built built)
    : tree_(std::make_unique<Tree>(exec, surface, built)) {}
SurfaceLocator::~SurfaceLocator() = default;
SurfaceLocator::SurfaceLocator(SurfaceLocator&&) noexcept = default;
SurfaceLocator& SurfaceLocator::operator=(SurfaceLocator&&) noexcept = default;

SurfaceLocator::Hit SurfaceLocator::nearest(Vec3 query, double radius) const {
  return tree_->nearest(query, radius, {}, kNone);
}

SurfaceLocator::Hit SurfaceLocator::nearest_in(In<Index> triangle_group, Index group, Vec3 query,
                                               double radius) const {
  return tree_->nearest(query, radius, triangle_group, group);
}

void SurfaceLocator::nearest(const Exec& exec, In<Vec3> query, Out<Hit> hit) const {
  constexpr Index kQueriesPerBlock = 64;
  exec.for_blocks(static_cast<Index>(query.size()), kQueriesPerBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) hit[i] = nearest(query[i]);
  });
}

}  // namespace planish
