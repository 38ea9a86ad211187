// Times closest points of SurfaceLocator against CGAL's AABB tree on the same queries and threads, in
// alternation, after proving that both find the same distances.
//
// usage: project_bench [--runs N] [--threads N] [--triangles N] [--queries N]
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/features/surface_locator.hpp"
#include "engine/sample/panels.hpp"

namespace {

using namespace planish;
using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(Vec3 p) { return {p.x, p.y, p.z}; }

Triangles triangles_of(const Surface& surface) {
  Triangles triangles;
  triangles.reserve(surface.num_triangles());
  const auto corner = [&](Index c) { return to_cgal(surface.position[surface.corner_vertex[c]]); };
  for (Index t = 0; t < surface.num_triangles(); ++t)
    triangles.emplace_back(corner(3 * t), corner(3 * t + 1), corner(3 * t + 2));
  return triangles;
}

double seconds_of(const auto& run) {
  const auto begin = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// Points of random triangles, moved by up to 2 mm along each axis as drawn curves are.
std::vector<Vec3> near_surface(const Surface& surface, Index count) {
  std::vector<Vec3> points(count);
  std::uint64_t state = 1;
  const auto uniform = [&] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (Vec3& p : points) {
    const auto t = static_cast<Index>(uniform() * surface.num_triangles());
    const double r = std::sqrt(uniform()), s = r * uniform();
    const auto corner = [&](int i) { return surface.position[surface.corner_vertex[3 * t + i]]; };
    p = (1 - r) * corner(0) + (r - s) * corner(1) + s * corner(2);
    p = p + 2e-3 * Vec3{2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1};
  }
  return points;
}

void closest_with_cgal(const Exec& exec, const Tree& tree, In<Vec3> query, Out<double> distance) {
  exec.for_blocks(static_cast<Index>(query.size()), 64, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      const Kernel::Point_3 p = to_cgal(query[i]);
      distance[i] = std::sqrt(CGAL::squared_distance(p, tree.closest_point_and_primitive(p).first));
    }
  });
}

/// Largest difference of distances, relative to the surface's size (about 1 m).
double largest_difference(In<SurfaceLocator::Hit> hit, In<double> distance) {
  double largest = 0;
  for (std::size_t i = 0; i < hit.size(); ++i)
    largest = std::max(largest, std::abs(hit[i].distance - distance[i]));
  return largest;
}

int compare(const Exec& exec, const Surface& surface, Index num_queries, int runs) {
  const std::vector<Vec3> query = near_surface(surface, num_queries);
  const Triangles triangles = triangles_of(surface);
  Tree tree;
  const double cgal_build = seconds_of([&] {
    tree.insert(triangles.begin(), triangles.end());
    tree.build();
    tree.accelerate_distance_queries();
  });
  const auto build_begin = std::chrono::steady_clock::now();
  const SurfaceLocator locator(exec, surface);
  const double build = std::chrono::duration<double>(std::chrono::steady_clock::now() - build_begin).count();
  std::vector<SurfaceLocator::Hit> hit(query.size());
  std::vector<double> distance(query.size());
  locator.nearest(exec, query, hit);
  closest_with_cgal(exec, tree, query, distance);
  const double difference = largest_difference(hit, distance);
  fmt::print("{} triangles, {} queries, {} threads; largest difference of distances {:.1e}\n",
             surface.num_triangles(), num_queries, exec.threads(), difference);
  if (!(difference < 1e-12)) return 1;
  std::vector<double> ours, theirs;
  for (int run = 0; run < runs; ++run) {
    ours.push_back(seconds_of([&] { locator.nearest(exec, query, hit); }));
    theirs.push_back(seconds_of([&] { closest_with_cgal(exec, tree, query, distance); }));
  }
  const double mine = median(ours), peer = median(theirs);
  fmt::print("{:<8} {:>9} {:>12} {:>12}\n", "", "build s", "median s", "points/s");
  fmt::print("{:<8} {:>9.3f} {:>12.4f} {:>12.0f}\n", "planish", build, mine, num_queries / mine);
  fmt::print("{:<8} {:>9.3f} {:>12.4f} {:>12.0f}   ratio {:.2f}\n", "CGAL", cgal_build, peer,
             num_queries / peer, peer / mine);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 7, threads = 0;
  Index triangles = 1'000'000, queries = 200'000;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string argument = argv[i];
    const int value = std::max(1, std::atoi(argv[i + 1]));
    if (argument == "--runs") runs = value;
    if (argument == "--threads") threads = value;
    if (argument == "--triangles") triangles = value;
    if (argument == "--queries") queries = value;
  }
  const Exec exec(threads);
  const auto sample = make_sample(exec, {.kind = "hood", .triangles = triangles, .noise = 1e-4});
  if (!sample) {
    fmt::print(stderr, "{}\n", describe(sample.error()));
    return 2;
  }
  return compare(exec, sample->mesh.surface(), queries, runs);
}
