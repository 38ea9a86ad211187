#include "engine/methods/filled_order.hpp"

#include "engine/solve/fill_reducing_order.hpp"
#include "engine/solve/laplacian.hpp"

namespace planish {

Result<std::vector<Index>> filled_order(const Exec& exec, const Workpiece& piece,
                                        const FilledSurface& filled) {
  const bool is_filled = filled.num_triangles() > filled.own_triangles;
  if (!is_filled && !piece.order.empty()) return piece.order;
  const std::vector<std::uint8_t> none(filled.num_vertices, 0);
  return fill_reducing_order(
      exec, vertex_laplacian(exec, filled.corner_vertex, filled.topology, none, [](Index) { return 1.0; }));
}

}  // namespace planish
