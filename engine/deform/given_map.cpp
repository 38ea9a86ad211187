#include "engine/deform/given_map.hpp"

#include <algorithm>
#include <cmath>

#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

Result<void> check_finite(In<Index> vertex_origin, In<Vec2> uv) {
  OffendingIds bad;
  for (const Index v : vertex_origin) {
    if (!std::isfinite(uv[v].x) || !std::isfinite(uv[v].y)) bad.add(v);
  }
  if (bad.empty()) return {};
  Error error{.code = ErrorCode::NonFinitePosition,
              .what = std::to_string(bad.count()) + " vertices have a uv that is not a finite number"};
  return fail(bad.of(std::move(error), ElementKind::Vertex));
}

std::vector<double> signed_areas(const Workpiece& piece, In<Vec2> uv) {
  const In<Index> corner = piece.mesh().corner_vertex;
  std::vector<double> area(piece.topology().num_components, 0);
  for (Index t = 0; t < piece.mesh().num_triangles(); ++t) {
    const Vec2 a = uv[corner[3 * t]], b = uv[corner[3 * t + 1]], c = uv[corner[3 * t + 2]];
    area[piece.topology().triangle_component[t]] += 0.5 * cross(b - a, c - a);
  }
  return area;
}

/// Means of points, a component each.
std::vector<Vec2> component_means(In<Index> vertex_component, Index num_components, In<Vec2> uv) {
  std::vector<Vec2> sum(num_components);
  std::vector<double> count(num_components, 0);
  for (std::size_t v = 0; v < uv.size(); ++v) {
    sum[vertex_component[v]] += uv[v];
    count[vertex_component[v]] += 1;
  }
  for (Index k = 0; k < num_components; ++k) sum[k] = (1 / count[k]) * sum[k];
  return sum;
}

void mirror_components(In<std::uint8_t> mirrored, In<Index> vertex_component, Out<Vec2> uv) {
  const std::vector<Vec2> middle = component_means(vertex_component, static_cast<Index>(mirrored.size()), uv);
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Index k = vertex_component[v];
    if (mirrored[k]) uv[v].x = 2 * middle[k].x - uv[v].x;
  }
}

}  // namespace

Result<GivenMap> take_map(const Workpiece& piece, In<Vec2> uv) {
  constexpr double kOwnUnits = 4;  // ratio of areas
  const OrderedMesh& mesh = piece.mesh();
  if (uv.size() != static_cast<std::size_t>(mesh.num_input_vertices))
    return fail(ErrorCode::BadUsage, "a map has one uv a vertex: " + std::to_string(uv.size()) + " for " +
                                         std::to_string(mesh.num_input_vertices));
  if (auto finite = check_finite(mesh.vertex_origin, uv); !finite) return fail(finite.error());
  GivenMap map;
  for (const Index v : mesh.vertex_origin) map.uv.push_back((1 / mesh.unit) * uv[v]);
  const std::vector<double> areas = signed_areas(piece, map.uv);
  double whole = 0;
  std::vector<std::uint8_t> mirrored;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    if (!(std::abs(areas[k]) > 0) || !std::isfinite(areas[k]))
      return fail(ErrorCode::NoParameterization,
                  "the map of component " + std::to_string(k) + " has no area");
    whole += std::abs(areas[k]);
    mirrored.push_back(areas[k] < 0);
    map.num_mirrored += mirrored.back();
  }
  if (map.num_mirrored > 0) mirror_components(mirrored, piece.component, map.uv);
  const double ratio = piece.geometry.area / whole;
  if (ratio > kOwnUnits || ratio < 1 / kOwnUnits) map.scale = std::sqrt(ratio);
  for (Vec2& z : map.uv) z = map.scale * z;
  return map;
}

Result<Geometry> geometry_of_map(const Exec& exec, const Workpiece& piece, In<Vec2> uv) {
  constexpr double kNeedle = 1e-12;  // height over length
  std::vector<Vec3> position;
  for (const Vec2 z : uv) position.push_back({z.x, z.y, 0});
  Geometry geometry = measure_geometry(exec, {position, piece.mesh().corner_vertex}, piece.topology());
  OffendingIds flat;
  for (Index t = 0; t < piece.mesh().num_triangles(); ++t) {
    const RestFrame& f = geometry.frame[t];
    if (!(f.x1 > 0) || !(f.y2 > kNeedle * f.x1)) flat.add(piece.mesh().triangle_origin[t]);
  }
  if (flat.empty()) return geometry;
  Error error{
      .code = ErrorCode::DegenerateTriangle,
      .what = std::to_string(flat.count()) +
              " triangles have no area in the map, which so cannot be the reference; take the surface"};
  return fail(flat.of(std::move(error), ElementKind::Triangle));
}

std::vector<Placement> onto_pins(In<Pin> pins, In<Index> vertex_component, Index num_components,
                                 In<Vec2> uv) {
  constexpr double kLeft = 0.1;
  std::vector<std::vector<Vec2>> from(num_components), to(num_components);
  for (const Pin& pin : pins) {
    from[vertex_component[pin.vertex]].push_back(uv[pin.vertex]);
    to[vertex_component[pin.vertex]].push_back(pin.uv);
  }
  std::vector<Placement> motion(num_components);
  for (Index k = 0; k < num_components; ++k) {
    if (from[k].empty()) continue;
    const Placement best = best_placement(from[k], to[k], 1);
    double before = 0, after = 0;
    for (std::size_t i = 0; i < from[k].size(); ++i) {
      const Vec2 far = to[k][i] - from[k][i], left = best.p + multiply(best.c, from[k][i]) - to[k][i];
      before += dot(far, far);
      after += dot(left, left);
    }
    if (after <= kLeft * before) motion[k] = best;
  }
  return motion;
}

std::vector<Placement> turns(In<double> by, In<Pin> pins, In<Index> vertex_component, In<Vec2> uv) {
  std::vector<Vec2> middle = component_means(vertex_component, static_cast<Index>(by.size()), uv);
  for (const Pin& pin : pins) middle[vertex_component[pin.vertex]] = pin.uv;
  std::vector<Placement> motion(by.size());
  for (std::size_t k = 0; k < by.size(); ++k) {
    if (by[k] != 0) motion[k] = {middle[k] - multiply(unit(by[k]), middle[k]), unit(by[k])};
  }
  return motion;
}

void move_components(In<Placement> motion, In<Index> vertex_component, Out<Vec2> uv) {
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Placement& m = motion[vertex_component[v]];
    if (m.c != Vec2{1, 0} || m.p != Vec2{}) uv[v] = m.p + multiply(m.c, uv[v]);
  }
}

std::vector<Placement> onto_map(In<Freedom> freedom, In<Index> vertex_component, In<Vec2> from, In<Vec2> to) {
  const auto num_components = static_cast<Index>(freedom.size());
  const std::vector<Vec2> from_mean = component_means(vertex_component, num_components, from),
                          to_mean = component_means(vertex_component, num_components, to);
  std::vector<Vec2> product(num_components);
  for (std::size_t v = 0; v < from.size(); ++v) {
    const Index k = vertex_component[v];
    product[k] += multiply(conjugate(from[v] - from_mean[k]), to[v] - to_mean[k]);
  }
  std::vector<Placement> motion(num_components);
  for (Index k = 0; k < num_components; ++k) {
    if (freedom[k] == Freedom::None) continue;
    const double length = norm(product[k]);
    if (freedom[k] == Freedom::Isometry && length > 0) motion[k].c = (1 / length) * product[k];
    motion[k].p = to_mean[k] - multiply(motion[k].c, from_mean[k]);
  }
  return motion;
}

}  // namespace planish
