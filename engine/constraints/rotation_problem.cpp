#include "engine/constraints/rotation_problem.hpp"

#include <algorithm>
#include <map>

#include "engine/constraints/disjoint_sets.hpp"
#include "engine/features/feature_error.hpp"
#include "engine/prepare/connection.hpp"
#include "engine/solve/dual_weights.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

/// Sums of angles that differ by less agree.
constexpr double kAngleSum = 1e-7;

}  // namespace

Result<RotationProblem> RotationProblem::make(const Exec& exec, const RestSurface& rest,
                                              const StartInput& input, const Layout& layout, Init init) {
  RotationProblem problem(exec, rest, input);
  if (init == Init::Cotangent) problem.weight_ = FlooredWeights(exec, input);
  problem.sectors_ = find_sectors(*input.topology, input.corner_vertex, layout.fixed_edge);
  problem.number_nodes();
  problem.find_parts();
  problem.walk_tree();
  const Sectors& sectors = problem.sectors_;
  problem.laplacian_ = quotient_laplacian(
      exec, sectors.corner_sector, sectors.opened, problem.node_, problem.num_nodes_,
      [&](Index c) { return sectors.opened.corner_twin[c] == kNone ? 0.0 : problem.weight_(c); });
  auto global = GlobalPhase::factor(exec, problem.laplacian_, sector_order(sectors, input.order));
  if (!global) return fail(global.error());
  problem.global_.emplace(std::move(*global));
  return problem;
}

void RotationProblem::number_nodes() {
  const Topology& topology = *input_.topology;
  const Index n = sectors_.num_sectors();
  node_.assign(n, kNone);
  num_nodes_ = n;
  sector_angle_.assign(n, 0);
  for (std::size_t c = 0; c < sectors_.corner_sector.size(); ++c)
    sector_angle_[sectors_.corner_sector[c]] += corner_angles(rest_.frame[c / 3])[c % 3];
  std::vector<Index> hole_node(topology.num_loops(), kNone);
  for (Index s = 0; s < n; ++s) {
    if (sectors_.rowless[s]) continue;
    const Index v = sectors_.vertex[s], loop = rest_.loop_of[v];
    if (loop == kNone || sectors_.is_prescribed(s)) {
      node_[s] = s;
      continue;
    }
    const Index component = topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3];
    if (loop == rest_.outer_loop[component]) continue;
    if (hole_node[loop] == kNone) {
      hole_node[loop] = num_nodes_++;
      hole_of_node_.push_back(loop);
    }
    node_[s] = hole_node[loop];
  }
}

/// Parts of the graph of rows that are not joined to ground have one row too many.
void RotationProblem::find_parts() {
  const Index ground = num_nodes_;
  DisjointSets sets(num_nodes_ + 1);
  const auto place = [&](Index corner) {
    const Index node = node_[sectors_.corner_sector[corner]];
    return node == kNone ? ground : node;
  };
  for (Index c = 0; c < static_cast<Index>(sectors_.corner_sector.size()); ++c) {
    if (sectors_.opened.corner_twin[c] != kNone) sets.unite(place(c), place(next_corner(c)));
  }
  std::map<Index, Index> part_of_root;
  const Index grounded = sets.root(ground);
  for (Index s = 0; s < sectors_.num_sectors(); ++s) {
    if (node_[s] == kNone || sets.root(node_[s]) == grounded) continue;
    const auto [entry, added] =
        part_of_root.try_emplace(sets.root(node_[s]), static_cast<Index>(part_.size()));
    if (added) part_.emplace_back();
    part_[entry->second].sector.push_back(s);
    part_[entry->second].node.push_back(node_[s]);
  }
  for (Part& part : part_) {
    std::sort(part.node.begin(), part.node.end());
    part.node.erase(std::unique(part.node.begin(), part.node.end()), part.node.end());
    for (const Index s : part.sector) {
      if (node_[s] == part.node.front()) node_[s] = kNone;
    }
  }
}

/// Breadth first over the triangles of each component, across all its edges.
void RotationProblem::walk_tree() {
  const auto num_triangles = static_cast<Index>(rest_.frame.size());
  parent_.assign(num_triangles, kNone);
  std::vector<std::uint8_t> reached(num_triangles, 0);
  tree_order_.reserve(num_triangles);
  for (Index root = 0; root < num_triangles; ++root) {
    if (reached[root]) continue;
    reached[root] = 1;
    std::size_t head = tree_order_.size();
    tree_order_.push_back(root);
    for (; head < tree_order_.size(); ++head) {
      const Index t = tree_order_[head];
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        const Index twin = input_.topology->corner_twin[c];
        if (twin == kNone || reached[twin / 3]) continue;
        reached[twin / 3] = 1;
        parent_[twin / 3] = c;
        tree_order_.push_back(twin / 3);
      }
    }
  }
}

