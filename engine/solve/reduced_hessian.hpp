// Hessians of map energies over the unknowns that a map is moved by: free vertices, and what moves features.
#pragma once

#include <array>
#include <vector>

#include "engine/constraints/dof_map.hpp"
#include "engine/solve/map_energy.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Real unknowns in the order of elimination: a pair of coordinates for each free vertex, then those that move features.
struct ReducedUnknowns {
  std::vector<Index> vertex;  ///< of pair k
  std::vector<Index> pair;    ///< [V] kNone: held, or on a feature
  /// Moves of feature vertices: those of vertex feature_vertex[i] are [begin[i], begin[i + 1]).
  struct Move {
    Index unknown;
    Vec2 by;
  };
  std::vector<Index> feature_vertex, feature_place, move_begin;  // feature_place [V] or empty
  std::vector<Move> move;
  std::vector<DofMap::LineEdge> line;        ///< rates over the unknowns
  std::vector<DofMap::Curvature> curvature;  ///< of the ways that features are moved, between the unknowns
  Index size = 0;
  std::vector<Index> held;  ///< unknowns that do not move, for their rows to be definite

  Index num_pairs() const { return static_cast<Index>(vertex.size()); }
  In<Move> moves_of(Index v) const {
    const Index i = feature_place.empty() ? kNone : feature_place[v];
    return i == kNone ? In<Move>() : In<Move>(move).subspan(move_begin[i], move_begin[i + 1] - move_begin[i]);
  }
};

/// What an energy between three vertices adds to half the Hessian.
struct HessianElement {
  std::array<Index, 3> vertex;
  std::array<std::array<Mat2, 3>, 3> block;
};

/// Half the Hessian of a map energy: its pattern is found once, its values at one place after another.
/// Curvature of the ways that features are moved counts as far as the Hessian is the true one.
class ReducedHessian {
 public:
  /// At uv [V]; holds until the next call, and may be changed until then. Mesh, unknowns and the vertices of further elements
  /// as in the call before, unless forget_pattern() came between; moves of features by other amounts.
  ///   projection, multiple [T] or empty for 0: as in triangle_hessian()
  /// Cost: O(T), parallel; O(m^2) at triangles with m moves of features.
  SymmetricMatrix& at(const Exec& exec, const ArapEnergy& mesh, const ReducedUnknowns& unknowns,
                      const MapDensity& density, double projection, In<Vec2> uv,
                      In<HessianElement> further = {}, In<double> multiple = {});
  void forget_pattern() { matrix_ = {}; }

  /// The blocks of a triangle that are not others transposed.
  struct TriangleBlocks {
    std::array<Mat2, 3> diagonal;
    std::array<Mat2, 3> between;  ///< corners (1, 2), (0, 2) and (0, 1)
  };

 private:
  std::vector<TriangleBlocks> triangle_;  // [T], kept for their memory
  SymmetricMatrix matrix_;
};

/// A fill-reducing order of the unknowns for such a matrix, whatever else couples them.   Fails: OutOfMemory.
Result<std::vector<Index>> order_of_unknowns(const Exec& exec, const SymmetricMatrix& hessian,
                                             const ReducedUnknowns& unknowns);

}  // namespace planish
