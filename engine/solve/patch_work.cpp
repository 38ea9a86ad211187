#include "engine/solve/patch_work.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "engine/solve/untangle.hpp"
#include "engine/solve/unwind.hpp"

namespace planish {
namespace {

constexpr int kRings = 4;
constexpr int kMostUntangling = 25;  // steps; what takes more is left to the whole
constexpr int kUnwoundRings = 1;     // around overwound vertices, at first
/// Mean stretch below which a triangle is part of a compressed place; the stricter one where neighbourhoods of the other would
/// have more than so large a share of all triangles.
constexpr double kCompressed = 0.8, kCrushed = 0.6;
constexpr double kMostShare = 0.2;

/// One patch, worked on in slices of time, so that the caller can be asked in between whether to go on.
class PatchJob {
 public:
  PatchJob(const Exec& exec, const ArapEnergy& mesh, const Patch& patch, const MapDensity& density,
           In<Vec2> x)
      : exec_(exec), patch_(patch), density_(density), local_(mesh, patch) {
    std::vector<Vec2> start;
    for (const Index v : patch.vertex) start.push_back(x[v]);
    map_.emplace(exec, local_.energy(), local_.unknowns(), nullptr, std::move(start));
  }
  PatchJob(const PatchJob&) = delete;
  PatchJob& operator=(const PatchJob&) = delete;

  void untangle(int most_steps) {
    most_untangling_ = most_steps;
    untangling_.emplace(*map_, most_steps);
  }
  void descend(double tolerance, double whole_energy, int most_steps) {
    tolerance_ = tolerance;
    whole_energy_ = whole_energy;
    most_steps_ = most_steps;
  }

  bool is_done() const { return done_; }
  int steps() const {
    return steps_before_ + (untangling_ ? untangling_->steps() : 0) + (descent_ ? descent_->steps() : 0);
  }

  /// Steps until the time is up, at least one.   Fails: OutOfMemory.
  Result<void> work(double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    do {
      auto stepped = step();
      if (!stepped && stepped.error().code != ErrorCode::FactorizationFailed) return stepped;
      if (!stepped) done_ = true;  // what was reached before stays good
    } while (!done_ && std::chrono::duration<double>(Clock::now() - begin).count() < seconds);
    return {};
  }

  void write_back(Out<Vec2> x) const {
    if (!good_) return;
    for (Index i = 0; i < patch_.num_free; ++i) x[patch_.vertex[i]] = map_->uv()[i];
  }

 private:
  Result<void> step() {
    if (untangling_ && !untangling_->is_done()) return untangling_->step();
    if (!descent_) {
      if (untangling_ && unwinds()) return {};
      good_ = map_->measure().is_injective(map_->uv());
      done_ = !good_;
      if (done_) return {};
      map_->lower(density_);
      const double share = whole_energy_ > 0 ? whole_energy_ / map_->energy() : 1;
      descent_.emplace(*map_, std::sqrt(share) * tolerance_, most_steps_);
    }
    auto stepped = descent_->step();
    done_ = descent_->is_done();
    return stepped;
  }

  /// Where vertices are overwound and nothing else is wrong: once more, from where they are laid out anew.
  bool unwinds() {
    constexpr int kMostTimes = 3;
    if (times_unwound_ == kMostTimes || !map_->is_positive()) return false;
    const std::vector<Index> wound = overwound_vertices(exec_, local_.energy(), map_->uv());
    if (wound.empty()) return false;
    std::vector<Vec2> x = map_->x();
    unwind(local_.energy(), wound, kUnwoundRings << times_unwound_++, x);
    map_->move_to(std::move(x));
    steps_before_ += untangling_->steps();
    untangling_.emplace(*map_, most_untangling_);
    return true;
  }

