#include "engine/constraints/sectors.hpp"

#include "tests/engine/constraints/laid_out.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr Index kN = 9;

struct Split {
  Rest rest{shapes::height_field(kN, shapes::flat, 0)};
  Layout layout = empty_layout(rest);
  Sectors sectors;

  void add(const std::vector<Index>& path, In<Vec2> image, bool closed = false) {
    lay(rest, rest.chain("chain", path, closed), image, layout);
  }
  void find() { sectors = find_sectors(rest.topology(), rest.mesh().corner_vertex, layout.fixed_edge); }

  /// Sectors of a vertex of the input.
  std::vector<Index> of(Index vertex) const {
    std::vector<Index> result;
    for (Index s = 0; s < sectors.num_sectors(); ++s) {
      if (sectors.vertex[s] == rest.here[vertex]) result.push_back(s);
    }
    return result;
  }
  double angle_sum(Index sector) const {
    double sum = 0;
    for (std::size_t c = 0; c < sectors.corner_sector.size(); ++c) {
      if (sectors.corner_sector[c] == sector) sum += corner_angles(rest.geometry.frame[c / 3])[c % 3];
    }
    return sum;
  }
  double prescribed(Index sector) const {
    return prescribed_angle(layout, sectors, sector, angle_sum(sector));
  }
};

/// The chain as it lies on the flat grid.
std::vector<Vec2> as_it_lies(In<Index> path) {
  std::vector<Vec2> image;
  for (const Index v : path) image.push_back({static_cast<double>(v % kN), static_cast<double>(v / kN)});
  return image;
}

}  // namespace

TEST_CASE("sectors: without fixed edges every vertex is one, and nothing is opened") {
  Split split;
  split.find();
  CHECK(split.sectors.num_sectors() == kN * kN);
  CHECK(split.sectors.corner_sector == split.rest.mesh().corner_vertex);
  CHECK(split.sectors.opened.corner_twin == split.rest.topology().corner_twin);
  CHECK(std::count(split.sectors.rowless.begin(), split.sectors.rowless.end(), 1) == 0);
}

TEST_CASE(
    "sectors: a chain splits its inner vertices in two, its ends keep one that goes all the way round") {
  Split split;
  const std::vector<Index> path = grid_path(kN, 2, 4, 6, 4);
  split.add(path, straight(path.size()));
  split.find();
  CHECK(split.sectors.num_sectors() == kN * kN + 3);
  for (const Index v : path) {
    const std::vector<Index> sectors = split.of(v);
    const bool end = v == path.front() || v == path.back();
    CHECK(sectors.size() == (end ? 1 : 2));
    double sum = 0;
    for (const Index s : sectors) {
      CHECK(split.sectors.is_prescribed(s));
      CHECK_FALSE(split.sectors.rowless[s]);
      CHECK(split.prescribed(s) == doctest::Approx(end ? 2 * kPi : kPi).epsilon(1e-14));
      CHECK((split.sectors.from[s] == split.sectors.to[s]) == end);
      sum += split.angle_sum(s);
    }
    CHECK(sum == doctest::Approx(2 * kPi).epsilon(1e-13));
  }
}

TEST_CASE(
    "sectors: corners belong to a sector of their vertex, and corners across a free edge to the same one") {
  Split split;
  split.add(grid_loop(kN, 2, 2, 6, 5), as_it_lies(grid_loop(kN, 2, 2, 6, 5)), true);
  split.add(grid_path(kN, 0, 7, 8, 7), straight(9));
  split.add(grid_path(kN, 4, 7, 4, 8), as_it_lies(grid_path(kN, 4, 7, 4, 8)));
  split.find();
  const Sectors& s = split.sectors;
  const auto& corner_vertex = split.rest.mesh().corner_vertex;
  std::vector<Index> corners(s.num_sectors(), 0);
  for (Index c = 0; c < static_cast<Index>(corner_vertex.size()); ++c) {
    CHECK(s.vertex[s.corner_sector[c]] == corner_vertex[c]);
    ++corners[s.corner_sector[c]];
    const Index twin = s.opened.corner_twin[c];
    CHECK((twin == kNone) == (split.layout.fixed_edge[c] || split.rest.topology().corner_twin[c] == kNone));
    if (twin == kNone) continue;
    CHECK(s.corner_sector[c] == s.corner_sector[next_corner(twin)]);
    CHECK(s.corner_sector[next_corner(c)] == s.corner_sector[twin]);
  }
  for (Index k = 0; k < s.num_sectors(); ++k) {
    CHECK(s.opened.star_begin[k + 1] - s.opened.star_begin[k] == corners[k]);
    CHECK(corners[k] > 0);
  }
}

