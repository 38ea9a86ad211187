#include "engine/methods/abf.hpp"

#include <algorithm>

#include "engine/methods/angle_constraints.hpp"
#include "engine/methods/angle_newton.hpp"
#include "engine/methods/component_places.hpp"
#include "engine/methods/filled_order.hpp"

namespace planish {
namespace {

constexpr double kTolerance = 1e-8;
constexpr int kMostSteps = 60;

class AngleBasedMap {
 public:
  AngleBasedMap(const MapInput& input, const Monitor& monitor) : input_(input), monitor_(monitor) {}

  Result<MethodMap> operator()() {
    return check()
        .and_then([&] { return prepare(); })
        .and_then([&] { return solve(); })
        .and_then([&] { return relate(); })
        .and_then([&] { return lay_out(); })
        .map([&] { return std::move(result_); });
  }

 private:
  Result<void> check() const {
    if (!input_.system) return {};
    for (const Body& body : compiled().bodies) {
      if (body.has_edges()) continue;
      return fail(constraint_error(
          ErrorCode::ConstraintUnsupported, *input_.view->set, body.constraint,
          "the direction of a chord depends on lengths, which abf does not know; make a line of it"));
    }
    return {};
  }

  Result<void> prepare() {
    const OrderedMesh& mesh = input_.piece.mesh();
    auto filled = fill_holes(input_.exec, mesh.surface(), input_.piece.topology(),
                             input_.piece.geometry.frame, input_.piece.outer_loop, mesh.vertex_origin);
    if (!filled) return fail(filled.error());
    filled_ = std::move(*filled);
    auto order = filled_order(input_.exec, input_.piece, filled_);
    if (!order) return fail(order.error());
    order_ = std::move(*order);
    std::vector<std::pair<Index, AngleRow>> straight;
    if (input_.system) straight = straight_rows(filled_, compiled());
    find_wanted(straight);
    rows_.emplace(filled_.topology);
    rows_->add(std::move(straight));
    return {};
  }

  /// The surface's angles, those around an interior vertex scaled to 2 pi, those on one side of a line to pi.
  void find_wanted(const std::vector<std::pair<Index, AngleRow>>& straight) {
    constexpr double kLargest = 0.95 * kPi, kFilling = 0.25;
    const Topology& topology = filled_.topology;
    wanted_.resize(filled_.corner_vertex.size());
    corner_angles({0, filled_.num_triangles()}, filled_.frame, wanted_);
    angle_ = wanted_;
    const auto scale = [&](Index v, Index first, Index count, double target) {
      const Index begin = topology.star_begin[v], star = topology.star_begin[v + 1] - begin;
      double sum = 0;
      for (Index k = 0; k < count; ++k) sum += wanted_[topology.star_corner[begin + (first + k) % star]];
      for (Index k = 0; k < count; ++k)
        wanted_[topology.star_corner[begin + (first + k) % star]] *= target / sum;
    };
    for (Index v = 0; v < filled_.num_vertices; ++v) {
      const Index star = topology.star_begin[v + 1] - topology.star_begin[v];
      if (!topology.is_boundary(v)) scale(v, 0, star, 2 * kPi);
    }
    for (const auto& [v, row] : straight) {
      const Index star = topology.star_begin[v + 1] - topology.star_begin[v];
      scale(v, row.first, row.count, row.target);
      if (!topology.is_boundary(v)) scale(v, row.first + row.count, star - row.count, 2 * kPi - row.target);
    }
    weight_.resize(wanted_.size());
    for (std::size_t c = 0; c < wanted_.size(); ++c) {
      wanted_[c] = std::min(wanted_[c], std::max(kLargest, angle_[c]));
      const bool own = static_cast<Index>(c) < 3 * filled_.own_triangles;
      weight_[c] = (own ? 1 : kFilling) / (wanted_[c] * wanted_[c]);
    }
    angle_ = wanted_;
    for (std::size_t c = 0; c < angle_.size(); c += 3) {
      const double sum = angle_[c] + angle_[c + 1] + angle_[c + 2];
      for (std::size_t i = 0; i < 3; ++i) angle_[c + i] *= kPi / sum;
    }
  }

