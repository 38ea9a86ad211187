#include "engine/methods/spectral.hpp"

#include <algorithm>
#include <Eigen/Dense>

#include "engine/constraints/fit.hpp"
#include "engine/methods/at_rest.hpp"
#include "engine/methods/conformal_system.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

constexpr double kStill = 1e-9,
                 kRounding = 1e-6;  // of a step, over the map, both in the metric E + B / boundary length
constexpr int kMostSteps = 500;
constexpr double kStaleTurn = 1e-3;                      // radians, of a feature since the last factor
constexpr double kFirstShift = 1e-7, kMostShift = 1e-3;  // sigma, over 1 / boundary length

/// A vector of the iteration, and E and B times it.
struct Image {
  std::vector<Vec2> change;  // unknowns
  std::vector<Vec2> moved;   // [V] displacement, or the place itself
  std::vector<Vec2> e, b;    // [V]
};

/// E and B between the place, the step and the step before, in one component.
struct Gram {
  Eigen::Matrix3d e = Eigen::Matrix3d::Zero(), b = Eigen::Matrix3d::Zero();
};

/// Shares of the step and of the step before that make E / B least.
Vec2 best_shares(const Gram& gram, double mass, int size) {
  const Eigen::MatrixXd metric = gram.e.topLeftCorner(size, size) + gram.b.topLeftCorner(size, size) / mass;
  Eigen::VectorXd scale(size);
  for (int i = 0; i < size; ++i) scale[i] = metric(i, i) > 0 ? 1 / std::sqrt(metric(i, i)) : 0;
  const auto scaled = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return scale.asDiagonal() * m * scale.asDiagonal();
  };
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      scaled(gram.b.topLeftCorner(size, size)), scaled(metric));
  const bool solved = scale.minCoeff() > 0 && solver.info() == Eigen::Success;
  const Eigen::VectorXd best =
      solved ? Eigen::VectorXd(scale.asDiagonal() * solver.eigenvectors().col(size - 1)) : Eigen::VectorXd();
  if (solved && best[0] != 0 && best.allFinite())
    return {best[1] / best[0], size > 2 ? best[2] / best[0] : 0};
  return size > 2 ? best_shares(gram, mass, 2) : Vec2{1, 0};  // the steps say the same, or are nothing
}

class SpectralMap {
 public:
  SpectralMap(const MapInput& input, DofMap& dof, const Monitor& monitor)
      : input_(input),
        dof_(dof),
        monitor_(monitor),
        mass_(boundary_mass(input.piece)),
        component_mass_(num_components(), 0),
        shift_(mass_.size()),
        energy_(input.exec, input.piece),
        system_(input.exec, input.piece, energy_, dof, shift_) {
    for (std::size_t v = 0; v < mass_.size(); ++v) component_mass_[input.piece.component[v]] += mass_[v];
  }

  Result<MethodMap> operator()() {
    begin();
    if (auto factored = factor(); !factored) return fail(factored.error());
    if (system_.num_unknowns() < 2)
      return fail(ErrorCode::NoConvergence,
                  "the constraints leave fewer than two unknowns free, and no eigenvector to choose");
    int steps = 0;
    // Components do not touch one another unless directions are tied between them.
    const Index groups = dof_.poses() ? num_components() : 1;
    for (Index group = 0; group < groups; ++group) {
      auto done = iterate(dof_.poses() ? group : kNone, steps);
      if (!done) return fail(done.error());
    }
    x_.resize(dof_.num_vertices());
    return MethodMap{std::move(x_), steps};
  }

 private:
  Index num_components() const { return input_.piece.topology().num_components; }
  Index component_of(std::size_t v) const { return input_.piece.component[v]; }
  In<Vec2> vertices(const std::vector<Vec2>& x) const { return In<Vec2>(x).first(dof_.num_vertices()); }

