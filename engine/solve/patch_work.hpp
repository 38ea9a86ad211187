// What is done in the patches of a map, each on its own, in parallel.
#pragma once

#include "engine/solve/driver.hpp"
#include "engine/solve/patches.hpp"

namespace planish {

class PatchWork {
 public:
  /// problem must outlive it. Vertices of features stay where they are.
  PatchWork(const Exec& exec, const ArapProblem& problem);

  /// Removes flips and overwound vertices of x [V], in patches around them and all that is compressed as they are.
  /// Patches that cannot be mended stay as they were.   Fails: OutOfMemory, Cancelled.
  Result<void> untangle(const MapDensity& density, const Monitor& monitor, Out<Vec2> x);

  /// Lowers the energy in patches around what is compressed most: there it is far from quadratic, and steps of the whole
  /// map would all be cut short by the worst place. Until the gradient of DESIGN 3.5, over the energy of the whole, is at
  /// most the tolerance.   Pre: no flips.   Fails: as above.
  Result<void> relax(const MapDensity& density, double tolerance, double whole_energy, const Monitor& monitor,
                     Out<Vec2> x);

  Index steps_done() const { return steps_; }  ///< Newton steps of the slowest patches, added up

 private:
  struct Aim {
    bool untangle;
    double tolerance, whole_energy;  // 0: of the patch itself
    int most_steps;
  };
  Result<void> run(const std::vector<Patch>& patches, const MapDensity& density, const Aim& aim,
                   const Monitor& monitor, Out<Vec2> x);
  std::vector<Index> faults(In<Vec2> x) const;
  std::vector<Index> compressed(In<Vec2> x, double stretch) const;
  std::vector<Patch> patches_around(const std::vector<Index>& faults, In<Vec2> x) const;

  const Exec& exec_;
  ArapEnergy mesh_;
  MapEnergy measure_;
  std::vector<std::uint8_t> movable_;
  std::vector<Index> rank_;
  Index steps_ = 0;
};

}  // namespace planish
