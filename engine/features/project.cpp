#include "engine/features/project.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "engine/features/feature_error.hpp"
#include "engine/features/sheet_search.hpp"

namespace planish {
namespace {

using Hit = SurfaceLocator::Hit;

/// Of a segment's length, by which its capsule exceeds the distances of its ends: leaves room for the sag of
/// an arc of 50 degrees; flatter ones need no wider capsule.
constexpr double kCapsuleWidening = 0.125;
/// A polyline is tried from so many of its runs at most.
constexpr int kMaxPasses = 8;

bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// A polyline with the closest point of each of its points.
struct Task {
  Index spec = 0;
  const PolylineSource* source = nullptr;
  double max_distance = 0;
  Out<Hit> nearest = {};        ///< [points]
  Out<std::uint8_t> link = {};  ///< [points] the hits of i and its successor are joined
  Index size() const { return static_cast<Index>(source->point.size()); }
  Index successor(Index i) const { return i + 1 < size() ? i + 1 : 0; }
  /// Segments; the last of a closed one returns to point 0.
  Index num_segments() const { return source->closed ? size() : size() - 1; }
};

double length_of(const PolylineSource& source) {
  double length = 0;
  for (std::size_t i = 1; i < source.point.size(); ++i) length += norm(source.point[i] - source.point[i - 1]);
  return source.closed ? length + norm(source.point.front() - source.point.back()) : length;
}

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
  SheetPass(const Surface& surface, const Topology& topology, const SurfaceLocator& locator, const Task& task)
      : topology_(topology), locator_(locator), task_(task), search_(surface, topology) {}

  Assignment run(Index start) {
    const Index n = task_.size();
    component_ = topology_.triangle_component[task_.nearest[start].at.triangle];
    assigned_ = {.hit = {task_.nearest.begin(), task_.nearest.end()}};
    const Index ahead = task_.source->closed ? n - 1 : n - 1 - start;
    for (Index k = 0, i = start; k < ahead; ++k, i = task_.successor(i)) step(i, task_.successor(i));
    if (task_.source->closed) {
      close((start + n - 1) % n, start);
    } else {
      for (Index i = start; i > 0; --i) step(i, i - 1);
    }
    rate();
    return std::move(assigned_);
  }

