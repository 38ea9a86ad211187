#include "engine/methods/conformal_map.hpp"

#include <algorithm>
#include <Eigen/Dense>

#include "engine/methods/at_rest.hpp"
#include "engine/methods/conformal_system.hpp"
#include "engine/methods/tied_components.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

constexpr double kSpring = 1;  // between the two vertices of a pair, so that the Hessian is definite

/// What a component that its pins do not hold is given: the difference of two images.
struct Pair {
  Index component = kNone;
  std::array<Index, 2> vertex;
  Vec2 difference;
  bool directed = false;  ///< only its length is given
};

/// Of components that are tied to one another one keeps its direction, the others turn with it.
std::vector<std::vector<Pair>> choose_pairs(const MapInput& input) {
  std::vector<Index> pins(input.piece.topology().num_components, 0);
  if (input.system) {
    for (const Pin& pin : input.system->pins()) ++pins[input.piece.component[pin.vertex]];
  }
  const auto has_direction = [&](Index k) {
    return pins[k] > 1 || (input.system && input.system->directed()[k]);
  };
  const auto& position = input.piece.mesh().position;
  std::vector<std::vector<Pair>> groups;
  for (const std::vector<Index>& tied : tied_components(input)) {
    bool directed = std::ranges::any_of(tied, has_direction);
    std::vector<Pair> pairs;
    for (const Index k : tied) {
      if (pins[k] > 1) continue;
      Pair pair{.component = k, .vertex = far_pair(input.piece, k), .difference = {}, .directed = directed};
      directed = true;
      pair.difference = {norm(position[pair.vertex[1]] - position[pair.vertex[0]]), 0};
      if (input.system) pair.difference = input.first[pair.vertex[1]] - input.first[pair.vertex[0]];
      pairs.push_back(pair);
    }
    if (!pairs.empty()) groups.push_back(std::move(pairs));
  }
  return groups;
}

std::vector<ConformalEnergy::Spring> springs_of(const std::vector<std::vector<Pair>>& groups) {
  std::vector<ConformalEnergy::Spring> springs;
  for (const std::vector<Pair>& pairs : groups) {
    for (const Pair& pair : pairs) springs.push_back({pair.vertex[0], pair.vertex[1], kSpring});
  }
  return springs;
}

class PinnedMap {
 public:
  PinnedMap(const MapInput& input, DofMap& dof, const Monitor& monitor)
      : input_(input),
        dof_(dof),
        monitor_(monitor),
        groups_(choose_pairs(input)),
        energy_(input.exec, input.piece, springs_of(groups_)),
        system_(input.exec, input.piece, energy_, dof) {}

  Result<MethodMap> operator()() {
    begin();
    if (auto factored = system_.factor(x_); !factored) return fail(factored.error());
    constexpr int kMostSteps = 100;
    constexpr double kStale = 1e-2;  // of the map's extent, as are these
    AtRest at_rest(1e-10, 1e-7);
    for (int step = 0; step <= kMostSteps; ++step) {
      if (monitor_ && monitor_({.phase = Phase::Map, .iteration = step}) == Verdict::Stop)
        return fail(ErrorCode::Cancelled, "stopped by the caller");
      const Result<double> moved = advance();
      if (!moved) return fail(moved.error());
      if (!dof_.poses() || at_rest(*moved)) {
        x_.resize(dof_.num_vertices());
        return MethodMap{std::move(x_), step};
      }
      if (*moved <= kStale || dof_.poses()->turned() == 0) continue;
      if (auto factored = system_.factor(x_); !factored) return fail(factored.error());
    }
    return fail(ErrorCode::NoConvergence,
                "the directions of features do not come to rest in a conformal map");
  }

 private:
  void begin() {
    if (input_.system) {
      x_.assign(input_.first.begin(), input_.first.end());
      x_.resize(dof_.size());
      dof_.collect(x_);
    } else {
      x_ = dof_.origin();
    }
  }

  /// One step to the minimum of the energy over the tangents; how far vertices went, over the map's extent.
  Result<double> advance() {
    std::vector<Vec2> change(dof_.size()), force(dof_.size());
    if (dof_.poses()) {
      energy_.forces(vertices(x_), Out<Vec2>(force).first(dof_.num_vertices()));
      clear_fixed(force);
      dof_.fold(force);
      for (Vec2& f : force) f = -f;
      system_.solve(force, change);
    }
    // Groups do not touch one another.
    if (dof_.poses()) {
      for (const std::vector<Pair>& pairs : groups_) meet_tied(pairs, change);
    } else if (!groups_.empty()) {
      meet_apart(change);
    }
    if (!dof_.poses()) return take(change, 1);
    std::vector<Vec2> moved = system_.displacement(change);
    const double relaxation = relaxation_of(std::move(moved));
    return take(change, relaxation);
  }

