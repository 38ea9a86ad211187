#include "engine/constraints/poses.hpp"

#include <map>
#include <numeric>

#include "engine/constraints/disjoint_sets.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

/// Bodies that share a scale group.
using ScaleGroups = std::map<std::string, Index>;  // slot

bool is_pin(const Joint& joint) { return joint.kind == Joint::Kind::Pin || joint.kind == Joint::Kind::Fixed; }

}  // namespace

Clusters separate_clusters(std::size_t num_bodies) {
  Clusters clusters{.of = std::vector<Index>(num_bodies),
                    .offset = std::vector<double>(num_bodies, 0),
                    .directed = std::vector<std::uint8_t>(num_bodies, 0)};
  std::iota(clusters.of.begin(), clusters.of.end(), 0);
  return clusters;
}

Assemblies find_assemblies(const Compiled& compiled, const Agreement& agreement) {
  DisjointSets sets(static_cast<Index>(compiled.bodies.size()));
  for (const Joint& joint : agreement.joints) {
    if (joint.b != kNone) sets.unite(joint.a, joint.b);
  }
  Assemblies assemblies;
  assemblies.of = sets.labels();
  assemblies.pinned.assign(sets.count(), 0);
  for (const Joint& joint : agreement.joints) {
    if (is_pin(joint)) assemblies.pinned[assemblies.of[joint.a]] = 1;
  }
  return assemblies;
}

Poses::Poses(const Compiled& compiled, const Agreement& agreement, const Assemblies& assemblies,
             const Clusters& clusters, In<double> angle)
    : compiled_(&compiled), agreement_(&agreement), assemblies_(&assemblies) {
  lay_out_slots(clusters, angle);
  place_over_joints();
  base_ = value_;
  group_slots();
}

Poses::~Poses() = default;

Index Poses::add_slot(double value) {
  value_.push_back(value);
  return static_cast<Index>(value_.size()) - 1;
}

void Poses::lay_out_slots(const Clusters& clusters, In<double> angle) {
  const std::vector<Body>& bodies = compiled_->bodies;
  std::vector<Index> members(clusters.size(), 0);
  std::vector<Vec2> mean(clusters.size());  // of the directions that the members ask the cluster for
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    ++members[clusters.of[b]];
    mean[clusters.of[b]] += bodies[b].size * unit(angle[b] - clusters.offset[b]);
  }
  std::vector<Index> angle_slot(clusters.size(), kNone);
  ScaleGroups scale_groups;
  std::vector<std::uint8_t> has_root(assemblies_->size(), 0);
  slots_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    PoseSlots& s = slots_[b];
    const Index cluster = clusters.of[b], assembly = assemblies_->of[b];
    if (assemblies_->pinned[assembly] || has_root[assembly]) {
      s.p = add_slot(0);
      add_slot(0);
    }
    has_root[assembly] = 1;
    const bool alone = members[cluster] == 1 && !clusters.directed[cluster] && body.scale_group.empty();
    if (!body.scale && alone) {
      const Vec2 c = unit(angle[b]);
      s.c = add_slot(c.x);
      add_slot(c.y);
      continue;
    }
    if (body.scale) {
      s.scale = *body.scale;
    } else if (body.scale_group.empty()) {
      s.scale_slot = add_slot(1);
    } else {
      const auto [entry, added] = scale_groups.try_emplace(body.scale_group, kNone);
      if (added) entry->second = add_slot(1);
      s.scale_slot = entry->second;
    }
    s.offset = clusters.offset[b];
    if (!clusters.directed[cluster]) {
      if (angle_slot[cluster] == kNone) angle_slot[cluster] = add_slot(argument(mean[cluster]));
      s.angle_slot = angle_slot[cluster];
    }
    if (body.kind != Body::Kind::FreeLine) continue;
    s.tau.assign(body.vertex.size(), kNone);
    for (std::size_t i = 1; i < body.vertex.size(); ++i) s.tau[i] = add_slot(body.shape[i].x);
  }
}

