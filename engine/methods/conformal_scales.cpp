#include "engine/methods/conformal_scales.hpp"

#include <algorithm>
#include <optional>

#include "engine/solve/global_phase.hpp"
#include "engine/solve/laplacian.hpp"
#include "kernels/intrinsic/milnor.hpp"

namespace planish {
namespace {

constexpr double kMet = 1e-12, kAccepted = 1e-9;

/// Logarithms of a triangle's edge lengths under u, edge i opposite corner i.
std::array<double, 3> log_lengths(const ScaleProblem& problem, Index t, In<double> u) {
  std::array<double, 3> result;
  for (Index i = 0; i < 3; ++i) {
    const Index c = next_corner(3 * t + i);
    result[i] = problem.log_length[c] +
                0.5 * (u[problem.corner_vertex[c]] + u[problem.corner_vertex[next_corner(c)]]);
  }
  return result;
}

class ConformalScales {
 public:
  /// flipping: what the problem's arrays are of, where edges may be flipped
  ConformalScales(const Exec& exec, const ScaleProblem& problem, IntrinsicTriangulation* flipping)
      : exec_(exec),
        problem_(problem),
        flipping_(flipping),
        num_corners_(static_cast<Index>(problem.corner_vertex.size())),
        u_(problem.nodes->node.size(), 0),
        angle_(num_corners_),
        cotangent_(num_corners_),
        used_(problem.nodes->num_nodes, 0) {
    for (const Index k : problem.nodes->node) {
      if (k != kNone) used_[k] = 1;
    }
  }

  Result<ScaleSolution> operator()(int max_steps, const Monitor& monitor) {
    ScaleSolution solution;
    if (auto measured = measure(u_); !measured) return fail(measured.error());
    solution.defect = largest_defect();
    for (int k = 0; k < max_steps; ++k) {
      const double before = solution.defect;
      auto went = step();
      if (!went) return fail(went.error());
      solution.defect = largest_defect();
      solution.history.push_back(solution.defect);
      const Progress progress{.phase = Phase::LocalGlobal,
                              .iteration = k,
                              .energy = solution.defect,
                              .gradient = solution.defect};
      if (monitor && monitor(progress) == Verdict::Stop)
        return fail(ErrorCode::Cancelled, "stopped by the caller");
      if (!*went || solution.defect <= kMet) break;
      if (solution.defect <= kAccepted && solution.defect > 0.5 * before) break;
    }
    for (Index t = 0; 3 * t < num_corners_; ++t) {
      if (is_broken(t)) solution.broken.push_back(t);
    }
    solution.converged = solution.defect <= kAccepted && solution.broken.empty();
    solution.u = std::move(u_);
    solution.angle = std::move(angle_);
    return solution;
  }

 private:
  const ScaleNodes& nodes() const { return *problem_.nodes; }
  bool is_broken(Index t) const {
    return angle_[3 * t] == kPi || angle_[3 * t + 1] == kPi || angle_[3 * t + 2] == kPi;
  }

  /// Angles and their cotangents; of broken triangles those of a flat one, small and definite, in place of none.
  Result<void> measure(In<double> u) {
    constexpr double kFlat = 0.01;
    if (flipping_) {
      auto flips = flip_to_delaunay(exec_, u, *flipping_);
      if (!flips) return fail(flips.error());
      other_edges_ = other_edges_ || *flips > 0;
    }
    exec_.for_blocks(num_corners_ / 3, kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        const TriangleAngles triangle = triangle_angles(log_lengths(problem_, t, u));
        for (Index i = 0; i < 3; ++i) {
          angle_[3 * t + i] = triangle.angle[i];
          cotangent_[3 * t + i] =
              triangle.broken ? kFlat : std::cos(triangle.angle[i]) / std::sin(triangle.angle[i]);
        }
      }
    });
    defects();
    return {};
  }