  /// How much of a step is taken. Tangents know nothing of the curvature of turning, so that steps may go too far, or not far
  /// enough; what two of them differ by tells.   Ref: Irons and Tuck 1969 (Aitken's process for vectors).
  double relaxation_of(std::vector<Vec2> moved) {
    constexpr double kLeast = 0.05, kMost = 2;
    if (!moved_before_.empty()) {
      std::vector<Vec2> difference(moved.size());
      combine(input_.exec, {{1, moved}, {-1, moved_before_}}, difference);
      const double squared = dot(input_.exec, difference, difference);
      if (squared > 0) relaxation_ *= -dot(input_.exec, moved_before_, difference) / squared;
      relaxation_ = std::clamp(std::abs(relaxation_), kLeast, kMost);
    }
    moved_before_ = std::move(moved);
    return relaxation_;
  }

  static Vec2 difference(const Pair& pair, In<Vec2> z) { return z[pair.vertex[1]] - z[pair.vertex[0]]; }

  /// Part of a pair's difference that is given; or that is free, and only the pair's spring in the Hessian holds it, which is
  /// taken back.
  struct Condition {
    const Pair* pair;
    Vec2 along;
    double target;
    double compliance = 0;  // of the spring
  };
  std::vector<Condition> conditions_of(const std::vector<Pair>& pairs) const {
    std::vector<Condition> conditions;
    for (const Pair& pair : pairs) {
      const Vec2 now = difference(pair, x_);
      if (pair.directed) {
        const Vec2 along = (1 / norm(now)) * now, across{-along.y, along.x};
        conditions.push_back({&pair, along, norm(pair.difference)});
        conditions.push_back({&pair, across, dot(across, now), 1 / kSpring});
      } else {
        conditions.push_back({&pair, {1, 0}, pair.difference.x});
        conditions.push_back({&pair, {0, 1}, pair.difference.y});
      }
    }
    return conditions;
  }

  /// Adds to a change what makes the differences of pairs in tied components those given: multipliers at all their ends.
  void meet_tied(const std::vector<Pair>& pairs, std::vector<Vec2>& change) const {
    const std::vector<Condition> conditions = conditions_of(pairs);
    const auto size = static_cast<Index>(conditions.size());
    std::vector<std::vector<Vec2>> response(size, std::vector<Vec2>(dof_.size()));
    Eigen::MatrixXd matrix(size, size);
    for (Index j = 0; j < size; ++j) {
      std::vector<Vec2> force(dof_.size());
      force[conditions[j].pair->vertex[0]] = -conditions[j].along;
      force[conditions[j].pair->vertex[1]] = conditions[j].along;
      clear_fixed(force);
      dof_.fold(force);
      system_.solve(force, response[j]);
      const std::vector<Vec2> moved = system_.displacement(response[j]);
      for (Index i = 0; i < size; ++i)
        matrix(i, j) = dot(conditions[i].along, difference(*conditions[i].pair, moved));
      matrix(j, j) -= conditions[j].compliance;
    }
    const std::vector<Vec2> moved = system_.displacement(change);
    Eigen::VectorXd missing(size);
    for (Index i = 0; i < size; ++i) {
      const Condition& c = conditions[i];
      missing[i] = c.target - dot(c.along, difference(*c.pair, x_) + difference(*c.pair, moved));
    }
    const Eigen::VectorXd multiplier = matrix.partialPivLu().solve(missing);
    for (Index j = 0; j < size; ++j) {
      for (std::size_t i = 0; i < change.size(); ++i) change[i] += multiplier[j] * response[j][i];
    }
  }

