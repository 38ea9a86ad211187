#include "engine/model/options.hpp"

namespace planish {

const char* name(Energy energy) {
  switch (energy) {
    case Energy::Arap: return "arap";
    case Energy::SymmetricDirichlet: return "symmetric-dirichlet";
  }
  return "";
}

const char* name(Flips flips) {
  switch (flips) {
    case Flips::Untangle: return "untangle";
    case Flips::Weights: return "weights";
    case Flips::Stiffening: return "stiffening";
    case Flips::Keep: return "keep";
  }
  return "";
}

}  // namespace planish
