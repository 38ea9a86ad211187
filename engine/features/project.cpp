#include "engine/features/project.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/features/feature_error.hpp"
#include "engine/features/nearest.hpp"
#include "engine/features/sheet_pass.hpp"

namespace planish {
namespace {

using Hit = SurfaceLocator::Hit;

/// A polyline among the features.
struct Task : PolylineHits {
  Index spec = 0;
};

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
  const auto not_finite = points_where(n, [&](Index i) { return !is_finite_point(source.point[i]); });
  if (!not_finite.empty())
    return point_error(ErrorCode::FeatureBroken, name, "points that are not finite", not_finite);
  if (!source.closed && n > 2 && source.point.front() == source.point.back()) {
    return point_error(
        ErrorCode::FeatureBroken, name,
        "the last point is the first again; for a closed feature set \"closed\": true and leave it out",
        {n - 1});
  }
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
      const double max_distance = allowed_distance(*source);
      task_of_point_.insert(task_of_point_.end(), source->point.size(), static_cast<Index>(tasks_.size()));
      tasks_.push_back({{.source = source, .max_distance = max_distance}, k});
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
        link_[p] = nearest_are_joined(search, task, i);
      }
    });
  }

  void choose_sheets(std::vector<Projection>& projection) {
    exec_.for_tasks(static_cast<Index>(tasks_.size()), [&](Index k) {
      const Task& task = tasks_[k];
      const auto links = task.link.first(static_cast<std::size_t>(task.num_segments()));
      if (!std::ranges::all_of(links, [](std::uint8_t link) { return link != 0; })) {
        std::ranges::copy(hits_on_one_sheet(surface_, topology_, locator_, task), task.nearest.begin());
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

double allowed_distance(const PolylineSource& source) {
  constexpr double kShare = 0.01;  // of the length
  return source.max_distance.value_or(kShare * length_of(source));
}

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
