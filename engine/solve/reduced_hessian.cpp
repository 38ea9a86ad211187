#include "engine/solve/reduced_hessian.hpp"

#include <algorithm>

#include "engine/solve/columns.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {
namespace {

Vec2 product(const Mat2& m, Vec2 v) { return {m.m00 * v.x + m.m01 * v.y, m.m10 * v.x + m.m11 * v.y}; }

using Blocks = ReducedHessian::TriangleBlocks;

Blocks blocks_of(const std::array<std::array<Mat2, 3>, 3>& block) {
  return {{block[0][0], block[1][1], block[2][2]}, {block[1][2], block[0][2], block[0][1]}};
}

/// Block (i, j).
Mat2 block(const Blocks& of, Index i, Index j) {
  if (i == j) return of.diagonal[i];
  const Mat2& m = of.between[3 - i - j];
  return i < j ? m : Mat2{m.m00, m.m10, m.m01, m.m11};
}

/// All that is summed up to the matrix: the blocks of triangles and the further elements.
class Elements {
 public:
  Elements(const ArapEnergy& mesh, const ReducedUnknowns& unknowns, In<Blocks> triangle,
           In<HessianElement> further)
      : mesh_(mesh), unknowns_(unknowns), triangle_(triangle), further_(further) {
    for (Index e = 0; e < static_cast<Index>(further.size()); ++e) {
      for (Index i = 0; i < 3; ++i) at_.push_back({further[e].vertex[i], e, i});
    }
    std::sort(at_.begin(), at_.end());
  }

  /// Rows of columns 2 k and 2 k + 1, ascending, the diagonal pair first.
  void find_rows(Index k, std::vector<Index>& row) const {
    row.clear();
    visit_column(k, [&](Index vertex, const Mat2&) {
      const Index other = unknowns_.pair[vertex];
      if (other > k) row.insert(row.end(), {2 * other, 2 * other + 1});
      if (other != kNone) return;
      for (const ReducedUnknowns::Move& move : unknowns_.moves_of(vertex)) row.push_back(move.unknown);
    });
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    row.insert(row.begin(), {2 * k, 2 * k + 1});
  }

  /// Values of columns 2 k (u) and 2 k + 1 (v), which has the same rows but the first.
  void sum_pair(Index k, In<Index> row, Out<double> u, Out<double> v) const {
    std::fill(u.begin(), u.end(), 0.0);
    std::fill(v.begin(), v.end(), 0.0);
    const Index num_rows = static_cast<Index>(row.size()), first_move = 2 * unknowns_.num_pairs();
    visit_column(k, [&](Index vertex, const Mat2& m) {
      const Index other = unknowns_.pair[vertex];
      if (other == k) {
        u[0] += m.m00;
        u[1] += m.m10;
        v[0] += m.m11;
      } else if (other > k) {
        Index at = 2;  // a handful of rows: searched one by one
        while (row[at] != 2 * other) at += 2;
        u[at] += m.m00;
        u[at + 1] += m.m10;
        v[at - 1] += m.m01;
        v[at] += m.m11;
      } else if (other == kNone) {
        for (const auto& [unknown, by] : unknowns_.moves_of(vertex)) {
          Index at = num_rows - 1;
          while (row[at] != unknown && row[at] >= first_move) --at;
          u[at] += by.x * m.m00 + by.y * m.m10;
          v[at - 1] += by.x * m.m01 + by.y * m.m11;
        }
      }
    });
  }

  /// Columns of the unknowns that move features: what triangles and further elements add between them.
  void add_between_moves(std::vector<std::vector<Entry>>& column) const {
    for (const Index t : triangles_at_features()) {
      const Index* v = &mesh_.corner_vertex[3 * static_cast<std::size_t>(t)];
      add_between_moves({v[0], v[1], v[2]}, triangle_[t], column);
    }
    for (const HessianElement& element : further_)
      add_between_moves(element.vertex, blocks_of(element.block), column);
  }

