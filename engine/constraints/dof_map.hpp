// The DOF map: from the free unknowns to all positions, x = P z + x0, with the constraints met in every point.
#pragma once

#include "engine/constraints/owners.hpp"
#include "engine/exec/parallel.hpp"
#include "engine/solve/border.hpp"
#include "engine/solve/laplacian.hpp"

namespace planish {

/// Where each vertex stands in the mesh's quotient Laplacian, whatever the poses are.
struct NodeMap {
  std::vector<Index>
      node;  ///< [V] itself, V + k of its assembly, or kNone: fixed, or moved by the border alone
  std::vector<std::uint8_t> fixed;            ///< [V] 1 where a vertex has a place of its own
  std::vector<std::pair<Index, Vec2>> place;  ///< of these, but those at 0
  std::vector<Index> assembly_node;           ///< per assembly, kNone: held or pinned
  Index num_nodes = 0;
};

/// In every component without pins one vertex, or its assembly, is held at 0.
NodeMap find_nodes(const Compiled& compiled, const std::vector<Owner>& owners, const Assemblies& assemblies,
                   In<Index> vertex_component, Index num_components);
/// Without constraints.
NodeMap find_nodes(In<Index> vertex_component, Index num_components);

/// Unknowns in one array of Vec2, [nodes + border]: the places of free vertices at their own numbers (entries of feature
/// vertices, pins and held vertices hold their positions, which the rest determines), then the translation of each
/// assembly, then real border unknowns in x: free scales, orientations, places along lines, positions within assemblies.
class DofMap {
 public:
  /// Without constraints. nodes must outlive the map.
  explicit DofMap(const NodeMap& nodes) : nodes_(&nodes) {}
  /// poses: closed.   All others must outlive the map.
  DofMap(const NodeMap& nodes, const std::vector<Owner>& owners, const Assemblies& assemblies,
         std::unique_ptr<Poses> poses);

  const NodeMap& nodes() const { return *nodes_; }
  Index num_vertices() const { return static_cast<Index>(nodes_->node.size()); }
  Index num_nodes() const { return nodes_->num_nodes; }
  Index num_border() const { return poses_ ? poses_->num_free() : 0; }
  std::size_t size() const { return static_cast<std::size_t>(num_nodes()) + num_border(); }

  /// The unknowns at the base: free vertices at 0.
  std::vector<Vec2> origin() const;
  /// Fills in the positions that the unknowns determine; false where joints cannot be met there.
  bool expand(Out<Vec2> x);
  /// From positions [V] with features as the poses have them, and room for the rest, to the unknowns; the base is set there.
  void collect(Out<Vec2> x);
  /// Fills in how feature vertices move when the unknowns change by x, to first order at the base; 0 at fixed ones.
  void linearise(Out<Vec2> x) const;
  /// From half the gradient at the vertices (zero at fixed ones) to that in the unknowns, at the x expanded last. Entries of
  /// feature vertices become 0.
  void fold(Out<Vec2> force) const;

  /// Takes over the poses of another map of the same bodies.
  void adopt(const DofMap& other) {
    if (poses_) poses_->adopt(*other.poses_);
  }
  /// Makes x, expanded last, the origin of the border's coordinates.
  void rebase(Out<Vec2> x);

  /// Border of the quotient Laplacian at the base: B and D of BorderedPhase for the energy z^H L z / 2.
  struct Border {
    std::vector<SparseColumn> column;  ///< rows are nodes
    std::vector<double> corner;        ///< [m * m]
  };
  Border border(In<Index> corner_vertex, const Topology& topology, const EdgeWeight& weight) const;

  /// How a feature vertex moves with a border unknown, at the base; sorted by column, then vertex.
  struct Motion {
    Index column, vertex;
    Vec2 value;
  };
  std::vector<Motion> motions() const;
  /// What turning features and their joints add to half the second derivatives of an energy over the border unknowns, at the
  /// base: sum of force . d2x, with the forces that joints exert among them. Each pair once, other <= column, sorted; the
  /// same pairs for any forces.   force [V]: half the gradient at the vertices
  struct Curvature {
    Index column, other;
    double value;
  };
  std::vector<Curvature> curvature(In<Vec2> force) const;
  /// An edge of a line with free lengths: how long it is now along the line (below 0: backwards), its rest length, and its
  /// rates of change with the border unknowns at the base.
  struct LineEdge {
    double length = 0, rest = 0;
    std::vector<std::pair<Index, double>> rate;
  };
  std::vector<LineEdge> line_edges() const;
  /// How many of these run backwards, or have no length.
  Index reversed_edges() const;
  /// Feature vertices and the node that carries each, kNone: none; in the owners' order.
  template <class Visit>
  void visit_carried(Visit visit) const {
    if (!poses_) return;
    for (const Owner& owner : *owners_)
      visit(owner.vertex, nodes_->assembly_node[assemblies_->of[owner.body]]);
  }

  const Poses* poses() const { return poses_.get(); }

 private:
  const NodeMap* nodes_;
  const std::vector<Owner>* owners_ = nullptr;
  const Assemblies* assemblies_ = nullptr;
  std::unique_ptr<Poses> poses_;
};

}  // namespace planish
