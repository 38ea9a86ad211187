#include "engine/prepare/connection.hpp"

#include <algorithm>

#include "kernels/intrinsic/transport.hpp"

namespace planish {

std::vector<Index> outer_loops(const Topology& topology, Index chosen) {
  std::vector<Index> outer(topology.num_components, kNone);
  for (Index l = topology.num_loops(); l-- > 0;) {  // by decreasing length
    const Index component = topology.triangle_component[topology.loop_corner[topology.loop_begin[l]] / 3];
    if (outer[component] == kNone || outer[component] != chosen) outer[component] = l;
  }
  return outer;
}

RotationRows rotation_rows(const Topology& topology, In<Index> corner_vertex, In<double> angle_sum,
                           In<Index> outer_loop) {
  const auto num_vertices = static_cast<Index>(angle_sum.size());
  RotationRows rows;
  rows.vertex_node.resize(num_vertices);
  rows.target.assign(num_vertices, 0);
  rows.outer_loop =
      outer_loop.empty() ? outer_loops(topology) : std::vector<Index>(outer_loop.begin(), outer_loop.end());
  for (Index v = 0; v < num_vertices; ++v) {
    rows.vertex_node[v] = v;
    rows.target[v] = 2 * kPi - angle_sum[v];
  }
  rows.num_nodes = num_vertices;
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const auto corners = slice(In<Index>(topology.loop_corner), topology.loops().group(l));
    const bool is_outer = l == rows.outer_loop[topology.triangle_component[corners.front() / 3]];
    double hole_target = 2 * kPi;
    for (const Index c : corners) {
      const Index v = corner_vertex[c];
      rows.vertex_node[v] = is_outer ? kNone : rows.num_nodes;
      rows.target[v] = 0;
      hole_target += kPi - angle_sum[v];
    }
    if (is_outer) continue;
    rows.target.push_back(hole_target);
    ++rows.num_nodes;
  }
  return rows;
}

double largest_residual(const SymmetricMatrix& laplacian, In<double> potential, In<double> target) {
  std::vector<double> residual(laplacian.size());
  for (Index j = 0; j < laplacian.size(); ++j) {
    const Index diagonal = laplacian.column_begin[j];
    residual[j] += laplacian.value[diagonal] * potential[j] - target[j];
    for (Index k = diagonal + 1; k < laplacian.column_begin[j + 1]; ++k) {
      residual[j] += laplacian.value[k] * potential[laplacian.row[k]];
      residual[laplacian.row[k]] += laplacian.value[k] * potential[j];
    }
  }
  double largest = 0;
  for (const double r : residual) largest = std::max(largest, std::abs(r));
  return largest;
}

std::vector<double> integrate_connection(const Topology& topology, In<Index> corner_vertex,
                                         In<RestFrame> frame, const RotationRows& rows, In<double> potential,
                                         const std::function<double(Index c)>& dual_weight) {
  const auto node_potential = [&](Index v) {
    const Index node = rows.vertex_node[v];
    return node == kNone ? 0.0 : potential[node];
  };
  std::vector<double> theta(frame.size(), 0);
  std::vector<std::uint8_t> reached(frame.size(), 0);
  std::vector<Index> queue;
  queue.reserve(frame.size());
  for (Index root = 0; root < static_cast<Index>(frame.size()); ++root) {
    if (reached[root]) continue;
    reached[root] = 1;
    std::size_t head = queue.size();
    queue.push_back(root);
    for (; head < queue.size(); ++head) {
      const Index t = queue[head];
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        const Index twin = topology.corner_twin[c];
        if (twin == kNone || reached[twin / 3]) continue;
        double angle = unfold_angle(theta[t], c, twin, frame);
        if (!potential.empty()) {
          const Index tail = corner_vertex[c], head_vertex = corner_vertex[next_corner(c)];
          angle += dual_weight(c) * (node_potential(head_vertex) - node_potential(tail));
        }
        theta[twin / 3] = reduce_angle(angle);
        reached[twin / 3] = 1;
        queue.push_back(twin / 3);
      }
    }
  }
  return theta;
}

}  // namespace planish