  const Exec& exec_;
  const Patch& patch_;
  MapDensity density_;
  PatchMesh local_;
  std::optional<NewtonMap> map_;
  std::optional<Untangling> untangling_;
  std::optional<Descent> descent_;
  double tolerance_ = 0, whole_energy_ = 0;
  int most_steps_ = 0, most_untangling_ = 0, times_unwound_ = 0, steps_before_ = 0;
  bool good_ = false, done_ = false;
};

}  // namespace

PatchWork::PatchWork(const Exec& exec, const ArapProblem& problem)
    : exec_(exec),
      mesh_(problem.energy),
      measure_(exec, mesh_),
      movable_(mesh_.num_vertices()),
      rank_(mesh_.num_vertices()) {
  const NodeMap& nodes = problem.dof->nodes();
  for (Index v = 0; v < mesh_.num_vertices(); ++v) movable_[v] = nodes.node[v] == v;
  if (problem.barrier) {
    for (const Index c : problem.topology->loop_corner) movable_[mesh_.corner_vertex[c]] = 0;
  }
  for (Index k = 0; k < static_cast<Index>(problem.order.size()); ++k) rank_[problem.order[k]] = k;
}

Result<void> PatchWork::run(const std::vector<Patch>& patches, const MapDensity& density, const Aim& aim,
                            const Monitor& monitor, Out<Vec2> x) {
  constexpr double kSlice = 0.2;  // seconds
  std::vector<std::unique_ptr<PatchJob>> jobs;
  for (const Patch& patch : patches) {
    jobs.push_back(std::make_unique<PatchJob>(exec_, mesh_, patch, density, x));
    if (aim.untangle) jobs.back()->untangle(kMostUntangling);
    jobs.back()->descend(aim.tolerance, aim.whole_energy, aim.most_steps);
  }
  std::vector<Result<void>> worked(jobs.size());
  const auto is_done = [](const auto& job) { return job->is_done(); };
  while (!std::all_of(jobs.begin(), jobs.end(), is_done)) {
    exec_.for_tasks(static_cast<Index>(jobs.size()), [&](Index k) {
      if (!jobs[k]->is_done()) worked[k] = jobs[k]->work(kSlice);
    });
    for (const Result<void>& w : worked) {
      if (!w) return w;
    }
    if (monitor && monitor({.phase = Phase::Untangle, .iteration = steps_}) == Verdict::Stop)
      return fail(ErrorCode::Cancelled, "stopped by the caller");
  }
  int most = 0;
  for (const auto& job : jobs) {
    job->write_back(x);
    most = std::max(most, job->steps());
  }
  steps_ += most;
  return {};
}

std::vector<Index> PatchWork::faults(In<Vec2> x) const {
  std::vector<Index> triangles = measure_.flipped(x);
  for (const Index v : overwound_vertices(exec_, mesh_, x)) {
    for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(v))) triangles.push_back(c / 3);
  }
  return triangles;
}

std::vector<Index> PatchWork::compressed(In<Vec2> x, double stretch) const {
  return select(exec_, mesh_.num_triangles(), [&](Index t) {
    const Wirtinger j = wirtinger(corner_weights(mesh_.frame[t]), corner_images(mesh_.corner_vertex, t, x));
    return norm(j.p) < stretch;
  });
}

std::vector<Patch> PatchWork::patches_around(const std::vector<Index>& faults, In<Vec2> x) const {
  const auto grown = [&](double stretch) {
    std::vector<Index> seeds = compressed(x, stretch);
    seeds.insert(seeds.end(), faults.begin(), faults.end());
    return grow_patches(mesh_, seeds, kRings, movable_, rank_);
  };
  std::vector<Patch> patches = grown(kCompressed);
  double triangles = 0;
  for (const Patch& patch : patches) triangles += static_cast<double>(patch.triangle.size());
  return triangles <= kMostShare * mesh_.num_triangles() ? patches : grown(kCrushed);
}

Result<void> PatchWork::untangle(const MapDensity& density, const Monitor& monitor, Out<Vec2> x) {
  constexpr int kMostDescent = 10;
  constexpr double kNear = 1e-2;
  const Aim aim{.untangle = true, .tolerance = kNear, .whole_energy = 0, .most_steps = kMostDescent};
  return run(patches_around(faults(x), x), density, aim, monitor, x);
}

Result<void> PatchWork::relax(const MapDensity& density, double tolerance, double whole_energy,
                              const Monitor& monitor, Out<Vec2> x) {
  constexpr int kMostDescent = 200;
  const Aim aim{
      .untangle = false, .tolerance = tolerance, .whole_energy = whole_energy, .most_steps = kMostDescent};
  return run(patches_around({}, x), density, aim, monitor, x);
}

}  // namespace planish
