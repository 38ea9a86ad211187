#include <cstring>

#include "io/line_chunks.hpp"
#include "io/mesh_files.hpp"
#include "io/obj_chunk.hpp"
#include "io/polygons.hpp"
#include "io/uv_set.hpp"

namespace planish {
namespace {

/// Elements of the whole file before each chunk.
struct ObjBase {
  Offset vertices = 0, uvs = 0, corners = 0, faces = 0;
  Offset coloured = 0, corners_with_uv = 0, statements = 0, normals = 0;
};

struct ObjFile {
  std::string_view bytes;
  const std::string& file;
  std::vector<std::string_view> text;  ///< of the chunks
  std::vector<ObjChunk> chunk;
  std::vector<ObjBase> base;  ///< [chunks + 1], the last are the totals
  const ObjBase& total() const { return base.back(); }
  Index num_chunks() const { return static_cast<Index>(chunk.size()); }
};

std::vector<ObjBase> scan(const std::vector<ObjChunk>& chunks) {
  std::vector<ObjBase> base = {ObjBase{}};
  for (const ObjChunk& chunk : chunks) {
    ObjBase next = base.back();
    next.vertices += static_cast<Offset>(chunk.position.size());
    next.uvs += static_cast<Offset>(chunk.uv.size());
    next.corners += static_cast<Offset>(chunk.corner_vertex.value.size());
    next.faces += static_cast<Offset>(chunk.face_end.size());
    next.coloured += static_cast<Offset>(chunk.colour.size());
    next.corners_with_uv += chunk.corners_with_uv;
    next.statements += static_cast<Offset>(chunk.statements.size());
    next.normals += chunk.normals;
    base.push_back(next);
  }
  return base;
}

Error error_at(const ObjFile& obj, ErrorCode code, std::string what, const char* position) {
  return {.code = code, .what = std::move(what), .place = place_in(obj.bytes, position, obj.file)};
}

/// The sentence about corner `corner` of chunk k, which names something that does not exist.
Error index_error(const ObjFile& obj, Index k, Index corner, bool of_uv, Offset defined) {
  const char* position = find_obj_index(obj.text[k], corner, of_uv);
  Offset named = 0;
  Cursor(obj.text[k].substr(static_cast<std::size_t>(position - obj.text[k].data())), kObjDialect)
      .read_integer(named);
  const std::string thing = of_uv ? "texture coordinate " : "vertex ";
  std::string what = "face names " + thing + std::to_string(named) + ", ";
  what += named == 0  ? "but OBJ counts from 1"
          : named > 0 ? "only " + std::to_string(defined) + " are defined"
                      : "but fewer are defined before it";
  return error_at(obj, ErrorCode::IndexOutOfRange, std::move(what), position);
}

/// Copies a chunk's indices to their place, counted from the file's first element; the first corner out of
/// range, or kNone.
Index place_indices(const ObjIndices& indices, Offset base, Offset limit, bool may_be_none, Out<Index> out) {
  std::size_t next_relative = 0;
  for (std::size_t c = 0; c < indices.value.size(); ++c) {
    Offset value = indices.value[c];
    if (next_relative < indices.relative.size() && indices.relative[next_relative] == static_cast<Index>(c)) {
      ++next_relative;
      value += base;
      if (value < 0) return static_cast<Index>(c);
    }
    if (value >= limit || (value < 0 && !(may_be_none && value == kNone))) return static_cast<Index>(c);
    out[c] = static_cast<Index>(value);
  }
  return kNone;
}

/// Indices of all corners; `of_uv` says which kind.
Result<std::vector<Index>> gather_indices(const Exec& exec, const ObjFile& obj, bool of_uv) {
  std::vector<Index> index(obj.total().corners);
  std::vector<Index> bad(obj.chunk.size(), kNone);
  const Offset limit = of_uv ? obj.total().uvs : obj.total().vertices;
  exec.for_tasks(obj.num_chunks(), [&](Index k) {
    const ObjIndices& indices = of_uv ? obj.chunk[k].corner_uv : obj.chunk[k].corner_vertex;
    const Offset base = of_uv ? obj.base[k].uvs : obj.base[k].vertices;
    bad[k] = place_indices(indices, base, limit, of_uv, Out<Index>(index).subspan(obj.base[k].corners));
  });
  for (Index k = 0; k < obj.num_chunks(); ++k) {
    if (bad[k] != kNone) return fail(index_error(obj, k, bad[k], of_uv, limit));
  }
  return index;
}

/// All chunks' elements behind each other.
template <class T>
std::vector<T> gather(const Exec& exec, const ObjFile& obj, std::vector<T> ObjChunk::*column,
                      Offset ObjBase::*count) {
  std::vector<T> all(obj.total().*count);
  exec.for_tasks(obj.num_chunks(),
                 [&](Index k) { std::ranges::copy(obj.chunk[k].*column, all.begin() + obj.base[k].*count); });
  return all;
}

/// Offsets of the faces' corners.
std::vector<Index> face_begin(const Exec& exec, const ObjFile& obj) {
  std::vector<Index> begin(obj.total().faces + 1, 0);
  exec.for_tasks(obj.num_chunks(), [&](Index k) {
    const auto corners = static_cast<Index>(obj.base[k].corners);
    Index* out = begin.data() + obj.base[k].faces + 1;
    for (const Index end : obj.chunk[k].face_end) *out++ = corners + end;
  });
  return begin;
}

void keep_colours(const Exec& exec, const ObjFile& obj, Mesh& mesh) {
  if (obj.total().coloured == 0) return;
  if (obj.total().coloured != obj.total().vertices) {
    mesh.warnings.push_back("vertex colours are left out: only " + std::to_string(obj.total().coloured) +
                            " of " + std::to_string(obj.total().vertices) + " vertices have one");
    return;
  }
  const std::vector<Vec3> colour = gather(exec, obj, &ObjChunk::colour, &ObjBase::coloured);
  const std::pair<const char*, double Vec3::*> kColumns[] = {
      {"red", &Vec3::x}, {"green", &Vec3::y}, {"blue", &Vec3::z}};
  for (const auto& [name, member] : kColumns) {
    Attribute attribute{.name = name, .scalar = Scalar::Float64, .values = {}};
    attribute.values.resize(colour.size() * sizeof(double));
    for (std::size_t v = 0; v < colour.size(); ++v) {
      std::memcpy(attribute.values.data() + v * sizeof(double), &(colour[v].*member), sizeof(double));
    }
    mesh.vertex_attributes.push_back(std::move(attribute));
  }
}

void warn_of_normals(const ObjFile& obj, Mesh& mesh) {
  const Offset normals = obj.total().normals;
  if (normals == 0) return;
  mesh.warnings.push_back(std::to_string(normals) + (normals == 1 ? " normal is" : " normals are") +
                          " not kept");
}

/// Verbatim but for joined line ends, which become a space.
std::string statement_text(std::string_view text) {
  std::string joined;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    const std::size_t length = rest.starts_with("\\\n") ? 2 : rest.starts_with("\\\r\n") ? 3 : 0;
    joined += length > 0 ? ' ' : text[i];
    if (length > 0) i += length - 1;
  }
  return joined;
}

void keep_statements(const ObjFile& obj, Mesh& mesh) {
  mesh.statements.reserve(obj.total().statements);
  for (Index k = 0; k < obj.num_chunks(); ++k) {
    for (const ObjStatement& statement : obj.chunk[k].statements) {
      const Offset corners = obj.base[k].corners + statement.corners_before;
      const Offset faces = obj.base[k].faces + statement.faces_before;
      mesh.statements.push_back(
          {.triangle = static_cast<Index>(corners - 2 * faces), .text = statement_text(statement.text)});
    }
  }
}

/// The comments at the head of the file, which speak about all of it.
void keep_head_comments(std::string_view bytes, Mesh& mesh) {
  Cursor cursor(bytes, {});
  while (!cursor.at_end()) {
    const bool blank = cursor.at_line_end();
    if (!blank && *cursor.position() != '#') return;
    std::string_view line = cursor.rest_of_line();
    if (blank) continue;
    line.remove_prefix(std::min(line.find_first_not_of("# \t"), line.size()));
    if (!line.empty()) mesh.comments.emplace_back(line);
  }
}

Result<void> keep_faces(const Exec& exec, const ObjFile& obj, Mesh& mesh) {
  auto corner_vertex = gather_indices(exec, obj, false);
  if (!corner_vertex) return fail(std::move(corner_vertex.error()));
  const Offset with_uv = obj.total().corners_with_uv;
  const bool has_uv = with_uv > 0 && with_uv == obj.total().corners;
  std::vector<Index> corner_uv;
  if (with_uv > 0) {
    auto index = gather_indices(exec, obj, true);
    if (!index) return fail(std::move(index.error()));
    if (has_uv) corner_uv = std::move(*index);
  }
  if (with_uv > 0 && !has_uv) {
    mesh.warnings.push_back("texture coordinates are left out: only " + std::to_string(with_uv) + " of " +
                            std::to_string(obj.total().corners) + " face corners have one");
  }
  std::vector<Index> triangle_corner;  // empty: all faces are triangles
  if (obj.total().corners != 3 * obj.total().faces) {
    const std::vector<Index> begin = face_begin(exec, obj);
    triangle_corner = triangulate(exec, {begin}, *corner_vertex, mesh.position);
  }
  const auto num_corners = static_cast<Index>(3 * (obj.total().corners - 2 * obj.total().faces));
  const auto corner = [&](Index c) { return triangle_corner.empty() ? c : triangle_corner[c]; };
  if (triangle_corner.empty()) {
    mesh.corner_vertex = std::move(*corner_vertex);
  } else {
    mesh.corner_vertex.resize(num_corners);
    for (Index c = 0; c < num_corners; ++c) mesh.corner_vertex[c] = (*corner_vertex)[corner(c)];
  }
  if (!has_uv) return {};
  const std::vector<Vec2> uv = gather(exec, obj, &ObjChunk::uv, &ObjBase::uvs);
  UvSet set{.name = "vt", .corner_uv = std::vector<Vec2>(num_corners)};
  exec.for_blocks(num_corners, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) set.corner_uv[c] = uv[corner_uv[corner(c)]];
  });
  set.per_vertex = is_per_vertex(exec, mesh.corner_vertex, set.corner_uv, mesh.num_vertices());
  mesh.uv_sets.push_back(std::move(set));
  return {};
}

}  // namespace