 private:
  using Place = std::array<Index, 3>;  // vertex, element, corner

  /// Calls visit(vertex, block) for all that is coupled with pair k, in a fixed order.
  template <class Visit>
  void visit_column(Index k, Visit visit) const {
    const Index vertex = unknowns_.vertex[k];
    for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(vertex))) {
      for (Index i = 0; i < 3; ++i)
        visit(mesh_.corner_vertex[c - c % 3 + i], block(triangle_[c / 3], i, c % 3));
    }
    for (auto at = std::lower_bound(at_.begin(), at_.end(), Place{vertex, 0, 0});
         at != at_.end() && (*at)[0] == vertex; ++at) {
      const HessianElement& element = further_[(*at)[1]];
      for (Index i = 0; i < 3; ++i) visit(element.vertex[i], element.block[i][(*at)[2]]);
    }
  }

  void add_between_moves(const std::array<Index, 3>& vertex, const Blocks& blocks,
                         std::vector<std::vector<Entry>>& column) const {
    const Index first = 2 * unknowns_.num_pairs();
    for (Index j = 0; j < 3; ++j) {
      for (const auto& [from, by] : unknowns_.moves_of(vertex[j])) {
        for (Index i = 0; i < 3; ++i) {
          const Vec2 force = product(block(blocks, i, j), by);
          for (const auto& [to, along] : unknowns_.moves_of(vertex[i])) {
            if (to == from) column[from - first].front().value += dot(along, force);
            if (to > from) column[from - first].push_back({to, dot(along, force)});
          }
        }
      }
    }
  }

  /// Each once.
  std::vector<Index> triangles_at_features() const {
    std::vector<Index> triangles;
    for (const Index v : unknowns_.feature_vertex) {
      for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(v))) triangles.push_back(c / 3);
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    return triangles;
  }

  const ArapEnergy& mesh_;
  const ReducedUnknowns& unknowns_;
  In<Blocks> triangle_;
  In<HessianElement> further_;
  std::vector<Place> at_;
};

/// Entries of edges along lines, to the columns from `first` on.
void add_line_edges(const ReducedUnknowns& unknowns, const MapDensity& density, Index first,
                    std::vector<std::vector<Entry>>& column) {
  for (const DofMap::LineEdge& edge : unknowns.line) {
    const double stiffness = std::max(0.0, edge_terms(density, edge.length / edge.rest).second);
    const double half = 0.5 * stiffness;  // the energy is rest^2 times the density of length / rest
    for (const auto& [from, rate] : edge.rate) {
      for (const auto& [to, other] : edge.rate) {
        if (to == from) column[from - first].front().value += half * rate * other;
        if (to > from) column[from - first].push_back({to, half * rate * other});
      }
    }
  }
}

/// Held rows and columns keep their places in the pattern.
void hold(const Exec& exec, SymmetricMatrix& matrix, In<Index> held) {
  if (held.empty()) return;
  std::vector<std::uint8_t> is_held(matrix.size(), 0);
  for (const Index h : held) is_held[h] = 1;
  exec.for_blocks(matrix.size(), kBlock, [&](Index, Range r) {
    for (Index column = r.begin; column < r.end; ++column) {
      for (Index k = matrix.column_begin[column]; k < matrix.column_begin[column + 1]; ++k) {
        if (is_held[column] || is_held[matrix.row[k]]) matrix.value[k] = matrix.row[k] == column ? 1 : 0;
      }
    }
  });
}

using Columns = std::vector<std::vector<Entry>>;

/// Those of the unknowns that move features.
Columns last_columns(const Elements& elements, const ReducedUnknowns& unknowns, const MapDensity& density,
                     double projection) {
  const Index first = 2 * unknowns.num_pairs();
  Columns last(unknowns.size - first);
  for (std::size_t k = 0; k < last.size(); ++k) last[k].assign(1, {first + static_cast<Index>(k), 0});
  elements.add_between_moves(last);
  add_line_edges(unknowns, density, first, last);
  for (const auto& [unknown, other, value] : unknowns.curvature) {
    const double share = (1 - projection) * value;
    if (unknown == other) last[other - first].front().value += share;
    if (unknown != other) last[other - first].push_back({unknown, share});
  }
  for (std::vector<Entry>& column : last) merge_rows(column);
  return last;
}

