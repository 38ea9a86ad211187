#include "engine/solve/tutte.hpp"

#include "engine/solve/columns.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {
namespace {

/// Vertices of a loop in its direction, the surface to the left.
std::vector<Index> loop_vertices(const StartInput& input, Index loop) {
  std::vector<Index> vertices;
  for (const Index c : slice(In<Index>(input.topology->loop_corner), input.topology->loops().group(loop)))
    vertices.push_back(input.corner_vertex[c]);
  return vertices;
}

struct TutteSystem {
  std::vector<std::uint8_t> fixed;         // [V]
  std::vector<Vec2> place;                 // [V] of the fixed ones
  std::vector<Index> middle;               // [V] the node that closes the vertex's loop, kNone: none
  std::vector<std::vector<Index>> around;  // of the nodes beyond the vertices
};

TutteSystem set_up(const StartInput& input) {
  const Topology& topology = *input.topology;
  const auto num_vertices = static_cast<Index>(input.angle_sum.size());
  TutteSystem system{.fixed = std::vector<std::uint8_t>(num_vertices, 0),
                     .place = std::vector<Vec2>(num_vertices),
                     .middle = std::vector<Index>(num_vertices, kNone),
                     .around = {}};
  std::vector<double> component_area(topology.num_components, 0);
  for (std::size_t t = 0; t < input.frame.size(); ++t)
    component_area[topology.triangle_component[t]] += area(input.frame[t]);
  std::vector<std::uint8_t> is_outer(topology.num_loops(), 0);
  for (Index k = 0; k < topology.num_components; ++k) {
    is_outer[input.outer_loop[k]] = 1;
    const std::vector<Index> loop = loop_vertices(input, input.outer_loop[k]);
    const double radius = std::sqrt(component_area[k] / kPi);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      system.fixed[loop[i]] = 1;
      system.place[loop[i]] =
          radius * unit(2 * kPi * static_cast<double>(i) / static_cast<double>(loop.size()));
    }
  }
  for (Index l = 0; l < topology.num_loops(); ++l) {
    if (is_outer[l]) continue;
    for (const Index v : loop_vertices(input, l))
      system.middle[v] = num_vertices + static_cast<Index>(system.around.size());
    system.around.push_back(loop_vertices(input, l));
  }
  return system;
}

}  // namespace

Result<std::vector<Vec2>> tutte_map(const Exec& exec, const StartInput& input) {
  const TutteSystem system = set_up(input);
  const Topology& topology = *input.topology;
  const auto num_vertices = static_cast<Index>(system.fixed.size());
  const Index num_nodes = num_vertices + static_cast<Index>(system.around.size());
  std::vector<Vec2> x(num_nodes);
  const auto visit_neighbours = [&](Index v, auto&& visit) {
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
      visit(input.corner_vertex[next_corner(c)]);
      const Index arriving = previous_corner(c);
      if (topology.corner_twin[arriving] == kNone) visit(input.corner_vertex[arriving]);
    }
    if (system.middle[v] != kNone) visit(system.middle[v]);
  };
  const SymmetricMatrix laplacian = gather_columns(exec, num_nodes, [&](Range r, ColumnSink& sink) {
    std::vector<Entry> column;
    for (Index j = r.begin; j < r.end; ++j) {
      column.assign(1, {j, 0});
      const auto add = [&](Index i) {
        column.front().value += 1;
        if (i < num_vertices && system.fixed[i]) {
          x[j] += system.place[i];
        } else if (i > j) {
          column.push_back({i, -1});
        }
      };
      if (j >= num_vertices) {
        for (const Index v : system.around[j - num_vertices]) add(v);
      } else if (system.fixed[j]) {
        column.front().value = 1;
        x[j] = system.place[j];
      } else {
        visit_neighbours(j, add);
      }
      merge_rows(column);
      sink.add(column);
    }
  });
  auto global = GlobalPhase::factor(exec, laplacian, input.order);
  if (!global) return fail(global.error());
  global->solve(exec, x, x);
  x.resize(num_vertices);
  return x;
}

}  // namespace planish
