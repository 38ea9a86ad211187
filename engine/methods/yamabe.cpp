#include "engine/methods/yamabe.hpp"

#include <algorithm>

#include "engine/methods/abf.hpp"
#include "engine/methods/angle_layout.hpp"
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
    on_.corner_vertex = filled_.corner_vertex;
    on_.topology = filled_.topology;
    on_.log_length.resize(filled_.corner_vertex.size());
    input_.exec.for_blocks(filled_.num_triangles(), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        const auto edge = edge_vectors(filled_.frame[t]);
        for (Index i = 0; i < 3; ++i) on_.log_length[3 * t + i] = std::log(norm(edge[i]));
      }
    });
    return {};
  }

  /// Edges stay as they are where scale factors make them close.
  Result<void> solve(In<double> chosen) {
    auto nodes = scale_nodes(filled_, *view(), compiled(), chosen, angle_sum_);
    if (!nodes) return fail(nodes.error());
    if (!flips_) {
      const ScaleProblem problem{.corner_vertex = on_.corner_vertex,
                                 .topology = &on_.topology,
                                 .log_length = on_.log_length,
                                 .nodes = &*nodes,
                                 .order = order_};
      auto solution = solve_scales(input_.exec, problem, kMostSteps, monitor_);
      if (!solution) return fail(solution.error());
      if (take(*solution)) return {};
      own_edges_ = no_convergence(*solution);
      if (auto flipped = begin_flips(); !flipped) return flipped;
    }
    auto solution = solve_scales(input_.exec, on_, *nodes, order_, kMostSteps, monitor_);
    if (!solution) return fail(solution.error());
    return take(*solution) ? Result<void>() : fail(neither(*solution));
  }

  Result<void> begin_flips() {
    flips_ = true;
    return flip_to_delaunay(input_.exec, on_).map([](Index) {});
  }

  bool take(ScaleSolution& solution) {
    result_.iterations += static_cast<int>(solution.history.size());
    if (!solution.converged) return false;
    angle_ = std::move(solution.angle);
    u_ = std::move(solution.u);
    angle_sum_.assign(filled_.num_vertices, 0);
    for (std::size_t c = 0; c < angle_.size(); ++c) angle_sum_[on_.corner_vertex[c]] += angle_[c];
    if (flips_)
      result_.intrinsic = IntrinsicFacts{.moved_edges = moved_edges(), .angle_defect = solution.defect};
    return true;
  }

  /// Relations take the turn that is nearest to the map without them.
  Result<void> relate() {
    return compiled().relations.empty() ? Result<void>() : solve(input_.system->orientation().chosen);
  }

  Error no_convergence(const ScaleSolution& solution) const {
    Error error{.code = ErrorCode::NoConvergence,
                .what =
                    "no scale factors make this mesh flat: edges of these triangles do not close; refine it "
                    "there, or use "
                    "another method",
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
    if (solution.broken.empty()) error.what = misses(solution);
    return error;
  }

  static std::string misses(const ScaleSolution& solution) {
    return "angles miss their sums by " + std::to_string(solution.defect) + " radians after " +
           std::to_string(solution.history.size()) + " steps of scale factors";
  }

  /// The mesh's own triangles are named; those of the flipped triangulation have no numbers.
  Error neither(const ScaleSolution& solution) const {
    Error error = own_edges_;
    error.also += error.also.empty() ? "" : "; ";
    error.also += solution.broken.empty() ? "with edges flipped, " + misses(solution)
                                          : "with edges flipped, " + std::to_string(solution.broken.size()) +
                                                " of the boundary's triangles do not close";
    return error;
  }

  /// Edges of the mesh that are not edges any more, or the other way round.
  Index moved_edges() const {
    const auto edges = [](In<Index> corner_vertex, const Topology& topology) {
      std::vector<std::pair<Index, Index>> list;
      for (Index c = 0; c < static_cast<Index>(corner_vertex.size()); ++c) {
        if (c < topology.corner_twin[c])
          list.push_back(std::minmax(corner_vertex[c], Index{corner_vertex[next_corner(c)]}));
      }
      std::sort(list.begin(), list.end());
      return list;
    };
    const auto before = edges(filled_.corner_vertex, filled_.topology),
               now = edges(on_.corner_vertex, on_.topology);
    std::vector<std::pair<Index, Index>> gone;
    std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(gone));
    return static_cast<Index>(gone.size());
  }

  double scaled_length(Index c) const {
    return std::exp(on_.log_length[c] +
                    0.5 * (u_[on_.corner_vertex[c]] + u_[on_.corner_vertex[next_corner(c)]]));
  }

  Result<void> lay_out() {
    std::vector<double> area(on_.num_triangles());
    for (Index t = 0; t < on_.num_triangles(); ++t)
      area[t] = 0.5 * scaled_length(3 * t) * scaled_length(3 * t + 2) * std::sin(angle_[3 * t]);
    auto uv = flips_ ? lay_out_flipped(area) : lay_out_and_place(input_, angle_, area, false);
    if (!uv) return fail(uv.error());
    result_.uv = std::move(*uv);
    return {};
  }

  /// The surface's vertices are those of the other triangulation too; what fills holes cannot be told apart there, and goes after.
  Result<std::vector<Vec2>> lay_out_flipped(In<double> area) const {
    std::vector<double> area_of(on_.topology.num_components, 0);
    for (Index t = 0; t < on_.num_triangles(); ++t) area_of[on_.topology.triangle_component[t]] += area[t];
    auto uv = lay_out_angles(input_.exec, on_.corner_vertex, on_.topology, angle_, order_, area_of);
    if (!uv) return uv;
    uv->resize(filled_.own_vertices);
    if (auto placed = place_components(input_, false, *uv); !placed) return fail(placed.error());
    return uv;
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
  IntrinsicTriangulation on_;  // the filled surface's, until edges are flipped
  bool flips_ = false;
  Error own_edges_;                    // why they had to be
  std::vector<double> angle_;          // [3 T]
  std::vector<double> u_, angle_sum_;  // [V]
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
