#include "engine/solve/reduced_hessian.hpp"

#include <algorithm>

#include "engine/solve/columns.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {
namespace {

Vec2 product(const Mat2& m, Vec2 v) { return {m.m00 * v.x + m.m01 * v.y, m.m10 * v.x + m.m11 * v.y}; }

/// Three vertices and what an energy between them adds.
using Element = HessianElement;

class Columns {
 public:
  Columns(const ArapEnergy& mesh, const ReducedUnknowns& unknowns, const MapDensity& density,
          double projection, In<Vec2> uv, In<Element> further)
      : mesh_(mesh),
        unknowns_(unknowns),
        density_(density),
        projection_(projection),
        uv_(uv),
        further_(further) {
    for (Index e = 0; e < static_cast<Index>(further.size()); ++e) {
      for (Index i = 0; i < 3; ++i) at_.push_back({further[e].vertex[i], e, i});
    }
    std::sort(at_.begin(), at_.end());
  }

  Element element_of(Index t) const {
    const Index* v = &mesh_.corner_vertex[3 * static_cast<std::size_t>(t)];
    return {
        {v[0], v[1], v[2]},
        triangle_hessian(density_, projection_, mesh_.frame[t], corner_images(mesh_.corner_vertex, t, uv_))};
  }

  /// Columns 2 k and 2 k + 1, over the star of the vertex and the further elements at it.
  void gather_pair(Index k, std::vector<Entry>& u, std::vector<Entry>& v) const {
    u.assign(1, {2 * k, 0});
    v.assign(1, {2 * k + 1, 0});
    const Index vertex = unknowns_.vertex[k];
    for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(vertex)))
      add(element_of(c / 3), c % 3, k, u, v);
    for (auto at = std::lower_bound(at_.begin(), at_.end(), Place{vertex, 0, 0});
         at != at_.end() && (*at)[0] == vertex; ++at)
      add(further_[(*at)[1]], (*at)[2], k, u, v);
    merge_rows(u);
    merge_rows(v);
  }

  /// Adds an element's entries between moves of features to their columns.
  void add_between_moves(const Element& element, Index first, std::vector<std::vector<Entry>>& column) const {
    for (int j = 0; j < 3; ++j) {
      for (const auto& [from, by] : unknowns_.moves_of(element.vertex[j])) {
        for (int i = 0; i < 3; ++i) {
          const Vec2 force = product(element.block[i][j], by);
          for (const auto& [to, along] : unknowns_.moves_of(element.vertex[i])) {
            if (to == from) column[from - first].front().value += dot(along, force);
            if (to > from) column[from - first].push_back({to, dot(along, force)});
          }
        }
      }
    }
  }

 private:
  using Place = std::array<Index, 3>;  // vertex, element, corner

  void add(const Element& element, Index corner, Index k, std::vector<Entry>& u,
           std::vector<Entry>& v) const {
    for (Index i = 0; i < 3; ++i) {
      const Mat2& block = element.block[i][corner];
      const Index row = unknowns_.pair[element.vertex[i]];
      if (row == k) {
        u.front().value += block.m00;
        u.push_back({2 * k + 1, block.m10});
        v.front().value += block.m11;
      } else if (row > k) {
        u.insert(u.end(), {{2 * row, block.m00}, {2 * row + 1, block.m10}});
        v.insert(v.end(), {{2 * row, block.m01}, {2 * row + 1, block.m11}});
      } else if (row == kNone) {
        for (const auto& [unknown, by] : unknowns_.moves_of(element.vertex[i])) {
          u.push_back({unknown, by.x * block.m00 + by.y * block.m10});
          v.push_back({unknown, by.x * block.m01 + by.y * block.m11});
        }
      }
    }
  }

  const ArapEnergy& mesh_;
  const ReducedUnknowns& unknowns_;
  const MapDensity& density_;
  double projection_;
  In<Vec2> uv_;
  In<Element> further_;
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

/// Triangles at feature vertices, each once.
std::vector<Index> triangles_at(const ArapEnergy& mesh, In<Index> vertices) {
  std::vector<Index> triangles;
  for (const Index v : vertices) {
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) triangles.push_back(c / 3);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

/// Held rows and columns keep their places in the pattern.
void hold(SymmetricMatrix& matrix, In<Index> held) {
  if (held.empty()) return;
  std::vector<std::uint8_t> is_held(matrix.size(), 0);
  for (const Index h : held) is_held[h] = 1;
  for (Index column = 0; column < matrix.size(); ++column) {
    for (Index k = matrix.column_begin[column]; k < matrix.column_begin[column + 1]; ++k) {
      if (is_held[column] || is_held[matrix.row[k]]) matrix.value[k] = matrix.row[k] == column ? 1 : 0;
    }
  }
}

}  // namespace

SymmetricMatrix reduced_hessian(const Exec& exec, const ArapEnergy& mesh, const ReducedUnknowns& unknowns,
                                const MapDensity& density, double projection, In<Vec2> uv,
                                In<HessianElement> further) {
  const Columns columns(mesh, unknowns, density, projection, uv, further);
  const Index first = 2 * unknowns.num_pairs();  // of the unknowns that move features
  std::vector<std::vector<Entry>> last(unknowns.size - first);
  for (std::size_t k = 0; k < last.size(); ++k) last[k].assign(1, {first + static_cast<Index>(k), 0});
  for (const Index t : triangles_at(mesh, unknowns.feature_vertex))
    columns.add_between_moves(columns.element_of(t), first, last);
  for (const HessianElement& element : further) columns.add_between_moves(element, first, last);
  add_line_edges(unknowns, density, first, last);
  SymmetricMatrix matrix = gather_columns(exec, unknowns.size, [&](Range r, ColumnSink& sink) {
    std::vector<Entry> u, v;
    for (Index column = r.begin; column < std::min(r.end, first); column += 2) {
      columns.gather_pair(column / 2, u, v);
      sink.add(u);
      sink.add(v);
    }
    for (Index column = std::max(r.begin, first); column < r.end; ++column) {
      merge_rows(last[column - first]);
      sink.add(last[column - first]);
    }
  });
  hold(matrix, unknowns.held);
  return matrix;
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
