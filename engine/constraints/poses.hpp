// Where bodies lie in the plane: poses, the equations between them, and the coordinates that these leave free.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/constraints/agreement.hpp"

namespace planish {

/// Which bodies share one orientation (DESIGN 2, cluster): direction of body b = angle of its cluster + offset[b].
struct Clusters {
  std::vector<Index> of;               ///< per body
  std::vector<double> offset;          ///< per body, radians
  std::vector<std::uint8_t> directed;  ///< per cluster: 1 where its angle is 0 against the u axis
  Index size() const { return static_cast<Index>(directed.size()); }
};

/// Every body a cluster of its own.
Clusters separate_clusters(std::size_t num_bodies);

/// Bodies that hang together over joints move as one assembly: its translation is a node of the mesh's Laplacian.
struct Assemblies {
  std::vector<Index> of;             ///< per body
  std::vector<std::uint8_t> pinned;  ///< per assembly: 1 where pins hold it
  Index size() const { return static_cast<Index>(pinned.size()); }
};
Assemblies find_assemblies(const Compiled& compiled, const Agreement& agreement);

/// The pose parameters ("slots") that a body's points depend on.
struct PoseSlots {
  Index p = kNone;  ///< two: translation against the assembly's; kNone: zero
  Index c = kNone;  ///< two: a free complex c; kNone: c = scale e^(i angle), each a slot or given
  Index scale_slot = kNone;
  double scale = 1;
  Index angle_slot = kNone;  ///< its value + offset
  double offset = 0;
  std::vector<Index>
      tau;  ///< of a line with free lengths: the place of each vertex along it, kNone of the first
};

/// Where a body is to lie, as far as what ties it to others allows.
struct BodyFit {
  Vec2 centroid;      ///< of its vertices
  Vec2 factor{1, 0};  ///< c of z = p + c t
  std::vector<double>
      along;  ///< of a line with free lengths: place of each vertex along it, that of the first as given
};

/// A free scale below has no size worth the name (DESIGN 3.4).
inline constexpr double kLeastScale = 1e-3;

class PoseGroup;

/// Poses of all bodies of a compiled set. The set and the agreement must outlive it.
class Poses {
 public:
  /// A gap between joints that no poses close.
  struct Gap {
    std::vector<Index> constraints;
    double size = 0;  ///< units of the mesh here
  };

  /// angle: per body, the start of its direction in its assembly, radians.
  Poses(const Compiled& compiled, const Agreement& agreement, const Assemblies& assemblies,
        const Clusters& clusters, In<double> angle);
  ~Poses();
  Poses(const Poses&) = delete;
  Poses& operator=(const Poses&) = delete;

  /// Poses near to wanted ones: directions that a cluster shares are turned to their mean, by equal and opposite angles where
  /// there are two, scales of a group to their mean; each body about its centroid. Joints are not met yet.
  ///   fit [bodies]
  void begin_at(In<BodyFit> fit);

  /// Meets the joints by Newton steps of least change from the present poses on. A gap where they cannot be met.
  /// Cost: cubic in the slots that joints tie together.
  std::optional<Gap> close();

  /// Vertices along lines with free lengths that no joint holds, in proportion between those that joints have moved.
  void spread_along_lines();

  /// Takes over the poses of the same bodies, laid out in other slots.
  void adopt(const Poses& other);
  /// Clusters that keep every body's direction as it is now.
  Clusters frozen() const;

  /// The joint at a shared vertex that gapes most, and how far, units of the mesh here.
  struct Gaping {
    Index joint = kNone;
    double size = 0;
    Index tied = 0;  ///< joints that are solved together with it
  };
  Gaping widest_joint() const;

  Vec2 translation(Index body) const;  ///< against its assembly
  Vec2 factor(Index body) const;       ///< c of z = p + c t
  double angle(Index body) const { return argument(factor(body)); }
  /// |c|, negative where a free scale has turned the body over its centre.
  double scale(Index body) const;
  /// Unit vector of a body's direction, whatever the sign of its scale; of one whose scale is no slot of its own, c / |c|.
  Vec2 heading(Index body) const;
  /// A vertex of a body, against its assembly.
  Vec2 point(Index body, Index place) const;
  /// The body of least free scale, kNone where none is free.
  Index smallest() const;

  // ---- free coordinates ----

