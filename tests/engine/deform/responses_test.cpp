// What earlier solves let expect of the next one.
#include "engine/deform/responses.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

using Points = std::vector<Vec2>;

/// A linear response: each vertex goes with the two held ones by matrices of its own.
Points linear(const Points& held, std::size_t count) {
  shapes::Random random(5);
  const auto number = [&] { return 2 * random.uniform() - 1; };
  Points map(count);
  for (Vec2& z : map) {
    for (const Vec2 h : held) {
      const double a = number(), b = number(), c = number(), d = number();
      z += Vec2{a * h.x + b * h.y, c * h.x + d * h.y};
    }
  }
  return map;
}

double farthest(const Points& a, const Points& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, norm(a[v] - b[v]));
  return most;
}

}  // namespace

TEST_CASE("responses: a linear map is followed along ways that were gone before, in any combination") {
  const Exec exec;
  Responses responses(exec);
  const Points ways[] = {{{1, 0}, {0, 0}}, {{1, 0.5}, {0, 0}}, {{0, 0}, {2, -1}}};
  for (const Points& way : ways) responses.learn(way, linear(way, 5000));
  const Points way = {{0.3, -0.4}, {1, -0.5}};
  Points uv(5000, {7, 8}), wanted = linear(way, 5000);
  for (Vec2& z : wanted) z += Vec2{7, 8};
  CHECK(responses.follow(way, uv) < 1e-4);
  CHECK(farthest(uv, wanted) < 1e-4);
}

TEST_CASE("responses: of a way that is new in part that part is left") {
  const Exec exec;
  Responses responses(exec);
  responses.learn({{1, 0}}, linear({{1, 0}}, 10));
  Points uv(10), half = linear({{0.6, 0}}, 10);
  CHECK(responses.follow(Points{{0.6, 0.8}}, uv) == doctest::Approx(0.8));
  CHECK(farthest(uv, half) < 1e-5);
}

TEST_CASE("responses: without anything learnt, after forgetting, and for far ways the map stays") {
  const Exec exec;
  Responses responses(exec);
  Points uv(10);
  CHECK(responses.follow(Points{{1, 0}}, uv) == 1);
  responses.learn({{1, 0}}, linear({{1, 0}}, 10));
  CHECK(responses.follow(Points{{100, 0}}, uv) == 1);
  responses.forget();
  CHECK(responses.follow(Points{{1, 0}}, uv) == 1);
  CHECK(uv == Points(10));
}

TEST_CASE("responses: a map that bends with what is held is followed exactly once five ways are known") {
  const Exec exec;
  Responses responses(exec);
  const auto map_at = [](Vec2 p) {
    return Points{{p.x + 0.3 * p.x * p.x - 0.2 * p.x * p.y, p.y}, {0.5 * p.y * p.y, p.x - p.y + p.x * p.y}};
  };
  const auto between = [](const Points& to, const Points& from) {
    Points change = to;
    for (std::size_t v = 0; v < to.size(); ++v) change[v] = change[v] - from[v];
    return change;
  };
  const Vec2 stops[] = {{0, 0}, {0.1, 0}, {0.1, 0.1}, {-0.05, 0.1}, {-0.1, -0.1}, {0.05, -0.1}};
  double error = 1;
  for (int k = 1; k < 6; ++k) {
    const Vec2 from = stops[k - 1], to = stops[k];
    responses.learn({to - from}, between(map_at(to), map_at(from)));
    Points uv = map_at(to);
    const Vec2 next{0.02, -0.03};
    responses.follow(Points{next - to}, uv);
    error = farthest(uv, map_at(next));
    if (k == 2) CHECK(error > 1e-4);
  }
  CHECK(error < 1e-6);
}

TEST_CASE("responses: nothing held is nothing learnt, and what is oldest is forgotten") {
  const Exec exec;
  Responses responses(exec);
  responses.learn({{0, 0}}, Points(10, {9, 9}));
  Points uv(10);
  CHECK(responses.follow(Points{{1, 0}}, uv) == 1);
  responses.learn({{0, 1}}, Points(10, {1, 1}));
  for (int k = 0; k < 6; ++k) responses.learn({{1, 0}}, Points(10, {1, 2}));
  CHECK(responses.follow(Points{{0, 1}}, uv) == doctest::Approx(1));
  CHECK(farthest(uv, Points(10)) < 1e-9);
  CHECK(responses.follow(Points{{0.5, 0}}, uv) < 1e-8);
  CHECK(farthest(uv, Points(10, {0.5, 1})) < 1e-8);
}