/// From body to body over joints, so that each first meets one joint that it has: what is left to Newton steps are the
/// cycles.
void Poses::place_over_joints() {
  const std::vector<Joint>& joints = agreement_->joints;
  std::vector<std::vector<Index>> joints_of(slots_.size());
  std::vector<std::uint8_t> placed(slots_.size(), 0);
  std::vector<Index> queue;
  const auto place = [&](Index b, Vec2 p) {
    placed[b] = 1;
    queue.push_back(b);
    if (slots_[b].p == kNone) return;
    value_[slots_[b].p] = p.x;
    value_[slots_[b].p + 1] = p.y;
  };
  for (Index k = 0; k < static_cast<Index>(joints.size()); ++k) {
    const Joint& joint = joints[k];
    joints_of[joint.a].push_back(k);
    if (joint.b != kNone) joints_of[joint.b].push_back(k);
    if (!is_pin(joint) || placed[joint.a]) continue;
    if (joint.kind == Joint::Kind::Pin) {
      place(joint.a, joint.p0 - point(joint.a, joint.place_a));
    } else {
      const PoseSlots& s = slots_[joint.a];
      if (s.c != kNone) value_[s.c] = joint.c0.x, value_[s.c + 1] = joint.c0.y;
      if (s.angle_slot != kNone) value_[s.angle_slot] = argument(joint.c0) - s.offset;
      place(joint.a, joint.p0);
    }
  }
  const auto follow = [&](Index from, const Joint& joint) {
    const Index to = joint.a == from ? joint.b : joint.a;
    if (to == kNone || placed[to]) return;
    if (joint.kind == Joint::Kind::Coincide) {
      const Index there = joint.a == to ? joint.place_a : joint.place_b;
      const Index here = joint.a == to ? joint.place_b : joint.place_a;
      place(to, point(from, here) - point(to, there));
    } else if (joint.a == to) {
      place(to, translation(from) + multiply(factor(from), joint.p0));
    } else {
      place(to, translation(from) - multiply(factor(to), joint.p0));
    }
  };
  for (Index root = 0; root < static_cast<Index>(slots_.size()); ++root) {
    if (queue.empty() && !placed[root]) place(root, {});
    while (!queue.empty()) {
      const Index from = queue.back();
      queue.pop_back();
      for (const Index k : joints_of[from]) follow(from, joints[k]);
    }
  }
}

void Poses::begin_at(In<BodyFit> fit) {
  std::vector<Vec2> direction(value_.size());  // per angle slot, the sum of the directions asked for
  std::vector<double> scale(value_.size(), 0), bodies(value_.size(), 0);  // per scale slot
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    const PoseSlots& s = slots_[b];
    const Vec2 c = fit[b].factor;
    if (s.c != kNone) value_[s.c] = c.x, value_[s.c + 1] = c.y;
    if (s.angle_slot != kNone) direction[s.angle_slot] += unit(argument(c) - s.offset);
    if (s.scale_slot != kNone) scale[s.scale_slot] += norm(c), bodies[s.scale_slot] += 1;
    for (std::size_t i = 0; i < s.tau.size(); ++i) {
      if (s.tau[i] != kNone) value_[s.tau[i]] = fit[b].along[i];
    }
  }
  for (std::size_t slot = 0; slot < value_.size(); ++slot) {
    if (dot(direction[slot], direction[slot]) > 0) value_[slot] = argument(direction[slot]);
    if (bodies[slot] > 0) value_[slot] = scale[slot] / bodies[slot];
  }
  // Positions: against the body of the assembly that has no slots for its own.
  const auto position = [&](std::size_t b) {
    const std::vector<double>& along = fit[b].along;
    const double middle =
        along.empty() ? 0
                      : std::accumulate(along.begin(), along.end(), 0.0) / static_cast<double>(along.size());
    return fit[b].centroid - middle * factor(static_cast<Index>(b));
  };
  std::vector<Vec2> origin(assemblies_->size());
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (slots_[b].p == kNone) origin[assemblies_->of[b]] = position(b);
  }
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (slots_[b].p == kNone) continue;
    const Vec2 p = position(b) - origin[assemblies_->of[b]];
    value_[slots_[b].p] = p.x, value_[slots_[b].p + 1] = p.y;
  }
}

