// What flatten and deform do with a finished map: number it, write it, say what became of the constraints.
#pragma once

#include "app/featured.hpp"
#include "engine/cut.hpp"
#include "engine/model/flattening.hpp"
#include "io/placed_feature.hpp"

namespace planish {

/// Outcomes speak of the opened surface; the report, of the mesh that is written.
///   parted: the features on the opened surface
void number_before_cut(const Cut& cut, const std::vector<Feature>& parted, Flattening& flattening);

/// Writes the mesh with its map, one uv a vertex, or a corner where it was opened.   cut: null: it was not
Result<void> write_flattened(const Exec& exec, const std::string& path, const FeaturedMesh& featured,
                             const Cut* cut, In<Vec2> uv, std::vector<std::string>& warnings);

/// The features that constraints speak of, as the flat picture shows them.
std::vector<PlacedFeature> placed_features(const std::vector<Feature>& features,
                                           const ConstraintFacts& constraints);

/// All features, whatever was asked of them.
std::vector<PlacedFeature> all_placed(const std::vector<Feature>& features);

// ---- on the terminal; `mesh` is its file ----

/// How many constraints are met, and the worst of them.
void say_constraints(const ConstraintFacts& constraints);
/// Constraints whose residual is above what is allowed, or no number; whether there is one.
bool say_unmet(const std::string& mesh, const ConstraintFacts& constraints);
/// Lines whose vertices do not follow one another any more; whether there is one.
bool say_disorder(const std::string& mesh, const ConstraintFacts& constraints);
/// How many triangles and vertices are wrong, and the first of them.
void say_flips(const std::string& mesh, const Certificate& certificate);
/// Overlaps that were to be removed and are left; whether there are any.
bool say_unwanted_overlaps(const std::string& mesh, const Flattening& flattening);

}  // namespace planish
