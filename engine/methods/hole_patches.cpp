#include "engine/methods/hole_patches.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <iterator>

namespace planish {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Halfedges = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Halfedges::Vertex_index;
using Face = Halfedges::Face_index;

Halfedges halfedges_of(const Surface& surface) {
  Halfedges mesh;
  mesh.reserve(surface.num_vertices(), 2 * surface.num_vertices(), surface.num_triangles());
  for (const Vec3 p : surface.position) mesh.add_vertex({p.x, p.y, p.z});
  const auto vertex = [&](Index c) {
    return Vertex(static_cast<Vertex::size_type>(surface.corner_vertex[c]));
  };
  for (Index t = 0; t < surface.num_triangles(); ++t)
    mesh.add_face(vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2));
  return mesh;
}

}  // namespace

HolePatches patch_holes(const Surface& surface, const Topology& topology, In<Index> loops) {
  namespace processing = CGAL::Polygon_mesh_processing;
  Halfedges mesh = halfedges_of(surface);
  HolePatches patches;
  for (const Index l : loops) {
    const Index c = topology.loop_corner[topology.loop_begin[l]];
    const auto tail = static_cast<Vertex::size_type>(surface.corner_vertex[c]);
    const auto head = static_cast<Vertex::size_type>(surface.corner_vertex[next_corner(c)]);
    const auto border = mesh.halfedge(Vertex(head), Vertex(tail));
    std::vector<Face> faces;
    std::vector<Vertex> vertices;
    processing::triangulate_and_refine_hole(mesh, border, std::back_inserter(faces),
                                            std::back_inserter(vertices));
    if (faces.empty()) patches.unfilled.push_back(l);
    for (const Face f : faces) {
      for (const Vertex v : mesh.vertices_around_face(mesh.halfedge(f)))
        patches.corner_vertex.push_back(static_cast<Index>(v.idx()));
    }
  }
  for (auto v = static_cast<Vertex::size_type>(surface.num_vertices()); v < mesh.number_of_vertices(); ++v) {
    const auto& p = mesh.point(Vertex(v));
    patches.position.push_back({p.x(), p.y(), p.z()});
  }
  return patches;
}

}  // namespace planish
