#include "engine/features/enclosed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct Model {
  explicit Model(Mesh m) : mesh(std::move(m)), topology(build_topology(Exec(1), mesh.surface())) {}
  Mesh mesh;
  Topology topology;

  Result<std::vector<Index>> enclosed(const std::vector<Index>& chain, std::optional<Vec3> seed = {},
                                      bool closed = true) const {
    return enclosed_triangles(mesh.surface(), topology, "plate", chain, closed, {"arch", seed});
  }
  std::vector<Index> loop(Index l) const {
    std::vector<Index> chain;
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l)))
      chain.push_back(mesh.corner_vertex[c]);
    return chain;
  }
};

/// Outline of cells [i0, i1] x [j0, j1] of an n x n grid, counter-clockwise.
std::vector<Index> outline(Index n, Index i0, Index j0, Index i1, Index j1) {
  std::vector<Index> chain;
  for (Index i = i0; i < i1; ++i) chain.push_back(j0 * n + i);
  for (Index j = j0; j < j1; ++j) chain.push_back(j * n + i1);
  for (Index i = i1; i > i0; --i) chain.push_back(j1 * n + i);
  for (Index j = j1; j > j0; --j) chain.push_back(j * n + i0);
  return chain;
}

/// Every edge between the region and the rest of the surface is a step of the chain.
void check_border(const Model& model, const std::vector<Index>& chain, const std::vector<Index>& region) {
  std::set<std::pair<Index, Index>> steps;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Index a = chain[i], b = chain[(i + 1) % chain.size()];
    steps.insert({a, b}), steps.insert({b, a});
  }
  CHECK(std::is_sorted(region.begin(), region.end()));
  for (const Index t : region) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index twin = model.topology.corner_twin[c];
      if (twin == kNone || std::binary_search(region.begin(), region.end(), twin / 3)) continue;
      CHECK(steps.count({model.mesh.corner_vertex[c], model.mesh.corner_vertex[next_corner(c)]}) == 1);
    }
  }
}

void check_error(const Result<std::vector<Index>>& result, const std::string& words) {
  REQUIRE(!result);
  CHECK(result.error().code == ErrorCode::RegionBroken);
  CHECK(result.error().what.find("feature \"plate\"") == 0);
  CHECK_MESSAGE(result.error().what.find(words) != std::string::npos, result.error().what);
}

}  // namespace

TEST_CASE("enclosed: a square on a grid holds its cells, whichever way it runs") {
  const Model model(shapes::height_field(11, shapes::flat, 0));
  std::vector<Index> chain = outline(11, 2, 3, 6, 8);
  const std::vector<Index> inside = model.enclosed(chain).value();
  CHECK(inside.size() == 2 * 4 * 5);
  check_border(model, chain, inside);
  std::reverse(chain.begin(), chain.end());
  CHECK(model.enclosed(chain).value() == inside);
}

TEST_CASE("enclosed: a seed takes its side, from above the surface too") {
  const Model model(shapes::height_field(11, shapes::flat, 0));
  const std::vector<Index> chain = outline(11, 2, 3, 6, 8);
  CHECK(model.enclosed(chain, Vec3{-0.25, 0.1, 0.1}).value() == model.enclosed(chain).value());
  const std::vector<Index> outside = model.enclosed(chain, Vec3{0.9, -3, 0.5}).value();
  CHECK(outside.size() == 200 - 40);
  check_border(model, chain, outside);
}

TEST_CASE("enclosed: a chain around the top of a cube holds two triangles, by area not by number") {
  const Model cube(shapes::cube(1));
  const std::vector<Index> top{4, 5, 7, 6};
  CHECK(cube.enclosed(top).value() == std::vector<Index>{2, 3});
  CHECK(cube.enclosed(top, Vec3{0.5, 0.4, 0}).value().size() == 10);
}

TEST_CASE("enclosed: a closed chain around a hole has the rim's side and the hole's side") {
  const Model model(shapes::frame(16, shapes::flat));
  const std::vector<Index> rim = model.loop(0), hole = model.loop(1);
  const Index all = model.mesh.num_triangles();
  CHECK(model.enclosed(rim).value().size() == all);
  CHECK(model.enclosed(rim, Vec3{0.9, 0.9, 0}).value().size() == all);
  check_error(model.enclosed(hole), "the loop of a hole");
  CHECK(model.enclosed(hole, Vec3{0, 0, 0}).value().size() == all);
  std::vector<Index> backwards(rim.rbegin(), rim.rend());
  CHECK(model.enclosed(backwards).value().size() == all);
}

