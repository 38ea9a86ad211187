// What constraints prescribe, as the solver sees it: bodies that keep a shape, and relations between them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/model/constraint.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/order.hpp"
#include "engine/prepare/topology.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// The surface that constraints speak of: ordered, so in units of its extent, with what was measured on it.
struct RestSurface {
  const OrderedMesh* mesh = nullptr;
  const Topology* topology = nullptr;
  In<RestFrame> frame;   ///< [T]
  In<Index> outer_loop;  ///< [components] loop that is the outer one
  In<Index> loop_of;     ///< [V] boundary loop of a vertex, kNone inside
  Surface surface() const { return mesh->surface(); }
};

/// A constraint set and the features it speaks of, in the numbers of the ordered mesh.
struct ConstraintView {
  const ConstraintSet* set = nullptr;
  In<Feature> features;  ///< of one name there are two where a seam runs along it
  In<Index>
      vertex_origin;  ///< of the surface's vertices, in the numbers that edges and pins use; empty: the same
  Index origin_of(Index v) const { return vertex_origin.empty() ? v : vertex_origin[v]; }
};

/// Vertices whose places in the plane are a template t up to a pose: z = p + c t.
struct Body {
  enum class Kind {
    Line,      ///< collinear template
    FreeLine,  ///< collinear, each vertex free along the line: z = p + e^(i phi) tau, tau real
    Chord,     ///< first and last vertex of a feature of no prescribed shape; a line of free scale
    Circle,
    Curve,
    Region
  };
  Kind kind = Kind::Line;
  Index constraint = kNone;  ///< index in the set; of a chord: the first relation that measures it
  Index feature = kNone;     ///< index in the features; kNone: an edge
  std::vector<Index> vertex = {};
  std::vector<Vec2> shape = {};      ///< [vertex] template at scale 1, its mean at the origin
  bool closed = false;               ///< a chain whose last vertex is joined to the first
  std::vector<Index> triangle = {};  ///< of a region
  std::optional<double> scale = 1;   ///< |c|; none: free
  std::string scale_group = {};
  double size = 0;  ///< length of the chain in space, or square root of the region's area

  // What was found out when the template was made.
  double planarity = 0;   ///< of a curve: farthest vertex from its plane; of a region: worst stretch - 1
  bool mirrored = false;  ///< laid in the plane against the surface's orientation
  bool chirality_open = false;  ///< the surface does not tell which way round it lies

  bool is_straight() const { return kind == Kind::Line || kind == Kind::FreeLine || kind == Kind::Chord; }
  /// Consecutive vertices are joined by edges of the mesh.
  bool has_edges() const { return kind != Kind::Chord || adjacent; }
  bool adjacent = false;  ///< a chord that is an edge of the mesh
  /// Number of edges of the chain; 0 of a region.
  std::size_t num_edges() const { return kind == Kind::Region ? 0 : vertex.size() - (closed ? 0 : 1); }
};

/// Yields come first to bodies of higher rank (DESIGN 3.2, near agreement): line and circle, then curve, then region.
inline int rank_of(Body::Kind kind) {
  switch (kind) {
    case Body::Kind::Curve: return 1;
    case Body::Kind::Region: return 0;
    default: return 2;
  }
}

/// The angle from body a to body b in the plane; kNone: the u axis.
struct Relation {
  Index constraint = kNone;
  Index a = kNone, b = kNone;
  double along_a = 0,
         along_b = 0;  ///< directions in the bodies' templates that the angle is measured between
  double degrees = 0;
  bool oriented = false;
  int side = 0;  ///< of a seam that it holds on: 1 left, 2 right
};

/// A vertex at a given place.
struct Pin {
  Index constraint = kNone;
  Index vertex = kNone;
  Vec2 uv;  ///< in units of the ordered mesh
};

/// `constraint "name": <what>`, with its place in the file.
Error constraint_error(ErrorCode code, const ConstraintSet& set, Index constraint, const std::string& what);

/// `constraints "a", "b" and "c": <what>`: all of them together cannot hold.
Error conflict(const ConstraintSet& set, std::vector<Index> constraints, const std::string& what);

}  // namespace planish
