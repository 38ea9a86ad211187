#include "engine/methods/component_places.hpp"

#include "engine/methods/angle_layout.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

class Placing {
 public:
  Placing(const MapInput& input, bool any_size, Out<Vec2> uv) : input_(input), any_size_(any_size), uv_(uv) {}

  Result<void> operator()() {
    turn_to_directions();
    for (Index k = 0; k < input_.piece.topology().num_components; ++k) {
      if (auto placed = place_onto_pins(k); !placed) return placed;
    }
    return {};
  }

 private:
  const std::vector<Body>& bodies() const { return input_.system->compiled().bodies; }
  Index component(Index body) const { return input_.piece.component[bodies()[body].vertex.front()]; }
  double direction(Index body) const {
    return argument(uv_[bodies()[body].vertex.back()] - uv_[bodies()[body].vertex.front()]);
  }

  void move(Index component, Vec2 factor, Vec2 from, Vec2 to) {
    for (std::size_t v = 0; v < uv_.size(); ++v) {
      if (input_.piece.component[v] == component) uv_[v] = to + multiply(factor, uv_[v] - from);
    }
  }

  /// Components that the u axis directs first, then those that are tied to them.
  void turn_to_directions() {
    const std::vector<Relation>& relations = input_.system->compiled().relations;
    const std::vector<double>& chosen = input_.system->orientation().chosen;
    std::vector<std::uint8_t> settled(input_.piece.topology().num_components, 0);
    const auto settle = [&](Index component, double by) {
      if (by != 0) move(component, unit(by), {}, {});
      settled[component] = 1;
    };
    for (std::size_t k = 0; k < relations.size(); ++k) {
      const Relation& r = relations[k];
      if (r.a == kNone && !settled[component(r.b)])
        settle(component(r.b), reduce_angle(chosen[k] - direction(r.b)));
    }
    for (std::size_t begin = 0; begin <= settled.size(); ++begin) {
      for (std::size_t k = 0; k < relations.size(); ++k) {
        const Relation& r = relations[k];
        if (r.a == kNone || component(r.a) == component(r.b)) continue;
        const double by = reduce_angle(chosen[k] - direction(r.b) + direction(r.a));
        if (settled[component(r.a)] && !settled[component(r.b)]) settle(component(r.b), by);
        if (settled[component(r.b)] && !settled[component(r.a)]) settle(component(r.a), -by);
        if (begin == 0 || settled[component(r.a)]) continue;
        settle(component(r.a), 0);  // nothing directs the two: one stays
        settle(component(r.b), by);
      }
    }
  }

  Result<void> place_onto_pins(Index component) {
    std::vector<Pin> pins;
    for (const Pin& pin : input_.system->pins()) {
      if (input_.piece.component[pin.vertex] == component) pins.push_back(pin);
    }
    if (pins.empty()) return {};
    const std::size_t most = !any_size_ || input_.system->directed()[component] ? 1 : 2;
    if (pins.size() > most) {
      return fail(constraint_error(ErrorCode::ConstraintUnsupported, *input_.view->set, pins[most].constraint,
                                   "this method makes a map of given shape" +
                                       std::string(any_size_ ? "" : " and size") +
                                       ", and has no way to meet more than " + std::to_string(most) + " pin" +
                                       (most > 1 ? "s" : "") + " of this component"));
    }
    Vec2 factor{1, 0};
    if (pins.size() == 2) {
      const Vec2 now = uv_[pins[1].vertex] - uv_[pins[0].vertex], wanted = pins[1].uv - pins[0].uv;
      factor = (1 / dot(now, now)) * multiply(wanted, conjugate(now));
    }
    move(component, factor, uv_[pins[0].vertex], pins[0].uv);
    return {};
  }

  const MapInput& input_;
  bool any_size_;
  Out<Vec2> uv_;
};

}  // namespace

Result<void> place_components(const MapInput& input, bool any_size, Out<Vec2> uv) {
  return input.system ? Placing(input, any_size, uv)() : Result<void>();
}

Result<std::vector<Vec2>> lay_out_and_place(const MapInput& input, In<double> angle, In<double> area,
                                            bool any_size) {
  const Topology& topology = input.piece.topology();
  const Index num_triangles = input.piece.mesh().num_triangles();
  std::vector<double> area_of(topology.num_components, 0);
  for (Index t = 0; t < num_triangles; ++t) area_of[topology.triangle_component[t]] += area[t];
  auto uv =
      lay_out_angles(input.exec, input.piece.mesh().corner_vertex, topology,
                     angle.first(static_cast<std::size_t>(3 * num_triangles)), input.piece.order, area_of);
  if (!uv) return fail(uv.error());
  if (auto placed = place_components(input, any_size, *uv); !placed) return fail(placed.error());
  return uv;
}

}  // namespace planish