  /// All hits as they are nearest.
  Assignment nearest(Index start) {
    component_ = topology_.triangle_component[task_.nearest[start].at.triangle];
    assigned_ = {.hit = {task_.nearest.begin(), task_.nearest.end()}};
    for (Index i = 0; i < task_.num_segments(); ++i) {
      if (!task_.link[i]) count_break(i, task_.successor(i));
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

  bool kept(Index i) const { return assigned_.hit[i].at.triangle == task_.nearest[i].at.triangle; }
  bool linked(Index i, Index j) const {
    const Index first = task_.source->closed ? i : std::min(i, j);
    return task_.link[first] != 0 && kept(i) && kept(j);
  }

  /// The widest capsule for a step: as wide as the segment is long, or as a point may be far.
  double widest(const Capsule& capsule, const Hit& a, const Hit& b) const {
    const double length = norm(capsule.axis.end - capsule.axis.begin);
    return a.distance + b.distance + std::max(length, task_.max_distance);
  }

  /// Chooses the hit of j, given that of its neighbour i. A wider capsule is tried only when a narrower one
  /// holds neither a path to the nearest hit nor another foot of j on this sheet.
  void step(Index i, Index j) {
    if (linked(i, j)) return;
    const Hit& from = assigned_.hit[i];
    const Hit nearest = task_.nearest[j];
    Capsule capsule = capsule_of(*task_.source, i, j, from, nearest);
    const double widest_radius = widest(capsule, from, nearest);
    while (true) {
      if (search_.joined(from, nearest, capsule)) return;
      const Hit foot = search_.closest_reached(task_.source->point[j]);
      if (foot.distance <= std::min(capsule.radius, task_.max_distance)) {
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
    if (topology_.triangle_component[task_.nearest[j].at.triangle] == component_) return;
    const Hit hit = locator_.nearest_in(topology_.triangle_component, component_, task_.source->point[j],
                                        task_.max_distance);
    if (hit.at.triangle != kNone) assigned_.hit[j] = hit;
  }

  /// Counts a break where the last step of a closed polyline finds no way.
  void close(Index i, Index j) {
    if (!linked(i, j)) count_break(i, j);
  }

  void count_break(Index i, Index j) {
    const Hit &a = assigned_.hit[i], &b = assigned_.hit[j];
    Capsule capsule = capsule_of(*task_.source, i, j, a, b);
    capsule.radius = std::max(capsule.radius, widest(capsule, a, b));
    if (!search_.joined(a, b, capsule)) ++assigned_.breaks;
  }

  const Topology& topology_;
  const SurfaceLocator& locator_;
  const Task& task_;
  SheetSearch search_;
  Index component_ = 0;
  Assignment assigned_;
};

/// First points of the runs of linked hits, the longest runs first (ties: the earlier).
std::vector<Index> run_starts(const Task& task) {
  std::vector<std::array<Index, 2>> run;  // minus the length, then the first point
  for (Index i = 0; i < task.size(); ++i) {
    if (i == 0 || !task.link[i - 1]) run.push_back({0, i});
    --run.back()[0];
  }
  std::ranges::sort(run);
  std::vector<Index> start;
  for (const auto& r : run) start.push_back(r[1]);
  return start;
}

/// The best of the passes from different runs. A run that an earlier pass left as it was would repeat it.
Assignment best_assignment(const Surface& surface, const Topology& topology, const SurfaceLocator& locator,
                           const Task& task) {
  SheetPass pass(surface, topology, locator, task);
  const std::vector<Index> starts = run_starts(task);
  const double segment = length_of(*task.source) / task.num_segments();
  std::vector<Assignment> tried = {pass.nearest(starts.front())};
  std::size_t best = 0;
  for (const Index start : starts) {
    const auto seen = [&](const Assignment& a) {
      return a.strays == 0 && a.breaks == 0 && a.hit[start].at.triangle == task.nearest[start].at.triangle;
    };
    if (std::ranges::any_of(tried, seen)) continue;
    tried.push_back(pass.run(start));
    if (tried.back().better_than(tried[best], segment)) best = tried.size() - 1;
    if (static_cast<int>(tried.size()) > kMaxPasses) break;
  }
  return std::move(tried[best]);
}

/// An error about some points of a feature.
Error point_error(ErrorCode code, const std::string& name, const std::string& what,
                  const std::vector<Index>& points) {
  OffendingIds ids;
  for (const Index i : points) ids.add(i);
  return ids.of(feature_error(code, name, what), ElementKind::Point);
}

std::vector<Index> points_where(Index n, auto&& holds) {
  std::vector<Index> points;
  for (Index i = 0; i < n; ++i) {
    if (holds(i)) points.push_back(i);
  }
  return points;
}

std::optional<Error> broken(const std::string& name, const PolylineSource& source) {
  const auto n = static_cast<Index>(source.point.size());
  const Index least = source.closed ? 3 : 2;
  if (n < least) {
    return feature_error(
        ErrorCode::FeatureBroken, name,
        fmt::format("a{} polyline needs {} points, {} given", source.closed ? " closed" : "", least, n));
  }
  const auto not_finite = points_where(n, [&](Index i) { return !is_finite(source.point[i]); });
  if (!not_finite.empty())
    return point_error(ErrorCode::FeatureBroken, name, "points that are not finite", not_finite);
  const auto repeated = points_where(n, [&](Index i) {
    return i > 0 ? source.point[i] == source.point[i - 1]
                 : source.closed && source.point.front() == source.point.back();
  });
  if (!repeated.empty())
    return point_error(ErrorCode::FeatureBroken, name, "points that repeat the one before", repeated);
  return std::nullopt;
}

std::optional<Error> too_far(const std::string& name, const Task& task, In<Hit> hit) {
  const auto far =
      points_where(task.size(), [&](Index i) { return !(hit[i].distance <= task.max_distance); });
  if (far.empty()) return std::nullopt;
  const Index worst = *std::ranges::max_element(far, {}, [&](Index i) { return hit[i].distance; });
  return point_error(ErrorCode::FeatureTooFar, name,
                     fmt::format("point {} is {:.6g} from the surface, {:.6g} allowed", worst,
                                 hit[worst].distance, task.max_distance),
                     far);
}

/// Names the points of the smaller part.
std::optional<Error> astray(const std::string& name, const Task& task, const Topology& topology,
                            In<Hit> hit) {
  const auto component = [&](Index i) { return topology.triangle_component[hit[i].at.triangle]; };
  std::vector<Index> of_point(task.size());
  for (Index i = 0; i < task.size(); ++i) of_point[i] = component(i);
  std::ranges::sort(of_point);
  Index home = of_point[0], most = 0;
  for (auto i = of_point.begin(); i != of_point.end();) {
    const auto end = std::upper_bound(i, of_point.end(), *i);
    if (end - i > most) home = *i, most = static_cast<Index>(end - i);
    i = end;
  }
  const auto others = points_where(task.size(), [&](Index i) { return component(i) != home; });
  if (others.empty()) return std::nullopt;
  return point_error(ErrorCode::FeatureLeavesSurface, name,
                     fmt::format("point {} lies on another component ({}) than the rest ({})", others[0],
                                 component(others[0]), home),
                     others);
}

Projection projection_of(In<Hit> hit) {
  Projection projection;
  for (const Hit& h : hit) {
    projection.at.push_back(h.at);
    projection.position.push_back(h.position);
    projection.max_distance = std::max(projection.max_distance, h.distance);
  }
  return projection;
}

/// All polylines at once; their points lie behind one another.
class Projector {
 public:
  Projector(const Exec& exec, const Surface& surface, const Topology& topology, const SurfaceLocator& locator,
            In<FeatureSpec> specs)
      : exec_(exec), surface_(surface), topology_(topology), locator_(locator), specs_(specs) {}

  Result<std::vector<Projection>> run() {
    collect();
    if (!failed_) find_nearest();
    if (!failed_) find_links();
    std::vector<Projection> projection(specs_.size());
    if (!failed_) choose_sheets(projection);
    if (failed_) return fail(std::move(*failed_));
    return projection;
  }

 private:
  const std::string& name(const Task& task) const { return specs_[task.spec].name; }

  /// Keeps the first error, and the names of later features with theirs.
  void note(const std::string& feature, std::optional<Error> error) {
    if (!error) return;
    if (!failed_) {
      failed_ = std::move(error);
    } else if (++noted_ <= kMaxNoted) {
      failed_->also += fmt::format("{}feature \"{}\"", failed_->also.empty() ? "fails too: " : ", ", feature);
    } else if (noted_ == kMaxNoted + 1) {
      failed_->also += " and more";
    }
  }

  void collect() {
    for (Index k = 0; k < static_cast<Index>(specs_.size()); ++k) {
      const auto* source = std::get_if<PolylineSource>(&specs_[k].source);
      if (!source) continue;
      if (auto error = broken(specs_[k].name, *source)) {
        note(specs_[k].name, std::move(error));
        continue;
      }
      tasks_.push_back({.spec = k, .source = source});
      tasks_.back().max_distance = source->max_distance.value_or(0.01 * length_of(*source));
      for (Index i = 0; i < tasks_.back().size(); ++i)
        task_of_point_.push_back(static_cast<Index>(tasks_.size()) - 1);
      point_.insert(point_.end(), source->point.begin(), source->point.end());
    }
    nearest_.resize(point_.size());
    link_.assign(point_.size(), 0);
    std::size_t begin = 0;
    for (Task& task : tasks_) {
      task.nearest = Out<Hit>(nearest_).subspan(begin, task.source->point.size());
      task.link = Out<std::uint8_t>(link_).subspan(begin, task.source->point.size());
      begin += task.source->point.size();
    }
  }

  void find_nearest() {
    locator_.nearest(exec_, point_, nearest_);
    for (const Task& task : tasks_) note(name(task), too_far(name(task), task, task.nearest));
  }

  void find_links() {
    constexpr Index kSegmentsPerBlock = 64;
    exec_.for_blocks(static_cast<Index>(point_.size()), kSegmentsPerBlock, [&](Index, Range r) {
      SheetSearch search(surface_, topology_);
      for (Index p = r.begin; p < r.end; ++p) {
        const Task& task = tasks_[task_of_point_[p]];
        const auto i = static_cast<Index>(&nearest_[p] - task.nearest.data());
        if (i >= task.num_segments()) continue;
        const Index j = task.successor(i);
        const Hit &a = task.nearest[i], &b = task.nearest[j];
        link_[p] = search.joined(a, b, capsule_of(*task.source, i, j, a, b));
      }
    });
  }

  void choose_sheets(std::vector<Projection>& projection) {
    exec_.for_tasks(static_cast<Index>(tasks_.size()), [&](Index k) {
      const Task& task = tasks_[k];
      const auto links = task.link.first(static_cast<std::size_t>(task.num_segments()));
      if (!std::ranges::all_of(links, [](std::uint8_t link) { return link != 0; })) {
        std::ranges::copy(best_assignment(surface_, topology_, locator_, task).hit, task.nearest.begin());
      }
      projection[task.spec] = projection_of(task.nearest);
    });
    for (const Task& task : tasks_) note(name(task), astray(name(task), task, topology_, task.nearest));
  }

  static constexpr int kMaxNoted = 8;
  const Exec& exec_;
  const Surface& surface_;
  const Topology& topology_;
  const SurfaceLocator& locator_;
  In<FeatureSpec> specs_;
  std::vector<Task> tasks_;
  std::vector<Index> task_of_point_;
  std::vector<Vec3> point_;
  std::vector<Hit> nearest_;
  std::vector<std::uint8_t> link_;
  std::optional<Error> failed_;
  int noted_ = 0;
};

}  // namespace

Result<Projection> project(const Exec& exec, const Surface& surface, const Topology& topology,
                           const SurfaceLocator& locator, const FeatureSpec& spec) {
  if (!std::holds_alternative<PolylineSource>(spec.source))
    return fail(ErrorCode::BadUsage, fmt::format("feature \"{}\" is no polyline", spec.name));
  auto all = Projector(exec, surface, topology, locator, In<FeatureSpec>(&spec, 1)).run();
  if (!all) return fail(std::move(all.error()));
  return std::move(all->front());
}

Result<std::vector<Projection>> project(const Exec& exec, const Surface& surface, const Topology& topology,
                                        const SurfaceLocator& locator, In<FeatureSpec> specs) {
  return Projector(exec, surface, topology, locator, specs).run();
}

}  // namespace planish