SymmetricMatrix find_pattern(const Exec& exec, const Elements& elements, const ReducedUnknowns& unknowns,
                             const Columns& last) {
  const Index first = 2 * unknowns.num_pairs();
  return gather_columns(exec, unknowns.size, [&](Range r, ColumnSink& sink) {
    std::vector<Index> row;
    std::vector<Entry> column;
    for (Index k = r.begin / 2; k < std::min(r.end, first) / 2; ++k) {
      elements.find_rows(k, row);
      column.clear();
      for (const Index i : row) column.push_back({i, 0});
      sink.add(column);
      column.erase(column.begin());
      sink.add(column);
    }
    for (Index k = std::max(r.begin, first); k < r.end; ++k) sink.add(last[k - first]);
  });
}

}  // namespace

SymmetricMatrix& ReducedHessian::at(const Exec& exec, const ArapEnergy& mesh, const ReducedUnknowns& unknowns,
                                    const MapDensity& density, double projection, In<Vec2> uv,
                                    In<HessianElement> further, In<double> multiple) {
  triangle_.resize(mesh.num_triangles());
  exec.for_blocks(mesh.num_triangles(), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      triangle_[t] = blocks_of(triangle_hessian(density, projection, multiple.empty() ? 0 : multiple[t],
                                                mesh.frame[t], corner_images(mesh.corner_vertex, t, uv)));
    }
  });
  const Elements elements(mesh, unknowns, triangle_, further);
  const Columns last = last_columns(elements, unknowns, density, projection);
  if (matrix_.column_begin.empty()) matrix_ = find_pattern(exec, elements, unknowns, last);
  const auto begin = [&](Index column) { return matrix_.column_begin[column]; };
  const auto values = [&](Index column) {
    return Out<double>(matrix_.value).subspan(begin(column), begin(column + 1) - begin(column));
  };
  exec.for_blocks(unknowns.num_pairs(), kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) {
      const In<Index> row = In<Index>(matrix_.row).subspan(begin(2 * k), begin(2 * k + 1) - begin(2 * k));
      elements.sum_pair(k, row, values(2 * k), values(2 * k + 1));
    }
  });
  for (std::size_t k = 0; k < last.size(); ++k) {
    const Out<double> value = values(2 * unknowns.num_pairs() + static_cast<Index>(k));
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = last[k][i].value;
  }
  hold(exec, matrix_, unknowns.held);
  return matrix_;
}

Result<std::vector<Index>> order_of_unknowns(const Exec& exec, const SymmetricMatrix& hessian,
                                             const ReducedUnknowns& unknowns) {
  const Index num_pairs = unknowns.num_pairs();
  SymmetricMatrix pairs;
  pairs.column_begin.assign(1, 0);
  for (Index k = 0; k < num_pairs; ++k) {
    for (Index e = hessian.column_begin[2 * k]; e < hessian.column_begin[2 * k + 1]; ++e) {
      const Index row = hessian.row[e];
      if (row % 2 == 0 && row < 2 * num_pairs) pairs.row.push_back(row / 2);
    }
    pairs.column_begin.push_back(static_cast<Index>(pairs.row.size()));
  }
  pairs.value.assign(pairs.row.size(), 0);
  const auto order = fill_reducing_order(exec, pairs);
  if (!order) return fail(order.error());
  std::vector<Index> unknown;
  for (const Index k : *order) unknown.insert(unknown.end(), {2 * k, 2 * k + 1});
  for (Index k = 2 * num_pairs; k < unknowns.size; ++k) unknown.push_back(k);
  return unknown;
}

}  // namespace planish
