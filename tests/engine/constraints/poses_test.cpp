#include "engine/constraints/poses.hpp"

#include "kernels/intrinsic/transport.hpp"
#include "tests/engine/constraints/bodies.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

/// Bodies with what agreement and assemblies make of them, and poses from given directions.
struct Posed {
  Bodies bodies;
  Agreement agreement;
  Assemblies assemblies;
  Clusters clusters;
  std::unique_ptr<Poses> poses;

  explicit Posed(Bodies given, std::vector<double> angle, std::optional<Clusters> tied = {})
      : bodies(std::move(given)) {
    auto agreed = bodies.agree();
    REQUIRE(agreed);
    agreement = std::move(*agreed);
    assemblies = find_assemblies(bodies.compiled, agreement);
    clusters = tied.value_or(separate_clusters(angle.size()));
    poses = std::make_unique<Poses>(bodies.compiled, agreement, assemblies, clusters, angle);
  }
  Posed(const Posed&) = delete;
  Posed& operator=(const Posed&) = delete;

  /// Largest distance between places that joints hold together.
  double open() const {
    double worst = 0;
    for (const Joint& j : agreement.joints) {
      if (j.kind == Joint::Kind::Coincide)
        worst = std::max(worst, norm(poses->point(j.a, j.place_a) - poses->point(j.b, j.place_b)));
      if (j.kind == Joint::Kind::Pin) worst = std::max(worst, norm(poses->point(j.a, j.place_a) - j.p0));
      if (j.kind == Joint::Kind::Fixed)
        worst = std::max({worst, norm(poses->translation(j.a) - j.p0), norm(poses->factor(j.a) - j.c0)});
      if (j.kind == Joint::Kind::Fit) {
        const Vec2 cb = poses->factor(j.b);
        worst = std::max(worst, norm(poses->translation(j.a) - poses->translation(j.b) - multiply(cb, j.p0)));
        worst = std::max(worst, norm(poses->factor(j.a) - multiply(cb, j.c0)));
      }
    }
    return worst;
  }
};

/// One cluster of all bodies with these offsets.
Clusters one_cluster(std::vector<double> offset, bool directed) {
  Clusters clusters = separate_clusters(offset.size());
  std::fill(clusters.of.begin(), clusters.of.end(), 0);
  clusters.offset = std::move(offset);
  clusters.directed = {directed};
  return clusters;
}

/// Lines between corners 0, 1, ..., n - 1, closed.
Bodies linkage(In<double> side, std::optional<double> scale = 1) {
  Bodies bodies;
  const auto n = static_cast<Index>(side.size());
  for (Index k = 0; k < n; ++k) {
    bodies.add_line({k, (k + 1) % n}, side.subspan(k, 1));
    bodies.compiled.bodies.back().scale = scale;
  }
  return bodies;
}

/// A body of every kind, hung together in several ways.
struct Everything {
  static Bodies bodies() {
    Bodies b;
    b.add_line({0, 1, 2}, std::vector<double>{1, 2});                           // 0: kept
    b.add(Body::Kind::Circle, {2, 3, 4}, {{1, 0}, {-0.5, 0.8}, {-0.5, -0.8}});  // 1: of free size, at its end
    b.add_line({10, 11, 12, 13}, std::vector<double>{1, 1, 2},
               Body::Kind::FreeLine);                                     // 2: free lengths, alone
    b.add_line({20, 21}, std::vector<double>{2});                         // 3: of free size, in a cluster
    b.add_line({21, 22}, std::vector<double>{3});                         // 4: the same, joined to it
    b.add(Body::Kind::Curve, {30, 31, 32}, {{-1, 0}, {0, 0.5}, {1, 0}});  // 5, 6: a common scale
    b.add(Body::Kind::Curve, {40, 41, 42}, {{-1, 0}, {0, -0.7}, {1, 0}});
    b.add_line({50, 51, 52}, std::vector<double>{1, 1}, Body::Kind::FreeLine);  // 7: pinned at one end
    b.add_line({52, 53, 50}, std::vector<double>{2, 2}, Body::Kind::FreeLine);  // 8: both ends on it
    b.add(Body::Kind::Region, {60, 61, 62}, {{0, 0}, {1, 0}, {0, 1}});          // 9, 10: fitted
    b.add(Body::Kind::Circle, {60, 61, 62, 63},
          {{0, 0}, {1 / 1.5, 0}, {0, 1 / 1.5}, {-1, -1}});  // drawn 1.5 times as large

    for (const Index free : {1, 3, 4, 5, 6}) b.compiled.bodies[free].scale = std::nullopt;
    for (const Index grouped : {5, 6}) b.compiled.bodies[grouped].scale_group = "g";
    b.compiled.bodies[10].scale = 1.5;
    b.pin(50, {4, 2});
    return b;
  }
  static Clusters clusters() {
    Clusters c = separate_clusters(11);
    c.of[4] = 3;  // 3 and 4 at a right angle
    c.offset[4] = kPi / 2;
    c.directed[2] = 1;  // 2 along 0.4 radians
    c.offset[2] = 0.4;
    return c;
  }
  static std::vector<double> angles() {
    return {0.3, -1, 0.4, 1, 1 + kPi / 2, 2, 0.5, 0.1, kPi + 0.1, 0.7, 0.7};
  }
};

