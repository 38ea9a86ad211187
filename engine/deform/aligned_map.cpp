#include "engine/deform/aligned_map.hpp"

#include "engine/deform/given_map.hpp"

namespace planish {

Placement then(const Placement& first, const Placement& second) {
  return {second.p + multiply(second.c, first.p), multiply(second.c, first.c)};
}

Result<std::vector<Placement>> align_map(const Workpiece& piece, ConstraintSystem& system, Out<Vec2> uv) {
  const Index num_components = piece.topology().num_components;
  const std::vector<Pin>& pins = system.pins();
  std::vector<Placement> motion = onto_pins(pins, piece.component, num_components, uv);
  move_components(motion, piece.component, uv);
  auto by = system.orient_at(uv);
  if (!by) return fail(by.error());
  std::vector<Index> count(num_components, 0);
  for (const Pin& pin : pins) ++count[piece.component[pin.vertex]];
  for (Index k = 0; k < num_components; ++k) {
    if (count[k] > 1) (*by)[k] = 0;  // how it is turned is for its pins to say
  }
  const std::vector<Placement> turned = turns(*by, pins, piece.component, uv);
  move_components(turned, piece.component, uv);
  for (Index k = 0; k < num_components; ++k) motion[k] = then(motion[k], turned[k]);
  return motion;
}

}  // namespace planish