void Poses::group_slots() {
  DisjointSets sets(num_slots());
  std::vector<Index> first_slot(agreement_->joints.size(), kNone);
  for (std::size_t k = 0; k < agreement_->joints.size(); ++k) {
    const Joint& joint = agreement_->joints[k];
    const auto tie = [&](Index slot) {
      if (slot == kNone) return;
      if (first_slot[k] == kNone) first_slot[k] = slot;
      sets.unite(first_slot[k], slot);
    };
    for (const Index b : {joint.a, joint.b}) {
      if (b == kNone) continue;
      const PoseSlots& s = slots_[b];
      tie(s.p), tie(s.p == kNone ? kNone : s.p + 1);
      tie(s.c), tie(s.c == kNone ? kNone : s.c + 1);
      tie(s.scale_slot), tie(s.angle_slot);
      const Index place = b == joint.a ? joint.place_a : joint.place_b;
      if (!s.tau.empty() && place != kNone) tie(s.tau[place]);
    }
  }
  std::map<Index, Index> group_of_root;
  std::vector<std::vector<Index>> joints, slots;
  for (std::size_t k = 0; k < first_slot.size(); ++k) {
    if (first_slot[k] == kNone) continue;
    const auto [entry, added] =
        group_of_root.try_emplace(sets.root(first_slot[k]), static_cast<Index>(joints.size()));
    if (added) joints.emplace_back();
    joints[entry->second].push_back(static_cast<Index>(k));
  }
  slots.resize(joints.size());
  slot_group_.assign(num_slots(), kNone);
  slot_place_.assign(num_slots(), kNone);
  num_free_ = 0;
  for (Index s = 0; s < num_slots(); ++s) {
    const auto found = group_of_root.find(sets.root(s));
    if (found == group_of_root.end()) {
      slot_place_[s] = num_free_++;
    } else {
      slot_group_[s] = found->second;
      slot_place_[s] = static_cast<Index>(slots[found->second].size());
      slots[found->second].push_back(s);
    }
  }
  for (std::size_t g = 0; g < joints.size(); ++g)
    groups_.push_back(std::make_unique<PoseGroup>(*this, std::move(slots[g]), std::move(joints[g])));
}

std::optional<Poses::Gap> Poses::close() {
  constexpr double kClosed = 1e-10;
  Gap worst;
  for (const auto& group : groups_) {
    const double gap = group->close();
    if (gap <= std::max(kClosed, worst.size)) continue;
    worst = {.constraints = {}, .size = gap};
    for (const Index k : group->joints()) {
      const Joint& joint = agreement_->joints[k];
      worst.constraints.push_back(compiled_->bodies[joint.a].constraint);
      if (joint.b != kNone) worst.constraints.push_back(compiled_->bodies[joint.b].constraint);
      if (joint.pin != kNone) worst.constraints.push_back(compiled_->pins[joint.pin].constraint);
    }
  }
  // Joints of bodies without any slot: all is given.
  for (const Joint& joint : agreement_->joints) {
    if (joint.kind != Joint::Kind::Coincide || joint.b == kNone) continue;
    const double gap = norm(point(joint.a, joint.place_a) - point(joint.b, joint.place_b));
    if (gap <= std::max(kClosed, worst.size) || !worst.constraints.empty()) continue;
    worst = {{compiled_->bodies[joint.a].constraint, compiled_->bodies[joint.b].constraint}, gap};
  }
  if (worst.constraints.empty()) return std::nullopt;
  return worst;
}

void Poses::spread_along_lines() {
  for (Index b = 0; b < static_cast<Index>(slots_.size()); ++b) {
    const std::vector<Index>& tau = slots_[b].tau;
    const std::vector<Vec2>& shape = compiled_->bodies[b].shape;
    const auto is_held = [&](std::size_t i) { return tau[i] == kNone || slot_group_[tau[i]] != kNone; };
    for (std::size_t first = 0; first < tau.size();) {
      std::size_t last = first + 1;
      while (last < tau.size() && !is_held(last)) ++last;
      const double from = length_along(b, static_cast<Index>(first));
      double ratio = 1;
      if (last < tau.size())
        ratio = (length_along(b, static_cast<Index>(last)) - from) / (shape[last].x - shape[first].x);
      for (std::size_t i = first + 1; i < last; ++i)
        value_[tau[i]] = from + ratio * (shape[i].x - shape[first].x);
      first = last;
    }
  }
}

