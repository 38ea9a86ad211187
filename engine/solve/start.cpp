#include "engine/solve/start.hpp"

#include <algorithm>
#include <optional>

#include "engine/solve/dual_weights.hpp"
#include "engine/solve/laplacian.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {
namespace {

/// Of rows that merge no vertices.
SymmetricMatrix laplacian_of_vertices(const Exec& exec, const StartInput& input, const RotationRows& rows,
                                      const EdgeWeight& weight) {
  std::vector<std::uint8_t> held;
  for (const Index node : rows.vertex_node) held.push_back(node == kNone);
  return held_laplacian(exec, input.corner_vertex, *input.topology, held, weight);
}

Result<std::vector<double>> solve_rotation_rows(const Exec& exec, const StartInput& input,
                                                const RotationRows& rows, const EdgeWeight& weight,
                                                GlobalPhase* analysed, double& residual) {
  const bool merges_none = rows.num_nodes == static_cast<Index>(rows.vertex_node.size());
  const bool serves = analysed != nullptr && merges_none;
  const SymmetricMatrix laplacian = serves ? laplacian_of_vertices(exec, input, rows, weight)
                                           : quotient_laplacian(exec, input.corner_vertex, *input.topology,
                                                                rows.vertex_node, rows.num_nodes, weight);
  std::optional<GlobalPhase> own;
  if (serves) {
    if (auto factored = analysed->refactor(exec, laplacian); !factored) return fail(factored.error());
  } else {
    auto factored = GlobalPhase::factor(exec, laplacian, input.order);
    if (!factored) return fail(factored.error());
    own.emplace(std::move(*factored));
  }
  std::vector<Vec2> x(rows.num_nodes);
  for (Index j = 0; j < rows.num_nodes; ++j) x[j] = {rows.target[j], 0};
  (own ? *own : *analysed).solve(exec, x, x);
  std::vector<double> potential(rows.num_nodes);
  for (Index j = 0; j < rows.num_nodes; ++j) potential[j] = x[j].x;
  residual = largest_residual(laplacian, potential, rows.target);
  if (!(residual <= kLargestRotationResidual)) {
    return fail(ErrorCode::ResidualTooLarge,
                "rotations miss their rows by " + std::to_string(residual) + " radians, 1e-9 is allowed");
  }
  return potential;
}

/// The boundary's outer loops on circles by arc length, of the component's area; everything else harmonic.
Result<std::vector<Vec2>> harmonic_map(const Exec& exec, const StartInput& input, In<Index> outer_loop,
                                       const EdgeWeight& weight) {
  const Topology& topology = *input.topology;
  const auto num_vertices = static_cast<Index>(input.angle_sum.size());
  std::vector<double> component_area(topology.num_components, 0);
  for (std::size_t t = 0; t < input.frame.size(); ++t) {
    component_area[topology.triangle_component[t]] += area(input.frame[t]);
  }
  std::vector<std::uint8_t> fixed(num_vertices, 0);
  std::vector<Vec2> uv(num_vertices);
  for (Index k = 0; k < topology.num_components; ++k) {
    const double radius = std::sqrt(component_area[k] / kPi);
    double along = 0;
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(outer_loop[k]))) {
      const Index v = input.corner_vertex[c];
      fixed[v] = 1;
      uv[v] = radius * unit(2 * kPi * along / topology.loop_length[outer_loop[k]]);
      along += norm(edge_vectors(input.frame[c / 3])[c % 3]);
    }
  }
  std::vector<Vec2> rhs = uv;
  exec.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      if (fixed[v]) continue;
      for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
        const Index u = input.corner_vertex[next_corner(c)];
        if (fixed[u]) rhs[v] += weight(c) * uv[u];
        const Index arriving = previous_corner(c), w = input.corner_vertex[arriving];
        if (topology.corner_twin[arriving] == kNone && fixed[w]) rhs[v] += weight(arriving) * uv[w];
      }
    }
  });
  auto global = GlobalPhase::factor(
      exec, vertex_laplacian(exec, input.corner_vertex, topology, fixed, weight), input.order);
  if (!global) return fail(global.error());
  global->solve(exec, rhs, uv);
  return uv;
}

std::vector<Vec2> closest_rotations(const Exec& exec, const StartInput& input, In<Vec2> uv) {
  std::vector<Vec2> rotation(input.frame.size());
  exec.for_blocks(static_cast<Index>(input.frame.size()), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      rotation[t] = closest_rotation({uv[input.corner_vertex[3 * t]], uv[input.corner_vertex[3 * t + 1]],
                                      uv[input.corner_vertex[3 * t + 2]]},
                                     &input.cotangent[3 * t], input.frame[t]);
    }
  });
  return rotation;
}

}  // namespace

Result<std::vector<Vec2>> harmonic_rotations(const Exec& exec, const StartInput& input,
                                             In<Index> outer_loop) {
  const FlooredWeights floored(exec, input);
  auto uv = harmonic_map(exec, input, outer_loop, std::cref(floored));
  if (!uv) return fail(uv.error());
  return closest_rotations(exec, input, *uv);
}

Result<Start> first_rotations(const Exec& exec, const StartInput& input, Init init, GlobalPhase* analysed) {
  RotationRows rows = rotation_rows(*input.topology, input.corner_vertex, input.angle_sum, input.outer_loop);
  Start start;
  const FlooredWeights floored(exec, input);
  if (init == Init::Harmonic) {
    auto rotation = harmonic_rotations(exec, input, rows.outer_loop);
    if (!rotation) return fail(rotation.error());
    start.rotation = std::move(*rotation);
  } else {
    const EdgeWeight weight =
        init == Init::Cotangent ? EdgeWeight(std::cref(floored)) : EdgeWeight([](Index) { return 1.0; });
    std::vector<double> potential;
    if (init != Init::Identity) {
      auto solved = solve_rotation_rows(exec, input, rows, weight, analysed, start.holonomy_residual);
      if (!solved) return fail(solved.error());
      potential = std::move(*solved);
    }
    const auto theta =
        integrate_connection(*input.topology, input.corner_vertex, input.frame, rows, potential, weight);
    start.rotation.resize(theta.size());
    exec.for_blocks(static_cast<Index>(theta.size()), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) start.rotation[t] = unit(theta[t]);
    });
  }
  start.outer_loop = std::move(rows.outer_loop);
  return start;
}

}  // namespace planish
