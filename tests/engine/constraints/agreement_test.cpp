#include "engine/constraints/agreement.hpp"

#include "tests/engine/constraints/bodies.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

const std::vector<Vec2> kSquare = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

std::vector<Vec2> moved(std::vector<Vec2> shape, Vec2 p, Vec2 c) {
  for (Vec2& t : shape) t = p + multiply(c, t);
  return shape;
}

Joint::Kind kind_of_only_joint(const Agreement& agreement) {
  REQUIRE(agreement.joints.size() == 1);
  return agreement.joints.front().kind;
}

}  // namespace

TEST_CASE(
    "agreement: shapes that are alike up to a motion are one body: the lower rank yields and is fitted") {
  const Vec2 p = {3, -1}, c = unit(0.7);
  Bodies bodies;
  const Index region =
      bodies.add(Body::Kind::Region, {0, 1, 2, 3, 9}, {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {0, 3}});
  const Index circle =
      bodies.add(Body::Kind::Circle, {3, 2, 1, 0}, moved({{1, -1}, {-1, -1}, {-1, 1}, {1, 1}}, p, c));
  const auto agreement = bodies.agree();
  REQUIRE(agreement);
  CHECK(agreement->yielded[region] == std::vector<std::uint8_t>{1, 1, 1, 1, 0});
  CHECK(agreement->yielded[circle] == std::vector<std::uint8_t>{0, 0, 0, 0});
  CHECK(agreement->mismatch[region] == 0);
  REQUIRE(kind_of_only_joint(*agreement) == Joint::Kind::Fit);
  CHECK(agreement->joints[0].a == region);
  CHECK(agreement->joints[0].b == circle);
  CHECK(norm(agreement->joints[0].p0 - p) < 1e-14);
  CHECK(norm(agreement->joints[0].c0 - c) < 1e-14);
}

TEST_CASE("agreement: within it the lower rank yields, and the mismatch is the largest distance") {
  // A square and one larger by e: nearest at the same place, each corner e sqrt(2) away.
  const double e = 4e-4;
  Bodies bodies;
  const Index plate = bodies.add(Body::Kind::Region, {0, 1, 2, 3}, kSquare);
  const Index hole = bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, moved(kSquare, {}, {1 + e, 0}));
  for (Body& body : bodies.compiled.bodies) body.size = 2;
  const auto agreement = bodies.agree();
  REQUIRE(agreement);
  CHECK(agreement->mismatch[plate] == doctest::Approx(e * std::sqrt(2)).epsilon(1e-10));
  CHECK(agreement->mismatch_with[plate] == bodies.compiled.bodies[hole].constraint);
  CHECK(agreement->mismatch[hole] == 0);
  CHECK(agreement->mismatch_with[hole] == kNone);
}

TEST_CASE("agreement: beyond it both constraints are named, with the difference") {
  for (const double e : {2e-3, 0.3}) {
    Bodies bodies;
    bodies.add(Body::Kind::Region, {0, 1, 2, 3}, kSquare);
    bodies.add(Body::Kind::Line, {20, 21}, {{-1, 0}, {1, 0}});
    bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, moved(kSquare, {}, {1 + e, 0}));
    for (Body& body : bodies.compiled.bodies) body.size = 2;
    const auto agreement = bodies.agree();
    REQUIRE_FALSE(agreement);
    CHECK(agreement.error().code == ErrorCode::ConstraintsConflict);
    CHECK(agreement.error().ids == std::vector<Index>{0, 2});
    CHECK(agreement.error().what.find("\"c0\" and \"c2\"") != std::string::npos);
    CHECK(agreement.error().what.find("4 vertices") != std::string::npos);
  }
}

TEST_CASE("agreement: a mismatch at the limit is judged by the smaller feature's size") {
  const auto agrees = [](double plate_size, double hole_size) {
    Bodies bodies;
    bodies.add(Body::Kind::Region, {0, 1, 2, 3}, kSquare);
    bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, moved(kSquare, {}, {1 + 1e-2 / std::sqrt(2), 0}));
    bodies.compiled.bodies[0].size = plate_size;
    bodies.compiled.bodies[1].size = hole_size;
    return bodies.agree().has_value();
  };
  CHECK(agrees(10.1, 10.1));
  CHECK_FALSE(agrees(9.9, 100));
  CHECK_FALSE(agrees(100, 9.9));
}

