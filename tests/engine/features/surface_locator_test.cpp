#include "engine/features/surface_locator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/support/shapes.hpp"

using namespace planish;
using Hit = SurfaceLocator::Hit;

namespace {

Hit brute_force(const Surface& surface, Vec3 query) {
  Hit best;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const Hit hit = closest_point(surface, t, query);
    if (hit.distance < best.distance) best = hit;
  }
  return best;
}

/// The same distance another way, with 50 digits: vertices, edges, and the plane by cross products.
using Long = boost::multiprecision::cpp_bin_float_50;
struct Long3 {
  Long x, y, z;
};
Long3 minus(Long3 a, Long3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Long dot_of(Long3 a, Long3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Long3 cross_of(Long3 a, Long3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Long edge_distance(Long3 a, Long3 b) {
  const Long3 e = minus(b, a);
  const Long t = std::clamp<Long>(-dot_of(a, e) / dot_of(e, e), 0, 1);
  const Long3 p{a.x + t * e.x, a.y + t * e.y, a.z + t * e.z};
  return sqrt(dot_of(p, p));
}

double reference_distance(const Surface& surface, Index t, Vec3 q) {
  Long3 p[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3 v = surface.position[surface.corner_vertex[3 * t + i]];
    p[i] = {v.x - Long(q.x), v.y - Long(q.y), v.z - Long(q.z)};
  }
  Long best = std::min({edge_distance(p[0], p[1]), edge_distance(p[1], p[2]), edge_distance(p[2], p[0])});
  const Long3 n = cross_of(minus(p[1], p[0]), minus(p[2], p[0]));
  bool inside = true;
  for (int i = 0; i < 3; ++i) {
    const Long3 a = p[i], b = p[(i + 1) % 3];
    inside = inside && dot_of(cross_of(n, minus(b, a)), a) <= 0;
  }
  if (inside) best = std::min<Long>(best, abs(dot_of(p[0], n)) / sqrt(dot_of(n, n)));
  return static_cast<double>(best);
}

Vec3 random_point(shapes::Random& random, double size) {
  const auto coordinate = [&] { return size * (2 * random.uniform() - 1); };
  const double x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

/// The hit is that of the search through all triangles, bit for bit, and lies where it says.
void check_hit(const Surface& surface, Vec3 query, const Hit& hit, double size) {
  const Hit expected = brute_force(surface, query);
  REQUIRE(hit.at.triangle == expected.at.triangle);
  CHECK(hit.distance == expected.distance);
  CHECK(hit.position == expected.position);
  const Vec3 b = hit.at.barycentric;
  CHECK(std::min({b.x, b.y, b.z}) >= 0);
  CHECK(std::abs(b.x + b.y + b.z - 1) < 1e-15);
  CHECK(std::abs(norm(hit.position - query) - hit.distance) <= 1e-13 * (size + norm(query)));
}

Mesh needles(shapes::Random& random, double thinness) {
  Mesh mesh;
  for (Index t = 0; t < 200; ++t) {
    const Vec3 a = random_point(random, 1), b = random_point(random, 1);
    const Vec3 c = a + random.uniform() * (b - a) + random_point(random, thinness);
    for (const Vec3 p : {a, b, c}) mesh.position.push_back(p);
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

}  // namespace

TEST_CASE("closest point: the seven regions of a triangle in closed form") {
  const Mesh mesh = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto at = [&](Vec3 q) { return closest_point(mesh.surface(), 0, q); };
  CHECK(at({-1, -2, 0}).at.barycentric == Vec3{1, 0, 0});
  CHECK(at({3, 1, 5}).at.barycentric == Vec3{0, 1, 0});
  CHECK(at({1, 3, -5}).at.barycentric == Vec3{0, 0, 1});
  CHECK(at({0.25, -1, 0}).at.barycentric == Vec3{0.75, 0.25, 0});
  CHECK(at({-1, 0.25, 0}).at.barycentric == Vec3{0.75, 0, 0.25});
  CHECK(at({1, 1, 2}).at.barycentric == Vec3{0, 0.5, 0.5});
  const Hit inside = at({0.25, 0.5, -3});
  CHECK(inside.at.barycentric == Vec3{0.25, 0.25, 0.5});
  CHECK(inside.distance == 3);
}

TEST_CASE("closest point: needles have the distance of 50-digit arithmetic to 1e-15 of their size") {
  shapes::Random random(5);
  for (const double thinness : {1e-2, 1e-5, 1e-8, 1e-11, 1e-14}) {
    const Mesh mesh = needles(random, thinness);
    for (int k = 0; k < 2000; ++k) {
      const Index t = k % mesh.num_triangles();
      const double w = random.uniform(), size = k % 3 == 0 ? 1 : thinness * 3;
      const Vec3 on = w * mesh.position[3 * t] + (1 - w) * mesh.position[3 * t + 1];
      const Vec3 query = on + random_point(random, size);
      const double expected = reference_distance(mesh.surface(), t, query);
      CHECK(std::abs(closest_point(mesh.surface(), t, query).distance - expected) <= 1e-15);
    }
  }
}

TEST_CASE("locator: finds what a search through all triangles finds, bit for bit") {
  shapes::Random random(11);
  std::vector<Mesh> meshes = {shapes::wavy_disk(3000), shapes::cube(1), shapes::torus(12),
                              needles(random, 1e-8)};
  std::vector<Index> new_of_old;
  meshes.push_back(shapes::relabelled(shapes::rigid_motion(shapes::wavy_disk(1000), 3), 4, new_of_old));
  for (const Mesh& mesh : meshes) {
    const SurfaceLocator locator(Exec(2), mesh.surface());
    const SurfaceLocator for_few(Exec(2), mesh.surface(), SurfaceLocator::Built::ForFewQueries);
    for (int k = 0; k < 300; ++k) {
      const Vec3 query = random_point(random, k % 3 == 0 ? 100 : 1.5);
      const Hit hit = locator.nearest(query), other = for_few.nearest(query);
      check_hit(mesh.surface(), query, hit, 2);
      CHECK(other.at.triangle == hit.at.triangle);
      CHECK(other.position == hit.position);
      const double exact = reference_distance(mesh.surface(), hit.at.triangle, query);
      CHECK(std::abs(hit.distance - exact) <= 1e-13 * (2 + exact));
    }
  }
}

TEST_CASE("locator: coordinates far from the origin and tiny units do not blur it") {
  shapes::Random random(12);
  Mesh far = shapes::wavy_disk(2000);
  for (Vec3& p : far.position) p = p + Vec3{1e6, -1e6, 1e6};
  const SurfaceLocator far_locator(Exec(2), far.surface());
  const Mesh tiny = shapes::scaled(shapes::wavy_disk(2000), 1e-9);
  const SurfaceLocator tiny_locator(Exec(2), tiny.surface());
  for (int k = 0; k < 300; ++k) {
    const Vec3 offset = random_point(random, k % 2 == 0 ? 1.2 : 1e-5);
    const Vec3 near_far = far.position[k] + offset, near_tiny = tiny.position[k] + 1e-9 * offset;
    check_hit(far.surface(), near_far, far_locator.nearest(near_far), 2);
    check_hit(tiny.surface(), near_tiny, tiny_locator.nearest(near_tiny), 1e-9);
  }
}

TEST_CASE("locator: queries at any distance are answered") {
  const Mesh mesh = shapes::wavy_disk(500);
  const SurfaceLocator locator(Exec(1), mesh.surface());
  shapes::Random random(13);
  for (const double size : {1e3, 1e8, 1e17, 1e25, 1e100}) {
    for (int k = 0; k < 10; ++k) {
      const Vec3 query = random_point(random, size);
      CHECK(locator.nearest(query).at.triangle == brute_force(mesh.surface(), query).at.triangle);
    }
  }
  CHECK(locator.nearest({kInfinity, 0, 0}).at.triangle == kNone);
  CHECK(locator.nearest({0, std::nan(""), 0}).at.triangle == kNone);
}

TEST_CASE("locator: every vertex and edge midpoint hits itself, and the smallest of its triangles") {
  const Mesh mesh = shapes::wavy_disk(1000);
  const Surface surface = mesh.surface();
  const SurfaceLocator locator(Exec(2), surface);
  std::vector<Index> smallest(surface.num_vertices(), kNone);
  for (Index c = 3 * surface.num_triangles() - 1; c >= 0; --c) smallest[surface.corner_vertex[c]] = c / 3;
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    const Hit hit = locator.nearest(surface.position[v]);
    CHECK(hit.distance == 0);
    CHECK(hit.position == surface.position[v]);
    CHECK(hit.at.triangle == smallest[v]);
    const Vec3 b = hit.at.barycentric;
    CHECK(std::max({b.x, b.y, b.z}) == 1);
  }
  for (Index c = 0; c < 3 * surface.num_triangles(); ++c) {
    const Vec3 middle = 0.5 * (surface.position[surface.corner_vertex[c]] +
                               surface.position[surface.corner_vertex[next_corner(c)]]);
    const Hit hit = locator.nearest(middle);
    CHECK(hit.distance <= 1e-15);
    CHECK(std::min({hit.at.barycentric.x, hit.at.barycentric.y, hit.at.barycentric.z}) <= 1e-14);
  }
}

TEST_CASE("locator: a radius is a sharp limit") {
  const Mesh mesh = shapes::height_field(9, shapes::flat);
  const SurfaceLocator locator(Exec(1), mesh.surface());
  CHECK(locator.nearest({0.1, 0.2, 0.5}, 0.5).distance == 0.5);
  CHECK(locator.nearest({0.1, 0.2, 0.5}, std::nextafter(0.5, 0)).at.triangle == kNone);
  CHECK(locator.nearest({0.1, 0.2, 0.5}, std::nextafter(0.5, 0)).distance == kInfinity);
  CHECK(locator.nearest(mesh.position[0], 0).distance == 0);
}

TEST_CASE("locator: the search in a group leaves out the others") {
  Mesh above = shapes::height_field(9, shapes::flat);
  for (Vec3& p : above.position) p.z = 1;
  const Mesh mesh = shapes::joined(shapes::height_field(9, shapes::flat), above);
  std::vector<Index> group(mesh.num_triangles(), 0);
  std::fill(group.begin() + mesh.num_triangles() / 2, group.end(), 1);
  const SurfaceLocator locator(Exec(1), mesh.surface());
  CHECK(locator.nearest_in(group, 0, {0.1, 0.2, 0.75}).distance == 0.75);
  CHECK(locator.nearest_in(group, 1, {0.1, 0.2, 0.75}).distance == 0.25);
  CHECK(locator.nearest_in(group, 2, {0.1, 0.2, 0.75}).at.triangle == kNone);
}

TEST_CASE("locator: a moved one answers; a surface without triangles has no nearest point") {
  const Mesh mesh = shapes::cube(1);
  SurfaceLocator locator(Exec(1), Surface{});
  CHECK(locator.nearest({0, 0, 0}).at.triangle == kNone);
  locator = SurfaceLocator(Exec(1), mesh.surface());
  CHECK(locator.nearest({0.5, 0.25, 3}).distance == 2);
}

TEST_CASE("locator: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh = shapes::wavy_disk(5000);
  shapes::Random random(14);
  std::vector<Vec3> query(2000);
  for (Vec3& q : query) q = random_point(random, 1.2);
  const auto hits = [&](int threads) {
    const Exec exec(threads);
    std::vector<Hit> hit(query.size());
    SurfaceLocator(exec, mesh.surface()).nearest(exec, query, hit);
    return hit;
  };
  const auto one = hits(1);
  for (const int threads : {2, 7}) {
    const auto other = hits(threads);
    for (std::size_t i = 0; i < one.size(); ++i) {
      CHECK(other[i].at.triangle == one[i].at.triangle);
      CHECK(std::memcmp(&other[i].position, &one[i].position, sizeof(Vec3)) == 0);
    }
  }
}
