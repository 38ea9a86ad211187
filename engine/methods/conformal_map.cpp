#include "engine/methods/conformal_map.hpp"

#include <algorithm>

#include "engine/methods/at_rest.hpp"
#include "engine/methods/conformal_system.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

/// What a component that its pins do not hold is given: the difference of two images.
struct Pair {
  Index component = kNone;
  std::array<Index, 2> vertex;
  Vec2 difference;
  bool directed = false;  ///< only its part along the difference is given
};

std::vector<Pair> choose_pairs(const MapInput& input) {
  const Index num_components = input.piece.topology().num_components;
  std::vector<Index> pins(num_components, 0);
  if (input.system) {
    for (const Pin& pin : input.system->pins()) ++pins[input.piece.component[pin.vertex]];
  }
  std::vector<Pair> pairs;
  for (Index k = 0; k < num_components; ++k) {
    if (pins[k] > 1) continue;
    Pair pair{.component = k, .vertex = far_pair(input.piece, k), .difference = {}};
    const auto& position = input.piece.mesh().position;
    pair.difference = {norm(position[pair.vertex[1]] - position[pair.vertex[0]]), 0};
    if (input.system) {
      pair.difference = input.first[pair.vertex[1]] - input.first[pair.vertex[0]];
      pair.directed = input.system->directed()[k];
    }
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<ConformalEnergy::Spring> springs_of(const std::vector<Pair>& pairs) {
  std::vector<ConformalEnergy::Spring> springs;
  for (const Pair& pair : pairs) springs.push_back({pair.vertex[0], pair.vertex[1], 1});
  return springs;
}

class PinnedMap {
 public:
  PinnedMap(const MapInput& input, DofMap& dof, const Monitor& monitor)
      : input_(input),
        dof_(dof),
        monitor_(monitor),
        pairs_(choose_pairs(input)),
        energy_(input.exec, input.piece, springs_of(pairs_)),
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
    // Components do not touch one another unless directions are tied between them.
    if (dof_.poses()) {
      for (const Pair& pair : pairs_) meet(In<Pair>(&pair, 1), change);
    } else if (!pairs_.empty()) {
      meet(pairs_, change);
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

  /// Adds to a change what makes the pairs' differences those given: multipliers at both ends.
  void meet(In<Pair> pairs, std::vector<Vec2>& change) {
    std::vector<Vec2> along_u(dof_.size()), along_v(dof_.size()), by_u(dof_.size()), by_v(dof_.size());
    for (const Pair& pair : pairs) {
      along_u[pair.vertex[0]].x = along_v[pair.vertex[0]].y = -1;
      along_u[pair.vertex[1]].x = along_v[pair.vertex[1]].y = 1;
    }
    clear_fixed(along_u);
    clear_fixed(along_v);
    dof_.fold(along_u);
    dof_.fold(along_v);
    system_.solve(along_u, along_v, by_u, by_v);
    const std::vector<Vec2> moved = system_.displacement(change), moved_u = system_.displacement(by_u),
                            moved_v = system_.displacement(by_v);
    std::vector<Vec2> multiplier(input_.piece.topology().num_components);
    for (const Pair& pair : pairs) {
      const auto difference = [&](const std::vector<Vec2>& z) {
        return z[pair.vertex[1]] - z[pair.vertex[0]];
      };
      multiplier[pair.component] =
          multiplier_of(pair, difference(x_) + difference(moved), difference(moved_u), difference(moved_v));
    }
    const bool single = pairs.size() == 1;
    for (std::size_t i = 0; i < change.size(); ++i) {
      const Index k =
          single || i >= input_.piece.component.size() ? pairs.front().component : input_.piece.component[i];
      change[i] += multiplier[k].x * by_u[i] + multiplier[k].y * by_v[i];
    }
  }

  static Vec2 multiplier_of(const Pair& pair, Vec2 now, Vec2 by_u, Vec2 by_v) {
    if (pair.directed) {
      const Vec2 along = (1 / norm(pair.difference)) * pair.difference;
      const double response = dot(along, along.x * by_u + along.y * by_v);
      return (dot(along, pair.difference - now) / response) * along;
    }
    const Vec2 missing = pair.difference - now;
    const double determinant = cross(by_u, by_v);
    return {cross(missing, by_v) / determinant, cross(by_u, missing) / determinant};
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
  std::vector<Pair> pairs_;
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
  if (input.dof) return PinnedMap(input, *input.dof, monitor)();
  const NodeMap nodes = find_nodes(input.piece.component, input.piece.topology().num_components);
  DofMap dof(nodes);
  return PinnedMap(input, dof, monitor)();
}

}  // namespace planish
