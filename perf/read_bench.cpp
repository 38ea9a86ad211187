// Times read_mesh against CGAL's readers on the same files, in alternation, after proving that both find the
// same numbers of vertices and triangles.
//
// usage: read_bench [--runs N] [--threads N] FILE...
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "io/mesh_files.hpp"

namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

struct Counts {
  std::size_t vertices = 0, triangles = 0;
  bool operator==(const Counts&) const = default;
};

struct Timed {
  Counts counts;
  double seconds = 0;
  bool good = false;
};

template <class Read>
Timed time_of(Read&& read) {
  const auto begin = std::chrono::steady_clock::now();
  Timed timed;
  timed.good = read(timed.counts);
  timed.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return timed;
}

Timed read_with_planish(const planish::Exec& exec, const std::string& path) {
  return time_of([&](Counts& counts) {
    const auto mesh = planish::read_mesh(exec, path);
    if (!mesh) {
      fmt::print(stderr, "{}\n", planish::describe(mesh.error()));
      return false;
    }
    counts = {mesh->position.size(), mesh->corner_vertex.size() / 3};
    return true;
  });
}

/// CGAL's STL reader welds as ours does; the polygons of the other formats count as their triangles.
Timed read_with_cgal(const std::string& path) {
  return time_of([&](Counts& counts) {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> polygons;
    if (!CGAL::IO::read_polygon_soup(path, points, polygons)) return false;
    counts.vertices = points.size();
    for (const auto& polygon : polygons) counts.triangles += polygon.size() - 2;
    return true;
  });
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// One line of the table; false where the readers disagree or fail.
bool compare(const planish::Exec& exec, const std::string& path, int runs) {
  const Timed first = read_with_planish(exec, path), peer = read_with_cgal(path);
  if (!first.good || !peer.good || first.counts != peer.counts) {
    fmt::print("{}: planish {} v {} t{}, CGAL {} v {} t{}\n", path, first.counts.vertices,
               first.counts.triangles, first.good ? "" : " (failed)", peer.counts.vertices,
               peer.counts.triangles, peer.good ? "" : " (failed)");
    return false;
  }
  std::vector<double> ours, theirs;
  for (int run = 0; run < runs; ++run) {
    ours.push_back(read_with_planish(exec, path).seconds);
    theirs.push_back(read_with_cgal(path).seconds);
  }
  const double triangles = static_cast<double>(std::max<std::size_t>(first.counts.triangles, 1));
  fmt::print("{:<40} {:>9} {:>9} {:>9.1f} {:>9.1f} {:>10.1f} {:>7.1f} {:>8.1f}\n", path,
             first.counts.vertices, first.counts.triangles, 1e3 * *std::ranges::min_element(ours),
             1e3 * median(ours), 1e3 * median(theirs), median(theirs) / median(ours),
             1e9 * median(ours) / triangles);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 7, threads = 0;
  std::vector<std::string> paths;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--runs" && i + 1 < argc) {
      runs = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--threads" && i + 1 < argc) {
      threads = std::max(0, std::atoi(argv[++i]));
    } else {
      paths.push_back(argument);
    }
  }
  if (paths.empty()) {
    fmt::print(stderr, "usage: read_bench [--runs N] [--threads N] FILE...\n");
    return 2;
  }
  const planish::Exec exec(threads);
  fmt::print("{} threads, {} runs in alternation, file to mesh, milliseconds\n", exec.threads(), runs);
  fmt::print("{:<40} {:>9} {:>9} {:>9} {:>9} {:>10} {:>7} {:>8}\n", "file", "vertices", "triangles", "min",
             "median", "CGAL", "ratio", "ns/tri");
  bool good = true;
  for (const std::string& path : paths) good = compare(exec, path, runs) && good;
  return good ? 0 : 1;
}