TEST_CASE(
    "agreement: line and circle go before curve, curve before region; then the larger, then the earlier "
    "one") {
  using Kind = Body::Kind;
  const auto yields = [](Kind first, double first_size, Kind second, double second_size) {
    Bodies bodies;
    bodies.add(first, {0, 1, 2, 3}, kSquare);
    bodies.add(second, {0, 1, 2, 3}, kSquare);
    bodies.compiled.bodies[0].size = first_size;
    bodies.compiled.bodies[1].size = second_size;
    const auto agreement = bodies.agree();
    REQUIRE(agreement);
    REQUIRE(agreement->yielded[0][0] + agreement->yielded[1][0] == 1);
    return agreement->yielded[0][0] ? 0 : 1;
  };
  CHECK(yields(Kind::Region, 9, Kind::Curve, 1) == 0);
  CHECK(yields(Kind::Curve, 9, Kind::Circle, 1) == 0);
  CHECK(yields(Kind::Curve, 9, Kind::Line, 1) == 0);
  CHECK(yields(Kind::Circle, 1, Kind::Region, 9) == 1);
  CHECK(yields(Kind::Circle, 1, Kind::Circle, 2) == 0);
  CHECK(yields(Kind::Circle, 2, Kind::Line, 1) == 1);
  CHECK(yields(Kind::Curve, 1, Kind::Curve, 1) == 1);
}

TEST_CASE(
    "agreement: two shared vertices make one body where both sizes are given; where one is free they are "
    "joints") {
  const std::vector<Vec2> pair = {{-1, 0}, {1, 0}};
  Bodies given;
  given.add(Body::Kind::Line, {0, 1}, pair);
  given.add(Body::Kind::Curve, {0, 1, 2}, {{0, -1}, {0, 1}, {2, 0}});
  const auto one = given.agree();
  REQUIRE(one);
  CHECK(kind_of_only_joint(*one) == Joint::Kind::Fit);
  Bodies free = given;
  free.compiled.bodies[0].scale = std::nullopt;
  const auto joined = free.agree();
  REQUIRE(joined);
  REQUIRE(joined->joints.size() == 2);
  for (const Joint& joint : joined->joints) {
    CHECK(joint.kind == Joint::Kind::Coincide);
    const auto& bodies = free.compiled.bodies;
    CHECK(bodies[joint.a].vertex[joint.place_a] == bodies[joint.b].vertex[joint.place_b]);
  }
}

TEST_CASE("agreement: three shared vertices fit a shape of free size with the scale that is nearest") {
  Bodies bodies;
  bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, moved(kSquare, {}, {2, 0}));
  bodies.add(Body::Kind::Region, {0, 1, 2, 3}, kSquare);
  bodies.compiled.bodies[0].scale = std::nullopt;
  const auto agreement = bodies.agree();
  REQUIRE(agreement);
  REQUIRE(kind_of_only_joint(*agreement) == Joint::Kind::Fit);
  CHECK(agreement->joints[0].c0.x == doctest::Approx(2).epsilon(1e-14));  // the square in the circle's frame
}

TEST_CASE(
    "agreement: a cycle of fitted shapes must close: the third pair is judged where the others put it") {
  // Three plates in a row, neighbours sharing three vertices each; the first and last share three too.
  const std::vector<Vec2> corner = {{0, 0}, {1, 0}, {0, 1}};
  const auto at = [&](Vec2 p, double turn) { return moved(corner, p, unit(turn)); };
  for (const double error : {0.0, 5e-4, 0.1}) {
    Bodies bodies;
    const auto plate = [&](std::vector<Index> vertex, const std::vector<Vec2>& a,
                           const std::vector<Vec2>& b) {
      std::vector<Vec2> shape = a;
      shape.insert(shape.end(), b.begin(), b.end());
      bodies.add(Body::Kind::Region, std::move(vertex), shape);
    };
    plate({0, 1, 2, 3, 4, 5}, at({0, 0}, 0), at({3, 0}, 1));
    plate({3, 4, 5, 6, 7, 8}, at({0, 0}, 1), at({0, 3}, 2));            // the first one's frame, moved by -3
    plate({6, 7, 8, 0, 1, 2}, at({0, 0}, 2), at({-3 + error, -3}, 0));  // and by -(0, 3)
    for (Body& body : bodies.compiled.bodies) body.size = 1;
    const auto agreement = bodies.agree();
    CHECK(agreement.has_value() == (error < 1e-3));
    if (agreement) {
      CHECK(std::count_if(agreement->joints.begin(), agreement->joints.end(),
                          [](const Joint& j) { return j.kind == Joint::Kind::Fit; }) == 2);
      CHECK(*std::max_element(agreement->mismatch.begin(), agreement->mismatch.end()) ==
            doctest::Approx(error).epsilon(1e-9));
    } else {
      CHECK(agreement.error().ids.size() == 2);
    }
  }
}

