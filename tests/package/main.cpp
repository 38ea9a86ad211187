#include <cstdio>
#include <planish/engine/flatten.hpp>

int main() {
  planish::Mesh tent;
  tent.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.5}};
  tent.corner_vertex = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
  const auto flat = planish::flatten(tent.surface());
  if (!flat) return std::puts(planish::describe(flat.error()).c_str()), 1;
  std::printf("arap %.6f, flipped %ld\n", flat->certificate.arap,
              static_cast<long>(flat->certificate.flipped_triangles));
}
