#include "engine/features/curve.hpp"

#include <algorithm>
#include <optional>

#include "engine/features/feature_error.hpp"
#include "engine/features/trace.hpp"

namespace planish {
namespace {

class CurveInsertion {
 public:
  CurveInsertion(RefinedMesh& mesh, const Surface& input, const CurveOnSurface& curve)
      : mesh_(mesh), input_(input), curve_(curve) {}

  Result<EmbeddedCurve> operator()() {
    std::vector<Index> place;  // vertex of each point
    for (std::size_t k = 0; k < curve_.at.size(); ++k) {
      bool moved = false;
      const double share = mesh_.tolerance(curve_.at[k].triangle, kSnapShare);
      const double left = curve_.allowed - norm(projected(k) - curve_.given[k]);
      place.push_back(mesh_.insert(curve_.at[k], std::clamp(left, 0.0, share), moved));
      embedded_.snapped += moved ? 1 : 0;
    }
    chain_.push_back({place.front(), 0});
    reached_.push_back(0);
    const std::size_t n = place.size();
    for (std::size_t k = 1; k < n + (curve_.closed ? 1 : 0); ++k) {
      if (auto done = go_on(k - 1, k % n, place[k % n]); !done) return fail(done.error());
      if (k < n) reached_.push_back(chain_.size() - 1);
    }
    return close();
  }

 private:
  Failure failure(ErrorCode code, const std::string& what, std::size_t i, std::size_t j) const {
    OffendingIds points;
    points.add(static_cast<Index>(i));
    points.add(static_cast<Index>(j));
    return fail(points.of(feature_error(code, curve_.name, what), ElementKind::Point));
  }

  Vec3 projected(std::size_t k) const {
    const Index* v = &input_.corner_vertex[3 * curve_.at[k].triangle];
    const Vec3 b = curve_.at[k].barycentric;
    return b.x * input_.position[v[0]] + b.y * input_.position[v[1]] + b.z * input_.position[v[2]];
  }

  Vec3 normal(std::size_t k) const {
    const Index* v = &input_.corner_vertex[3 * curve_.at[k].triangle];
    const Vec3 n =
        cross(input_.position[v[1]] - input_.position[v[0]], input_.position[v[2]] - input_.position[v[0]]);
    const double length = norm(n);
    return length > 0 ? (1 / length) * n : n;
  }

  /// From the chain's end to the vertex of point j.
  Result<void> go_on(std::size_t i, std::size_t j, Index target) {
    if (chain_.back().vertex == target) return {};  // closer than the tolerance
    const Chord chord{curve_.given[i], curve_.given[j], curve_.allowed};
    for (const Vec3 n : {normal(i) + normal(j), normal(i), normal(j)}) {
      if (auto path = path_in_plane(mesh_, chain_.back().vertex, target, n, chord))
        return follow(*path, i, j, target);
    }
    if (auto path = path_in_strip(mesh_, chain_.back().vertex, target, chord))
      return follow(*path, i, j, target);
    return failure(ErrorCode::FeatureLeavesSurface,
                   "no path over the surface stays within " + in_words(curve_.allowed) +
                       " of the polyline between two of its points",
                   i, j);
  }

  Result<void> follow(const SurfacePath& path, std::size_t i, std::size_t j, Index target) {
    std::vector<Index> way = vertices_of(path, {curve_.given[i], curve_.given[j], curve_.allowed});
    way.push_back(target);
    for (const Index v : way) {
      std::vector<Index> steps;
      if (!mesh_.connect(chain_.back().vertex, v, kSnapShare, steps)) {
        return failure(ErrorCode::InternalDefect, "its path is not joined between two of its points", i, j);
      }
      for (const Index step : steps) {
        if (auto done = step_to(step, i, j); !done) return done;
      }
    }
    return {};
  }

  /// A place where a path crosses an edge of the input or passes a vertex.
  struct Place {
    Crossing crossing;
    double tolerance = 0;
    Index vertex = kNone;  ///< where it is at a vertex, or near enough
  };

  /// The path's vertices, new ones where it crosses edges of the input. Edges inside input triangles do not matter:
  /// they are flipped out of the way.
  std::vector<Index> vertices_of(const SurfacePath& path, const Chord& chord) {
    std::vector<Place> places;
    for (const Crossing& crossing : path) {
      if (auto place = place_of(crossing, chord)) places.push_back(*place);
    }
    drop_beside_vertices(places);
    std::vector<Index> way;
    for (const Place& place : places) {
      const Index v = place.vertex == kNone ? split(place) : place.vertex;
      if (v != kNone) way.push_back(v);
    }
    return way;
  }

