#include "engine/methods/spectral.hpp"

#include <algorithm>
#include <numeric>
#include <Eigen/Dense>

#include "engine/constraints/fit.hpp"
#include "engine/methods/at_rest.hpp"
#include "engine/methods/conformal_system.hpp"
#include "engine/methods/spectral_measure.hpp"
#include "engine/methods/tied_components.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

constexpr double kStill = 1e-9,
                 kRounding = 1e-6;  // of a step, over the map, both in the metric E + B / boundary length
constexpr int kMostSteps = 500;
constexpr double kStaleTurn = 1e-3;                      // radians, of a feature since the last factor
constexpr double kFirstShift = 1e-7, kMostShift = 1e-3;  // sigma, over 1 / boundary length

class SpectralMap {
 public:
  SpectralMap(const MapInput& input, DofMap& dof, const Monitor& monitor)
      : input_(input),
        dof_(dof),
        monitor_(monitor),
        measure_(input.exec, input.piece),
        shift_(measure_.mass().size()),
        system_(input.exec, input.piece, measure_.energy(), dof, shift_) {}

  Result<MethodMap> operator()() {
    const std::vector<std::vector<Index>> groups = find_groups();
    begin(groups);
    if (auto factored = factor(); !factored) return fail(factored.error());
    if (system_.num_unknowns() < 2)
      return fail(ErrorCode::NoConvergence,
                  "the constraints leave fewer than two unknowns free, and no eigenvector to choose");
    int steps = 0;
    for (const std::vector<Index>& group : groups) {
      auto done = iterate(group, steps);
      if (!done) return fail(done.error());
    }
    x_.resize(dof_.num_vertices());
    return MethodMap{std::move(x_), steps};
  }

 private:
  Index num_components() const { return measure_.num_components(); }
  Index component_of(std::size_t v) const { return measure_.component_of(v); }

  /// Components that are iterated together: those that touch one another where features turn, else all of them, each with
  /// its own shares.
  std::vector<std::vector<Index>> find_groups() const {
    if (dof_.poses()) return tied_components(input_);
    std::vector<Index> all(num_components());
    std::iota(all.begin(), all.end(), 0);
    return {all};
  }

  /// The map of the first rotations, or the surface seen along its smallest axis, what is held at 0.
  void begin(const std::vector<std::vector<Index>>& groups) {
    if (input_.system) {
      x_.assign(input_.first.begin(), input_.first.end());
      if (dof_.poses()) {
        for (const std::vector<Index>& group : groups) {
          if (group.size() > 1) even_out(group);
        }
      }
      x_.resize(dof_.size());
      dof_.collect(x_);
      return;
    }
    const std::vector<Vec3>& position = input_.piece.mesh().position;
    const FittedPlane plane = fit_plane(position);
    x_.resize(dof_.size());
    std::vector<Vec2> held(num_components());
    for (std::size_t v = 0; v < position.size(); ++v) {
      x_[v] = in_plane(plane, position[v]);
      if (dof_.nodes().fixed[v]) held[component_of(v)] = x_[v];
    }
    for (std::size_t v = 0; v < position.size(); ++v) x_[v] = x_[v] - held[component_of(v)];
  }

