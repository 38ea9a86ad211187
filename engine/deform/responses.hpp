// How a map followed what is held, and from that how it will follow next.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

/// Pairs of how far held vertices went and how far the whole map went with them, from one minimum to the next. To first order
/// the second depends linearly on the first, so a new way of held vertices that earlier ones span is followed by their
/// combination.
class Responses {
 public:
  explicit Responses(const Exec& exec) : exec_(exec) {}

  /// held [any]: change of what is held, always in the same order;  map [V]: change of all vertices
  void learn(std::vector<Vec2> held, std::vector<Vec2> map);
  /// Adds to the map what the part of a change that earlier ones span lets expect.   held [any], uv [V] in and out
  /// Returns how much of the change is left, over its length; 1 where nothing is added.
  double follow(In<Vec2> held, Out<Vec2> uv) const;
  void forget() { known_.clear(); }

 private:
  struct Response {
    std::vector<Vec2> held, map;
  };
  const Exec& exec_;
  std::vector<Response> known_;  // newest first
};

}  // namespace planish
