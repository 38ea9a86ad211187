// How a map followed what is held, and from that how it will follow next.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

/// Pairs of how far held vertices went and how far the whole map went with them, from one minimum to the next. The map depends
/// smoothly on what is held, so where it goes next is extrapolated through the minima that were reached: exactly to first order
/// in what is held as far as earlier ways span the new one, and to second order as far as there are enough of them (five for
/// one pin).
class Responses {
 public:
  explicit Responses(const Exec& exec) : exec_(exec) {}

  /// held [any]: change of what is held, always in the same order;  map [V]: change of all vertices. Each begins where the one
  /// learnt before ended.
  void learn(std::vector<Vec2> held, std::vector<Vec2> map);
  /// Adds to the map what the part of a change that earlier ones span lets expect.   held [any], uv [V] in and out
  /// Returns how much of the change is left, over its length; 1 where nothing is added.
  /// Cost: reads the map's changes once.
  double follow(In<Vec2> held, Out<Vec2> uv) const;
  void forget() { known_.clear(); }

 private:
  struct Response {
    std::vector<Vec2> held, map;
  };
  std::vector<double> shares(In<Vec2> held, double second_order, double& left) const;

  const Exec& exec_;
  std::vector<Response> known_;  // newest first
};

}  // namespace planish
