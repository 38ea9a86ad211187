// What the solver's benchmarks work on: the Laplacian of a scan-like panel, and orders of its rows.
#pragma once

#include <cstdlib>
#include <functional>
#include <string>

#include "engine/sample/panels.hpp"
#include "engine/solve/laplacian.hpp"
#include "engine/workpiece.hpp"
#include "io/mesh_files.hpp"

namespace planish::perf {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "wrong answer: %s\n", what);
  std::exit(1);
}

/// PLANISH_PERF_MESH, or a sampled bonnet of so many triangles.
inline Mesh perf_mesh(const Exec& exec, Index triangles) {
  if (const char* path = std::getenv("PLANISH_PERF_MESH")) {
    auto mesh = read_mesh(exec, path);
    require(mesh.has_value(), path);
    return std::move(*mesh);
  }
  auto sample = make_sample(
      exec, {.kind = "hood", .triangles = triangles, .noise = 0.0002, .seed = 1, .feature_count = 0});
  require(sample.has_value(), "sample");
  return std::move(sample->mesh);
}

/// The cotangent Laplacian with the first vertex of each component held, as the global phase has it.
inline SymmetricMatrix held_laplacian(const Exec& exec, const Workpiece& piece) {
  std::vector<std::uint8_t> held(piece.mesh().num_vertices(), 0), seen(held.size(), 0);
  for (std::size_t v = 0; v < held.size(); ++v) {
    held[v] = !seen[piece.component[v]];
    seen[piece.component[v]] = 1;
  }
  return vertex_laplacian(exec, piece.mesh().corner_vertex, piece.topology(), held,
                          [&](Index c) { return piece.edge_weight(c); });
}

/// Two real unknowns a vertex, every pair of neighbours a full 2 x 2 block, definite: the pattern of a Newton step.
inline SymmetricMatrix newton_like(const SymmetricMatrix& laplacian) {
  SymmetricMatrix matrix;
  matrix.column_begin = {0};
  for (Index j = 0; j < laplacian.size(); ++j) {
    for (Index d = 0; d < 2; ++d) {
      for (Index k = laplacian.column_begin[j]; k < laplacian.column_begin[j + 1]; ++k) {
        for (Index e = laplacian.row[k] == j ? d : 0; e < 2; ++e) {
          matrix.row.push_back(2 * laplacian.row[k] + e);
          matrix.value.push_back(laplacian.value[k] * (d == e ? 1 : 0.3));
        }
      }
      matrix.column_begin.push_back(static_cast<Index>(matrix.row.size()));
    }
  }
  return matrix;
}

inline std::vector<Index> in_pairs(In<Index> order) {
  std::vector<Index> pairs;
  for (const Index v : order) pairs.push_back(2 * v), pairs.push_back(2 * v + 1);
  return pairs;
}

}  // namespace planish::perf
