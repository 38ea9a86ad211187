#include "engine/solve/weighted_steps.hpp"

#include <algorithm>

#include "engine/solve/map_energy.hpp"
#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/local/jacobians.hpp"
#include "kernels/local/proxy.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {
namespace {

class WeightedSteps {
 public:
  WeightedSteps(const Exec& exec, const ArapProblem& problem, In<std::uint8_t> settled)
      : exec_(exec),
        problem_(problem),
        settled_(settled),
        dof_(*problem.first),
        local_(exec, problem.energy),
        measure_(exec, problem.energy),
        stiffness_(problem.energy.num_triangles(), 1),
        rotation_(problem.rotation.begin(), problem.rotation.end()),
        cotangent_(problem.energy.cotangent.begin(), problem.energy.cotangent.end()),
        x_(dof_.origin()),
        force_(dof_.size()),
        change_(dof_.size()) {}

  /// The minimiser for the present rotations and weights.
  Result<void> step() {
    auto global = GlobalPhase::factor(exec_, laplacian(), problem_.order);
    if (!global) return fail(global.error());
    dof_.rebase(x_);
    const DofMap::Border border = dof_.border(corner_vertex(), *problem_.topology, weight());
    auto bordered = BorderedPhase::factor(exec_, *global, border.column, border.corner);
    if (!bordered) return fail(bordered.error());
    if (!dof_.expand(x_)) return fail(ErrorCode::InternalDefect, "poses leave their joints");
    evaluate_rotations();
    bordered->solve(exec_, force_, change_);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = x_[i] - change_[i];
    if (!dof_.expand(x_)) return fail(ErrorCode::InternalDefect, "poses leave their joints");
    return {};
  }

  Index count_flipped() const { return static_cast<Index>(measure_.flipped(vertices()).size()); }

  void double_flipped() {
    for (const Index t : measure_.flipped(vertices())) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) cotangent_[c] *= 2;
    }
  }

  void stiffen() {
    constexpr double kGain = 1, kMostGain = 5;
    const Index num_triangles = problem_.energy.num_triangles();
    std::vector<double> distortion(num_triangles);
    for (Index t = 0; t < num_triangles; ++t) {
      const auto z = image(t);
      const SingularValues s = singular_values(jacobian(problem_.energy.frame[t], z[0], z[1], z[2]));
      distortion[t] = std::abs(s.sigma_max - 1) + std::abs(s.sigma_min - 1);
    }
    for (Index t = 0; t < num_triangles; ++t) {
      double sum = 0, neighbours = 0;
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        const Index twin = problem_.topology->corner_twin[c];
        if (twin == kNone) continue;
        sum += distortion[twin / 3];
        ++neighbours;
      }
      if (neighbours == 0) continue;
      const double before = stiffness_[t];
      stiffness_[t] += std::min(kGain * std::abs(sum / neighbours - distortion[t]), kMostGain);
      for (Index c = 3 * t; c < 3 * t + 3; ++c) cotangent_[c] *= stiffness_[t] / before;
    }
  }

  void rotate() {
    exec_.for_blocks(problem_.energy.num_triangles(), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        if (!settled_.empty() && settled_[t]) continue;
        rotation_[t] =
            closest_rotation(image(t), &problem_.energy.cotangent[3 * t], problem_.energy.frame[t]);
      }
    });
  }

  /// Unweighted, per area.
  double energy() {
    return local_.evaluate(vertices(), Out<Vec2>(force_).first(dof_.num_vertices())) / problem_.energy.area;
  }

  std::vector<Vec2> take_uv() {
    x_.resize(dof_.num_vertices());
    return std::move(x_);
  }

 private:
  In<Vec2> vertices() const { return In<Vec2>(x_).first(dof_.num_vertices()); }
  In<Index> corner_vertex() const { return problem_.energy.corner_vertex; }

  std::array<Vec2, 3> image(Index t) const { return corner_images(corner_vertex(), t, x_); }

  EdgeWeight weight() const {
    return [this](Index c) { return edge_cotangent(cotangent_, c, problem_.topology->corner_twin[c]); };
  }

  SymmetricMatrix laplacian() const {
    return quotient_laplacian(exec_, corner_vertex(), *problem_.topology, dof_.nodes().node, dof_.num_nodes(),
                              weight());
  }

  void evaluate_rotations() {
    ArapEnergy weighted = problem_.energy;
    weighted.cotangent = cotangent_;
    LocalPhase(exec_, weighted)
        .evaluate_rotations(vertices(), rotation_, Out<Vec2>(force_).first(dof_.num_vertices()));
    dof_.fold(force_);
  }

  const Exec& exec_;
  const ArapProblem& problem_;
  In<std::uint8_t> settled_;
  DofMap& dof_;
  LocalPhase local_;
  MapEnergy measure_;
  std::vector<double> stiffness_;  // [T] weights against flips; in cotangent_ too
  std::vector<Vec2> rotation_;
  std::vector<double> cotangent_;  // weighted
  std::vector<Vec2> x_, force_, change_;
};

}  // namespace

Result<Minimum> weighted_global_steps(const Exec& exec, const ArapProblem& problem, In<std::uint8_t> settled,
                                      const FlattenOptions& options, const Monitor& monitor) {
  WeightedSteps steps(exec, problem, settled);
  Minimum minimum;
  minimum.gradient = kInfinity;
  for (int k = 0;; ++k) {
    if (auto done = steps.step(); !done) return fail(done.error());
    minimum.history.push_back({k, steps.energy(), kInfinity});
    const Progress progress{Phase::LocalGlobal, k, minimum.history.back().energy, kInfinity};
    if (monitor && monitor(progress) == Verdict::Stop)
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    minimum.converged = steps.count_flipped() == 0;
    if (minimum.converged || k == options.max_iterations) break;
    if (options.flips == Flips::Stiffening) {
      steps.stiffen();
    } else {
      steps.double_flipped();
    }
    steps.rotate();
  }
  minimum.uv = steps.take_uv();
  return minimum;
}

}  // namespace planish
