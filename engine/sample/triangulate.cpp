#include "engine/sample/triangulate.hpp"

#include <algorithm>

namespace planish {
namespace {

constexpr Index kRowBlock = 8;
constexpr double kSmallestArea = 0.2;  // of the triangle before jitter

double doubled_area(Vec2 a, Vec2 b, Vec2 c) { return cross(b - a, c - a); }
double squared_distance(Vec2 a, Vec2 b) { return dot(b - a, b - a); }

/// One row as the strip walk sees it: its points, and their vertices, counted on around a ring.
struct Row {
  std::vector<Vec2> point;
  Index first = 0, edges = 0;
  Vec2 at(Index i) const { return point[i % static_cast<Index>(point.size())]; }
  Index vertex(Index i) const { return first + i % static_cast<Index>(point.size()); }
};

Row undisturbed_row(const RowDomain& domain, const RowPlan& plan, const RowPoints& points, Index r) {
  const Index n = plan.row_begin[r + 1] - plan.row_begin[r];
  Row row{std::vector<Vec2>(n), plan.row_begin[r], plan.row_edges[r]};
  // Points on rulings cannot turn a triangle over; there the walk may see the jitter.
  points.place(r, domain.ruling != nullptr, row.point);
  return row;
}

/// The point of `upper` nearest to the first one of `lower`: where the walk around two rings starts.
Index start_on_ring(const Row& lower, const Row& upper) {
  Index best = 0;
  for (Index j = 1; j < static_cast<Index>(upper.point.size()); ++j) {
    if (squared_distance(lower.at(0), upper.at(j)) < squared_distance(lower.at(0), upper.at(best))) best = j;
  }
  return best;
}

/// Walks along both rows and takes the shorter of the two diagonals ahead, if its triangle is not turned
/// over.
void zip_strip(const Row& lower, const Row& upper, Index upper_start, Out<Index> corner_vertex) {
  Index i = 0, j = upper_start, out = 0;
  const Index i_end = lower.edges, j_end = upper_start + upper.edges;
  while (i < i_end || j < j_end) {
    bool advance_lower = j == j_end;
    if (i < i_end && j < j_end) {
      const bool lower_fits = doubled_area(lower.at(i), lower.at(i + 1), upper.at(j)) > 0;
      const bool upper_fits = doubled_area(lower.at(i), upper.at(j + 1), upper.at(j)) > 0;
      const bool lower_shorter =
          squared_distance(lower.at(i + 1), upper.at(j)) <= squared_distance(lower.at(i), upper.at(j + 1));
      advance_lower = lower_fits && (lower_shorter || !upper_fits);
    }
    corner_vertex[out++] = lower.vertex(i);
    if (advance_lower) {
      corner_vertex[out++] = lower.vertex(++i);
      corner_vertex[out++] = upper.vertex(j);
    } else {
      corner_vertex[out++] = upper.vertex(j + 1);
      corner_vertex[out++] = upper.vertex(j++);
    }
  }
}

/// Calls body(r, its points) for every row.
template <class Body>
void for_rows(const Exec& exec, const RowPlan& plan, Out<Vec2> chart, Body&& body) {
  exec.for_blocks(plan.strips + 1, kRowBlock, [&](Index, Range rows) {
    for (Index r = rows.begin; r < rows.end; ++r) {
      body(r, chart.subspan(plan.row_begin[r], plan.row_begin[r + 1] - plan.row_begin[r]));
    }
  });
}

double chart_area(In<Vec2> chart, In<Index> corner_vertex, Index t) {
  return doubled_area(chart[corner_vertex[3 * t]], chart[corner_vertex[3 * t + 1]],
                      chart[corner_vertex[3 * t + 2]]);
}

/// Triangles that jitter has left less than kSmallestArea of what they were, ascending.
std::vector<Index> spoiled_triangles(const Exec& exec, In<Vec2> chart, In<double> area_before,
                                     In<Index> corner_vertex) {
  const auto n = static_cast<Index>(area_before.size());
  std::vector<std::vector<Index>> found(Exec::num_blocks(n, kBlock));
  exec.for_blocks(n, kBlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      if (!(chart_area(chart, corner_vertex, t) >= kSmallestArea * area_before[t])) found[block].push_back(t);
    }
  });
  std::vector<Index> all;
  for (const std::vector<Index>& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

RowMesh triangulate_rows(const Exec& exec, const RowDomain& domain, const RowPlan& plan, std::uint64_t seed) {
  const RowPoints points(domain, plan, seed);
  RowMesh mesh{std::vector<Vec2>(plan.num_vertices()), std::vector<Index>(3 * plan.num_triangles())};
  std::vector<double> area(plan.num_triangles());
  exec.for_blocks(plan.strips, kRowBlock, [&](Index, Range r) {
    Row lower = undisturbed_row(domain, plan, points, r.begin);
    for (Index s = r.begin; s < r.end; ++s) {
      Row upper = undisturbed_row(domain, plan, points, s + 1);
      const Index begin = plan.strip_begin[s], n = plan.strip_begin[s + 1] - begin;
      const auto corners = Out<Index>(mesh.corner_vertex).subspan(3 * begin, 3 * n);
      zip_strip(lower, upper,
                domain.shape == RowShape::Open || lower.edges == 0 ? 0 : start_on_ring(lower, upper),
                corners);
      for (Index t = 0; t < n; ++t) {
        const auto at = [&](Index i) {
          const Index v = corners[3 * t + i];
          return v >= upper.first ? upper.point[v - upper.first] : lower.point[v - lower.first];
        };
        area[begin + t] = doubled_area(at(0), at(1), at(2));
      }
      lower = std::move(upper);
    }
  });
  for_rows(exec, plan, mesh.chart, [&](Index r, Out<Vec2> point) { points.place(r, true, point); });
  if (domain.ruling) return mesh;
  std::vector<char> still(plan.num_vertices(), 0);
  constexpr int kRounds = 8;  // some ten triangles in a million need the first
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Index> spoiled = spoiled_triangles(exec, mesh.chart, area, mesh.corner_vertex);
    if (spoiled.empty()) break;
    for (Index t : spoiled) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) still[mesh.corner_vertex[c]] = 1;
    }
    for_rows(exec, plan, mesh.chart, [&](Index r, Out<Vec2> point) {
      points.put_back(r, In<char>(still).subspan(plan.row_begin[r], point.size()), point);
    });
  }
  return mesh;
}

}  // namespace planish