std::vector<double> RotationProblem::bends(const Layout& layout) const {
  std::vector<double> bend(sectors_.num_sectors(), 0);
  const auto off = [&](Index c) {
    return reduce_angle(laid_out_rotation(layout, rest_, c) - edge_rotation(layout, rest_, c));
  };
  for (Index c = 0; c < static_cast<Index>(sectors_.corner_sector.size()); ++c) {
    if (!layout.fixed_triangle[c / 3]) continue;
    const Index arriving = previous_corner(c);
    if (layout.fixed_edge[c]) bend[sectors_.corner_sector[c]] -= off(c);
    if (layout.fixed_edge[arriving]) bend[sectors_.corner_sector[c]] += off(arriving);
  }
  return bend;
}

Result<std::vector<double>> RotationProblem::targets(const Layout& layout, std::vector<Index>& at) const {
  const Index n = sectors_.num_sectors();
  std::vector<double> sector_target(n, 0), vertex_sum(sectors_.num_vertices, 0);
  std::vector<double> hole_target;
  std::map<Index, std::size_t> hole_number;
  for (const Index loop : hole_of_node_) {
    hole_number.emplace(loop, hole_target.size());
    double target = 2 * kPi;
    for (const Index c : slice(In<Index>(input_.topology->loop_corner), input_.topology->loops().group(loop)))
      target += kPi - input_.angle_sum[input_.corner_vertex[c]];
    hole_target.push_back(target);
  }
  const std::vector<double> bend = bends(layout);
  for (Index s = 0; s < n; ++s) {
    const Index v = sectors_.vertex[s], loop = rest_.loop_of[v];
    const auto hole = hole_number.find(loop);
    if (loop == kNone && sectors_.from[s] == kNone) {
      sector_target[s] = 2 * kPi - sector_angle_[s];
    } else if (sectors_.is_prescribed(s)) {
      const double angle = prescribed_angle(layout, sectors_, s, sector_angle_[s]);
      sector_target[s] = angle - sector_angle_[s];
      vertex_sum[v] += angle;
      if (hole != hole_number.end()) hole_target[hole->second] -= sector_target[s];
      sector_target[s] += bend[s];
    } else if (hole != hole_number.end()) {
      hole_target[hole->second] += bend[s];
    }
  }
  for (Index v = 0; v < sectors_.num_vertices; ++v) {
    const bool whole = rest_.loop_of[v] == kNone && vertex_sum[v] > 0;
    if (!whole || std::abs(vertex_sum[v] - 2 * kPi) <= kAngleSum) continue;
    at = {v};
    return fail(ErrorCode::ConstraintsConflict, "the angles that they prescribe around a vertex sum to " +
                                                    in_words(vertex_sum[v] * 180 / kPi) +
                                                    " degrees, not 360");
  }
  std::vector<double> target(num_nodes_, 0);
  for (Index s = 0; s < n; ++s) {
    if (!sectors_.rowless[s] && (rest_.loop_of[sectors_.vertex[s]] == kNone || sectors_.is_prescribed(s)))
      target[s] = sector_target[s];
  }
  for (std::size_t h = 0; h < hole_target.size(); ++h) target[n + static_cast<Index>(h)] = hole_target[h];
  if (auto checked = check_parts(target, at); !checked) return fail(checked.error());
  for (const Part& part : part_) target[part.node.front()] = 0;
  return target;
}

Result<void> RotationProblem::check_parts(In<double> target, std::vector<Index>& at) const {
  for (const Part& part : part_) {
    double sum = 0;
    for (const Index node : part.node) sum += target[node];
    if (std::abs(sum) <= kAngleSum) continue;
    for (const Index s : part.sector) {
      if (sectors_.from[s] != kNone) at.push_back(sectors_.vertex[s]);
    }
    return fail(ErrorCode::ConstraintsConflict,
                "the angles that they prescribe around a part of the surface sum to " +
                    in_words(sum * 180 / kPi) + " degrees more than its curvature allows");
  }
  return {};
}

