#include "engine/solve/newton.hpp"

#include <algorithm>

#include "engine/solve/columns.hpp"

namespace planish {
namespace {

/// Columns 2 j and 2 j + 1 of the Hessian, gathered over the star of vertex j.
class VertexColumns {
 public:
  VertexColumns(const ArapEnergy& energy, In<Vec2> uv, In<std::uint8_t> held, Convexity convexity)
      : energy_(energy), uv_(uv), held_(held), convexity_(convexity) {}

  void gather(Index j) {
    u_.assign(1, {2 * j, 0});
    v_.assign(1, {2 * j + 1, 0});
    for (const Index c : slice(energy_.star_corner, energy_.stars.group(j))) add_triangle(c / 3, c % 3, j);
    finish(2 * j, u_);
    finish(2 * j + 1, v_);
  }
  const std::vector<Entry>& u() const { return u_; }
  const std::vector<Entry>& v() const { return v_; }

 private:
  void add_triangle(Index t, Index corner, Index j) {
    const Index* vertex = &energy_.corner_vertex[3 * static_cast<std::size_t>(t)];
    const auto hessian = proxy_hessian({uv_[vertex[0]], uv_[vertex[1]], uv_[vertex[2]]},
                                       &energy_.cotangent[3 * t], energy_.frame[t], convexity_);
    for (Index k = 0; k < 3; ++k) {
      const Index i = vertex[k];
      const Mat2& block = hessian[k][corner];
      if (i == j) {
        u_.front().value += block.m00;
        u_.push_back({2 * j + 1, block.m10});
        v_.front().value += block.m11;
      } else if (i > j) {
        u_.insert(u_.end(), {{2 * i, block.m00}, {2 * i + 1, block.m10}});
        v_.insert(v_.end(), {{2 * i, block.m01}, {2 * i + 1, block.m11}});
      }
    }
  }

  /// Held rows and columns keep their places in the pattern, with zeros, so that one analysis serves every
  /// step.
  void finish(Index column, std::vector<Entry>& entries) const {
    merge_rows(entries);
    for (Entry& e : entries) {
      if (held_[e.row] || held_[column]) e.value = e.row == column ? 1 : 0;
    }
  }

  const ArapEnergy& energy_;
  In<Vec2> uv_;
  In<std::uint8_t> held_;
  Convexity convexity_;
  std::vector<Entry> u_, v_;
};

}  // namespace

SymmetricMatrix arap_hessian(const Exec& exec, const ArapEnergy& energy, In<Vec2> uv, In<std::uint8_t> held,
                             Convexity convexity) {
  const Index num_vertices = energy.num_vertices();
  return gather_columns(exec, 2 * num_vertices, [&](Range columns, ColumnSink& sink) {
    VertexColumns gathered(energy, uv, held, convexity);
    for (Index column = columns.begin; column < columns.end; column += 2) {
      gathered.gather(column / 2);
      sink.add(gathered.u());
      sink.add(gathered.v());
    }
  });
}

NewtonDirections::NewtonDirections(const Exec& exec, const ArapEnergy& energy, In<Index> vertex_order,
                                   In<Index> vertex_component, Index num_components)
    : exec_(exec), energy_(energy), vertex_component_(vertex_component), num_components_(num_components) {
  order_.reserve(2 * vertex_order.size());
  for (const Index v : vertex_order) order_.insert(order_.end(), {2 * v, 2 * v + 1});
}

std::vector<std::uint8_t> NewtonDirections::held_coordinates(In<Vec2> uv) const {
  const Index num_vertices = energy_.num_vertices();
  std::vector<std::uint8_t> held(2 * static_cast<std::size_t>(num_vertices), 0);
  std::vector<Index> centre(num_components_, kNone), farthest(num_components_, kNone),
      num_held(num_components_, 0);
  for (Index v = 0; v < num_vertices; ++v) {
    if (!energy_.fixed[v]) continue;
    held[2 * v] = held[2 * v + 1] = 1;
    centre[vertex_component_[v]] = farthest[vertex_component_[v]] = v;
    ++num_held[vertex_component_[v]];
  }
  const auto distance = [&](Index v, Index k) { return norm(uv[v] - uv[centre[k]]); };
  for (Index v = 0; v < num_vertices; ++v) {
    const Index k = vertex_component_[v];
    if (num_held[k] != 1) continue;
    if (distance(v, k) > distance(farthest[k], k)) farthest[k] = v;
  }
  for (Index k = 0; k < num_components_; ++k) {
    if (num_held[k] != 1) continue;                    // two say how it is turned
    const Vec2 arm = uv[farthest[k]] - uv[centre[k]];  // a rotation moves its end by (-arm.y, arm.x)
    held[2 * farthest[k] + (std::abs(arm.y) >= std::abs(arm.x) ? 0 : 1)] = 1;
  }
  return held;
}

Result<void> NewtonDirections::factor(const SymmetricMatrix& hessian) {
  if (global_) return global_->refactor(exec_, hessian);
  auto factored = GlobalPhase::factor(exec_, hessian, order_);
  if (!factored) return fail(factored.error());
  global_.emplace(std::move(*factored));
  return {};
}

Result<void> NewtonDirections::direction(In<Vec2> uv, In<Vec2> force, Out<Vec2> direction) {
  const auto held = held_coordinates(uv);
  auto factored = factor(arap_hessian(exec_, energy_, uv, held, Convexity::True));
  if (!factored && factored.error().code == ErrorCode::FactorizationFailed) {
    factored = factor(arap_hessian(exec_, energy_, uv, held, Convexity::Projected));
  }
  if (!factored) return factored;
  std::vector<Vec2> x(held.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    const Vec2 f = force[i / 2];
    x[i] = {held[i] ? 0 : (i % 2 == 0 ? -f.x : -f.y), 0};
  }
  global_->solve(exec_, x, x);
  for (std::size_t v = 0; v < direction.size(); ++v) direction[v] = {x[2 * v].x, x[2 * v + 1].x};
  return {};
}

}  // namespace planish