  Result<void> solve() {
    std::vector<double> start = angle_;
    const AngleProblem problem{.corner_vertex = filled_.corner_vertex,
                               .topology = &filled_.topology,
                               .rows = &*rows_,
                               .long_rows = &long_rows_,
                               .wanted = wanted_,
                               .weight = weight_,
                               .order = order_};
    auto solution = solve_angles(input_.exec, problem, std::move(start), kTolerance, kMostSteps, monitor_);
    if (!solution) return fail(named(solution.error()));
    result_.iterations += static_cast<int>(solution->history.size());
    angle_ = std::move(solution->angle);
    return solution->converged ? Result<void>() : fail(no_convergence(*solution));
  }

  /// Relations take the turn that is nearest to the map without them.
  Result<void> relate() {
    if (!input_.system || compiled().relations.empty()) return {};
    long_rows_ = relation_rows(filled_, compiled(), input_.system->orientation().chosen, angle_);
    return long_rows_.empty() ? Result<void>() : solve();
  }

  Error named(Error error) const {
    if (error.code != ErrorCode::ConstraintsConflict) return error;
    std::vector<Index> constraints;
    for (const Index k : error.ids) constraints.push_back(compiled().relations[k].constraint);
    return conflict(*input_.view->set, std::move(constraints),
                    "the sums of angles that they ask for contradict one another in a flat map");
  }

  Error no_convergence(const AngleSolution& solution) const {
    constexpr double kFlat = 1e-4;
    Error error{.code = ErrorCode::NoConvergence,
                .what = "the angles of a flat map were not found (rows are missed by " +
                        std::to_string(solution.residual) + " radians after " +
                        std::to_string(solution.history.size()) +
                        " steps); angles of these triangles go to 0",
                .element = ElementKind::Triangle};
    for (Index t = 0; t < filled_.own_triangles; ++t) {
      const double* a = angle_.data() + 3 * t;
      if (std::min({a[0], a[1], a[2]}) >
          kFlat * std::min({wanted_[3 * t], wanted_[3 * t + 1], wanted_[3 * t + 2]}))
        continue;
      ++error.count;
      if (error.ids.size() < kMaxListedIds) error.ids.push_back(input_.piece.mesh().triangle_origin[t]);
    }
    return error;
  }

  Result<void> lay_out() {
    std::vector<double> rest_area;
    for (const RestFrame& frame : filled_.frame) rest_area.push_back(area(frame));
    auto uv = lay_out_and_place(input_, angle_, rest_area, true);
    if (!uv) return fail(uv.error());
    result_.uv = std::move(*uv);
    return {};
  }

  const Compiled& compiled() const { return input_.system->compiled(); }

  const MapInput& input_;
  const Monitor& monitor_;
  FilledSurface filled_;
  std::vector<Index> order_;
  std::optional<AngleRows> rows_;
  std::vector<LongAngleRow> long_rows_;
  std::vector<double> wanted_, weight_, angle_;  // [3 T]
  MethodMap result_;
};

constexpr const char* kNoShapes =
    "it solves for angles, and the shape of an N-gon has 2 N - 4 degrees of freedom, of which its angles "
    "control N";

}  // namespace

Result<MethodMap> angle_based_map(const MapInput& input, const Monitor& monitor) {
  return AngleBasedMap(input, monitor)();
}

const char* angle_refusal(const Constraint& constraint) {
  if (asks_for_shape(constraint)) return kNoShapes;
  return asks_for_lengths(constraint)
             ? "it solves for angles, which have no way to give a line the lengths it asks for"
             : nullptr;
}

bool asks_for_shape(const Constraint& constraint) {
  return std::holds_alternative<CircleConstraint>(constraint.rule) ||
         std::holds_alternative<CurveConstraint>(constraint.rule) ||
         std::holds_alternative<RegionConstraint>(constraint.rule);
}

bool asks_for_lengths(const Constraint& constraint) {
  const auto* line = std::get_if<LineConstraint>(&constraint.rule);
  if (!line || line->lengths != LineConstraint::Lengths::Scale) return false;
  return !line->scale.group.empty() || line->scale.factor.value_or(1) != 1;
}

bool free_lengths(Constraint& constraint) {
  auto* line = std::get_if<LineConstraint>(&constraint.rule);
  if (!line || line->lengths == LineConstraint::Lengths::Free) return false;
  line->lengths = LineConstraint::Lengths::Free;
  line->scale = {};
  return true;
}

}  // namespace planish