std::vector<double> random_free(Index n, double size, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<double> free(n);
  for (double& y : free) y = size * (2 * random.uniform() - 1);
  return free;
}

}  // namespace

TEST_CASE("poses: joints hold to rounding after closing, and wherever the free coordinates go") {
  Posed all(Everything::bodies(), Everything::angles(), Everything::clusters());
  REQUIRE_FALSE(all.poses->close());
  CHECK(all.open() < 1e-13);
  all.poses->set_base();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    REQUIRE(all.poses->move_to(random_free(all.poses->num_free(), 0.2, seed)));
    CHECK(all.open() < 1e-12);
    const Poses& p = *all.poses;
    CHECK(norm(p.factor(0)) == doctest::Approx(1));
    CHECK(std::abs(reduce_angle(p.angle(4) - p.angle(3) - kPi / 2)) < 1e-12);
    CHECK(std::abs(reduce_angle(p.angle(2) - 0.4)) < 1e-12);
    CHECK(norm(p.factor(5)) == doctest::Approx(norm(p.factor(6))).epsilon(1e-14));
    CHECK(norm(p.point(7, 0) - Vec2{4, 2}) < 1e-12);
  }
}

TEST_CASE("poses: slots say how every point moves with the free coordinates, by central differences") {
  Posed all(Everything::bodies(), Everything::angles(), Everything::clusters());
  Poses& poses = *all.poses;
  REQUIRE_FALSE(poses.close());
  poses.set_base();
  const double step = 1e-5;
  double worst = 0, largest = 0;
  std::vector<double> free(poses.num_free(), 0);
  for (Index b = 0; b < static_cast<Index>(all.bodies.compiled.bodies.size()); ++b) {
    for (Index i = 0; i < static_cast<Index>(all.bodies.compiled.bodies[b].vertex.size()); ++i) {
      std::vector<Vec2> slope(poses.num_free());
      REQUIRE(poses.move_to(free));
      poses.visit_slots(b, i, [&](Index slot, Vec2 dz) {
        poses.visit_free(slot, [&](Index k, double value) { slope[k] += value * dz; });
      });
      for (Index k = 0; k < poses.num_free(); ++k) {
        std::vector<double> y = free;
        y[k] = step;
        REQUIRE(poses.move_to(y));
        const Vec2 ahead = poses.point(b, i);
        y[k] = -step;
        REQUIRE(poses.move_to(y));
        worst = std::max(worst, norm((0.5 / step) * (ahead - poses.point(b, i)) - slope[k]));
        largest = std::max(largest, norm(slope[k]));
      }
    }
  }
  CHECK(worst < 1e-8);
  CHECK(largest > 0.5);
}

