// Features as a person names them, and as the engine found them on a mesh.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// A curve drawn in space, near the surface but not along its edges.
struct PolylineSource {
  std::vector<Vec3> point;  ///< mesh units; a closed one does not repeat its first point
  bool closed = false;
  std::optional<double> max_distance;  ///< of a point from the surface, mesh units; none: 1% of the length
};

/// Vertices of the mesh in order.
struct VertexSource {
  std::vector<Index> vertex;
  bool closed = false;
  bool shortest = false;  ///< consecutive ones are joined by shortest paths of edges; else they share an edge
};

/// A boundary loop by its number; loops by decreasing length.
struct LoopSource {
  Index loop = 0;
};

/// The boundary loop nearest to a point.
struct BoundaryNearSource {
  Vec3 point;
};

/// The triangles on one side of a closed feature: that of the seed, or the side without the rest.
struct EnclosedBySource {
  std::string feature;
  std::optional<Vec3> seed;
};

struct TriangleSource {
  std::vector<Index> triangle;
};

/// The curve where a plane cuts the mesh, nearest to a point.
struct PlaneCutSource {
  Vec3 point, normal;
  Vec3 near;
};

/// The path of edges bent by more than an angle, grown both ways from the one nearest to a point.
struct SharpEdgesSource {
  double degrees = 0;
  Vec3 near;
};

using FeatureSource = std::variant<PolylineSource, VertexSource, LoopSource, BoundaryNearSource,
                                   EnclosedBySource, TriangleSource, PlaneCutSource, SharpEdgesSource>;

struct FeatureSpec {
  std::string name;
  FeatureSource source;
};

/// A feature on the embedded mesh: a chain of vertices joined by edges, or a set of triangles.
struct Feature {
  std::string name;
  std::vector<Index> vertex;    ///< the chain, in order; empty for a region
  bool closed = false;          ///< the last vertex is joined to the first, which is not repeated
  double length = 0;            ///< of the chain, mesh units
  double max_deviation = 0;     ///< largest distance between the chain and the given polyline, mesh units
  std::vector<Index> triangle;  ///< of a region, ascending; empty for a chain
  int side = 0;  ///< 0; where a seam runs along the chain: 1 its copy on the left, 2 on the right

  bool is_region() const { return vertex.empty(); }
};

}  // namespace planish