void Poses::adopt(const Poses& other) {
  for (Index b = 0; b < static_cast<Index>(slots_.size()); ++b) {
    const PoseSlots& s = slots_[b];
    const Vec2 p = other.translation(b), c = other.factor(b);
    if (s.p != kNone) value_[s.p] = p.x, value_[s.p + 1] = p.y;
    if (s.c != kNone) value_[s.c] = c.x, value_[s.c + 1] = c.y;
    const double scale = other.scale(b);
    if (s.scale_slot != kNone) value_[s.scale_slot] = scale;
    if (s.angle_slot != kNone) value_[s.angle_slot] = argument(scale < 0 ? -c : c) - s.offset;
    for (Index i = 0; i < static_cast<Index>(s.tau.size()); ++i) {
      if (s.tau[i] != kNone) value_[s.tau[i]] = other.length_along(b, i);
    }
  }
}

Clusters Poses::frozen() const {
  Clusters clusters = separate_clusters(slots_.size());
  std::fill(clusters.directed.begin(), clusters.directed.end(), std::uint8_t{1});
  for (std::size_t b = 0; b < slots_.size(); ++b) clusters.offset[b] = angle(static_cast<Index>(b));
  return clusters;
}

Poses::Gaping Poses::widest_joint() const {
  Gaping widest;
  for (Index k = 0; k < static_cast<Index>(agreement_->joints.size()); ++k) {
    const Joint& joint = agreement_->joints[k];
    if (joint.kind != Joint::Kind::Coincide) continue;
    const double gap = norm(point(joint.a, joint.place_a) - point(joint.b, joint.place_b));
    if (gap > widest.size) widest = {k, gap, 0};
  }
  for (const auto& group : groups_) {
    const std::vector<Index>& joints = group->joints();
    if (std::find(joints.begin(), joints.end(), widest.joint) != joints.end())
      widest.tied = static_cast<Index>(joints.size());
  }
  return widest;
}

Index Poses::smallest() const {
  Index least = kNone;
  for (Index b = 0; b < static_cast<Index>(slots_.size()); ++b) {
    if (compiled_->bodies[b].scale) continue;
    if (least == kNone || scale(b) < scale(least)) least = b;
  }
  return least;
}

double Poses::turned() const {
  double largest = 0;
  for (std::size_t b = 0; b < base_angle_.size(); ++b) {
    if (slots_[b].angle_slot == kNone) continue;
    largest = std::max(largest, std::abs(reduce_angle(angle(static_cast<Index>(b)) - base_angle_[b])));
  }
  return largest;
}

void Poses::set_base() {
  base_ = value_;
  base_angle_.clear();
  for (Index b = 0; b < static_cast<Index>(slots_.size()); ++b) base_angle_.push_back(angle(b));
  num_free_ = static_cast<Index>(std::count(slot_group_.begin(), slot_group_.end(), kNone));
  group_begin_.clear();
  for (const auto& group : groups_) {
    group->set_base();
    group_begin_.push_back(num_free_);
    num_free_ += group->num_free();
  }
}

bool Poses::move_to(In<double> free) {
  const std::vector<double> before = value_;
  for (Index s = 0; s < num_slots(); ++s) {
    if (slot_group_[s] == kNone) value_[s] = base_[s] + free[slot_place_[s]];
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g]->move_to(free.subspan(group_begin_[g], groups_[g]->num_free()))) continue;
    value_ = before;
    return false;
  }
  return true;
}

void Poses::pull_back(In<double> slot_gradient, Out<double> gradient) const {
  for (Index s = 0; s < num_slots(); ++s) {
    if (slot_group_[s] == kNone) gradient[slot_place_[s]] = slot_gradient[s];
  }
  for (std::size_t g = 0; g < groups_.size(); ++g)
    groups_[g]->pull_back(slot_gradient, gradient.subspan(group_begin_[g], groups_[g]->num_free()));
}

}  // namespace planish
