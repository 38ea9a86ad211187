#include "engine/model/options.hpp"

#include "engine/model/deformation.hpp"
#include "engine/model/flattening.hpp"

namespace planish {

const char* name(Method method) {
  switch (method) {
    case Method::Arap: return "arap";
    case Method::Lscm: return "lscm";
    case Method::Dncp: return "dncp";
    case Method::Spectral: return "spectral";
    case Method::Abf: return "abf";
    case Method::Yamabe: return "yamabe";
    case Method::Deform: return "deform";
  }
  return "";
}

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

const char* name(OverlapRemoval::Start start) {
  switch (start) {
    case OverlapRemoval::Start::None: return "none";
    case OverlapRemoval::Start::Straightened: return "straightened";
    case OverlapRemoval::Start::FirstMap: return "first_map";
    case OverlapRemoval::Start::ConvexMap: return "convex_map";
    case OverlapRemoval::Start::Unconstrained: return "unconstrained";
  }
  return "";
}

const char* name(Overlapping overlapping) {
  switch (overlapping) {
    case Overlapping::Report: return "report";
    case Overlapping::Remove: return "remove";
  }
  return "";
}

Overlapping overlapping(const FlattenOptions& options) {
  const bool untangled = options.method == Method::Arap && !options.paper && options.flips == Flips::Untangle;
  return options.overlaps.value_or(untangled ? Overlapping::Remove : Overlapping::Report);
}

const char* name(FeaturePoses poses) {
  switch (poses) {
    case FeaturePoses::Held: return "held";
    case FeaturePoses::Free: return "free";
  }
  return "";
}

const char* name(Reference reference) {
  switch (reference) {
    case Reference::Surface: return "surface";
    case Reference::Parameterization: return "parameterization";
  }
  return "";
}

const char* name(Release release) {
  switch (release) {
    case Release::None: return "none";
    case Release::Features: return "features";
    case Release::Map: return "map";
  }
  return "";
}

}  // namespace planish
