#include "engine/features/select.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/features/one_ring.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct Model {
  explicit Model(Mesh m) : mesh(std::move(m)), topology(build_topology(Exec(1), mesh.surface())) {}
  Mesh mesh;
  Topology topology;

  Result<std::vector<Index>> vertices(std::vector<Index> list, bool closed = false,
                                      bool shortest = false) const {
    return chain_of_vertices(mesh.surface(), topology, "sill", {std::move(list), closed, shortest});
  }
};

/// 5 x 5 vertices, numbered by rows.
Model grid() { return Model(shapes::height_field(5, shapes::flat, 0)); }

void check_error(const Result<std::vector<Index>>& result, ErrorCode code, std::vector<Index> ids,
                 const std::string& words) {
  REQUIRE(!result);
  const Error& error = result.error();
  CHECK(error.code == code);
  CHECK(error.ids == ids);
  CHECK_MESSAGE(error.what.find(words) != std::string::npos, error.what);
  CHECK(error.what.find("feature \"sill\"") == 0);
}

}  // namespace

TEST_CASE("select: vertices that share edges are the chain itself") {
  const Model model = grid();
  CHECK(model.vertices({10, 11, 12, 13, 14}).value() == std::vector<Index>{10, 11, 12, 13, 14});
  CHECK(model.vertices({6, 7, 12, 11}, true).value() == std::vector<Index>{6, 7, 12, 11});
}

TEST_CASE("select: faulty vertex lists are refused with the vertices and what to do") {
  const Model model = grid();
  const auto broken = ErrorCode::FeatureBroken;
  check_error(model.vertices({}), broken, {}, "at least 2 vertices, 0 are given");
  check_error(model.vertices({3}), broken, {}, "1 is given");
  check_error(model.vertices({3, 4}, true), broken, {}, "at least 3");
  check_error(model.vertices({3, 25, -1}), ErrorCode::FeatureBroken, {25, -1}, "25 vertices");
  check_error(model.vertices({6, 7, 12, 11, 6}), broken, {6}, "set \"closed\"");
  check_error(model.vertices({6, 7, 12, 11, 6}, true), broken, {6}, "leave the last one out");
  check_error(model.vertices({6, 7, 6, 7, 8}), broken, {6, 7}, "several times");
  check_error(model.vertices({6, 8, 9, 19}), broken, {6, 8, 9, 19}, "\"join\": \"shortest\"");
  check_error(model.vertices({6, 7, 8}, true), broken, {8, 6}, "vertices 8 and 6 share no edge");
}

TEST_CASE("select: gaps are all counted, and listed up to the limit") {
  const Model model(shapes::height_field(21, shapes::flat, 0));
  std::vector<Index> list;
  for (Index i = 0; i < 100; ++i) list.push_back(4 * i);
  const auto result = model.vertices(list);
  REQUIRE(!result);
  CHECK(result.error().element == ElementKind::Edge);
  CHECK(result.error().count == 99);
  CHECK(result.error().ids.size() == kMaxListedIds);
}

TEST_CASE("select: unused vertices and vertices of several components are refused") {
  Mesh mesh = shapes::joined(shapes::wavy_disk(50), shapes::wavy_disk(50));
  const Index half = mesh.num_vertices() / 2, unused = mesh.num_vertices();
  mesh.position.push_back({0, 0, 0});
  const Model model(mesh);
  check_error(model.vertices({0, unused}), ErrorCode::FeatureBroken, {unused}, "no triangle");
  check_error(model.vertices({0, 1, half, half + 1}, false, true), ErrorCode::FeatureBroken, {half, half + 1},
              "different components");
}

TEST_CASE("select: shortest joins pass the given vertices in order along edges") {
  const Model model(shapes::wavy_disk(2000));
  const std::vector<Index> list{40, 500, 900};
  for (const bool closed : {false, true}) {
    const std::vector<Index> chain = model.vertices(list, closed, true).value();
    auto place = chain.begin();
    for (const Index v : list) {
      place = std::find(place, chain.end(), v);
      CHECK(place != chain.end());
    }
    CHECK(chain.front() == 40);
    CHECK((chain.back() == 900) == !closed);
    for (std::size_t i = closed ? 0 : 1; i < chain.size(); ++i) {
      CHECK(share_edge(model.mesh.surface(), model.topology, chain[i], i == 0 ? chain.back() : chain[i - 1]));
    }
  }
}

