// Steps that flattening a surface and deforming a map of it have in common.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/model/monitor.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// Counts of the mesh; which loops are outer ones is not among them.
MeshFacts mesh_facts(const Workpiece& piece);

/// Features in the numbers of the ordered mesh, triangles ascending.   features: null: none
std::vector<Feature> features_in_order(const OrderedMesh& mesh, const std::vector<Feature>* features);

/// Per component its outer loop: the one of the named feature, else ("": always) the longest.
/// Pre: piece.find_loops().   Fails: ConstraintInvalid where the feature is no boundary loop.
Result<std::vector<Index>> choose_outer(const Workpiece& piece, In<Feature> features,
                                        const std::string& name);

/// The map of a region by itself, for its template.
/// Fails: as flatten(); ConstraintsConflict where triangles are turned over or vertices overwound.
Result<std::vector<Vec2>> map_region(const Surface& region, int threads, const Monitor& monitor);

/// What the constraints left free: counts, no outcomes.
ConstraintFacts constraint_facts(const ConstraintSystem& system, const DofMap& dof, Offset factor_nonzeros);

/// DESIGN 3.8 but for residuals.   uv [V] of the ordered mesh, mesh units; ids of the result are those of the input
Certificate measure_map(const Exec& exec, const Workpiece& piece, In<Vec2> uv);
Certificate measure_without_overlaps(const Exec& exec, const Workpiece& piece, In<Vec2> uv);

/// [input V] from [V] of the ordered mesh; 0 0 for unreferenced vertices.
std::vector<Vec2> in_input_order(const OrderedMesh& mesh, In<Vec2> uv);

}  // namespace planish