TEST_CASE(
    "agreement: at a vertex of several bodies the one of highest rank owns it, each other one has a joint to "
    "it") {
  Bodies bodies;
  bodies.add(Body::Kind::Region, {7, 1, 2}, {{0, 0}, {1, 0}, {0, 1}});
  bodies.add(Body::Kind::Curve, {3, 7, 4}, {{-1, 0}, {0, 0.1}, {1, 0}});
  bodies.add(Body::Kind::Line, {5, 6, 7}, {{-1, 0}, {0, 0}, {1, 0}});
  const auto agreement = bodies.agree();
  REQUIRE(agreement);
  REQUIRE(agreement->joints.size() == 2);
  for (const Joint& joint : agreement->joints) {
    CHECK(joint.kind == Joint::Kind::Coincide);
    CHECK(joint.b == 2);
    CHECK(joint.place_b == 2);
  }
  CHECK(agreement->joints[0].a != agreement->joints[1].a);
}

TEST_CASE("agreement: pins go before all: enough of them fix a shape, fewer hold single vertices") {
  Bodies bodies;
  bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, kSquare);
  const Vec2 p = {2, 5}, c = unit(-0.4);
  const std::vector<Vec2> image = moved(kSquare, p, c);
  bodies.pin(0, image[0]);
  const auto one = bodies.agree();
  REQUIRE(one);
  CHECK(kind_of_only_joint(*one) == Joint::Kind::Pin);
  CHECK(one->joints[0].place_a == 0);
  CHECK(one->yielded[0][0] == 0);
  bodies.pin(2, image[2]);
  const auto two = bodies.agree();
  REQUIRE(two);
  REQUIRE(kind_of_only_joint(*two) == Joint::Kind::Fixed);
  CHECK(norm(two->joints[0].p0 - p) < 1e-13);
  CHECK(norm(two->joints[0].c0 - c) < 1e-13);
  CHECK(two->yielded[0] == std::vector<std::uint8_t>{1, 0, 1, 0});
  bodies.compiled.bodies[0].scale = std::nullopt;  // of free size two pins leave nothing over
  const auto free = bodies.agree();
  REQUIRE(free);
  CHECK(free->joints.size() == 2);
  CHECK(free->joints[0].kind == Joint::Kind::Pin);
}

TEST_CASE("agreement: pins that a shape cannot take are a conflict of it and them; nearly so it yields") {
  for (const double miss : {1e-4, 0.1}) {
    Bodies bodies;
    bodies.add(Body::Kind::Line, {0, 1, 2}, {{-1, 0}, {0, 0}, {1, 0}});
    bodies.pin(0, {-1 - miss, 0});
    bodies.pin(2, {1 + miss, 0});
    const auto agreement = bodies.agree();
    CHECK(agreement.has_value() == (miss < 1e-3));
    if (agreement) {
      CHECK(agreement->mismatch[0] == doctest::Approx(miss).epsilon(1e-9));
      CHECK(agreement->mismatch_with[0] == bodies.compiled.pins[0].constraint);
    } else {
      CHECK(agreement.error().code == ErrorCode::ConstraintsConflict);
      CHECK(agreement.error().ids == std::vector<Index>{0, 1, 2});
    }
  }
}

TEST_CASE("agreement: a line of free lengths is never over-determined: any number of pins are joints") {
  Bodies bodies;
  bodies.add(Body::Kind::FreeLine, {0, 1, 2}, {{-1, 0}, {0, 0}, {1, 0}});
  for (Index v = 0; v < 3; ++v) bodies.pin(v, {5.0 * v, 0});
  const auto agreement = bodies.agree();
  REQUIRE(agreement);
  CHECK(agreement->joints.size() == 3);
  for (const Joint& joint : agreement->joints) CHECK(joint.kind == Joint::Kind::Pin);
}

TEST_CASE("agreement: allowed nothing, equal shapes still agree to rounding") {
  Bodies bodies;
  bodies.add(Body::Kind::Region, {0, 1, 2, 3}, moved(kSquare, {0.1, 0.7}, unit(1.1)));
  bodies.add(Body::Kind::Circle, {0, 1, 2, 3}, kSquare);
  bodies.set.agreement = 0;
  CHECK(bodies.agree());
  bodies.compiled.bodies[0].shape[0].x += 1e-9;
  CHECK_FALSE(bodies.agree());
}
