#include "engine/prepare/repair.hpp"

#include <algorithm>
#include <utility>

#include "engine/prepare/flat_triangles.hpp"
#include "engine/prepare/merge.hpp"
#include "engine/prepare/soup.hpp"

namespace planish {

#ifndef PLANISH_WITH_CGAL_GPL

Result<void> remove_flat_triangles(Soup& soup, MendingLog&) {
  const Precision precision(soup);
  const std::vector<char> marked = triangles_to_mend(soup, precision);
  Error error{.code = ErrorCode::NotBuilt, .element = ElementKind::Triangle};
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    const Index* v = soup.corners(t);
    const bool flat = precision.is_flat(soup.position[v[0]], soup.position[v[1]], soup.position[v[2]]);
    if (!marked[t] || !flat) continue;
    ++error.count;
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(soup.triangle_origin[t]);
  }
  if (error.count == 0) return {};
  error.what =
      "this planish was built without the removal of triangles without area (PLANISH_WITH_CGAL_GPL), "
      "the only mending that is missing";
  return fail(std::move(error));
}

#endif

namespace {

Attribute gather(const Attribute& attribute, In<Index> origin) {
  const std::size_t size = byte_size(attribute.scalar);
  Attribute gathered{attribute.name, attribute.scalar, std::vector<std::byte>(origin.size() * size)};
  for (std::size_t i = 0; i < origin.size(); ++i) {
    std::copy_n(attribute.values.begin() + static_cast<Offset>(origin[i] * size), size,
                gathered.values.begin() + static_cast<Offset>(i * size));
  }
  return gathered;
}

/// Whether all corners of each vertex have one uv.
bool one_uv_a_vertex(In<Index> corner_vertex, In<Vec2> corner_uv, Index num_vertices) {
  std::vector<Index> first(num_vertices, kNone);
  for (Index c = 0; c < static_cast<Index>(corner_vertex.size()); ++c) {
    Index& seen = first[corner_vertex[c]];
    if (seen == kNone) seen = c;
    if (corner_uv[seen] != corner_uv[c]) return false;
  }
  return true;
}

UvSet gather(const UvSet& uv, const Soup& soup) {
  UvSet gathered{uv.name, {}, uv.per_vertex};
  gathered.corner_uv.reserve(soup.corner_origin.size());
  for (Index c : soup.corner_origin) gathered.corner_uv.push_back(uv.corner_uv[c]);
  const auto num_vertices = static_cast<Index>(soup.position.size());
  gathered.per_vertex =
      uv.per_vertex && one_uv_a_vertex(soup.corner_vertex, gathered.corner_uv, num_vertices);
  return gathered;
}

/// A statement is in force from the first triangle left at or after its own.
Statement moved(const Statement& statement, const Soup& soup) {
  const auto first =
      std::lower_bound(soup.triangle_origin.begin(), soup.triangle_origin.end(), statement.triangle);
  return {static_cast<Index>(first - soup.triangle_origin.begin()), statement.text};
}

Mesh mended_mesh(const Mesh& mesh, const Soup& soup) {
  Mesh mended;
  mended.position = soup.position;
  mended.corner_vertex = soup.corner_vertex;
  for (const UvSet& uv : mesh.uv_sets) mended.uv_sets.push_back(gather(uv, soup));
  for (const Attribute& a : mesh.vertex_attributes) {
    mended.vertex_attributes.push_back(gather(a, soup.vertex_origin));
  }
  for (const Attribute& a : mesh.triangle_attributes) {
    mended.triangle_attributes.push_back(gather(a, soup.triangle_origin));
  }
  for (const Statement& s : mesh.statements) mended.statements.push_back(moved(s, soup));
  mended.comments = mesh.comments;
  mended.warnings = mesh.warnings;
  return mended;
}

}  // namespace

Result<Repair> repair(const Mesh& mesh) {
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    if (mesh.corner_vertex[c] >= 0 && mesh.corner_vertex[c] < mesh.num_vertices()) continue;
    return fail(Error{.code = ErrorCode::IndexOutOfRange,
                      .what = "a triangle names a vertex that does not exist",
                      .element = ElementKind::Triangle,
                      .ids = {c / 3},
                      .count = 1});
  }
  Soup soup = make_soup(mesh);
  MendingLog log;
  drop_repeated(soup, log);
  drop_copies(soup, log);
  merge_vertices(soup, log);
  drop_repeated(soup, log);  // those that merging has closed
  drop_copies(soup, log);
  turn_triangles(soup, log);
  split_vertices(soup, log);
  if (const Result<void> removed = remove_flat_triangles(soup, log); !removed) return fail(removed.error());
  Mesh mended = mended_mesh(mesh, soup);
  return Repair{std::move(mended), std::move(soup.vertex_origin), std::move(soup.triangle_origin),
                std::move(log).finish()};
}

}  // namespace planish