TEST_CASE("poses: gradients pulled back far from the base are those of the points, by central differences") {
  Posed all(Everything::bodies(), Everything::angles(), Everything::clusters());
  Poses& poses = *all.poses;
  REQUIRE_FALSE(poses.close());
  poses.set_base();
  const auto visit_points = [&](auto&& visit) {
    double weight = 1;
    for (Index b = 0; b < static_cast<Index>(all.bodies.compiled.bodies.size()); ++b) {
      for (Index i = 0; i < static_cast<Index>(all.bodies.compiled.bodies[b].vertex.size()); ++i)
        visit(b, i, weight += 0.37);
    }
  };
  const auto value = [&](In<double> y) {
    REQUIRE(poses.move_to(y));
    double sum = 0;
    visit_points([&](Index b, Index i, double weight) {
      const Vec2 z = poses.point(b, i);
      sum += std::sin(weight) * z.x + 0.3 * dot(z, z) + std::cos(weight) * z.y * z.x;
    });
    return sum;
  };
  std::vector<double> y = random_free(poses.num_free(), 0.3, 4), gradient(poses.num_free());
  value(y);
  std::vector<double> slot_gradient(poses.num_slots(), 0);
  visit_points([&](Index b, Index i, double weight) {
    const Vec2 z = poses.point(b, i);
    const Vec2 force = {std::sin(weight) + 0.6 * z.x + std::cos(weight) * z.y,
                        0.6 * z.y + std::cos(weight) * z.x};
    poses.visit_slots(b, i, [&](Index slot, Vec2 dz) { slot_gradient[slot] += dot(dz, force); });
  });
  poses.pull_back(slot_gradient, gradient);
  const double step = 1e-5;
  for (Index k = 0; k < poses.num_free(); ++k) {
    std::vector<double> ahead = y, behind = y;
    ahead[k] += step, behind[k] -= step;
    CHECK(gradient[k] == doctest::Approx((value(ahead) - value(behind)) / (2 * step)).epsilon(1e-6));
  }
}

TEST_CASE("poses: a four-bar linkage closes and has two freedoms: to turn, and to fold") {
  Posed bars(linkage(std::vector<double>{3, 4, 5, 6}), {0.2, 1.5, 3.0, 4.6});
  REQUIRE_FALSE(bars.poses->close());
  CHECK(bars.open() < 1e-13);
  bars.poses->set_base();
  CHECK(bars.poses->num_free() == 2);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    REQUIRE(bars.poses->move_to(random_free(2, 0.3, seed)));
    CHECK(bars.open() < 1e-12);
    for (Index b = 0; b < 4; ++b) CHECK(norm(bars.poses->factor(b)) == doctest::Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("poses: bars of which one is longer than the others together leave a gap that names them all") {
  Posed bars(linkage(std::vector<double>{1, 1, 1, 5}), {0.1, 0.2, -0.1, 3.1});
  const auto gap = bars.poses->close();
  REQUIRE(gap);
  std::vector<Index> named = gap->constraints;
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  CHECK(named == std::vector<Index>{0, 1, 2, 3});
  CHECK(gap->size > 0.1);
}

TEST_CASE("poses: four lines of free scale at right angles are a rectangle of free sides") {
  for (const bool directed : {false, true}) {
    Posed sides(linkage(std::vector<double>{3, 2, 3.1, 1.8}, std::nullopt), {0, 1.57, 3.14, 4.71},
                one_cluster({0, kPi / 2, kPi, 1.5 * kPi}, directed));
    REQUIRE_FALSE(sides.poses->close());
    sides.poses->set_base();
    CHECK(sides.poses->num_free() == (directed ? 2 : 3));
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      REQUIRE(sides.poses->move_to(random_free(sides.poses->num_free(), 0.3, seed)));
      const Poses& p = *sides.poses;
      CHECK(sides.open() < 1e-12);
      CHECK(norm(p.point(0, 1) - p.point(0, 0)) == doctest::Approx(norm(p.point(2, 1) - p.point(2, 0))));
      CHECK(std::abs(dot(p.point(0, 1) - p.point(0, 0), p.point(1, 1) - p.point(1, 0))) < 1e-12);
    }
  }
}

TEST_CASE("poses: lines of free lengths that cross keep their crossing, and count one freedom a vertex") {
  Bodies bodies;
  bodies.add_line({0, 1, 2}, std::vector<double>{1, 1}, Body::Kind::FreeLine);
  bodies.add_line({3, 1, 4}, std::vector<double>{1, 1}, Body::Kind::FreeLine);
  Posed crossing(std::move(bodies), {0, 1});
  REQUIRE_FALSE(crossing.poses->close());
  crossing.poses->set_base();
  // Each line: a direction and two places along it; the second one's translation is what the joint takes.
  CHECK(crossing.poses->num_free() == 6);
  REQUIRE(crossing.poses->move_to(random_free(6, 0.3, 2)));
  CHECK(crossing.open() < 1e-12);
}

TEST_CASE("poses: where joints cannot be met the poses stay as they were") {
  Posed bars(linkage(std::vector<double>{3, 4, 5, 6}), {0.2, 1.5, 3.0, 4.6});
  REQUIRE_FALSE(bars.poses->close());
  bars.poses->set_base();
  std::vector<Vec2> before;
  for (Index b = 0; b < 4; ++b) before.push_back(bars.poses->point(b, 1));
  CHECK_FALSE(bars.poses->move_to(std::vector<double>{300, -200}));
  for (Index b = 0; b < 4; ++b) CHECK(bars.poses->point(b, 1) == before[b]);
}

TEST_CASE("poses: frozen clusters keep directions, and adopted poses are the same points") {
  Posed all(Everything::bodies(), Everything::angles(), Everything::clusters());
  REQUIRE_FALSE(all.poses->close());
  all.poses->set_base();
  REQUIRE(all.poses->move_to(random_free(all.poses->num_free(), 0.2, 9)));
  Poses still(all.bodies.compiled, all.agreement, all.assemblies, all.poses->frozen(), Everything::angles());
  still.adopt(*all.poses);
  const auto& bodies = all.bodies.compiled.bodies;
  for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) {
    for (Index i = 0; i < static_cast<Index>(bodies[b].vertex.size()); ++i)
      CHECK(norm(still.point(b, i) - all.poses->point(b, i)) < 1e-12);
  }
  REQUIRE_FALSE(still.close());
  still.set_base();
  REQUIRE(still.move_to(random_free(still.num_free(), 0.1, 3)));
  CHECK(still.turned() < 1e-12);
}

