// The steps that flatten and embed share: read the mesh and its constraints, put the features into its edges.
#pragma once

#include <optional>

#include "app/common.hpp"
#include "engine/model/constraint.hpp"
#include "engine/model/embedding.hpp"

namespace planish {

struct FeaturedMesh {
  Input input;
  ConstraintSet set;                   ///< empty without a constraint file
  std::optional<Embedding> embedding;  ///< where the set has features
  Mesh mesh;                           ///< what is worked on and written: the input, or the embedding of it
};

/// constraints: path of the file, or "".   Errors name the file at fault.
Result<FeaturedMesh> read_featured(const Exec& exec, const std::string& mesh, const std::string& constraints,
                                   bool mend, const Monitor& monitor, Stopwatch& stopwatch);

}  // namespace planish
