#include "engine/prepare/prepare.hpp"

#include <algorithm>
#include <bit>

#include "engine/prepare/defects.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {
namespace {

Result<void> check_indices(const Surface& surface) {
  constexpr std::size_t kMostHalfEdges = std::size_t{1} << 31;
  if (surface.corner_vertex.size() >= kMostHalfEdges) {
    return fail(ErrorCode::TooLarge, "the mesh has 2^31 or more half-edges");
  }
  if (surface.corner_vertex.size() % 3 != 0) {
    return fail(ErrorCode::BadUsage, "corner_vertex must hold three vertices a triangle, it holds " +
                                         std::to_string(surface.corner_vertex.size()));
  }
  Error error{.code = ErrorCode::IndexOutOfRange, .element = ElementKind::Triangle};
  for (std::size_t c = 0; c < surface.corner_vertex.size(); ++c) {
    const Index v = surface.corner_vertex[c];
    if (v >= 0 && v < surface.num_vertices()) continue;
    if (error.count++ == 0) {
      error.what = "a triangle names vertex " + std::to_string(v) + ", the mesh has " +
                   std::to_string(surface.num_vertices());
    }
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(static_cast<Index>(c / 3));
  }
  if (error.count > 0) return fail(std::move(error));
  return {};
}

std::uint64_t position_hash(Vec3 p) {
  std::uint64_t hash = 0;
  for (const double x : {p.x, p.y, p.z}) {
    hash ^= std::bit_cast<std::uint64_t>(x + 0.0);  // -0 becomes +0
    hash *= 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 29;
  }
  return hash;
}

Index count_duplicate_positions(const Exec& exec, In<Vec3> position) {
  constexpr int kHashBits = 4 * kRadixBits;
  std::vector<KeyedIndex> items;
  items.reserve(position.size());
  for (std::size_t v = 0; v < position.size(); ++v) {
    const Vec3 p = position[v];
    if (!std::isfinite(p.x + p.y + p.z)) continue;  // equal to nothing, not even to itself
    items.push_back({position_hash(p) & ((std::uint64_t{1} << kHashBits) - 1), static_cast<Index>(v)});
  }
  sort_by_key(exec, items, kHashBits);
  Index duplicates = 0;
  for (std::size_t i = 1; i < items.size(); ++i) {
    for (std::size_t k = i; k-- > 0 && items[k].key == items[i].key;) {
      if (position[items[k].index] == position[items[i].index]) {
        ++duplicates;
        break;
      }
    }
  }
  return duplicates;
}

void measure(const Exec& exec, const OrderedMesh& mesh, Diagnosis& diagnosis) {
  struct Extremes {
    double least = kInfinity, largest = 0;
  };
  std::vector<Extremes> part(Exec::num_blocks(mesh.num_triangles(), kBlock));
  std::vector<double> area_part(part.size());
  exec.for_blocks(mesh.num_triangles(), kBlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const Index* v = &mesh.corner_vertex[3 * static_cast<std::size_t>(t)];
      const RestFrame frame = rest_frame(mesh.position[v[0]], mesh.position[v[1]], mesh.position[v[2]]);
      const double a = area(frame);
      if (!(a > 0)) continue;
      area_part[block] += a;
      for (const double angle : corner_angles(frame)) {
        part[block].least = std::min(part[block].least, angle);
        part[block].largest = std::max(part[block].largest, angle);
      }
    }
  });
  Extremes all;
  for (const Extremes& e : part) all = {std::min(all.least, e.least), std::max(all.largest, e.largest)};
  diagnosis.area = pairwise_sum(area_part) * mesh.unit * mesh.unit;
  diagnosis.min_angle = std::isfinite(all.least) ? all.least : 0;
  diagnosis.max_angle = all.largest;
}

void bound(const OrderedMesh& mesh, Diagnosis& diagnosis) {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (const Vec3 p : mesh.position) {
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  if (lower.x > upper.x) lower = upper = {};
  diagnosis.lower = mesh.centre + mesh.unit * lower;
  diagnosis.upper = mesh.centre + mesh.unit * upper;
}

double largest_coordinate(const Exec& exec, const Surface& surface) {
  const auto num_corners = static_cast<Index>(surface.corner_vertex.size());
  std::vector<double> part(Exec::num_blocks(num_corners, kBlock), 0);
  exec.for_blocks(num_corners, kBlock, [&](Index block, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      const Vec3 p = surface.position[surface.corner_vertex[c]];
      part[block] = std::max({part[block], std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  });
  return part.empty() ? 0 : *std::max_element(part.begin(), part.end());
}

/// All triangles have an area that is beyond the doubt of find_defects(), and coordinates can be scaled.
bool is_well_shaped(const Exec& exec, const Surface& surface) {
  constexpr double kLargest = 1e75, kLeast = 1e-75;  // fourth powers are finite
  const double largest = largest_coordinate(exec, surface);
  if (!(largest > kLeast && largest < kLargest)) return false;
  const double least_altitude = 16 * std::numeric_limits<double>::epsilon() * largest;
  const auto is_flat = [&](Index t) {
    const Index* v = &surface.corner_vertex[3 * static_cast<std::size_t>(t)];
    const Vec3 a = surface.position[v[0]], ab = surface.position[v[1]] - a, ac = surface.position[v[2]] - a;
    const double longest = std::max({norm(ab), norm(ac), norm(ac - ab)});
    return !(norm(cross(ab, ac)) > least_altitude * longest);
  };
  return select(exec, surface.num_triangles(), is_flat).empty();
}

}  // namespace

Result<PreparedMesh> prepare(const Exec& exec, const Surface& surface) {
  if (auto checked = check_indices(surface); !checked) return fail(checked.error());
  PreparedMesh prepared;
  prepared.mesh = order_mesh(exec, surface);
  prepared.topology = build_topology(exec, prepared.mesh.surface());
  const OrderedMesh& mesh = prepared.mesh;
  const Topology& topology = prepared.topology;

  Diagnosis& diagnosis = prepared.diagnosis;
  diagnosis.vertices = surface.num_vertices();
  diagnosis.triangles = surface.num_triangles();
  diagnosis.unreferenced_vertices = surface.num_vertices() - mesh.num_vertices();
  diagnosis.components = topology.num_components;
  diagnosis.boundary_loops = topology.num_loops();
  for (const double length : topology.loop_length) diagnosis.loop_lengths.push_back(length * mesh.unit);
  if (topology.num_components > 1)
    diagnosis.duplicate_positions = count_duplicate_positions(exec, mesh.position);
  bound(mesh, diagnosis);
  measure(exec, mesh, diagnosis);
  find_defects(exec, mesh, topology, diagnosis);
  return prepared;
}

Result<Topology> manifold_topology(const Exec& exec, const Surface& surface) {
  if (auto checked = check_indices(surface); !checked) return fail(checked.error());
  Topology topology = build_topology(exec, surface);
  if (topology.manifold && is_well_shaped(exec, surface)) return topology;
  if (auto checked = check_manifold(exec, surface); !checked) return fail(checked.error());
  return topology;
}

Result<Diagnosis> diagnose(const Exec& exec, const Surface& surface) {
  auto prepared = prepare(exec, surface);
  if (!prepared) return fail(prepared.error());
  prepared->diagnosis.duplicate_positions = count_duplicate_positions(exec, prepared->mesh.position);
  return std::move(prepared->diagnosis);
}

}  // namespace planish
