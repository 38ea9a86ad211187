#include "engine/features/sheet_pass.hpp"

#include <algorithm>
#include <array>

namespace planish {
namespace {

using Hit = SurfaceLocator::Hit;

/// Of a segment's length, by which its capsule exceeds the distances of its ends: leaves room for the sag of
/// an arc of 50 degrees; flatter ones need no wider capsule.
constexpr double kCapsuleWidening = 0.125;
/// A polyline is tried from so many of its runs at most.
constexpr int kMaxPasses = 8;

/// The narrowest capsule that a segment with these projections is looked at in.
Capsule capsule_of(const PolylineSource& source, Index i, Index j, const Hit& a, const Hit& b) {
  const Segment axis{source.point[i], source.point[j]};
  return {axis, a.distance + b.distance + kCapsuleWidening * norm(axis.end - axis.begin)};
}

/// One way to choose the hits of a polyline.
struct Assignment {
  std::vector<Hit> hit;
  Index strays = 0;    ///< hits on another component than the start
  Index breaks = 0;    ///< steps without a path on the surface
  double squares = 0;  ///< sum of squared distances
  /// A break costs as much as a point that is half a segment off: an unseen way round a fold is likelier than many
  /// points that all lie elsewhere.
  bool better_than(const Assignment& other, double segment) const {
    const double break_cost = segment * segment / 4;
    if (strays != other.strays) return strays < other.strays;
    return squares + breaks * break_cost < other.squares + other.breaks * break_cost;
  }
};

/// Carries a sheet along a polyline from one of its points.
class SheetPass {
 public:
  SheetPass(const Surface& surface, const Topology& topology, const SurfaceLocator& locator,
            const PolylineHits& polyline)
      : topology_(topology), locator_(locator), polyline_(polyline), search_(surface, topology) {}

  Assignment run(Index start) {
    const Index n = polyline_.size();
    component_ = topology_.triangle_component[polyline_.nearest[start].at.triangle];
    assigned_ = {.hit = {polyline_.nearest.begin(), polyline_.nearest.end()}};
    const Index ahead = polyline_.source->closed ? n - 1 : n - 1 - start;
    for (Index k = 0, i = start; k < ahead; ++k, i = polyline_.successor(i)) step(i, polyline_.successor(i));
    if (polyline_.source->closed) {
      close((start + n - 1) % n, start);
    } else {
      for (Index i = start; i > 0; --i) step(i, i - 1);
    }
    rate();
    return std::move(assigned_);
  }

  /// All hits as they are nearest.
  Assignment nearest(Index start) {
    component_ = topology_.triangle_component[polyline_.nearest[start].at.triangle];
    assigned_ = {.hit = {polyline_.nearest.begin(), polyline_.nearest.end()}};
    for (Index i = 0; i < polyline_.num_segments(); ++i) {
      if (!polyline_.link[i]) count_break(i, polyline_.successor(i));
    }
    rate();
    return std::move(assigned_);
  }

 private:
  void rate() {
    for (const Hit& hit : assigned_.hit) {
      assigned_.squares += hit.distance * hit.distance;
      if (topology_.triangle_component[hit.at.triangle] != component_) ++assigned_.strays;
    }
  }

  bool kept(Index i) const { return assigned_.hit[i].at.triangle == polyline_.nearest[i].at.triangle; }
  bool linked(Index i, Index j) const {
    const Index first = polyline_.source->closed ? i : std::min(i, j);
    return polyline_.link[first] != 0 && kept(i) && kept(j);
  }

  /// The widest capsule for a step: as wide as the segment is long, or as a point may be far.
  double widest(const Capsule& capsule, const Hit& a, const Hit& b) const {
    const double length = norm(capsule.axis.end - capsule.axis.begin);
    return a.distance + b.distance + std::max(length, polyline_.max_distance);
  }