double RotationProblem::step(In<double> potential, Index c) const {
  const auto at = [&](Index corner) {
    const Index node = node_[sectors_.corner_sector[corner]];
    return node == kNone ? 0.0 : potential[node];
  };
  return weight_(c) * (at(next_corner(c)) - at(c));
}

std::vector<double> RotationProblem::integrate(const Layout& layout, In<double> potential,
                                               In<double> extra) const {
  std::vector<double> theta(rest_.frame.size(), 0);
  for (const Index t : tree_order_) {
    const Index c = parent_[t];
    if (c == kNone) continue;
    const Index twin = input_.topology->corner_twin[c];
    double angle = 0;
    if (layout.fixed_edge[c]) {
      angle = theta[c / 3] - laid_out_rotation(layout, rest_, c) + laid_out_rotation(layout, rest_, twin);
    } else {
      angle = unfold_angle(theta[c / 3], c, twin, rest_.frame) + step(potential, c);
    }
    if (!extra.empty()) angle += extra[t];
    theta[t] = reduce_angle(angle);
  }
  return theta;
}

Result<Rotations> RotationProblem::solve(const Layout& layout, std::vector<Index>& at) const {
  const auto target = targets(layout, at);
  if (!target) return fail(target.error());
  std::vector<Vec2> x(num_nodes_);
  for (Index j = 0; j < num_nodes_; ++j) x[j] = {(*target)[j], 0};
  global_->solve(*exec_, x, x);
  Rotations result;
  result.potential.resize(num_nodes_);
  for (Index j = 0; j < num_nodes_; ++j) result.potential[j] = x[j].x;
  result.residual = largest_residual(laplacian_, result.potential, *target);
  if (!(result.residual <= kLargestRotationResidual)) {
    return fail(
        ErrorCode::ResidualTooLarge,
        "rotations miss their rows by " + std::to_string(result.residual) + " radians, 1e-9 is allowed");
  }
  result.theta = integrate(layout, result.potential, {});
  return result;
}

Result<Rotations> RotationProblem::adjust(const Layout& layout, const Rotations& base,
                                          const std::vector<PathRow>& rows) const {
  // Row k as coefficients of the w of tree edges, known by the triangles that they lead to.
  std::vector<std::map<Index, double>> coefficient(rows.size());
  std::vector<SparseColumn> column(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (const PathRow::End& end : rows[k].end) {
      for (Index t = end.triangle; parent_[t] != kNone; t = parent_[t] / 3) {
        if (!layout.fixed_edge[parent_[t]]) coefficient[k][t] += end.sign;
      }
    }
    std::erase_if(coefficient[k], [](const auto& entry) { return entry.second == 0; });
    std::map<Index, double> entry;  // per node
    for (const auto& [t, sign] : coefficient[k]) {
      const Index c = parent_[t];
      const auto add = [&](Index corner, double value) {
        const Index node = node_[sectors_.corner_sector[corner]];
        if (node != kNone) entry[node] += value;
      };
      add(next_corner(c), sign * weight_(c));
      add(c, -sign * weight_(c));
    }
    for (const auto& [node, value] : entry) {
      column[k].row.push_back(node);
      column[k].value.push_back({value, 0});
    }
  }
  const std::size_t m = rows.size();
  std::vector<double> corner(m * m, 0), change(m);
  for (std::size_t k = 0; k < m; ++k) {
    change[k] = rows[k].change;
    for (std::size_t l = 0; l <= k; ++l) {
      double sum = 0;
      for (const auto& [t, sign] : coefficient[k]) {
        if (const auto other = coefficient[l].find(t); other != coefficient[l].end())
          sum += sign * other->second * weight_(parent_[t]);
      }
      corner[k * m + l] = corner[l * m + k] = sum;
    }
  }
  auto bordered = BorderedPhase::factor(*exec_, *global_, column, corner);
  if (!bordered) return fail(bordered.error());
  std::vector<Vec2> x(num_nodes_);
  std::vector<double> multiplier(m);
  bordered->solve(*exec_, x, change, x, multiplier);
  Rotations result = base;
  for (Index j = 0; j < num_nodes_; ++j) result.potential[j] += x[j].x;
  std::vector<double> extra(rest_.frame.size(), 0);
  for (std::size_t k = 0; k < m; ++k) {
    for (const auto& [t, sign] : coefficient[k]) extra[t] += multiplier[k] * sign * weight_(parent_[t]);
  }
  result.theta = integrate(layout, result.potential, extra);
  return result;
}

}  // namespace planish
