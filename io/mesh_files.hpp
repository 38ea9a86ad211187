// Readers and writers of mesh files, chosen by extension (and first bytes where the name tells nothing).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// Parsers of one format from bytes; `file` is used in errors only.
/// Fails: BadSyntax, Truncated, IndexOutOfRange, TooLarge, each with its place.
Result<Mesh> read_obj(const Exec& exec, std::string_view bytes, const std::string& file);
Result<Mesh> read_ply(const Exec& exec, std::string_view bytes, const std::string& file);
Result<Mesh> read_stl(const Exec& exec, std::string_view bytes, const std::string& file);
Result<Mesh> read_off(const Exec& exec, std::string_view bytes, const std::string& file);

/// Reads .obj .ply .stl .off, each also with .gz; the extension is not case-sensitive.
/// Fails: CannotOpen, UnknownFormat, and what the parsers fail with.
Result<Mesh> read_mesh(const Exec& exec, const std::string& path);

/// What is written beside the mesh itself.
struct MeshOutput {
  const Mesh* mesh = nullptr;      ///< positions, triangles, attributes, statements
  In<Vec2> uv = {};                ///< [V] one uv a vertex; empty: none
  In<Vec2> corner_uv = {};         ///< [3 T] or empty: written in place of `uv`; several a vertex: seams
  In<Index> triangle_origin = {};  ///< [T] or empty: provenance, PLY only
  In<Index> vertex_origin_triangle = {};  ///< [V] or empty: triangle of the input with the vertex, PLY only
  In<Vec3> vertex_barycentric = {};       ///< [V] or empty: its barycentric coordinates there, PLY only
  const std::vector<Feature>* features = nullptr;  ///< on this mesh; regions PLY only
};

/// File contents (DESIGN 4.3); numbers read back bit for bit. `warnings` receives what the format cannot
/// hold, a sentence each. PLY keeps the input's uv sets beside the new one: per-vertex sets under their own
/// or a free spelling, sets with seams as face scalars u0 v0 u1 v1 u2 v2; OBJ groups and materials become
/// face scalars with names in the comments.
/// Corner uv: corners of a vertex with the same bits share one `vt` in OBJ; PLY has the face list texcoord.
/// Features: OBJ has a group and a line `l` for each chain after the faces; PLY has an element `edge` with the
/// feature's number, a face scalar `region`, and the features' names in comments "feature NUMBER NAME".
std::string format_obj(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings);
std::string format_ply(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings);

/// Writes .obj or .ply (optionally .gz) by extension.
/// Fails: UnknownFormat for other extensions; CannotWrite.
Result<void> write_mesh(const Exec& exec, const std::string& path, const MeshOutput& output,
                        std::vector<std::string>& warnings);

}  // namespace planish
