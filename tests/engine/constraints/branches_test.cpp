#include "engine/constraints/branches.hpp"

#include "kernels/intrinsic/transport.hpp"
#include "tests/engine/constraints/bodies.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr double kDegree = kPi / 180;

/// n bodies and where the map without relations has them, degrees; all in one component.
struct Directions : Bodies {
  Measured measured{.angle = {}, .frame = {}, .num_frames = 1};

  explicit Directions(std::initializer_list<double> degrees) {
    for (const double d : degrees) add_body(d, 0);
  }
  Index add_body(double degrees, Index frame) {
    measured.angle.push_back(degrees * kDegree);
    measured.frame.push_back(frame);
    measured.num_frames = std::max(measured.num_frames, frame + 1);
    const auto k = static_cast<Index>(compiled.bodies.size());
    return add_line({2 * k, 2 * k + 1}, std::vector<double>{1.0});
  }
  Result<Oriented> choose() const { return choose_branches(compiled, view(), measured); }
};

/// Degrees of a relation as chosen, in (-180, 180].
double chosen(const Oriented& oriented, std::size_t k) { return oriented.chosen[k] / kDegree; }

/// Every relation holds between the offsets of its bodies, which are of one cluster.
void check_offsets(const Directions& d, const Oriented& oriented) {
  for (std::size_t k = 0; k < d.compiled.relations.size(); ++k) {
    const Relation& r = d.compiled.relations[k];
    const Clusters& clusters = oriented.clusters;
    const double a = r.a == kNone ? 0 : clusters.offset[r.a];
    if (r.a == kNone) {
      CHECK(clusters.directed[clusters.of[r.b]] == 1);
    } else {
      CHECK(clusters.of[r.a] == clusters.of[r.b]);
    }
    const double between = clusters.offset[r.b] + r.along_b - a - r.along_a;
    CHECK(std::abs(reduce_angle(between - oriented.chosen[k])) < 1e-12);
    const double wanted = r.degrees * kDegree;
    double off = std::abs(reduce_angle(between - wanted));
    if (!r.oriented) {  // between undirected lines: the sign and half turns are free
      for (const double x : {-wanted, wanted + kPi, -wanted + kPi})
        off = std::min(off, std::abs(reduce_angle(between - x)));
    }
    CHECK(off < 1e-9);
  }
}

}  // namespace

TEST_CASE(
    "branches: the representative nearest to the map without the relation is taken, modulo half turns") {
  const std::pair<double, double> cases[] = {{25, 30},     {44, 30},   {80, 30},   {100, 150},
                                             {170, 150},   {-10, -30}, {-80, -30}, {-100, -150},
                                             {-179, -150}, {359, -30}, {200, -150}};
  for (const auto& [measured, expected] : cases) {
    Directions d({10, 10 + measured});
    d.relate(0, 1, 30);
    const auto oriented = d.choose();
    REQUIRE(oriented);
    CHECK(chosen(*oriented, 0) == doctest::Approx(expected).epsilon(1e-12));
    check_offsets(d, *oriented);
  }
}

TEST_CASE("branches: an oriented angle has one representative, whatever the map has") {
  for (const double measured : {0.0, 25.0, 170.0, -100.0, 300.0}) {
    Directions d({10, 10 + measured});
    d.relate(0, 1, 250, true);
    const auto oriented = d.choose();
    REQUIRE(oriented);
    CHECK(chosen(*oriented, 0) == doctest::Approx(-110).epsilon(1e-12));
    check_offsets(d, *oriented);
  }
}

TEST_CASE("branches: parallel and perpendicular take the nearer direction along the line") {
  for (const auto& [measured, parallel, perpendicular] :
       {std::tuple(80.0, 0.0, 90.0), {100.0, 180.0, 90.0}, {-80.0, 0.0, -90.0}, {-130.0, 180.0, -90.0}}) {
    Directions p({0, measured}), q({0, measured});
    p.relate(0, 1, 0);
    q.relate(0, 1, 90);
    CHECK(std::abs(reduce_angle(p.choose()->chosen[0] - parallel * kDegree)) < 1e-12);
    CHECK(std::abs(reduce_angle(q.choose()->chosen[0] - perpendicular * kDegree)) < 1e-12);
  }
}

