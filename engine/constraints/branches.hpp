// Which of its angles an angle constraint takes, and which bodies share their orientation (DESIGN 3.2, C3; 3.3).
#pragma once

#include "engine/constraints/poses.hpp"

namespace planish {

/// Directions of bodies in the map without relations, as far as that map tells them.
struct Measured {
  std::vector<double> angle;  ///< per body, radians, against the frame of its component
  std::vector<Index> frame;   ///< per body: its component; components have frames that may be turned
  Index num_frames = 0;
};

struct Oriented {
  Clusters clusters;
  std::vector<double> chosen;      ///< per relation: angle from a's line to b's in the plane, radians
  std::vector<double> frame_turn;  ///< per component: by how much its frame is to be turned
  std::vector<Index> frame_set;    ///< per component: components whose frames are tied have one number
  std::vector<std::uint8_t> directed_set;  ///< per frame set: 1 where it is tied to the u axis
};

/// For each relation the representative nearest to what was measured: +-degrees modulo 180, or degrees modulo 360 where it
/// is oriented. Relations that close a cycle must agree; where the nearest ones do not, other representatives are tried.
/// Fails: ConstraintsConflict with a smallest set of relations that no choice satisfies.
Result<Oriented> choose_branches(const Compiled& compiled, const ConstraintView& view,
                                 const Measured& measured);

}  // namespace planish
