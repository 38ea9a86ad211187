#include "engine/prepare/flat_triangles.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/Euler_operations.h>

#include <algorithm>
#include <utility>

namespace planish {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Halfedges = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Halfedges::Vertex_index;
using Halfedge = Halfedges::Halfedge_index;
using Face = Halfedges::Face_index;

/// The marked triangles as halfedges, which remember triangle, vertex and corner.
class FlatTriangles {
 public:
  FlatTriangles(const Soup& soup, const Precision& precision, MendingLog& log)
      : soup_(soup),
        precision_(precision),
        log_(log),
        triangle_(mesh_.add_property_map<Face, Index>("f:triangle", kNone).first),
        vertex_(mesh_.add_property_map<Vertex, Index>("v:vertex", kNone).first),
        corner_origin_(mesh_.add_property_map<Halfedge, Index>("h:corner", kNone).first) {}

  /// False where the triangles do not fit together.
  bool load(const std::vector<char>& marked) {
    std::vector<Vertex> of(soup_.position.size());
    for (Index t = 0; t < soup_.num_triangles(); ++t) {
      if (!marked[t]) continue;
      for (Index i = 0; i < 3; ++i) {
        const Index v = soup_.corners(t)[i];
        if (of[v] != Halfedges::null_vertex()) continue;
        of[v] = mesh_.add_vertex({soup_.position[v].x, soup_.position[v].y, soup_.position[v].z});
        vertex_[of[v]] = v;
      }
      const Index* v = soup_.corners(t);
      const Face face = mesh_.add_face(of[v[0]], of[v[1]], of[v[2]]);
      if (face == Halfedges::null_face()) return false;
      triangle_[face] = t;
      for (Halfedge h : mesh_.halfedges_around_face(mesh_.halfedge(face))) {
        const Index* at = std::find(v, v + 3, vertex_[mesh_.target(h)]);
        corner_origin_[h] = soup_.corner_origin[3 * t + static_cast<Index>(at - v)];
      }
    }
    return true;
  }

  /// One mending can make room for another; every round but the last mends something.
  void mend() {
    constexpr int kRounds = 64;
    bool changed = true;
    for (int round = 0; round < kRounds && changed; ++round) {
      changed = false;
      std::vector<Face> flat;
      for (Face face : mesh_.faces()) {
        if (is_flat(face)) flat.push_back(face);
      }
      for (Face face : flat) {
        if (!mesh_.is_removed(face) && is_flat(face) && mend(face)) changed = true;
      }
    }
  }

  /// Calls body(triangle, vertices, corner origins) for every triangle left.
  template <class Body>
  void for_each_triangle(Body&& body) const {
    for (Face face : mesh_.faces()) {
      Index v[3], origin[3];
      Halfedge h = first_halfedge(face);
      for (int i = 0; i < 3; ++i, h = mesh_.next(h)) {
        v[i] = vertex_[mesh_.target(h)];
        origin[i] = corner_origin_[h];
      }
      body(triangle_[face], v, origin);
    }
  }

 private:
  /// The one whose corner came first in the input, so that untouched triangles keep their order of corners.
  Halfedge first_halfedge(Face face) const {
    const Index* v = soup_.corners(triangle_[face]);
    for (Halfedge h : mesh_.halfedges_around_face(mesh_.halfedge(face))) {
      if (vertex_[mesh_.target(h)] == v[0]) return h;
    }
    return mesh_.halfedge(face);
  }

  Vec3 position(Vertex v) const { return soup_.position[vertex_[v]]; }
  double length(Halfedge h) const {
    return precision_.distance(position(mesh_.source(h)), position(mesh_.target(h)));
  }
  Index input_triangle(Face face) const { return soup_.triangle_origin[triangle_[face]]; }
  bool on_border(Halfedge h) const { return mesh_.is_border(mesh_.opposite(h)); }

  bool is_flat(Face face) const {
    const Halfedge h = mesh_.halfedge(face);
    return precision_.is_flat(position(mesh_.source(h)), position(mesh_.target(h)),
                              position(mesh_.target(mesh_.next(h))));
  }