TEST_CASE("branches: an angle is measured between directions in the templates") {
  Directions d({20, 65});
  d.relate(0, 1, 30, true);
  d.compiled.relations[0].along_a = 0.4;
  d.compiled.relations[0].along_b = -0.3;
  const auto oriented = d.choose();
  REQUIRE(oriented);
  CHECK(chosen(*oriented, 0) == doctest::Approx(30).epsilon(1e-12));
  check_offsets(d, *oriented);
}

TEST_CASE("branches: bodies without relations stay clusters of their own, free of the u axis") {
  Directions d({0, 20, 40, 60});
  d.relate(1, 3, 45);
  const auto oriented = d.choose();
  REQUIRE(oriented);
  const Clusters& c = oriented->clusters;
  CHECK(c.of[1] == c.of[3]);
  CHECK(c.of[0] != c.of[1]);
  CHECK(c.of[2] != c.of[1]);
  CHECK(c.of[0] != c.of[2]);
  for (const Index cluster : c.of) CHECK(c.directed[cluster] == 0);
}

TEST_CASE("branches: a direction ties a body to the u axis as it is given, wherever the frame lay") {
  for (const auto& [measured, expected] :
       {std::pair(10.0, 20.0), {190.0, 20.0}, {-30.0, 20.0}, {100.0, 20.0}}) {
    Directions d({measured, measured + 80});
    d.relate(kNone, 0, 20);
    d.relate(0, 1, 90, true);
    const auto oriented = d.choose();
    REQUIRE(oriented);
    CHECK(std::abs(reduce_angle(oriented->chosen[0] - (oriented->clusters.offset[0]))) < 1e-12);
    check_offsets(d, *oriented);
    CHECK(oriented->directed_set[oriented->frame_set[0]] == 1);
    // The component's frame is free to turn until the direction is given.
    CHECK(std::abs(reduce_angle(measured * kDegree + oriented->frame_turn[0] - expected * kDegree)) < 1e-12);
  }
}

TEST_CASE("branches: three lines at 60 degrees close also where the nearest angles do not") {
  for (const auto& [b, c] : {std::pair(50.0, 0.0), {50.0, 5.0}, {-55.0, 2.0}, {60.0, 120.0}, {61.0, -58.0}}) {
    Directions d({0, b, c});
    d.relate(0, 1, 60);
    d.relate(1, 2, 60);
    d.relate(0, 2, 60);
    const auto oriented = d.choose();
    REQUIRE(oriented);
    check_offsets(d, *oriented);
  }
}

TEST_CASE("branches: many triangles whose first angles come before all others are still closed") {
  Directions d({});
  const Index count = 12;
  for (Index k = 0; k < count; ++k) {
    for (const double degrees : {0.0, 50.0, 3.0}) d.add_body(degrees, 0);
  }
  for (Index k = 0; k < count; ++k) d.relate(3 * k, 3 * k + 1, 60);
  for (Index k = 0; k < count; ++k) d.relate(3 * k + 1, 3 * k + 2, 60);
  for (Index k = 0; k < count; ++k) d.relate(3 * k, 3 * k + 2, 60);
  const auto oriented = d.choose();
  REQUIRE(oriented);
  check_offsets(d, *oriented);
}

TEST_CASE("branches: a set that no choice satisfies is refused with a smallest part of it") {
  Directions d({0, 60, 120, 30, 75});
  const Index first = d.relate(0, 1, 60), beside = d.relate(3, 4, 45), second = d.relate(1, 2, 60),
              third = d.relate(0, 2, 50), after = d.relate(2, 3, 10);
  const auto refused = d.choose();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::ConstraintsConflict);
  CHECK(refused.error().ids == std::vector<Index>{first, second, third});
  CHECK(refused.error().what.find("10 degrees") != std::string::npos);
  CHECK(refused.error().what.find("\"c" + std::to_string(beside) + "\"") == std::string::npos);
  CHECK(refused.error().what.find("\"c" + std::to_string(after) + "\"") == std::string::npos);
}

