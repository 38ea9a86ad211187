#include "engine/constraints/region_shape.hpp"

#include <algorithm>

#include "engine/constraints/chain_shape.hpp"
#include "engine/exec/parallel.hpp"
#include "engine/features/feature_error.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

constexpr double kDevelopable = 1e-10;  // radians
constexpr double kLargestHolonomy = 1e-3;

/// The region as a mesh of its own; its vertices ascend in the numbers of the input.
struct Cutout {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Index> vertex;  ///< of the ordered mesh
  Surface surface() const { return {position, corner_vertex}; }
};

Cutout cut_out(const RestSurface& rest, In<Index> triangle) {
  Cutout region;
  const OrderedMesh& mesh = *rest.mesh;
  for (const Index t : triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) region.vertex.push_back(mesh.corner_vertex[c]);
  }
  const auto by_origin = [&](Index a, Index b) { return mesh.vertex_origin[a] < mesh.vertex_origin[b]; };
  std::sort(region.vertex.begin(), region.vertex.end(), by_origin);
  region.vertex.erase(std::unique(region.vertex.begin(), region.vertex.end()), region.vertex.end());
  for (const Index v : region.vertex) region.position.push_back(mesh.position[v]);
  for (const Index t : triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const auto place =
          std::lower_bound(region.vertex.begin(), region.vertex.end(), mesh.corner_vertex[c], by_origin);
      region.corner_vertex.push_back(static_cast<Index>(place - region.vertex.begin()));
    }
  }
  return region;
}

std::vector<double> angle_sums(const Cutout& region, In<RestFrame> frame) {
  std::vector<double> sum(region.vertex.size(), 0);
  for (std::size_t t = 0; t < frame.size(); ++t) {
    const auto angle = corner_angles(frame[t]);
    for (std::size_t i = 0; i < 3; ++i) sum[region.corner_vertex[3 * t + i]] += angle[i];
  }
  return sum;
}

/// Largest angle defect at interior vertices.
double largest_defect(const Topology& topology, In<double> angle_sum) {
  double largest = 0;
  for (Index v = 0; v < static_cast<Index>(angle_sum.size()); ++v) {
    if (!topology.is_boundary(v)) largest = std::max(largest, std::abs(2 * kPi - angle_sum[v]));
  }
  return largest;
}

/// Of a loop: 2 pi + sum (pi - angle), which is 0 where the loop of a hole closes in the plane.
double holonomy(const Cutout& region, const Topology& topology, Index loop, In<double> angle_sum) {
  double sum = 2 * kPi;
  for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(loop)))
    sum += kPi - angle_sum[region.corner_vertex[c]];
  return sum;
}

/// Triangle by triangle, across edges, breadth first.
std::vector<Vec2> unroll(const Cutout& region, const Topology& topology, In<RestFrame> frame) {
  std::vector<Vec2> point(region.vertex.size());
  std::vector<std::uint8_t> placed(region.vertex.size(), 0), reached(frame.size(), 0);
  std::vector<double> theta(frame.size(), 0);
  std::vector<Index> queue = {0};
  reached[0] = 1;
  const auto place_others = [&](Index t, Index from) {
    // Corners relative to one that is placed.
    const auto edge = edge_vectors(frame[t]);
    const Vec2 corner[3] = {Vec2{}, edge[0], edge[0] + edge[1]};
    const Vec2 turn = unit(theta[t]);
    for (Index i = 0; i < 3; ++i) {
      const Index v = region.corner_vertex[3 * t + i];
      if (placed[v]) continue;
      placed[v] = 1;
      point[v] = point[region.corner_vertex[3 * t + from]] + multiply(turn, corner[i] - corner[from]);
    }
  };
  placed[region.corner_vertex[0]] = 1;
  place_others(0, 0);
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const Index t = queue[head];
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index twin = topology.corner_twin[c];
      if (twin == kNone || reached[twin / 3]) continue;
      reached[twin / 3] = 1;
      theta[twin / 3] = reduce_angle(unfold_angle(theta[t], c, twin, frame));
      place_others(twin / 3, twin % 3);
      queue.push_back(twin / 3);
    }
  }
  return point;
}

/// Largest relative change of an edge's length.
double worst_stretch(const Cutout& region, In<RestFrame> frame, In<Vec2> point) {
  double worst = 0;
  for (Index c = 0; c < static_cast<Index>(region.corner_vertex.size()); ++c) {
    const double length = norm(edge_vectors(frame[c / 3])[c % 3]);
    const Vec2 image = point[region.corner_vertex[next_corner(c)]] - point[region.corner_vertex[c]];
    worst = std::max(worst, std::abs(norm(image) / length - 1));
  }
  return worst;
}

}  // namespace

Result<void> make_region(const RestSurface& rest, const ConstraintSet& set, const RegionMap& map,
                         Body& body) {
  const Cutout region = cut_out(rest, body.triangle);
  const Topology topology = build_topology(Exec(1), region.surface());
  const auto refuse = [&](const std::string& what) {
    return fail(constraint_error(ErrorCode::ConstraintsConflict, set, body.constraint, what));
  };
  if (!topology.manifold)
    return refuse(
        "its region touches itself in a vertex, and has no shape of its own; leave that vertex out");
  std::vector<RestFrame> frame;
  for (const Index t : body.triangle) frame.push_back(rest.frame[t]);
  const std::vector<double> angle_sum = angle_sums(region, frame);
  if (topology.num_components > 1)
    return refuse("a cut parts its region in " + std::to_string(topology.num_components) +
                  "; make a feature of each part");
  // The rim is the loop that turns once to the left; all others are holes, and turn once to the right.
  Index rim = 0;
  const auto off_rim = [&](Index loop) {
    return std::abs(holonomy(region, topology, loop, angle_sum) - 4 * kPi);
  };
  for (Index loop = 1; loop < topology.num_loops(); ++loop) {
    if (off_rim(loop) < off_rim(rim)) rim = loop;
  }
  for (Index loop = 0; loop < topology.num_loops(); ++loop) {
    const double gap = holonomy(region, topology, loop, angle_sum);
    if (loop == rim || std::abs(gap) <= kLargestHolonomy) continue;
    return refuse("its region does not close in the plane around one of its holes (it turns by " +
                  in_words(gap * 180 / kPi) +
                  " degrees too much, as a tube does by 360); add a seam that opens it");
  }
  body.vertex = region.vertex;
  if (largest_defect(topology, angle_sum) <= kDevelopable) {
    body.shape = unroll(region, topology, frame);
  } else {
    auto mapped = map(region.surface());
    if (!mapped) {
      Error error = mapped.error();
      error.what = "constraint \"" + set.constraints[body.constraint].name +
                   "\": its region has no shape of its own in the plane: " + error.what;
      error.place.pointer = "/constraints/" + std::to_string(body.constraint);
      error.ids.clear();
      error.element = ElementKind::None;
      return fail(error);
    }
    body.shape = std::move(*mapped);
  }
  body.planarity = worst_stretch(region, frame, body.shape);
  centre(body.shape);
  return {};
}

}  // namespace planish
