#include "engine/methods/conformal_energy.hpp"

#include "engine/solve/columns.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {

ConformalEnergy::ConformalEnergy(const Exec& exec, const Workpiece& piece, const std::vector<Spring>& springs)
    : exec_(exec), piece_(piece), springs_(springs) {
  if (springs.empty()) return;
  spring_at_.assign(piece.mesh().num_vertices(), kNone);
  for (std::size_t k = 0; k < springs.size(); ++k)
    spring_at_[springs[k].a] = spring_at_[springs[k].b] = static_cast<Index>(k);
}

/// Returns the diagonal entry, a real number. Area 1/2 cross(z_i, z_j) of a boundary edge from i to j puts -i/2 between
/// column i and row j, i/2 between column j and row i.
template <class Visit>
double ConformalEnergy::visit_row(Index v, Visit visit) const {
  const Topology& topology = piece_.topology();
  const std::vector<Index>& corner_vertex = piece_.mesh().corner_vertex;
  double diagonal = 0;
  const auto edge = [&](Index w, double weight, double area) {
    diagonal += weight;
    visit(w, Vec2{-weight, area});
  };
  for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
    edge(corner_vertex[next_corner(c)], piece_.edge_weight(c), topology.corner_twin[c] == kNone ? -0.5 : 0);
    const Index arriving = previous_corner(c);
    if (topology.corner_twin[arriving] == kNone)
      edge(corner_vertex[arriving], piece_.edge_weight(arriving), 0.5);
  }
  return diagonal;
}

void ConformalEnergy::forces(In<Vec2> uv, Out<Vec2> force) const {
  exec_.for_blocks(static_cast<Index>(uv.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      Vec2 sum;
      // The row is the conjugate of the column.
      const double diagonal =
          visit_row(v, [&](Index w, Vec2 entry) { sum += multiply(conjugate(entry), uv[w]); });
      force[v] = sum + diagonal * uv[v];
    }
  });
}

double ConformalEnergy::value(In<Vec2> uv) const {
  std::vector<Vec2> force(uv.size());
  forces(uv, force);
  return 0.5 * dot(exec_, uv, force);
}

SymmetricMatrix ConformalEnergy::hessian(const ReducedUnknowns& unknowns, In<double> diagonal) const {
  const Index first = 2 * unknowns.num_pairs();  // of the unknowns that move features
  const auto visit_column = [&](Index v, auto&& visit) {
    double own = visit_row(v, visit);
    if (!diagonal.empty()) own += diagonal[v];
    if (!spring_at_.empty() && spring_at_[v] != kNone) {
      const Spring& spring = springs_[spring_at_[v]];
      own += spring.weight;
      visit(spring.a == v ? spring.b : spring.a, Vec2{-spring.weight, 0});
    }
    return own;
  };
  std::vector<std::vector<Entry>> last(unknowns.size - first);
  for (std::size_t k = 0; k < last.size(); ++k) last[k].assign(1, {first + static_cast<Index>(k), 0});
  for (const Index v : unknowns.feature_vertex) {
    const auto between_moves = [&](Index w, Vec2 entry) {
      for (const auto& [from, by] : unknowns.moves_of(v)) {
        const Vec2 image = multiply(entry, by);
        for (const auto& [to, along] : unknowns.moves_of(w)) {
          if (to == from) last[from - first].front().value += dot(along, image);
          if (to > from) last[from - first].push_back({to, dot(along, image)});
        }
      }
    };
    const double own = visit_column(v, between_moves);
    between_moves(v, {own, 0});
  }
  return gather_columns(exec_, unknowns.size, [&](Range r, ColumnSink& sink) {
    std::vector<Entry> u, v;
    for (Index column = r.begin; column < std::min(r.end, first); column += 2) {
      const Index k = column / 2;
      u.assign(1, {column, 0});
      v.assign(1, {column + 1, 0});
      const double own = visit_column(unknowns.vertex[k], [&](Index w, Vec2 entry) {
        const Index row = unknowns.pair[w];
        if (row > k) {
          u.push_back({2 * row, entry.x});
          if (entry.y != 0) u.push_back({2 * row + 1, entry.y}), v.push_back({2 * row, -entry.y});
          v.push_back({2 * row + 1, entry.x});
        } else if (row == kNone) {
          for (const auto& [unknown, by] : unknowns.moves_of(w)) {
            u.push_back({unknown, dot(by, entry)});
            v.push_back({unknown, dot(by, Vec2{-entry.y, entry.x})});
          }
        }
      });
      u.front().value = v.front().value = own;
      merge_rows(u);
      merge_rows(v);
      sink.add(u);
      sink.add(v);
    }
    for (Index column = std::max(r.begin, first); column < r.end; ++column) {
      merge_rows(last[column - first]);
      sink.add(last[column - first]);
    }
  });
}

}  // namespace planish
