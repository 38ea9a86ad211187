#include "engine/methods/yamabe.hpp"

#include <algorithm>

#include "engine/methods/abf.hpp"
#include "engine/methods/component_places.hpp"
#include "engine/methods/filled_order.hpp"
#include "engine/methods/scale_boundary.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

constexpr int kMostSteps = 100;

class ConformalScaleMap {
 public:
  ConformalScaleMap(const MapInput& input, const Monitor& monitor) : input_(input), monitor_(monitor) {}

  Result<MethodMap> operator()() {
    return prepare()
        .and_then([&] { return solve({}); })
        .and_then([&] { return relate(); })
        .and_then([&] { return lay_out(); })
        .and_then([&] { return check_relations(); })
        .map([&] { return std::move(result_); });
  }

 private:
  Result<void> prepare() {
    const OrderedMesh& mesh = input_.piece.mesh();
    auto filled = fill_holes(input_.exec, mesh.surface(), input_.piece.topology(),
                             input_.piece.geometry.frame, input_.piece.outer_loop, mesh.vertex_origin);
    if (!filled) return fail(filled.error());
    filled_ = std::move(*filled);
    if (auto checked = check_on_boundary(filled_, *view(), compiled()); !checked) return checked;
    auto order = filled_order(input_.exec, input_.piece, filled_);
    if (!order) return fail(order.error());
    order_ = std::move(*order);
    log_length_.resize(filled_.corner_vertex.size());
    input_.exec.for_blocks(filled_.num_triangles(), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        const auto edge = edge_vectors(filled_.frame[t]);
        for (Index i = 0; i < 3; ++i) log_length_[3 * t + i] = std::log(norm(edge[i]));
      }
    });
    return {};
  }

  Result<void> solve(In<double> chosen) {
    auto nodes = scale_nodes(filled_, *view(), compiled(), chosen, angle_);
    if (!nodes) return fail(nodes.error());
    const ScaleProblem problem{.corner_vertex = filled_.corner_vertex,
                               .topology = &filled_.topology,
                               .log_length = log_length_,
                               .nodes = &*nodes,
                               .order = order_};
    auto solution = solve_scales(input_.exec, problem, kMostSteps, monitor_);
    if (!solution) return fail(solution.error());
    result_.iterations += static_cast<int>(solution->history.size());
    angle_ = std::move(solution->angle);
    u_ = std::move(solution->u);
    return solution->converged ? Result<void>() : fail(no_convergence(*solution));
  }

  /// Relations take the turn that is nearest to the map without them.
  Result<void> relate() {
    return compiled().relations.empty() ? Result<void>() : solve(input_.system->orientation().chosen);
  }

  Error no_convergence(const ScaleSolution& solution) const {
    Error error{.code = ErrorCode::NoConvergence,
                .what =
                    "no scale factors make this mesh flat: edges of these triangles do not close; flip edges "
                    "there until "
                    "the mesh is Delaunay, refine it, or use another method",
                .element = ElementKind::Triangle};
    Index filling = 0;
    for (const Index t : solution.broken) {
      if (t >= filled_.own_triangles) {
        ++filling;
        continue;
      }
      ++error.count;
      if (error.ids.size() < kMaxListedIds) error.ids.push_back(input_.piece.mesh().triangle_origin[t]);
    }
    if (filling > 0) error.also = std::to_string(filling) + " triangles that close holes do not close either";
    if (solution.broken.empty())
      error.what = "angles miss their sums by " + std::to_string(solution.defect) + " radians after " +
                   std::to_string(solution.history.size()) + " steps of scale factors";
    return error;
  }

  double scaled_length(Index c) const {
    return std::exp(log_length_[c] +
                    0.5 * (u_[filled_.corner_vertex[c]] + u_[filled_.corner_vertex[next_corner(c)]]));
  }

  Result<void> lay_out() {
    std::vector<double> area(filled_.own_triangles);
    for (Index t = 0; t < filled_.own_triangles; ++t)
      area[t] = 0.5 * scaled_length(3 * t) * scaled_length(3 * t + 2) * std::sin(angle_[3 * t]);
    auto uv = lay_out_and_place(input_, angle_, area, false);
    if (!uv) return fail(uv.error());
    result_.uv = std::move(*uv);
    return {};
  }

  /// One that followed from the others may ask for something else.
  Result<void> check_relations() const {
    constexpr double kAllowed = 1e-7;
    const auto direction = [&](Index b) {
      const Body& body = compiled().bodies[b];
      return argument(result_.uv[body.vertex.back()] - result_.uv[body.vertex.front()]);
    };
    std::vector<Index> missed;
    for (std::size_t k = 0; k < compiled().relations.size(); ++k) {
      const Relation& r = compiled().relations[k];
      const double now = direction(r.b) - (r.a == kNone ? 0 : direction(r.a));
      if (std::abs(reduce_angle(now - input_.system->orientation().chosen[k])) > kAllowed)
        missed.push_back(r.constraint);
    }
    if (missed.empty()) return {};
    return fail(
        conflict(*view()->set, std::move(missed),
                 "all angles of the outer boundary are asked for, and turn by another sum than 2 pi"));
  }

  const Compiled& compiled() const {
    static const Compiled none;
    return input_.system ? input_.system->compiled() : none;
  }
  const ConstraintView* view() const {
    static const ConstraintView none;
    return input_.view ? input_.view : &none;
  }

  const MapInput& input_;
  const Monitor& monitor_;
  FilledSurface filled_;
  std::vector<Index> order_;
  std::vector<double> log_length_, angle_;  // [3 T]
  std::vector<double> u_;                   // [V]
  MethodMap result_;
};

}  // namespace

Result<MethodMap> conformal_scale_map(const MapInput& input, const Monitor& monitor) {
  return ConformalScaleMap(input, monitor)();
}

const char* scale_refusal(const Constraint& constraint) {
  if (asks_for_shape(constraint))
    return "its map is unique up to what is asked for at the outer boundary, lengths or angles there, and "
           "has no way to "
           "meet a shape";
  return asks_for_lengths(constraint)
             ? "where it meets angles it has no way to give a line the lengths it asks for"
             : nullptr;
}

}  // namespace planish