TEST_CASE("select: shortest joins through random vertices are simple chains") {
  const Model model(shapes::wavy_disk(2000));
  shapes::Random random(5);
  int joined = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Index> list;
    for (int i = 0; i < 4; ++i)
      list.push_back(static_cast<Index>(random.bits() % model.mesh.position.size()));
    auto chain = model.vertices(list, trial % 2 == 0, true);
    if (!chain) continue;  // a list may be out of order, or shut itself in
    ++joined;
    std::sort(chain->begin(), chain->end());
    CHECK(std::adjacent_find(chain->begin(), chain->end()) == chain->end());
  }
  CHECK(joined > 60);
}

TEST_CASE("select: shortest joins of vertices out of order are refused with the vertices passed") {
  const Model model = grid();
  check_error(model.vertices({10, 14, 12}, false, true), ErrorCode::FeatureBroken, {12}, "order");
  check_error(model.vertices({12, 14, 10}, false, true), ErrorCode::FeatureBroken, {12},
              "from vertex 14 to 10");
}

TEST_CASE("select: a chain that shuts itself in is refused") {
  // From edge to edge across the square, then to the other side of that path.
  const Model model(shapes::height_field(9, shapes::flat, 0));
  check_error(model.vertices({36, 44, 8, 72}, false, true), ErrorCode::FeatureBroken, {8, 72},
              "meets the chain so far");
}

TEST_CASE("select: a loop's chain has the surface on its left, and closes") {
  const Model model(shapes::frame(12, shapes::flat));
  for (Index l = 0; l < 2; ++l) {
    const std::vector<Index> chain = chain_of_loop(model.mesh.surface(), model.topology, "sill", {l}).value();
    double area = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Index a = chain[i], b = chain[(i + 1) % chain.size()];
      const Index c = half_edge(model.mesh.surface(), model.topology, a, b);
      REQUIRE(c != kNone);
      CHECK(model.topology.corner_twin[c] == kNone);
      const Vec3 p = model.mesh.position[a], q = model.mesh.position[b];
      area += 0.5 * (p.x * q.y - p.y * q.x);
    }
    CHECK((area > 0) == (l == 0));
  }
}

TEST_CASE("select: a loop that does not exist is refused with the number of loops") {
  const Model frame(shapes::frame(12, shapes::flat)), cube(shapes::cube(1));
  const auto loop = [](const Model& model, Index l) {
    return chain_of_loop(model.mesh.surface(), model.topology, "sill", {l});
  };
  check_error(loop(frame, 2), ErrorCode::FeatureBroken, {}, "2 loops, 0 to 1");
  check_error(loop(frame, -1), ErrorCode::FeatureBroken, {}, "loop -1");
  check_error(loop(grid(), 1), ErrorCode::FeatureBroken, {}, "one loop only");
  check_error(loop(cube, 0), ErrorCode::FeatureBroken, {}, "no boundary");
}

TEST_CASE("select: the nearest loop is nearest by its edges, not by its vertices") {
  // A hole of short edges beside a long edge of the rim, which has no vertex near.
  const Model model(shapes::frame(12, shapes::flat));
  const auto near = [&](Vec3 p) {
    return chain_of_nearest_loop(model.mesh.surface(), model.topology, "sill", {p}).value().size();
  };
  const auto loop_size = [&](Index l) {
    const Range r = model.topology.loops().group(l);
    return static_cast<std::size_t>(r.end - r.begin);
  };
  CHECK(near({0, 0, 0}) == loop_size(1));
  CHECK(near({5, 0, 0}) == loop_size(0));

  Mesh two = shapes::triangle({-100, 0, 0}, {100, 0, 0}, {0, 100, 0});
  two = shapes::joined(two, shapes::triangle({0, -3, 0}, {-1, -4, 0}, {1, -4, 0}));
  const Model pair(two);
  const auto chain = chain_of_nearest_loop(two.surface(), pair.topology, "sill", {{0, -1, 0}}).value();
  CHECK(*std::max_element(chain.begin(), chain.end()) == 2);
}

TEST_CASE("select: a point that is not finite and a surface without boundary have no nearest loop") {
  const Model frame(shapes::frame(12, shapes::flat)), cube(shapes::cube(1));
  check_error(chain_of_nearest_loop(frame.mesh.surface(), frame.topology, "sill", {{0, std::nan(""), 0}}),
              ErrorCode::FeatureBroken, {}, "not a finite number");
  check_error(chain_of_nearest_loop(cube.mesh.surface(), cube.topology, "sill", {{0, 0, 0}}),
              ErrorCode::FeatureBroken, {}, "no boundary");
}