TEST_CASE("branches: parallel and perpendicular at once are refused naming both, also against the u axis") {
  Directions d({0, 40});
  d.relate(0, 1, 0);
  d.relate(1, 0, 90);
  const auto refused = d.choose();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().ids == std::vector<Index>{2, 3});
  CHECK(refused.error().what.find("90 degrees") != std::string::npos);
  Directions e({0, 40});
  e.relate(kNone, 0, 0);
  e.relate(kNone, 1, 90);
  e.relate(0, 1, 45);
  const auto also = e.choose();
  REQUIRE_FALSE(also);
  CHECK(also.error().ids == std::vector<Index>{2, 3, 4});
}

TEST_CASE("branches: relations that repeat one another hold together") {
  Directions d({0, 85, 5});
  d.relate(0, 1, 90);
  d.relate(1, 0, 90);
  d.relate(1, 2, 90);
  d.relate(0, 2, 0);
  const auto oriented = d.choose();
  REQUIRE(oriented);
  check_offsets(d, *oriented);
}

TEST_CASE("branches: turning the whole map changes no angle that is chosen") {
  shapes::Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Directions d({0, 0, 0, 0, 0});
    for (double& a : d.measured.angle) a = 6.28 * random.uniform();
    d.relate(0, 1, 37);
    d.relate(1, 2, 90);
    d.relate(3, 2, 0);
    d.relate(4, 0, 123, true);
    const auto oriented = d.choose();
    for (double& a : d.measured.angle) a += 2.5;
    const auto turned = d.choose();
    REQUIRE(oriented);
    REQUIRE(turned);
    for (std::size_t k = 0; k < 4; ++k)
      CHECK(std::abs(reduce_angle(oriented->chosen[k] - turned->chosen[k])) < 1e-12);
    check_offsets(d, *oriented);
  }
}

TEST_CASE(
    "branches: components are turned so that the first relation between them holds, a directed one stays") {
  Directions d({});
  d.add_body(0, 0);
  d.add_body(70, 0);
  d.add_body(200, 1);
  d.add_body(245, 1);
  d.add_body(13, 2);
  d.relate(kNone, 0, 0);
  d.relate(1, 2, 90, true);
  d.relate(2, 3, 45, true);
  const auto oriented = d.choose();
  REQUIRE(oriented);
  check_offsets(d, *oriented);
  // 1 lies at 70, so 2 comes to 160: its component turns by -40; the third component is not asked.
  CHECK(std::abs(reduce_angle(oriented->frame_turn[0])) < 1e-12);
  CHECK(std::abs(reduce_angle(oriented->frame_turn[1] + 40 * kDegree)) < 1e-12);
  CHECK(oriented->frame_turn[2] == 0);
  CHECK(oriented->frame_set[0] == oriented->frame_set[1]);
  CHECK(oriented->frame_set[2] != oriented->frame_set[0]);
  CHECK(oriented->directed_set[oriented->frame_set[0]] == 1);
  CHECK(oriented->directed_set[oriented->frame_set[2]] == 0);
}

TEST_CASE("branches: one triangle that does not close among many that do is named alone") {
  Directions d({});
  const Index count = 12;
  for (Index k = 0; k < count; ++k) {
    for (const double degrees : {0.0, 50.0, 3.0}) d.add_body(degrees, 0);
  }
  std::vector<Index> bad;
  for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {0, 2}}) {
    for (Index k = 0; k < count; ++k) {
      const bool is_bad = k == 7 && a == 0 && b == 2;
      const Index constraint = d.relate(3 * k + a, 3 * k + b, is_bad ? 50 : 60);
      if (k == 7) bad.push_back(constraint);
    }
  }
  const auto refused = d.choose();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().ids == bad);
}