  /// Chooses the hit of j, given that of its neighbour i. A wider capsule is tried only when a narrower one
  /// holds neither a path to the nearest hit nor another foot of j on this sheet.
  void step(Index i, Index j) {
    if (linked(i, j)) return;
    const Hit& from = assigned_.hit[i];
    const Hit nearest = polyline_.nearest[j];
    Capsule capsule = capsule_of(*polyline_.source, i, j, from, nearest);
    const double widest_radius = widest(capsule, from, nearest);
    while (true) {
      if (search_.joined(from, nearest, capsule)) return;
      const Hit foot = search_.closest_reached(polyline_.source->point[j]);
      if (foot.distance <= std::min(capsule.radius, polyline_.max_distance)) {
        assigned_.hit[j] = foot;
        return;
      }
      if (capsule.radius >= widest_radius) break;
      capsule.radius = std::min(2 * capsule.radius, widest_radius);
    }
    ++assigned_.breaks;
    keep_component(j);
  }

  void keep_component(Index j) {
    if (topology_.triangle_component[polyline_.nearest[j].at.triangle] == component_) return;
    const Hit hit = locator_.nearest_in(topology_.triangle_component, component_, polyline_.source->point[j],
                                        polyline_.max_distance);
    if (hit.at.triangle != kNone) assigned_.hit[j] = hit;
  }

  /// Counts a break where the last step of a closed polyline finds no way.
  void close(Index i, Index j) {
    if (!linked(i, j)) count_break(i, j);
  }

  void count_break(Index i, Index j) {
    const Hit &a = assigned_.hit[i], &b = assigned_.hit[j];
    Capsule capsule = capsule_of(*polyline_.source, i, j, a, b);
    capsule.radius = std::max(capsule.radius, widest(capsule, a, b));
    if (!search_.joined(a, b, capsule)) ++assigned_.breaks;
  }

  const Topology& topology_;
  const SurfaceLocator& locator_;
  const PolylineHits& polyline_;
  SheetSearch search_;
  Index component_ = 0;
  Assignment assigned_;
};

/// First points of the runs of linked hits, the longest runs first (ties: the earlier).
std::vector<Index> run_starts(const PolylineHits& polyline) {
  std::vector<std::array<Index, 2>> run;  // minus the length, then the first point
  for (Index i = 0; i < polyline.size(); ++i) {
    if (i == 0 || !polyline.link[i - 1]) run.push_back({0, i});
    --run.back()[0];
  }
  std::ranges::sort(run);
  std::vector<Index> start;
  for (const auto& r : run) start.push_back(r[1]);
  return start;
}

}  // namespace

double length_of(const PolylineSource& source) {
  double length = 0;
  for (std::size_t i = 1; i < source.point.size(); ++i) length += norm(source.point[i] - source.point[i - 1]);
  return source.closed ? length + norm(source.point.front() - source.point.back()) : length;
}

bool nearest_are_joined(SheetSearch& search, const PolylineHits& polyline, Index i) {
  const Index j = polyline.successor(i);
  const Hit &a = polyline.nearest[i], &b = polyline.nearest[j];
  return search.joined(a, b, capsule_of(*polyline.source, i, j, a, b));
}

std::vector<Hit> hits_on_one_sheet(const Surface& surface, const Topology& topology,
                                   const SurfaceLocator& locator, const PolylineHits& polyline) {
  SheetPass pass(surface, topology, locator, polyline);
  const std::vector<Index> starts = run_starts(polyline);
  const double segment = length_of(*polyline.source) / polyline.num_segments();
  std::vector<Assignment> tried = {pass.nearest(starts.front())};
  std::size_t best = 0;
  for (const Index start : starts) {
    const auto seen = [&](const Assignment& a) {
      return a.strays == 0 && a.breaks == 0 &&
             a.hit[start].at.triangle == polyline.nearest[start].at.triangle;
    };
    if (std::ranges::any_of(tried, seen)) continue;  // a run that was left as it is would repeat that pass
    tried.push_back(pass.run(start));
    if (tried.back().better_than(tried[best], segment)) best = tried.size() - 1;
    if (static_cast<int>(tried.size()) > kMaxPasses) break;
  }
  return std::move(tried[best].hit);
}

}  // namespace planish
