// Where each vertex and triangle of the written mesh lies on the mesh that was read, through repair and embedding.
#pragma once

#include <vector>

#include "app/common.hpp"
#include "engine/model/embedding.hpp"

namespace planish {

/// Empty columns where the mesh is written as it was read.
struct Provenance {
  std::vector<Index> triangle_origin;         ///< [T] of the file
  std::vector<Index> vertex_origin_triangle;  ///< [V] a triangle of the file with the vertex, or kNone
  std::vector<Vec3> vertex_barycentric;       ///< [V] its barycentric coordinates there
};

/// embedding: of input.mesh, or null.
Provenance provenance_of(const Input& input, const Embedding* embedding);

}  // namespace planish