  /// Tied components are given the mass of their boundaries' lengths, so that together they minimise the sum of E / B times
  /// length, which no component's size enters.
  void even_out(const std::vector<Index>& group) {
    const Image here = image_of_place();
    const std::vector<Vec2> b = measure_.products(here.moved, here.b);
    std::vector<double> factor(num_components(), 1);
    for (const Index k : group) factor[k] = std::sqrt(measure_.mass_of(k) / b[k].x);
    std::vector<Vec2> held(num_components());
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      if (dof_.nodes().fixed[v]) held[component_of(v)] = x_[v];
    }
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      const Index k = component_of(v);
      x_[v] = held[k] + factor[k] * (x_[v] - held[k]);
    }
  }

  /// With the least shift that makes the matrix definite: maps of flat surfaces have no energy at all.
  Result<void> factor() {
    for (double sigma = kFirstShift;; sigma *= 100) {
      for (std::size_t v = 0; v < shift_.size(); ++v)
        shift_[v] = sigma / measure_.mass_of(component_of(v)) * measure_.mass()[v];
      auto factored = system_.factor(x_);
      if (factored || factored.error().code != ErrorCode::FactorizationFailed || sigma >= kMostShift)
        return factored;
    }
  }

  /// Until the group stands still.
  Result<void> iterate(const std::vector<Index>& group, int& steps) {
    Image step, before;
    AtRest at_rest(kStill, kRounding);
    for (int k = 0; k < kMostSteps; ++k, ++steps) {
      const Image here = image_of_place();
      const std::vector<double> lambda = measure_.quotients(here);
      residual_step(here, lambda, group, step);
      const double residual = measure_.relative_size(step, here, group);
      const Progress progress{
          .phase = Phase::Map, .iteration = steps, .energy = lambda[group.front()], .gradient = residual};
      if (monitor_ && monitor_(progress) == Verdict::Stop)
        return fail(ErrorCode::Cancelled, "stopped by the caller");
      if (at_rest(residual)) return {};
      if (auto moved = move(here, step, group, before); !moved) return moved;
      turns_ |= dof_.poses() && dof_.poses()->turned() > 0;
      if (dof_.poses() && dof_.poses()->turned() > kStaleTurn) {
        if (auto factored = factor(); !factored) return factored;
        before = {};  // in unknowns that are no more
      }
    }
    return fail(ErrorCode::NoConvergence,
                "the smallest eigenvector of the conformal energy was not found within " +
                    std::to_string(kMostSteps) + " steps");
  }

  Image image_of_place() const {
    Image here;
    here.moved.assign(x_.begin(), x_.begin() + dof_.num_vertices());
    measure_.fill_products(here);
    return here;
  }

  std::vector<std::uint8_t> membership(const std::vector<Index>& group) const {
    std::vector<std::uint8_t> is_in(num_components(), 0);
    for (const Index k : group) is_in[k] = 1;
    return is_in;
  }

  /// The step -(H + sigma B)^-1 (H z - lambda B z) in the components of a group.
  void residual_step(const Image& here, const std::vector<double>& lambda, const std::vector<Index>& group,
                     Image& step) const {
    const std::vector<std::uint8_t> is_in = membership(group);
    std::vector<Vec2> force(dof_.size());
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      const Index k = component_of(v);
      if (dof_.nodes().fixed[v] || !is_in[k]) continue;
      force[v] = lambda[k] * here.b[v] - here.e[v];
    }
    dof_.fold(force);
    step.change.resize(dof_.size());
    system_.solve(force, step.change);
    if (dof_.poses()) take_out_similarity(here, group, step.change);
    step.moved = system_.displacement(step.change);
    measure_.fill_products(step);
  }

  /// B times the place of one component, turned by a quarter where asked for, as a force on the unknowns.
  void add_mass(const Image& here, Index component, bool turned, std::vector<Vec2>& force) const {
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      if (dof_.nodes().fixed[v] || component_of(v) != component) continue;
      force[v] = turned ? multiply({0, 1}, here.b[v]) : here.b[v];
    }
  }

  /// Where features turn, a step must be small to be near its tangent: without what scales the components of the group and
  /// turns them together. Where directions are given there is no turning.
  /// Ref: Sleijpen and van der Vorst 1996 (corrections across the vector).
  void take_out_similarity(const Image& here, const std::vector<Index>& group,
                           std::vector<Vec2>& change) const {
    const bool directed =
        std::ranges::any_of(group, [&](Index k) { return input_.system->directed()[k] != 0; });
    const auto num_scalings = static_cast<Index>(group.size()), size = num_scalings + (directed ? 0 : 1);
    std::vector<std::vector<Vec2>> response(size, std::vector<Vec2>(dof_.size()));
    for (Index i = 0; i < size; ++i) {
      std::vector<Vec2> force(dof_.size());
      for (const Index k : i < num_scalings ? std::vector<Index>{group[i]} : group)
        add_mass(here, k, i == num_scalings, force);
      dof_.fold(force);
      system_.solve(force, response[i]);
    }
    const auto along = [&](In<Vec2> vector) {
      const std::vector<Vec2> b = measure_.products(here.b, system_.displacement(vector));
      Eigen::VectorXd result = Eigen::VectorXd::Zero(size);
      for (Index i = 0; i < num_scalings; ++i) {
        result[i] = b[group[i]].x;
        if (!directed) result[num_scalings] += b[group[i]].y;
      }
      return result;
    };
    Eigen::MatrixXd matrix(size, size);
    for (Index i = 0; i < size; ++i) matrix.col(i) = along(response[i]);
    const Eigen::VectorXd share = -matrix.partialPivLu().solve(along(change));
    for (Index k = 0; k < size; ++k) {
      for (std::size_t i = 0; i < change.size(); ++i) change[i] += share[k] * response[k][i];
    }
  }

  /// Along the best combination of the step and the one before, which becomes the step before.
  Result<void> move(const Image& here, const Image& step, const std::vector<Index>& group, Image& before) {
    const bool is_whole = turns_ || (dof_.poses() && group.size() > 1);
    const std::vector<Vec2> share = is_whole ? std::vector<Vec2>(num_components(), Vec2{1, 0})
                                             : measure_.best_shares(here, step, before, group);
    const bool has_before = !before.change.empty();
    const auto combined = [&](std::vector<Vec2> Image::*part) {
      std::vector<Vec2> sum(step.*part);
      for (std::size_t i = 0; i < sum.size(); ++i) {
        const Vec2 s = share[dof_.poses() ? group.front() : component_of(i)];
        sum[i] = s.x * sum[i] + (has_before ? s.y * (before.*part)[i] : Vec2{});
      }
      return sum;
    };
    Image taken{.change = combined(&Image::change),
                .moved = combined(&Image::moved),
                .e = combined(&Image::e),
                .b = combined(&Image::b)};
    before = std::move(taken);
    return take(before.change);
  }

  /// Shortened where joints cannot follow.
  Result<void> take(In<Vec2> change) {
    constexpr int kMostHalvings = 20;
    std::vector<Vec2> trial(x_.size());
    double length = 1;
    for (int halving = 0; halving < kMostHalvings; ++halving, length *= 0.5) {
      combine(input_.exec, {{1, x_}, {length, change}}, trial);
      if (!dof_.expand(trial)) continue;
      x_.swap(trial);
      return {};
    }
    return fail(ErrorCode::NoConvergence,
                "features that share vertices do not stay joined in a conformal map");
  }

  const MapInput& input_;
  DofMap& dof_;
  const Monitor& monitor_;
  SpectralMeasure measure_;
  std::vector<double> shift_;
  ConformalSystem system_;
  std::vector<Vec2> x_;
  bool turns_ = false;  // features turn: what steps do together is not what each of them does
};

}  // namespace

Result<MethodMap> spectral_map(const MapInput& input, const Monitor& monitor) {
  if (auto checked = check_scale_groups(input); !checked) return fail(checked.error());
  if (input.dof) return SpectralMap(input, *input.dof, monitor)();
  const NodeMap nodes = find_nodes(input.piece.component, input.piece.topology().num_components);
  DofMap dof(nodes);
  return SpectralMap(input, dof, monitor)();
}

}  // namespace planish
