#include "engine/methods/angle_blocks.hpp"

#include <algorithm>

#include "engine/solve/columns.hpp"

namespace planish {
namespace {

using Triple = AngleBlocks::Triple;

/// Derivatives of a row at another corner of the triangle, turned to begin at corner c.
Triple turned(const Triple& g, Index from, Index c) {
  const Index shift = (from - c + 3) % 3;
  Triple result;
  for (Index i = 0; i < 3; ++i) result[(i + shift) % 3] = g[i];
  return result;
}

}  // namespace

AngleBlocks::AngleBlocks(const Exec& exec, const AngleProblem& problem)
    : exec_(exec),
      problem_(problem),
      rows_(*problem.rows),
      num_corners_(static_cast<Index>(problem.corner_vertex.size())),
      hessian_(num_corners_),
      cotangent_(num_corners_) {}

/// Second derivatives of the Lagrangian by the angles; where a triangle's are not definite they are kept away from 0.
void AngleBlocks::linearise(In<double> angle, In<double> multiplier, bool exact) {
  angle_ = angle;
  exec_.for_blocks(num_corners_ / 3, kBlock, [&](Index, Range r) {
    for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
      const double sine = std::sin(angle_[c]);
      cotangent_[c] = std::cos(angle_[c]) / sine;
      hessian_[c] = 2 * problem_.weight[c] + (wheel_multiplier(multiplier, vertex(next_corner(c))) -
                                              wheel_multiplier(multiplier, vertex(previous_corner(c)))) /
                                                 (sine * sine);
    }
    for (Index t = r.begin; t < r.end && !exact; ++t) regularise(t);
  });
}

void AngleBlocks::regularise(Index t) {
  constexpr double kLeast = 0.05;
  const Triple own{2 * problem_.weight[3 * t], 2 * problem_.weight[3 * t + 1],
                   2 * problem_.weight[3 * t + 2]};
  const Projection p = projection(3 * t), q{own};
  const Triple& h = p.h;
  const bool sums_positive = h[0] + h[1] > 0 && h[1] + h[2] > 0 && h[2] + h[0] > 0;
  if (sums_positive && p.determinant() > kLeast * q.determinant()) return;
  for (Index i = 0; i < 3; ++i) hessian_[3 * t + i] = std::max(h[i], kLeast * own[i]);
}

double AngleBlocks::wheel_multiplier(In<double> multiplier, Index v) const {
  const Index row = rows_.wheel(v);
  return row == kNone ? 0 : multiplier[row];
}

SymmetricMatrix AngleBlocks::matrix() const {
  return gather_columns(exec_, rows_.size(), [&](Range r, ColumnSink& sink) {
    std::vector<Entry> column;
    for (Index j = r.begin; j < r.end; ++j) {
      column.assign(1, {j, 0});
      const Index v = rows_.vertex_of(j);
      for (const Index c :
           slice(In<Index>(problem_.topology->star_corner), problem_.topology->stars().group(v))) {
        const Triple pg = projection(c).apply(rows_.derivatives(j, c, cotangent_));
        for (const Index other : {c, next_corner(c), previous_corner(c)}) {
          const Range theirs = rows_.of(vertex(other));
          for (Index i = std::max(j, theirs.begin); i < theirs.end; ++i) {
            const double value = dot3(pg, turned(rows_.derivatives(i, other, cotangent_), other % 3, c % 3));
            if (i == j) {
              column.front().value += value;
            } else {
              column.push_back({i, value});
            }
          }
        }
      }
      merge_rows(column);
      sink.add(column);
    }
  });
}

AngleBlocks::Triple AngleBlocks::plain_step(Index c) const {
  const Projection p = projection(c);
  const std::array<Index, 3> at{c, next_corner(c), previous_corner(c)};
  Triple q;
  double gap = -kPi;
  for (int i = 0; i < 3; ++i) {
    q[i] = 2 * problem_.weight[at[i]] * (angle_[at[i]] - problem_.wanted[at[i]]);
    gap += angle_[at[i]];
  }
  const Triple pushed = p.apply(q), closing = p.spread(gap);
  return {-pushed[0] - closing[0], -pushed[1] - closing[1], -pushed[2] - closing[2]};
}

void AngleBlocks::find_rhs(Out<Vec2> rhs) const {
  exec_.for_blocks(rows_.size(), kBlock, [&](Index, Range r) {
    for (Index j = r.begin; j < r.end; ++j) {
      double sum = rows_.residual(j, angle_);
      for (const Index c : slice(In<Index>(problem_.topology->star_corner),
                                 problem_.topology->stars().group(rows_.vertex_of(j))))
        sum += dot3(rows_.derivatives(j, c, cotangent_), plain_step(c));
      rhs[j] = {sum, 0};
    }
  });
}

void AngleBlocks::find_step(In<double> multiplier, In<double> long_multiplier, Out<double> step) const {
  std::vector<double> force(num_corners_, 0);  // J^T multipliers, of the rows
  exec_.for_blocks(num_corners_, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      double sum = 0;
      const std::array<Index, 3> at{c, previous_corner(c), next_corner(c)};  // c is their own, next, previous
      for (int i = 0; i < 3; ++i) {
        const Range rows = rows_.of(vertex(at[i]));
        for (Index j = rows.begin; j < rows.end; ++j)
          sum += multiplier[j] * rows_.derivatives(j, at[i], cotangent_)[i];
      }
      force[c] = sum;
    }
  });
  for (std::size_t k = 0; k < long_multiplier.size(); ++k) {
    for (const LongAngleRow::Term& term : (*problem_.long_rows)[k].terms)
      force[term.corner] += long_multiplier[k] * term.factor;
  }
  exec_.for_blocks(num_corners_ / 3, kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const Index c = 3 * t;
      const Triple plain = plain_step(c),
                   pushed = projection(c).apply({force[c], force[c + 1], force[c + 2]});
      for (int i = 0; i < 3; ++i) step[c + i] = plain[i] - pushed[i];
    }
  });
}

std::vector<double> AngleBlocks::projected(const LongAngleRow& row) const {
  std::vector<LongAngleRow::Term> terms = row.terms;
  std::sort(terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.corner < b.corner; });
  std::vector<double> column(num_corners_, 0);
  for (std::size_t i = 0; i < terms.size();) {
    const Index t = terms[i].corner / 3;
    Triple g{};
    for (; i < terms.size() && terms[i].corner / 3 == t; ++i) g[terms[i].corner % 3] = terms[i].factor;
    const Triple pg = projection(3 * t).apply(g);
    for (Index k = 0; k < 3; ++k) column[3 * t + k] = pg[k];
  }
  return column;
}

std::vector<double> AngleBlocks::in_rows(In<double> values) const {
  std::vector<double> result(rows_.size());
  exec_.for_blocks(rows_.size(), kBlock, [&](Index, Range r) {
    for (Index j = r.begin; j < r.end; ++j) {
      for (const Index c : slice(In<Index>(problem_.topology->star_corner),
                                 problem_.topology->stars().group(rows_.vertex_of(j)))) {
        result[j] += dot3(rows_.derivatives(j, c, cotangent_),
                          {values[c], values[next_corner(c)], values[previous_corner(c)]});
      }
    }
  });
  return result;
}

}  // namespace planish
