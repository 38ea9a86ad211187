// What an input mesh had beside its shape, carried over to a finer mesh that contains it.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/model/embedding.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// The embedded mesh with the attributes, statements, uv sets, comments and warnings of the input. Attributes
/// of new vertices are interpolated linearly at their origin (integers: to the nearest, halves away from
/// zero); those of triangles come from the triangle of origin. Statements are repeated wherever neighbours in
/// the list of triangles come from parts of the input with different ones. uv sets keep their seams.
///   Pre: the embedding was made of this input.   Cost: O(V' + T' + statements), per column.
Mesh carry_over(const Exec& exec, const Mesh& input, const Embedding& embedding);

}  // namespace planish
