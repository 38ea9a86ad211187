// A plane domain swept by rows of points, its triangles between neighbouring rows. Points stand denser where
// rows run closer, so that triangles come near to equilateral whatever the shape of the domain.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "kernels/base/types.hpp"

namespace planish {

enum class RowShape {
  Open,    ///< rows run from one side of the domain to the other: a disk with four corners
  Closed,  ///< rows are rings: an annulus
  Rings,   ///< the same, and the first row is a point: a disk
};

struct RowDomain {
  RowShape shape = RowShape::Open;
  /// The unit square to the plane, counter-clockwise; u runs along a row (periodic where rows are closed), v
  /// across.
  std::function<Vec2(double u, double v)> chart;
  /// Where rows are the rulings of a developable: the points of row r, which jitter then never leaves. Empty
  /// elsewhere.
  std::function<Vec2(double u, Index r)> ruling = {};
};

/// Running integral along a row of the density of its points, at evenly spaced u; the last is its share of
/// edges.
inline constexpr Index kStations = 64;
using RowIntegral = std::array<double, kStations + 1>;

RowIntegral integrate_row(const RowDomain& domain, double v);

/// The u up to which a row has this fraction of its points: inverse of the integral, linear between stations.
double position_in_row(const RowIntegral& integral, double fraction);

/// How many points on which row; row r of strips + 1 is at v = r / strips.
struct RowPlan {
  Index strips = 0;
  std::vector<RowIntegral> row_integral;  ///< [strips + 1]
  std::vector<Index> row_edges;           ///< [strips + 1]
  std::vector<Index> row_begin;           ///< [strips + 2] first vertex of each row
  std::vector<Index> strip_begin;         ///< [strips + 1] first triangle of each strip
  Index num_vertices() const { return row_begin.back(); }
  Index num_triangles() const { return strip_begin.back(); }
};

/// Strips for so many triangles, nearly equilateral.
Index num_strips(const RowDomain& domain, Index triangles);

/// Shares the triangles out over the rows.
RowPlan plan_rows(const Exec& exec, const RowDomain& domain, Index strips, Index triangles);

/// Points of a planned domain, with or without jitter.
class RowPoints {
 public:
  RowPoints(const RowDomain& domain, const RowPlan& plan, std::uint64_t seed);

  /// Where the points of row r go, with all of the jitter or none.
  void place(Index r, bool jitter, Out<Vec2> point) const;

  /// Moves the points with still [points of the row] != 0 to where they were without jitter.
  void put_back(Index r, In<char> still, Out<Vec2> point) const;

 private:
  template <class Wanted>
  void place_points(Index r, double jitter, Wanted&& wanted, Out<Vec2> point) const;

  const RowDomain& domain_;
  const RowPlan& plan_;
  std::uint64_t seed_;
};

}  // namespace planish