TEST_CASE("enclosed: a meridian of a torus does not separate it, a small loop does") {
  const Index n = 12;
  const Model model(shapes::torus(n));
  std::vector<Index> meridian;
  for (Index j = 0; j < n; ++j) meridian.push_back(j * n + 3);
  check_error(model.enclosed(meridian), "does not separate");
  check_error(model.enclosed(meridian, Vec3{-3, 0, 0}), "does not separate");
  const std::vector<Index> chain = outline(n, 2, 2, 5, 4);
  const std::vector<Index> region = model.enclosed(chain).value();
  CHECK(region.size() == 2 * 3 * 2);
  check_border(model, chain, region);
}

TEST_CASE("enclosed: an open chain, a short one and one with gaps are refused") {
  const Model model(shapes::height_field(11, shapes::flat, 0));
  check_error(model.enclosed(outline(11, 2, 3, 6, 8), {}, false), "is open");
  check_error(model.enclosed({1, 2}), "fewer than 3");
  check_error(model.enclosed({24, 25, 40}), "share no edge");
  CHECK(model.enclosed({24, 25, 40}).error().ids == std::vector<Index>{25, 40, 40, 24});
}

TEST_CASE("enclosed: halves of the same area need a seed") {
  const Model model(shapes::height_field(11, shapes::flat, 0));
  const std::vector<Index> half = outline(11, 0, 0, 5, 10);
  check_error(model.enclosed(half), "the same area");
  const std::vector<Index> left = model.enclosed(half, Vec3{-0.5, 0, 0}).value();
  CHECK(left.size() == 100);
  check_border(model, half, left);
  CHECK(model.enclosed(half, Vec3{0.5, 0, 0}).value().size() == 100);
  CHECK(model.enclosed(half, Vec3{-3, 0, 0}).value() == left);  // nearest to the boundary part of the chain
}

TEST_CASE("enclosed: a chain that touches the boundary may leave several pieces outside") {
  // A band across the square: the rest is above and below it.
  const Model model(shapes::height_field(11, shapes::flat, 0));
  const std::vector<Index> band = outline(11, 0, 2, 10, 8);
  check_error(model.enclosed(band), "2 pieces");
  CHECK(model.enclosed(band).error().count == 2);
  CHECK(model.enclosed(band, Vec3{0, 0.9, 0}).value().size() == 2 * 10 * 2);
  CHECK(model.enclosed(outline(11, 0, 4, 10, 6)).value().size() == 2 * 10 * 2);
}

TEST_CASE("enclosed: seeds on the chain, on another component or not finite are refused") {
  Mesh far = shapes::height_field(5, shapes::flat, 0);
  for (Vec3& p : far.position) p = p + Vec3{10, 0, 0};
  const Model model(shapes::joined(shapes::height_field(11, shapes::flat, 0), far));
  const std::vector<Index> chain = outline(11, 2, 3, 6, 8);
  check_error(model.enclosed(chain, Vec3{0.2, 0.1, 0}), "on \"arch\" itself");
  check_error(model.enclosed(chain, Vec3{9.8, 0.1, 0}), "another component");
  check_error(model.enclosed(chain, Vec3{0, std::nan(""), 0}), "not a finite number");
  CHECK(model.enclosed(chain, Vec3{0.21, 0.1, 0}).value().size() == 160);
}

TEST_CASE("enclosed: the region does not depend on the numbering") {
  const Mesh mesh = shapes::height_field(11, shapes::flat);
  std::vector<Index> new_of_old, chain = outline(11, 2, 3, 6, 8);
  const Model model(mesh), other(shapes::relabelled(mesh, 4, new_of_old));
  std::vector<Index> moved;
  for (const Index v : chain) moved.push_back(new_of_old[v]);
  const auto triangles = [](const Model& m, const std::vector<Index>& region) {
    std::multiset<double> sums;  // of the corners' coordinates: a label that numbering does not change
    for (const Index t : region) {
      double corners[3];
      for (Index i = 0; i < 3; ++i) {
        const Vec3 p = m.mesh.position[m.mesh.corner_vertex[3 * t + i]];
        corners[i] = p.x + 10 * p.y;
      }
      std::sort(corners, corners + 3);
      sums.insert(corners[0] + 7 * corners[1] + 31 * corners[2]);
    }
    return sums;
  };
  CHECK(triangles(model, model.enclosed(chain).value()) == triangles(other, other.enclosed(moved).value()));
}