  bool mend(Face face) {
    Halfedge longest = mesh_.halfedge(face), shortest = longest;
    for (Halfedge h : mesh_.halfedges_around_face(longest)) {
      if (length(h) > length(longest)) longest = h;
      if (length(h) < length(shortest)) shortest = h;
    }
    if (length(shortest) <= precision_.least_altitude()) return collapse(shortest);
    return on_border(longest) ? remove(face, longest) : flip(longest);
  }

  /// A needle: the ends of its short edge become one; an end on the border stays.
  bool collapse(Halfedge h) {
    if (mesh_.is_border(mesh_.source(h)) && !mesh_.is_border(mesh_.target(h))) h = mesh_.opposite(h);
    if (!CGAL::Euler::does_satisfy_link_condition(mesh_.edge(h), mesh_)) return false;
    log_.add("closed edges shorter than the coordinates can tell",
             soup_.vertex_origin[vertex_[mesh_.source(h)]]);
    CGAL::Euler::collapse_edge(mesh_.edge(h), mesh_);
    return true;
  }

  /// A cap at the border: its long edge gives way to the other two. With its apex on the border too that
  /// would tear the surface, unless the triangle hangs on by one edge only.
  bool remove(Face face, Halfedge longest) {
    Index borders = 0;
    for (Halfedge h : mesh_.halfedges_around_face(longest)) borders += on_border(h);
    if (borders == 1 && mesh_.is_border(mesh_.target(mesh_.next(longest)))) return false;
    log_.add("removed triangles without area at the border", input_triangle(face));
    CGAL::Euler::remove_face(longest, mesh_);
    return true;
  }

  /// A cap inside: its long edge is replaced by the one from its apex across the neighbour, if that leaves
  /// fewer flat triangles, or as many with a shorter edge between them: so flips come to an end.
  bool flip(Halfedge h) {
    const Halfedge across = mesh_.opposite(h);
    const Vertex a = mesh_.source(h), b = mesh_.target(h);
    const Vertex p = mesh_.target(mesh_.next(h)), q = mesh_.target(mesh_.next(across));
    if (p == q || mesh_.halfedge(p, q) != Halfedges::null_halfedge()) return false;
    const int before = 1 + is_flat(mesh_.face(across));
    const int after = precision_.is_flat(position(a), position(q), position(p)) +
                      precision_.is_flat(position(b), position(p), position(q));
    if (after > before || (after == before && precision_.distance(position(p), position(q)) >= length(h)))
      return false;
    const Index corner_p = corner_origin_[mesh_.next(h)], corner_q = corner_origin_[mesh_.next(across)];
    log_.add("flipped the long edge of triangles without area", input_triangle(mesh_.face(h)));
    CGAL::Euler::flip_edge(h, mesh_);
    for (Halfedge side : {h, across}) corner_origin_[side] = mesh_.target(side) == p ? corner_p : corner_q;
    return true;
  }

  const Soup& soup_;
  const Precision& precision_;
  MendingLog& log_;
  Halfedges mesh_;
  Halfedges::Property_map<Face, Index> triangle_;
  Halfedges::Property_map<Vertex, Index> vertex_;
  Halfedges::Property_map<Halfedge, Index> corner_origin_;
};

}  // namespace

Result<void> remove_flat_triangles(Soup& soup, MendingLog& log) {
  const Precision precision(soup);
  const std::vector<char> marked = triangles_to_mend(soup, precision);
  if (std::find(marked.begin(), marked.end(), 1) == marked.end()) return {};
  FlatTriangles flat(soup, precision, log);
  if (!flat.load(marked))
    return fail(ErrorCode::InternalDefect, "repair met a component that is not manifold");
  flat.mend();
  std::vector<char> keep(soup.num_triangles());
  for (Index t = 0; t < soup.num_triangles(); ++t) keep[t] = !marked[t];
  Soup mended = soup;
  flat.for_each_triangle([&](Index t, const Index* v, const Index* origin) {
    keep[t] = 1;
    std::copy(v, v + 3, mended.corner_vertex.begin() + 3 * t);
    std::copy(origin, origin + 3, mended.corner_origin.begin() + 3 * t);
  });
  keep_triangles(mended, keep);
  soup = std::move(mended);
  return {};
}

}  // namespace planish