  void defects() {
    const auto num_vertices = static_cast<Index>(u_.size());
    std::vector<double> sum(num_vertices);
    exec_.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) {
        for (const Index c :
             slice(In<Index>(problem_.topology->star_corner), problem_.topology->stars().group(v)))
          sum[v] += angle_[c];
      }
    });
    defect_.assign(nodes().num_nodes, 0);
    for (Index v = 0; v < num_vertices; ++v) {
      if (nodes().node[v] != kNone) defect_[nodes().node[v]] -= sum[v];
    }
    for (Index k = 0; k < nodes().num_nodes; ++k) {
      if (used_[k]) defect_[k] += nodes().target[k];
    }
  }

  double largest_defect() const {
    double largest = 0;
    for (const double d : defect_) largest = std::max(largest, std::abs(d));
    return largest;
  }

  double weight(Index c) const {
    const Index twin = problem_.topology->corner_twin[c];
    return 0.5 * (cotangent_[previous_corner(c)] + (twin == kNone ? 0 : cotangent_[previous_corner(twin)]));
  }

  Result<std::vector<double>> direction() {
    const SymmetricMatrix laplacian =
        quotient_laplacian(exec_, problem_.corner_vertex, *problem_.topology, nodes().node, nodes().num_nodes,
                           [&](Index c) { return weight(c); });
    if (global_ && !other_edges_) {
      if (auto again = global_->refactor(exec_, laplacian); !again) return fail(again.error());
    } else {
      auto global = GlobalPhase::factor(exec_, laplacian, problem_.order);
      if (!global) return fail(global.error());
      global_.emplace(std::move(*global));
      other_edges_ = false;
    }
    std::vector<Vec2> x(nodes().num_nodes);
    for (Index k = 0; k < nodes().num_nodes; ++k) x[k] = {-defect_[k], 0};
    global_->solve(exec_, x, x);
    std::vector<double> along(u_.size(), 0);
    for (std::size_t v = 0; v < u_.size(); ++v) {
      if (nodes().node[v] != kNone) along[v] = x[nodes().node[v]].x;
    }
    return along;
  }

  /// Derivative of the energy along a direction, where the defects are now.
  double slope(In<double> along) const {
    std::vector<double> by_node(nodes().num_nodes, 0);
    for (std::size_t v = 0; v < u_.size(); ++v) {
      if (nodes().node[v] != kNone) by_node[nodes().node[v]] = along[v];
    }
    double sum = 0;
    for (Index k = 0; k < nodes().num_nodes; ++k) sum += 0.5 * defect_[k] * by_node[k];
    return sum;
  }

  /// Along Newton's direction until the energy falls enough, or its slope does: near the minimum the energy's own rounding hides
  /// what is left. False where neither does.
  Result<bool> step() {
    auto along = direction();
    if (!along) return fail(along.error());
    const double energy = conformal_energy(exec_, problem_, u_), steepness = slope(*along);
    std::vector<double> trial(u_.size());
    constexpr int kHalvings = 30;
    double share = 1;
    for (int k = 0; k < kHalvings; ++k, share *= 0.5) {
      for (std::size_t v = 0; v < u_.size(); ++v) trial[v] = u_[v] + share * (*along)[v];
      if (auto measured = measure(trial); !measured) return fail(measured.error());
      const bool lower = conformal_energy(exec_, problem_, trial) < energy + 1e-4 * share * steepness;
      const bool flatter = std::abs(slope(*along)) <= 0.5 * std::abs(steepness);
      if (!lower && !flatter) continue;
      u_ = trial;
      return true;
    }
    return measure(u_).map([] { return false; });
  }

  const Exec& exec_;
  const ScaleProblem& problem_;
  IntrinsicTriangulation* flipping_;
  Index num_corners_;
  std::vector<double> u_, angle_, cotangent_, defect_;
  std::vector<std::uint8_t> used_;  // nodes that have vertices
  std::optional<GlobalPhase> global_;
  bool other_edges_ = false;  // than those that were factored
};

}  // namespace

double conformal_energy(const Exec& exec, const ScaleProblem& problem, In<double> u) {
  const ScaleNodes& nodes = *problem.nodes;
  const auto num_triangles = static_cast<Index>(problem.corner_vertex.size() / 3);
  double sum = exec.sum_blocks(num_triangles, kBlock, [&](Range r) {
    double part = 0;
    for (Index t = r.begin; t < r.end; ++t) {
      const std::array<double, 3> length = log_lengths(problem, t, u);
      const TriangleAngles triangle = triangle_angles(length);
      for (Index i = 0; i < 3; ++i) {
        part += (triangle.angle[i] - 0.5 * kPi) * length[i] + lobachevsky(triangle.angle[i]);
      }
    }
    return part;
  });
  std::vector<double> of_node(nodes.num_nodes, 0);
  for (std::size_t v = 0; v < u.size(); ++v) {
    if (nodes.node[v] != kNone) of_node[nodes.node[v]] = u[v];
  }
  for (Index k = 0; k < nodes.num_nodes; ++k) sum += 0.5 * nodes.target[k] * of_node[k];
  return sum;
}

Result<ScaleSolution> solve_scales(const Exec& exec, const ScaleProblem& problem, int max_steps,
                                   const Monitor& monitor) {
  return ConformalScales(exec, problem, nullptr)(max_steps, monitor);
}

Result<ScaleSolution> solve_scales(const Exec& exec, IntrinsicTriangulation& triangulation,
                                   const ScaleNodes& nodes, In<Index> order, int max_steps,
                                   const Monitor& monitor) {
  const ScaleProblem problem{.corner_vertex = triangulation.corner_vertex,
                             .topology = &triangulation.topology,
                             .log_length = triangulation.log_length,
                             .nodes = &nodes,
                             .order = order};
  return ConformalScales(exec, problem, &triangulation)(max_steps, monitor);
}

}  // namespace planish
