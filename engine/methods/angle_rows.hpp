// The linear and logarithmic conditions that make the corner angles of a disk those of a flat map.
#pragma once

#include <array>

#include "engine/model/error.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Condition at one vertex, on the corners of its star.
struct AngleRow {
  enum class Kind {
    Sum,  ///< the angles at some consecutive corners sum to `target`
    Wheel  ///< sum of log sin(angle at the next corner) - log sin(at the previous one) is 0: the star closes in length
  };
  Kind kind = Kind::Sum;
  Index first = 0, count = 0;  ///< places in the star, counted round where it is closed
  double target = 0;           ///< radians
  Index constraint = kNone;    ///< that asks for it; kNone: flatness does
};

/// A sum over corners anywhere: what one direction is against another one.
struct LongAngleRow {
  struct Term {
    Index corner;
    double factor;
  };
  std::vector<Term> terms;  ///< corners distinct
  double target = 0;
  Index relation = kNone;
};

class AngleRows {
 public:
  /// Of interior vertices: the angles sum to 2 pi, and the star closes.   topology: of a disk, or of several
  explicit AngleRows(const Topology& topology);

  /// Adds rows [vertex, row], in any order; a sum over corners that another row has already (or has the rest of) is left out.
  void add(std::vector<std::pair<Index, AngleRow>> rows);

  Index size() const { return static_cast<Index>(row_.size()); }
  /// Rows of a vertex.
  Range of(Index vertex) const { return {begin_[vertex], begin_[vertex + 1]}; }
  const AngleRow& operator[](Index row) const { return row_[row]; }
  Index vertex_of(Index row) const { return vertex_[row]; }
  /// Row of the wheel of a vertex, kNone on the boundary.
  Index wheel(Index vertex) const;

  /// What a row depends on in the triangle of corner c of its vertex: derivatives by the angle at c, at the next corner, and at
  /// the previous one.   cotangent [3 T] of the angles
  std::array<double, 3> derivatives(Index row, Index c, In<double> cotangent) const;
  /// What the row misses.
  double residual(Index row, In<double> angle) const;

 private:
  bool covers(const AngleRow& row, Index vertex, Index place) const;

  const Topology* topology_;
  std::vector<Index> begin_, vertex_;
  std::vector<AngleRow> row_;
  std::vector<Index> place_;  // [3 T] of a corner in its star
};

}  // namespace planish
