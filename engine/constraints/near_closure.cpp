#include "engine/constraints/near_closure.hpp"

#include <algorithm>

#include "engine/constraints/disjoint_sets.hpp"
#include "engine/features/feature_error.hpp"

namespace planish {

std::vector<PartedJoint> part_nearly_closed(const Compiled& compiled, double tolerance,
                                            const std::function<std::unique_ptr<Poses>()>& poses,
                                            Agreement& agreement, std::vector<Owner>& owners) {
  constexpr double kClosed = 1e-10;
  const auto closed = [&] {
    std::unique_ptr<Poses> result = poses();
    result->close();
    return result;
  };
  std::vector<PartedJoint> parted;
  while (true) {
    const Poses::Gaping widest = closed()->widest_joint();
    if (widest.size <= kClosed) return parted;
    const Joint joint = agreement.joints[widest.joint];
    const double size = std::min(compiled.bodies[joint.a].size, compiled.bodies[joint.b].size);
    // The gap was spread over the joints of a cycle; where one of them takes all it is at most as many times as wide.
    if (widest.size * widest.tied > tolerance * size) return parted;
    part(agreement, compiled, joint, 0);
    const std::unique_ptr<Poses> without = closed();
    const double mismatch =
        norm(without->point(joint.a, joint.place_a) - without->point(joint.b, joint.place_b));
    agreement.mismatch[joint.a] = std::max(agreement.mismatch[joint.a], mismatch);
    parted.push_back({joint, mismatch});
    owners = find_owners(compiled, agreement);
  }
}

Result<void> check_folds(const RestSurface& rest, const ConstraintView& view, const Compiled& compiled,
                         const Agreement& agreement, const std::vector<Owner>& owners, In<Vec2> point) {
  DisjointSets rigid(static_cast<Index>(compiled.bodies.size()));
  for (const Joint& joint : agreement.joints) {
    if (joint.kind == Joint::Kind::Fit) rigid.unite(joint.a, joint.b);
  }
  std::vector<Index> whole(point.size(), kNone);
  std::vector<Index> constraint_of(point.size(), kNone);
  for (const Owner& owner : owners) {
    if (compiled.bodies[owner.body].kind == Body::Kind::FreeLine) continue;
    whole[owner.vertex] = rigid.root(owner.body);
    constraint_of[owner.vertex] = compiled.bodies[owner.body].constraint;
  }
  OffendingIds folded;
  std::vector<Index> constraints;
  const In<Index> vertex = rest.mesh->corner_vertex;
  for (Index t = 0; t < static_cast<Index>(vertex.size() / 3); ++t) {
    const Index* v = &vertex[3 * static_cast<std::size_t>(t)];
    if (whole[v[0]] == kNone || whole[v[0]] != whole[v[1]] || whole[v[0]] != whole[v[2]]) continue;
    const Vec2 a = point[v[0]];
    if (cross(point[v[1]] - a, point[v[2]] - a) > 0) continue;
    folded.add(rest.mesh->triangle_origin[t]);
    for (int i = 0; i < 3; ++i) constraints.push_back(constraint_of[v[i]]);
  }
  if (folded.empty()) return {};
  Error error = conflict(*view.set, constraints,
                         "the shapes that they prescribe turn over or flatten triangles of the mesh");
  return fail(folded.of(std::move(error), ElementKind::Triangle));
}

}  // namespace planish