TEST_CASE(
    "poses: turned is the largest turn of a body since the base, smallest the body of least free scale") {
  Bodies bodies;
  bodies.add_line({0, 1}, std::vector<double>{1});
  bodies.add_line({2, 3}, std::vector<double>{1});
  bodies.compiled.bodies[1].scale = 0.25;
  Posed two(std::move(bodies), {0.5, 3.0});
  REQUIRE_FALSE(two.poses->close());
  two.poses->set_base();
  REQUIRE(two.poses->num_free() == 2);
  REQUIRE(two.poses->move_to(std::vector<double>{0.1, -0.3}));
  CHECK(two.poses->turned() == doctest::Approx(0.3).epsilon(1e-12));
  CHECK(two.poses->smallest() == kNone);  // both scales are given
  Bodies free;
  free.add_line({0, 1}, std::vector<double>{1});
  free.add_line({2, 3}, std::vector<double>{1});
  free.compiled.bodies[0].scale = 0.25;
  free.compiled.bodies[1].scale = std::nullopt;
  Posed one(std::move(free), {0.5, 3.0});
  CHECK(one.poses->smallest() == 1);
}

TEST_CASE("poses: bodies that hang together are one assembly, pinned where a pin holds any of them") {
  Posed all(Everything::bodies(), Everything::angles(), Everything::clusters());
  const std::vector<Index>& of = all.assemblies.of;
  for (const auto& [a, b] : {std::pair(0, 1), {3, 4}, {7, 8}, {9, 10}}) CHECK(of[a] == of[b]);
  for (const auto& [a, b] : {std::pair(0, 2), {2, 3}, {5, 6}, {8, 9}}) CHECK(of[a] != of[b]);
  CHECK(all.assemblies.size() == 7);
  for (Index b = 0; b < 11; ++b) CHECK((all.assemblies.pinned[of[b]] == 1) == (b == 7 || b == 8));
}