  /// Makes the present poses the origin of the free coordinates.
  void set_base();
  Index num_free() const { return num_free_; }
  /// Largest turn since then of a body whose points depend on its direction's sine and cosine, radians.
  double turned() const;
  /// Poses at free coordinates [num_free] from the base; false, and the poses as they were, where the joints cannot be
  /// met there.
  bool move_to(In<double> free);
  Index num_slots() const { return static_cast<Index>(value_.size()); }
  /// Calls visit(slot, dz) for every slot that a vertex of a body depends on.
  template <class Visit>
  void visit_slots(Index body, Index place, Visit visit) const;
  /// Calls visit(slot, other, d2z) for every pair of slots whose second derivative of a vertex of a body is not always 0, once.
  template <class Visit>
  void visit_slot_pairs(Index body, Index place, Visit visit) const;
  /// The same for the forces that joints exert, in balance with the gradient that vertices exert on slots: calls visit(slot,
  /// other, force . d2).   slot_gradient [num_slots]
  template <class Visit>
  void visit_joint_pairs(In<double> slot_gradient, Visit visit) const;
  /// Gradient in the free coordinates, where the poses are now.   slot_gradient [num_slots];  gradient [num_free] out
  void pull_back(In<double> slot_gradient, Out<double> gradient) const;
  /// Calls visit(length, rest, from, to) for every edge of the lines with free lengths: its length along the line now and at
  /// rest, and the slots of its ends, kNone where an end does not move along.
  template <class Visit>
  void visit_line_edges(Visit visit) const;
  /// Change of a slot with the free coordinates at the base: visit(k, value).
  template <class Visit>
  void visit_free(Index slot, Visit visit) const;

 private:
  friend struct PoseAccess;
  Index add_slot(double value);
  void lay_out_slots(const Clusters& clusters, In<double> angle);
  void place_over_joints();
  void group_slots();
  /// Pairs of slots of c t, t given.
  template <class Visit>
  void visit_factor_pairs(Index body, Vec2 t, Visit visit) const;
  double length_along(Index body, Index place) const;

  const Compiled* compiled_;
  const Agreement* agreement_;
  const Assemblies* assemblies_;
  std::vector<PoseSlots> slots_;    // per body
  std::vector<double> value_;       // per slot
  std::vector<double> base_angle_;  // per body: its direction at the base
  std::vector<double> base_;        // per slot: values at the origin of the free coordinates
  std::vector<Index> slot_group_;   // per slot, kNone: free by itself
  std::vector<Index> slot_place_;   // per slot: its free coordinate, or its place in the group
  std::vector<std::unique_ptr<PoseGroup>> groups_;
  std::vector<Index> group_begin_;  // per group: its first free coordinate
  Index num_free_ = 0;
};

/// Slots that joints tie together, and coordinates of what the joints leave free: y = N^T (slots - base), N an
/// orthonormal basis of the joints' null space at the base. Points of given y are found by Newton steps across N.
class PoseGroup {
 public:
  PoseGroup(Poses& poses, std::vector<Index> slot, std::vector<Index> joint);
  ~PoseGroup();

  /// Largest residual of the joints after Newton steps from the present values.
  double close();
  void set_base();
  Index num_free() const;
  bool move_to(In<double> y);
  void pull_back(In<double> slot_gradient, Out<double> gradient) const;
  /// Change of the slot at a place with free coordinate k, at the base.
  double at_base(Index place, Index k) const;
  /// Multipliers of the joints, in the order of their equations, two each: those that balance the gradient best.
  std::vector<Vec2> reactions(In<double> slot_gradient) const;
  const std::vector<Index>& joints() const { return joint_; }

