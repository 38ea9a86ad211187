#include "engine/solve/patches.hpp"

#include <algorithm>
#include <numeric>

namespace planish {
namespace {

/// Calls visit(u) for the vertices of the triangles around v.
template <class Visit>
void visit_neighbours(const ArapEnergy& mesh, Index v, Visit visit) {
  for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) {
    visit(mesh.corner_vertex[next_corner(c)]);
    visit(mesh.corner_vertex[previous_corner(c)]);
  }
}

/// Free vertices: those of the seeds and of so many rings around them.
std::vector<Index> vertices_around(const ArapEnergy& mesh, In<Index> seed_triangle, int rings,
                                   In<std::uint8_t> movable, std::vector<std::uint8_t>& marked) {
  std::vector<Index> reached;
  const auto reach = [&](Index v) {
    if (marked[v]) return;
    marked[v] = 1;
    reached.push_back(v);
  };
  for (const Index t : seed_triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) reach(mesh.corner_vertex[c]);
  }
  std::size_t begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const std::size_t end = reached.size();
    for (; begin < end; ++begin) visit_neighbours(mesh, reached[begin], reach);
  }
  std::vector<Index> free;
  for (const Index v : reached) {
    marked[v] = movable[v];
    if (movable[v]) free.push_back(v);
  }
  return free;
}

void complete(const ArapEnergy& mesh, In<Index> rank, Patch& patch) {
  std::sort(patch.vertex.begin(), patch.vertex.end(), [&](Index a, Index b) { return rank[a] < rank[b]; });
  patch.num_free = static_cast<Index>(patch.vertex.size());
  for (const Index v : patch.vertex) {
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) patch.triangle.push_back(c / 3);
  }
  const auto unique = [](auto begin, auto end) {
    std::sort(begin, end);
    return std::unique(begin, end);
  };
  patch.triangle.erase(unique(patch.triangle.begin(), patch.triangle.end()), patch.triangle.end());
  std::vector<Index> free = patch.vertex, rim;
  std::sort(free.begin(), free.end());
  for (const Index t : patch.triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index v = mesh.corner_vertex[c];
      if (!std::binary_search(free.begin(), free.end(), v)) rim.push_back(v);
    }
  }
  rim.erase(unique(rim.begin(), rim.end()), rim.end());
  patch.vertex.insert(patch.vertex.end(), rim.begin(), rim.end());
}

}  // namespace

std::vector<Patch> grow_patches(const ArapEnergy& mesh, In<Index> seed_triangle, int rings,
                                In<std::uint8_t> movable, In<Index> rank) {
  std::vector<std::uint8_t> marked(mesh.num_vertices(), 0);
  const std::vector<Index> free = vertices_around(mesh, seed_triangle, rings, movable, marked);
  std::vector<Patch> patches;
  for (const Index root : free) {
    if (!marked[root]) continue;
    marked[root] = 0;
    Patch patch;
    patch.vertex.push_back(root);
    for (std::size_t i = 0; i < patch.vertex.size(); ++i) {
      visit_neighbours(mesh, patch.vertex[i], [&](Index u) {
        if (!marked[u]) return;
        marked[u] = 0;
        patch.vertex.push_back(u);
      });
    }
    complete(mesh, rank, patch);
    patches.push_back(std::move(patch));
  }
  return patches;
}

Patch grow_patch(const ArapEnergy& mesh, In<Index> seed_triangle, int rings, In<std::uint8_t> movable,
                 In<Index> rank) {
  std::vector<std::uint8_t> marked(mesh.num_vertices(), 0);
  Patch patch;
  patch.vertex = vertices_around(mesh, seed_triangle, rings, movable, marked);
  complete(mesh, rank, patch);
  return patch;
}

PatchMesh::PatchMesh(const ArapEnergy& mesh, const Patch& patch) : num_free_(patch.num_free) {
  const auto num_vertices = static_cast<Index>(patch.vertex.size());
  std::vector<std::pair<Index, Index>> place;  // of the mesh's vertices here
  for (Index i = 0; i < num_vertices; ++i) place.emplace_back(patch.vertex[i], i);
  std::sort(place.begin(), place.end());
  double area_sum = 0;
  for (const Index t : patch.triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const auto found = std::lower_bound(place.begin(), place.end(), std::pair(mesh.corner_vertex[c], 0));
      corner_vertex_.push_back(found->second);
      cotangent_.push_back(mesh.cotangent[c]);
    }
    frame_.push_back(mesh.frame[t]);
    area_sum += area(mesh.frame[t]);
  }
  fixed_.assign(num_vertices, 0);
  std::fill(fixed_.begin() + num_free_, fixed_.end(), std::uint8_t{1});
  // Stars in the mesh's own order around each free vertex; those of the rim are open and in any order.
  std::vector<std::vector<Index>> star(num_vertices);
  for (Index i = 0; i < num_free_; ++i) {
    for (const Index c : slice(mesh.star_corner, mesh.stars.group(patch.vertex[i]))) {
      const auto t = std::lower_bound(patch.triangle.begin(), patch.triangle.end(), c / 3);
      star[i].push_back(3 * static_cast<Index>(t - patch.triangle.begin()) + c % 3);
    }
  }
  for (Index c = 0; c < static_cast<Index>(corner_vertex_.size()); ++c) {
    if (corner_vertex_[c] >= num_free_) star[corner_vertex_[c]].push_back(c);
  }
  star_begin_.push_back(0);
  for (const std::vector<Index>& s : star) {
    star_corner_.insert(star_corner_.end(), s.begin(), s.end());
    star_begin_.push_back(static_cast<Index>(star_corner_.size()));
  }
  energy_ = {.corner_vertex = corner_vertex_,
             .stars = {star_begin_},
             .star_corner = star_corner_,
             .frame = frame_,
             .cotangent = cotangent_,
             .fixed = fixed_,
             .area = area_sum};
}

ReducedUnknowns PatchMesh::unknowns() const {
  ReducedUnknowns unknowns;
  unknowns.vertex.resize(num_free_);
  std::iota(unknowns.vertex.begin(), unknowns.vertex.end(), 0);
  unknowns.pair.assign(fixed_.size(), kNone);
  std::iota(unknowns.pair.begin(), unknowns.pair.begin() + num_free_, 0);
  unknowns.size = 2 * num_free_;
  return unknowns;
}

}  // namespace planish