  /// The same in all components at once, where they do not touch one another and nothing turns.
  void meet_apart(std::vector<Vec2>& change) const {
    std::vector<Vec2> along_u(dof_.size()), along_v(dof_.size()), by_u(dof_.size()), by_v(dof_.size());
    for (const std::vector<Pair>& pairs : groups_) {
      for (const Pair& pair : pairs) {
        along_u[pair.vertex[0]].x = along_v[pair.vertex[0]].y = -1;
        along_u[pair.vertex[1]].x = along_v[pair.vertex[1]].y = 1;
      }
    }
    clear_fixed(along_u);
    clear_fixed(along_v);
    dof_.fold(along_u);
    dof_.fold(along_v);
    system_.solve(along_u, along_v, by_u, by_v);
    const std::vector<Vec2> moved = system_.displacement(change), moved_u = system_.displacement(by_u),
                            moved_v = system_.displacement(by_v);
    std::vector<Vec2> multiplier(input_.piece.topology().num_components);
    for (const std::vector<Pair>& pairs : groups_) {
      for (const Pair& pair : pairs) {
        const Vec2 missing = pair.difference - difference(pair, x_) - difference(pair, moved),
                   u = difference(pair, moved_u), v = difference(pair, moved_v);
        multiplier[pair.component] = {cross(missing, v) / cross(u, v), cross(u, missing) / cross(u, v)};
      }
    }
    for (std::size_t i = 0; i < change.size(); ++i) {
      const Index k =
          i < input_.piece.component.size() ? input_.piece.component[i] : groups_.front().front().component;
      change[i] += multiplier[k].x * by_u[i] + multiplier[k].y * by_v[i];
    }
  }

  /// A part of the change, shortened where joints cannot follow; how far the whole would go.
  Result<double> take(const std::vector<Vec2>& change, double length) {
    constexpr int kMostHalvings = 20;
    std::vector<Vec2> trial(x_.size());
    for (int halving = 0; halving < kMostHalvings; ++halving, length *= 0.5) {
      combine(input_.exec, {{1, x_}, {length, change}}, trial);
      if (!dof_.expand(trial)) continue;
      Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
      double farthest = 0;
      for (Index v = 0; v < dof_.num_vertices(); ++v) {
        lower = {std::min(lower.x, trial[v].x), std::min(lower.y, trial[v].y)};
        upper = {std::max(upper.x, trial[v].x), std::max(upper.y, trial[v].y)};
        farthest = std::max(farthest, norm(trial[v] - x_[v]));
      }
      x_.swap(trial);
      return farthest / (length * norm(upper - lower));
    }
    return fail(ErrorCode::NoConvergence,
                "features that share vertices do not stay joined in a conformal map");
  }

  /// Forces at held and pinned vertices move nothing.
  void clear_fixed(std::vector<Vec2>& force) const {
    const std::vector<std::uint8_t>& fixed = dof_.nodes().fixed;
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      if (fixed[v]) force[v] = {};
    }
  }
  In<Vec2> vertices(const std::vector<Vec2>& x) const { return In<Vec2>(x).first(dof_.num_vertices()); }

  const MapInput& input_;
  DofMap& dof_;
  const Monitor& monitor_;
  std::vector<std::vector<Pair>> groups_;  // of tied components
  ConformalEnergy energy_;
  ConformalSystem system_;
  std::vector<Vec2> x_;
  std::vector<Vec2> moved_before_;  // [V] by the whole step before
  double relaxation_ = 1;
};

}  // namespace

std::array<Index, 2> far_pair(const Workpiece& piece, Index component) {
  const Topology& topology = piece.topology();
  const std::vector<Vec3>& position = piece.mesh().position;
  const In<Index> loop =
      slice(In<Index>(topology.loop_corner), topology.loops().group(piece.outer_loop[component]));
  Index from = piece.mesh().corner_vertex[loop.front()], to = from;
  double farthest = -1;
  while (true) {
    Index next = to;
    double distance = farthest;
    for (const Index c : loop) {
      const Index v = piece.mesh().corner_vertex[c];
      const double d = norm(position[v] - position[to]);
      if (d > distance || (d == distance && next != to && v < next)) distance = d, next = v;
    }
    if (!(distance > farthest)) break;
    farthest = distance;
    from = to;
    to = next;
  }
  return {std::min(from, to), std::max(from, to)};
}

Result<MethodMap> pinned_conformal_map(const MapInput& input, const Monitor& monitor) {
  if (auto checked = check_scale_groups(input); !checked) return fail(checked.error());
  if (input.dof) return PinnedMap(input, *input.dof, monitor)();
  const NodeMap nodes = find_nodes(input.piece.component, input.piece.topology().num_components);
  DofMap dof(nodes);
  return PinnedMap(input, dof, monitor)();
}

}  // namespace planish
