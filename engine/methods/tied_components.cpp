#include "engine/methods/tied_components.hpp"

#include "engine/constraints/disjoint_sets.hpp"

namespace planish {

std::vector<std::vector<Index>> tied_components(const MapInput& input) {
  const Index num_components = input.piece.topology().num_components;
  DisjointSets sets(num_components);
  if (input.system) {
    const Compiled& compiled = input.system->compiled();
    const auto component = [&](Index body) {
      return input.piece.component[compiled.bodies[body].vertex.front()];
    };
    for (const Relation& r : compiled.relations) {
      if (r.a != kNone) sets.unite(component(r.a), component(r.b));
    }
  }
  const std::vector<Index> label = sets.labels();
  std::vector<std::vector<Index>> groups(sets.count());
  for (Index k = 0; k < num_components; ++k) groups[label[k]].push_back(k);
  return groups;
}

}  // namespace planish
