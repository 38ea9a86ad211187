#include "engine/methods/tied_components.hpp"

#include <map>
#include <string>

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

Result<void> check_scale_groups(const MapInput& input) {
  if (!input.system) return {};
  std::map<std::string, Index> component_of;
  for (const Body& body : input.system->compiled().bodies) {
    if (body.scale_group.empty()) continue;
    const Index component = input.piece.component[body.vertex.front()];
    const auto [first, is_new] = component_of.emplace(body.scale_group, component);
    if (!is_new && first->second != component)
      return fail(constraint_error(
          ErrorCode::ConstraintUnsupported, *input.view->set, body.constraint,
          "the scale group \"" + body.scale_group +
              "\" joins features of several components, whose sizes conformal maps choose each by itself; "
              "give each component a group of its own, or use --method arap"));
  }
  return {};
}

}  // namespace planish