  std::optional<Place> place_of(const Crossing& crossing, const Chord& chord) const {
    if (crossing.head == kNone) return Place{crossing, 0, crossing.tail};
    const Index corner = mesh_.edge_between(crossing.tail, crossing.head);
    if (corner == kNone || !mesh_.on_input_edge(corner)) return std::nullopt;
    const Vec3 tail = mesh_.position(crossing.tail);
    const Vec3 at = tail + crossing.s * (mesh_.position(crossing.head) - tail);
    const double left = curve_.allowed - distance_to(chord, at);
    const double tolerance = std::clamp(left, 0.0, mesh_.edge_tolerance(corner, kSnapShare));
    return Place{crossing, tolerance, mesh_.near_end(corner, along(corner, crossing), tolerance)};
  }

  double along(Index corner, const Crossing& crossing) const {
    return mesh_.vertex(corner) == crossing.tail ? crossing.s : 1 - crossing.s;
  }

  /// kNone where the path crossed this very edge before: the straight way on crosses it again.
  Index split(const Place& place) {
    const Index corner = mesh_.edge_between(place.crossing.tail, place.crossing.head);
    if (corner == kNone) return kNone;
    return mesh_.split_edge(corner, along(corner, place.crossing), place.tolerance);
  }

  /// A path that goes through a vertex need not cross the edges at it just before and after.
  static void drop_beside_vertices(std::vector<Place>& places) {
    const auto touches = [](const Place& place, Index v) {
      return place.crossing.tail == v || place.crossing.head == v;
    };
    std::vector<std::uint8_t> dropped(places.size(), 0);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Index v = places[k].vertex;
      if (v == kNone || dropped[k]) continue;
      for (std::size_t j = k; j-- > 0 && touches(places[j], v);) dropped[j] = 1;
      for (std::size_t j = k + 1; j < places.size() && touches(places[j], v); ++j) dropped[j] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!dropped[k]) places[kept++] = places[k];
    }
    places.resize(kept);
  }

  Result<void> step_to(Index v, std::size_t i, std::size_t j) {
    if (v == chain_.back().vertex) return {};
    if (chain_.size() > 1 && v == chain_[chain_.size() - 2].vertex) return step_back(i, j);
    retraced_ = 0;
    // Distance from a segment is convex along an edge: the largest is at a vertex.
    const Chord chord{curve_.given[i], curve_.given[j], curve_.allowed};
    chain_.push_back({v, distance_to(chord, mesh_.position(v))});
    return {};
  }

  /// Snapping may bend a path back on itself by about as much as it moves points: such a step is taken back. More is
  /// the polyline's own doing.
  Result<void> step_back(std::size_t i, std::size_t j) {
    constexpr double kMostSnaps = 4;
    const double snap = std::max(mesh_.tolerance(curve_.at[i].triangle, kSnapShare),
                                 mesh_.tolerance(curve_.at[j].triangle, kSnapShare));
    const Vec3 end = mesh_.position(chain_.back().vertex);
    retraced_ += norm(mesh_.position(chain_[chain_.size() - 2].vertex) - end);
    if (retraced_ > kMostSnaps * snap) {
      return failure(ErrorCode::FeatureBroken, "it turns back on itself between two of its points", i, j);
    }
    chain_.pop_back();
    for (std::size_t k = reached_.size(); k-- > 0 && reached_[k] >= chain_.size();) --reached_[k];
    return {};
  }

  Result<EmbeddedCurve> close() {
    if (curve_.closed && chain_.size() > 1) chain_.pop_back();  // the first vertex again
    if (chain_.size() < (curve_.closed ? 3U : 2U)) {
      return fail(feature_error(ErrorCode::FeatureBroken, curve_.name,
                                "its points are so close that they are one place of the mesh"));
    }
    for (const Step& step : chain_) {
      embedded_.vertex.push_back(step.vertex);
      embedded_.deviation = std::max(embedded_.deviation, step.distance);
    }
    for (std::size_t k = 0; k < reached_.size(); ++k) {
      const Index v = chain_[std::min(reached_[k], chain_.size() - 1)].vertex;
      embedded_.deviation = std::max(embedded_.deviation, norm(mesh_.position(v) - curve_.given[k]));
    }
    constexpr double kRounding = 1e-9;
    if (embedded_.deviation > curve_.allowed * (1 + kRounding)) {
      return fail(feature_error(ErrorCode::FeatureLeavesSurface, curve_.name,
                                "its chain would be " + in_words(embedded_.deviation) +
                                    " from the polyline, " + in_words(curve_.allowed) +
                                    " allowed: the triangles there are too thin"));
    }
    return std::move(embedded_);
  }

  /// A vertex of the chain and its distance from the drawn segment.
  struct Step {
    Index vertex;
    double distance;
  };

  RefinedMesh& mesh_;
  const Surface& input_;
  const CurveOnSurface& curve_;
  std::vector<Step> chain_;
  std::vector<std::size_t> reached_;  // where the chain was when it came to each point
  double retraced_ = 0;               // length taken back since the last step ahead
  EmbeddedCurve embedded_;
};

}  // namespace

Result<EmbeddedCurve> embed_curve(RefinedMesh& mesh, const Surface& input, const CurveOnSurface& curve) {
  return CurveInsertion(mesh, input, curve)();
}

}  // namespace planish