  /// The map of the first rotations, or the surface seen along its smallest axis, what is held at 0.
  void begin() {
    if (input_.system) {
      x_.assign(input_.first.begin(), input_.first.end());
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

  /// With the least shift that makes the matrix definite: maps of flat surfaces have no energy at all.
  Result<void> factor() {
    for (double sigma = kFirstShift;; sigma *= 100) {
      for (std::size_t v = 0; v < shift_.size(); ++v)
        shift_[v] = sigma / component_mass_[component_of(v)] * mass_[v];
      auto factored = system_.factor(x_);
      if (factored || factored.error().code != ErrorCode::FactorizationFailed || sigma >= kMostShift)
        return factored;
    }
  }

  /// Until the component stands still, kNone: all of them.
  Result<void> iterate(Index only, int& steps) {
    Image step, before;
    AtRest at_rest(kStill, kRounding);
    for (int k = 0; k < kMostSteps; ++k, ++steps) {
      const Image here = image_of_place();
      const std::vector<double> lambda = quotients(here);
      residual_step(here, lambda, only, step);
      const double residual = relative_size(step, here, only);
      const Progress progress{.phase = Phase::Map,
                              .iteration = steps,
                              .energy = lambda[std::max(only, Index{0})],
                              .gradient = residual};
      if (monitor_ && monitor_(progress) == Verdict::Stop)
        return fail(ErrorCode::Cancelled, "stopped by the caller");
      if (at_rest(residual)) return {};
      if (auto moved = move(here, step, only, before); !moved) return moved;
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

  /// Mass times the distance from the component's mean.
  std::vector<Vec2> mass_times(In<Vec2> z) const {
    std::vector<Vec2> mean(num_components()), result(z.size());
    for (std::size_t v = 0; v < z.size(); ++v) mean[component_of(v)] += mass_[v] * z[v];
    for (Index k = 0; k < num_components(); ++k) mean[k] = (1 / component_mass_[k]) * mean[k];
    for (std::size_t v = 0; v < z.size(); ++v) result[v] = mass_[v] * (z[v] - mean[component_of(v)]);
    return result;
  }

  void fill_products(Image& image) const {
    image.e.resize(image.moved.size());
    energy_.forces(image.moved, image.e);
    image.b = mass_times(image.moved);
  }
  Image image_of_place() const {
    Image here;
    here.moved.assign(x_.begin(), x_.begin() + dof_.num_vertices());
    fill_products(here);
    return here;
  }

  /// Per component, of complex vectors: conj(a) b.
  std::vector<Vec2> products(In<Vec2> a, In<Vec2> b) const {
    std::vector<Vec2> sum(num_components());
    for (std::size_t v = 0; v < a.size(); ++v) sum[component_of(v)] += multiply(conjugate(a[v]), b[v]);
    return sum;
  }
  std::vector<double> quotients(const Image& here) const {
    const std::vector<Vec2> e = products(here.moved, here.e), b = products(here.moved, here.b);
    std::vector<double> lambda(e.size());
    for (std::size_t k = 0; k < e.size(); ++k) lambda[k] = e[k].x / b[k].x;
    return lambda;
  }

  /// The step -(H + sigma B)^-1 (H z - lambda B z) in one component, kNone: in all.
  void residual_step(const Image& here, const std::vector<double>& lambda, Index only, Image& step) const {
    std::vector<Vec2> force(dof_.size());
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      const Index k = component_of(v);
      if (dof_.nodes().fixed[v] || (only != kNone && k != only)) continue;
      force[v] = lambda[k] * here.b[v] - here.e[v];
    }
    dof_.fold(force);
    step.change.resize(dof_.size());
    system_.solve(force, step.change);
    if (only != kNone) take_out_similarity(here, only, step.change);
    step.moved = system_.displacement(step.change);
    fill_products(step);
  }

  /// Where features turn, a step must be small to be near its tangent: without what scales and turns the whole. Where
  /// directions are given there is no turning.   Ref: Sleijpen and van der Vorst 1996 (corrections across the vector).
  void take_out_similarity(const Image& here, Index only, std::vector<Vec2>& change) const {
    std::vector<Vec2> scaling(dof_.size()), turning(dof_.size()), by_scaling(dof_.size()),
        by_turning(dof_.size());
    for (Index v = 0; v < dof_.num_vertices(); ++v) {
      if (dof_.nodes().fixed[v] || component_of(v) != only) continue;
      scaling[v] = here.b[v];
      turning[v] = multiply({0, 1}, here.b[v]);
    }
    dof_.fold(scaling);
    dof_.fold(turning);
    system_.solve(scaling, turning, by_scaling, by_turning);
    const auto along = [&](In<Vec2> vector) { return products(here.b, system_.displacement(vector))[only]; };
    const Vec2 excess = along(change), s = along(by_scaling), t = along(by_turning);
    Vec2 share{-excess.x / s.x, 0};
    if (!input_.system->directed()[only]) {
      const double determinant = cross(s, t);
      share = {-cross(excess, t) / determinant, -cross(s, excess) / determinant};
    }
    for (std::size_t i = 0; i < change.size(); ++i)
      change[i] += share.x * by_scaling[i] + share.y * by_turning[i];
  }

  /// What of a step is no scaling and no rotation of the map, over the map; the largest of the components.
  double relative_size(const Image& step, const Image& here, Index only) const {
    double largest = 0;
    const auto step_e = products(step.moved, step.e), step_b = products(step.moved, step.b),
               here_e = products(here.moved, here.e), here_b = products(here.moved, here.b),
               both_e = products(here.moved, step.e), both_b = products(here.moved, step.b);
    for (Index k = 0; k < num_components(); ++k) {
      if (only != kNone && k != only) continue;
      const auto in_metric = [&](const std::vector<Vec2>& e, const std::vector<Vec2>& b) {
        return e[k] + (1 / component_mass_[k]) * b[k];
      };
      const double map = in_metric(here_e, here_b).x;
      const Vec2 along = in_metric(both_e, both_b);
      const double across = in_metric(step_e, step_b).x - dot(along, along) / map;
      largest = std::max(largest, std::sqrt(std::max(0.0, across) / map));
    }
    return largest;
  }

  /// Along the best combination of the step and the one before, which becomes the step before.
  Result<void> move(const Image& here, const Image& step, Index only, Image& before) {
    const int size = before.change.empty() ? 2 : 3;
    std::vector<Gram> gram(num_components());
    const std::array<const Image*, 3> image = {&here, &step, &before};
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) {
        const auto e = products(image[i]->moved, image[j]->e), b = products(image[i]->moved, image[j]->b);
        for (Index k = 0; k < num_components(); ++k) {
          gram[k].e(i, j) = gram[k].e(j, i) = e[k].x;
          gram[k].b(i, j) = gram[k].b(j, i) = b[k].x;
        }
      }
    }
    std::vector<Vec2> share(num_components());
    for (Index k = 0; k < num_components(); ++k) {
      if (only == kNone || k == only)
        share[k] = turns_ ? Vec2{1, 0} : best_shares(gram[k], component_mass_[k], size);
    }
    const auto combined = [&](std::vector<Vec2> Image::*part) {
      std::vector<Vec2> sum(step.*part);
      for (std::size_t i = 0; i < sum.size(); ++i) {
        const Vec2 s = share[only == kNone ? component_of(i) : only];
        sum[i] = s.x * sum[i] + (size > 2 ? s.y * (before.*part)[i] : Vec2{});
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
  std::vector<double> mass_, component_mass_, shift_;
  ConformalEnergy energy_;
  ConformalSystem system_;
  std::vector<Vec2> x_;
  bool turns_ = false;  // features turn: what steps do together is not what each of them does
};

}  // namespace

std::vector<double> boundary_mass(const Workpiece& piece) {
  const Topology& topology = piece.topology();
  const OrderedMesh& mesh = piece.mesh();
  std::vector<double> mass(mesh.num_vertices(), 0);
  for (const Index c : topology.loop_corner) {
    const Index i = mesh.corner_vertex[c], j = mesh.corner_vertex[next_corner(c)];
    const double half = 0.5 * norm(mesh.position[j] - mesh.position[i]);
    mass[i] += half;
    mass[j] += half;
  }
  return mass;
}

Result<MethodMap> spectral_map(const MapInput& input, const Monitor& monitor) {
  if (input.dof) return SpectralMap(input, *input.dof, monitor)();
  const NodeMap nodes = find_nodes(input.piece.component, input.piece.topology().num_components);
  DofMap dof(nodes);
  return SpectralMap(input, dof, monitor)();
}

}  // namespace planish