 private:
  struct Dense;
  Poses& poses_;
  std::vector<Index> slot_, joint_;
  bool linear_ = true;
  std::unique_ptr<Dense> dense_;
};

inline Vec2 Poses::factor(Index body) const {
  const PoseSlots& s = slots_[body];
  if (s.c != kNone) return {value_[s.c], value_[s.c + 1]};
  const double scale = s.scale_slot == kNone ? s.scale : value_[s.scale_slot];
  return scale * unit((s.angle_slot == kNone ? 0 : value_[s.angle_slot]) + s.offset);
}

inline double Poses::scale(Index body) const {
  const PoseSlots& s = slots_[body];
  return s.scale_slot == kNone ? norm(factor(body)) : value_[s.scale_slot];
}

inline Vec2 Poses::heading(Index body) const {
  const PoseSlots& s = slots_[body];
  if (s.c != kNone) return unit(argument({value_[s.c], value_[s.c + 1]}));
  return unit((s.angle_slot == kNone ? 0 : value_[s.angle_slot]) + s.offset);
}

inline Vec2 Poses::translation(Index body) const {
  const Index p = slots_[body].p;
  return p == kNone ? Vec2{} : Vec2{value_[p], value_[p + 1]};
}

inline double Poses::length_along(Index body, Index place) const {
  const PoseSlots& s = slots_[body];
  return s.tau.empty() || s.tau[place] == kNone ? compiled_->bodies[body].shape[place].x
                                                : value_[s.tau[place]];
}

inline Vec2 Poses::point(Index body, Index place) const {
  const Body& b = compiled_->bodies[body];
  const Vec2 t = b.kind == Body::Kind::FreeLine ? Vec2{length_along(body, place), 0} : b.shape[place];
  return translation(body) + multiply(factor(body), t);
}

template <class Visit>
void Poses::visit_slots(Index body, Index place, Visit visit) const {
  const PoseSlots& s = slots_[body];
  const Body& b = compiled_->bodies[body];
  const bool free_lengths = b.kind == Body::Kind::FreeLine;
  const Vec2 t = free_lengths ? Vec2{length_along(body, place), 0} : b.shape[place];
  const Vec2 c = factor(body);
  if (s.p != kNone) {
    visit(s.p, Vec2{1, 0});
    visit(s.p + 1, Vec2{0, 1});
  }
  if (s.c != kNone) {
    visit(s.c, t);
    visit(s.c + 1, Vec2{-t.y, t.x});
  }
  if (s.scale_slot != kNone) visit(s.scale_slot, multiply(heading(body), t));
  if (s.angle_slot != kNone) {
    const Vec2 ct = multiply(c, t);
    visit(s.angle_slot, Vec2{-ct.y, ct.x});
  }
  if (free_lengths && s.tau[place] != kNone) visit(s.tau[place], c);
}

template <class Visit>
void Poses::visit_factor_pairs(Index body, Vec2 t, Visit visit) const {
  const PoseSlots& s = slots_[body];
  if (s.angle_slot == kNone) return;
  visit(s.angle_slot, s.angle_slot, -multiply(factor(body), t));
  if (s.scale_slot == kNone) return;
  const Vec2 z = multiply(heading(body), t);
  visit(s.angle_slot, s.scale_slot, Vec2{-z.y, z.x});
}

template <class Visit>
void Poses::visit_slot_pairs(Index body, Index place, Visit visit) const {
  const PoseSlots& s = slots_[body];
  const Body& b = compiled_->bodies[body];
  if (b.kind != Body::Kind::FreeLine) return visit_factor_pairs(body, b.shape[place], visit);
  visit_factor_pairs(body, {length_along(body, place), 0}, visit);
  if (s.tau[place] == kNone) return;
  const Vec2 c = factor(body);
  if (s.angle_slot != kNone) visit(s.angle_slot, s.tau[place], Vec2{-c.y, c.x});
  if (s.scale_slot != kNone) visit(s.scale_slot, s.tau[place], heading(body));
}

template <class Visit>
void Poses::visit_joint_pairs(In<double> slot_gradient, Visit visit) const {
  const auto along = [&](Vec2 force) {
    return [&visit, force](Index slot, Index other, Vec2 second) { visit(slot, other, dot(force, second)); };
  };
  for (const auto& group : groups_) {
    const std::vector<Vec2> multiplier = group->reactions(slot_gradient);
    std::size_t row = 0;  // as PoseGroup writes the equations
    for (const Index k : group->joints()) {
      const Joint& joint = agreement_->joints[k];
      const Vec2 force = multiplier[row++];
      if (joint.kind == Joint::Kind::Coincide || joint.kind == Joint::Kind::Pin) {
        visit_slot_pairs(joint.a, joint.place_a, along(-force));
        if (joint.kind == Joint::Kind::Coincide) visit_slot_pairs(joint.b, joint.place_b, along(force));
        continue;
      }
      const bool fit = joint.kind == Joint::Kind::Fit;
      if (fit) visit_factor_pairs(joint.b, joint.p0, along(force));
      const Vec2 on_factor = multiplier[row++];
      // Where both sizes are given this equation is one of angles, linear.
      if (compiled_->bodies[joint.a].scale && (!fit || compiled_->bodies[joint.b].scale)) continue;
      visit_factor_pairs(joint.a, {1, 0}, along(-on_factor));
      if (fit) visit_factor_pairs(joint.b, joint.c0, along(on_factor));
    }
  }
}

template <class Visit>
void Poses::visit_line_edges(Visit visit) const {
  for (Index b = 0; b < static_cast<Index>(slots_.size()); ++b) {
    const std::vector<Index>& tau = slots_[b].tau;
    const std::vector<Vec2>& shape = compiled_->bodies[b].shape;
    for (std::size_t i = 1; i < tau.size(); ++i) {
      const auto place = static_cast<Index>(i);
      visit(length_along(b, place) - length_along(b, place - 1), shape[i].x - shape[i - 1].x, tau[i - 1],
            tau[i]);
    }
  }
}

template <class Visit>
void Poses::visit_free(Index slot, Visit visit) const {
  const Index group = slot_group_[slot];
  if (group == kNone) return visit(slot_place_[slot], 1.0);
  for (Index k = 0; k < groups_[group]->num_free(); ++k)
    visit(group_begin_[group] + k, groups_[group]->at_base(slot_place_[slot], k));
}

}  // namespace planish