Result<Mesh> read_obj(const Exec& exec, std::string_view bytes, const std::string& file) {
  ObjFile obj{.bytes = bytes, .file = file, .text = line_chunks(bytes, kObjDialect), .chunk = {}, .base = {}};
  obj.chunk.resize(obj.text.size());
  exec.for_tasks(obj.num_chunks(), [&](Index k) { obj.chunk[k] = parse_obj_chunk(obj.text[k]); });
  for (const ObjChunk& chunk : obj.chunk) {
    if (chunk.fault) return fail(error_at(obj, chunk.fault->code, chunk.fault->what, chunk.fault->position));
  }
  obj.base = scan(obj.chunk);
  constexpr Offset kMost = std::numeric_limits<Index>::max();
  const ObjBase& total = obj.total();
  if (std::max({total.vertices, total.uvs, total.corners, 3 * (total.corners - 2 * total.faces)}) >= kMost) {
    return fail(Error{.code = ErrorCode::TooLarge,
                      .what = std::to_string(total.vertices) + " vertices and " +
                              std::to_string(total.faces) + " faces are more than 32-bit indices can count",
                      .place = {.file = file}});
  }
  Mesh mesh;
  mesh.position = gather(exec, obj, &ObjChunk::position, &ObjBase::vertices);
  keep_head_comments(bytes, mesh);
  keep_colours(exec, obj, mesh);
  keep_statements(obj, mesh);
  warn_of_normals(obj, mesh);
  if (const auto kept = keep_faces(exec, obj, mesh); !kept) return fail(kept.error());
  return mesh;
}

}  // namespace planish