TEST_CASE("sectors: laid out as it lies on a flat mesh, each prescribed angle is that of its corners") {
  Split split;
  split.add(grid_loop(kN, 2, 2, 6, 5), as_it_lies(grid_loop(kN, 2, 2, 6, 5)), true);
  split.add(grid_path(kN, 6, 5, 8, 5),
            as_it_lies(grid_path(kN, 6, 5, 8, 5)));  // from a corner of it to the rim
  split.add(grid_path(kN, 0, 0, 8, 0), as_it_lies(grid_path(kN, 0, 0, 8, 0)));  // on the rim
  split.find();
  Index prescribed = 0;
  for (Index s = 0; s < split.sectors.num_sectors(); ++s) {
    if (!split.sectors.is_prescribed(s)) continue;
    ++prescribed;
    CHECK(split.prescribed(s) == doctest::Approx(split.angle_sum(s)).epsilon(1e-13));
  }
  // Two at each of the loop's 14 vertices, one more where the path leaves it; two at the path's inner vertex; one at
  // each inner vertex of the rim's path.
  CHECK(prescribed == 2 * 14 + 1 + 2 + 7);
}

TEST_CASE("sectors: at the boundary the fan is split from its first edge on, ends free of fixed edges") {
  Split split;
  const std::vector<Index> path = grid_path(kN, 4, 0, 4, 3);
  split.add(path, straight(path.size()));
  split.find();
  const std::vector<Index> at_rim = split.of(path.front());
  REQUIRE(at_rim.size() == 2);
  Index free_from = 0, free_to = 0;
  for (const Index s : at_rim) {
    CHECK_FALSE(split.sectors.is_prescribed(s));
    free_from += split.sectors.from[s] == kNone;
    free_to += split.sectors.to[s] == kNone;
  }
  CHECK(free_from == 1);
  CHECK(free_to == 1);
}

TEST_CASE(
    "sectors: a corner with one triangle between two fixed edges has no row, nor a star of fixed edges") {
  Split split;
  // The cell (2, 3) is cut by the diagonal away from its lower left corner.
  const std::vector<Index> loop = grid_loop(kN, 2, 3, 5, 6);
  split.add(loop, as_it_lies(loop), true);
  const Index centre = 7 * kN + 7;
  const auto neighbours = [&](Index v) {
    std::vector<Index> around;
    for_each_neighbour(split.rest.mesh().surface(), split.rest.topology(), split.rest.here[v],
                       [&](Index u) { around.push_back(split.rest.mesh().vertex_origin[u]); });
    return around;
  };
  for (const Index u : neighbours(centre)) split.add({centre, u}, as_it_lies(std::vector<Index>{centre, u}));
  split.find();
  const std::vector<Index> corner = split.of(loop.front());
  REQUIRE(corner.size() == 2);
  for (const Index s : corner) CHECK(split.sectors.rowless[s] == (split.angle_sum(s) < kPi));
  REQUIRE(split.of(centre).size() == 1);
  CHECK(split.sectors.rowless[split.of(centre).front()] == 1);
}

TEST_CASE(
    "sectors: an angle is counter-clockwise between its edges, and 0 or a full turn as the surface has it") {
  Split split;
  const std::vector<Index> path = grid_path(kN, 3, 4, 5, 4);
  split.add(path, straight(path.size()));
  split.find();
  const Index middle = path[1], s = split.of(middle)[0];
  const Vec2 at = {0.5, 0.5};
  const auto angle = [&](double from, double to, double surface) {
    split.layout.point[split.rest.here[middle]] = at;
    split.layout.point[split.sectors.from[s]] = at + 2 * unit(from);
    split.layout.point[split.sectors.to[s]] = at + unit(to);
    return prescribed_angle(split.layout, split.sectors, s, surface);
  };
  CHECK(angle(0.3, 1.3, kPi) == doctest::Approx(1).epsilon(1e-14));
  CHECK(angle(1.3, 0.3, kPi) == doctest::Approx(2 * kPi - 1).epsilon(1e-14));
  CHECK(angle(3.0, -3.0, kPi) == doctest::Approx(2 * kPi - 6).epsilon(1e-13));
  CHECK(std::abs(angle(0.7, 0.7, 0.5)) < 1e-12);
  CHECK(angle(0.7, 0.7, 5.5) == doctest::Approx(2 * kPi).epsilon(1e-14));
}

TEST_CASE("sectors: their order is the vertices' own, those of a vertex together") {
  Split split;
  split.add(grid_loop(kN, 2, 2, 6, 5), as_it_lies(grid_loop(kN, 2, 2, 6, 5)), true);
  split.find();
  std::vector<Index> order = split.rest.order;
  std::reverse(order.begin(), order.end());
  const std::vector<Index> sectors = sector_order(split.sectors, order);
  REQUIRE(static_cast<Index>(sectors.size()) == split.sectors.num_sectors());
  std::vector<Index> vertices, sorted = sectors;
  for (const Index s : sectors) {
    if (vertices.empty() || vertices.back() != split.sectors.vertex[s])
      vertices.push_back(split.sectors.vertex[s]);
  }
  CHECK(vertices == order);
  std::sort(sorted.begin(), sorted.end());
  for (Index s = 0; s < split.sectors.num_sectors(); ++s) CHECK(sorted[s] == s);
}
