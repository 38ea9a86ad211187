#include "kernels/local/star_sums.hpp"

#include <algorithm>

namespace planish {

void gather_forces(Range r, In<Index> star_begin, In<Index> star_corner, In<Vec2> force,
                   Out<Vec2> vertex_force) {
  for (Index v = r.begin; v < r.end; ++v) {
    Vec2 sum{};
    for (Index k = star_begin[v]; k < star_begin[v + 1]; ++k) sum += force[star_corner[k]];
    vertex_force[v] = sum;
  }
}

namespace {

using Pair __attribute__((vector_size(16), aligned(8), may_alias)) = double;

/// Degree: a constant, or 0 for that of the run.
template <int Degree>
void gather_run(const StarRun& run, const Index* vertex, const std::uint16_t* slot, const Vec2* force,
                Vec2* vertex_force) {
  const Index degree = Degree > 0 ? Degree : run.degree;
  constexpr Index kAhead = 16;
  slot += run.slot_begin;
  const Index last = run.end - 1;
  for (Index i = run.begin; i < run.end; ++i, slot += degree) {
    __builtin_prefetch(&vertex_force[vertex[std::min(i + kAhead, last)]], 1);
    Pair sum{};
    for (Index k = 0; k < degree; ++k) sum += reinterpret_cast<const Pair&>(force[slot[k]]);
    reinterpret_cast<Pair&>(vertex_force[vertex[i]]) = sum;
  }
}

}  // namespace

void gather_runs(In<StarRun> runs, In<Index> vertex, In<std::uint16_t> slot, In<Vec2> force,
                 Out<Vec2> vertex_force) {
  for (const StarRun& run : runs) {
    const auto gather = [&]<int Degree>() {
      gather_run<Degree>(run, vertex.data(), slot.data(), force.data(), vertex_force.data());
    };
    switch (run.degree) {
      case 4: gather.template operator()<4>(); break;
      case 5: gather.template operator()<5>(); break;
      case 6: gather.template operator()<6>(); break;
      case 7: gather.template operator()<7>(); break;
      case 8: gather.template operator()<8>(); break;
      default: gather.template operator()<0>();
    }
  }
}

}  // namespace planish
