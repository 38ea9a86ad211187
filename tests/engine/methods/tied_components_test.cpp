// Conformal maps of several components whose features' directions are tied to one another.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "engine/flatten.hpp"
#include "kernels/intrinsic/transport.hpp"
#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

constexpr Index kSide = 13;

double bowl(double x, double y) { return 0.5 * x * x + 0.3 * y * y + 0.2 * x * y * y; }
double hill(double x, double y) { return 0.4 * std::exp(-2 * (x * x + y * y)) + 0.1 * x; }

/// Two sheets, the second sheared, each with a row and a column that become straight; their angle by itself is 90 degrees in
/// one and about 70 in the other.
struct Tied {
  Mesh part[2] = {shapes::height_field(kSide, bowl), shapes::scaled(shapes::height_field(kSide, hill), 1.3)};
  Mesh mesh;
  ConstraintSet set;
  std::vector<Feature> features;

  Tied() {
    for (Vec3& p : part[1].position) p.x += 0.35 * p.y;
    mesh = shapes::joined(part[0], part[1]);
    for (const int k : {0, 1}) {
      const Index first = k * kSide * kSide;
      std::vector<Index> row, column;
      for (Index i = 2; i < 9; ++i) {
        row.push_back(first + 4 * kSide + i);
        column.push_back(first + (i + 2) * kSide + 8);
      }
      add("row" + std::to_string(k), row);
      add("column" + std::to_string(k), column);
    }
  }
  void add(const std::string& name, const std::vector<Index>& chain) {
    features.push_back({.name = name, .vertex = chain});
    LineConstraint line{.feature = name};
    line.lengths = LineConstraint::Lengths::Scale;
    line.scale.factor.reset();
    set.constraints.push_back({name, "line", line});
  }
  void relate(const std::string& a, const std::string& b, double degrees) {
    AngleConstraint angle{};
    angle.features = {a, b};
    angle.degrees = degrees;
    angle.oriented = degrees > 0;
    set.constraints.push_back({a + " and " + b, "angle", angle});
  }
  /// Two opposite corners of each sheet where they lie in space.
  void pin() {
    PinConstraint pins;
    for (const Index v : {0, kSide * kSide - 1, kSide * kSide, 2 * kSide * kSide - 1}) {
      pins.vertex.push_back(v);
      pins.uv.push_back({mesh.position[v].x, mesh.position[v].y});
    }
    set.constraints.push_back({"pins", "pin", pins});
  }

  std::vector<Vec2> map(Method method) const {
    FlattenOptions options;
    options.method = method;
    auto flat = flatten(mesh.surface(), {&set, &features}, options);
    REQUIRE_MESSAGE(flat, flat.error().what);
    for (const ConstraintOutcome& c : flat->constraints.outcome) CHECK(c.residual < 1e-9);
    return std::move(flat->uv);
  }
  double degrees(int k, const std::vector<Vec2>& uv) const {
    const auto direction = [&](int f) {
      return argument(uv[features[f].vertex.back()] - uv[features[f].vertex.front()]);
    };
    return 180 / kPi * reduce_angle(direction(2 * k + 1) - direction(2 * k));
  }
  In<Vec2> of_part(int k, const std::vector<Vec2>& uv) const {
    return In<Vec2>(uv).subspan(k * kSide * kSide, kSide * kSide);
  }
  /// Conformal energy of a sheet's map by its stretches.
  double energy(int k, const std::vector<Vec2>& uv) const {
    const In<Vec2> z = of_part(k, uv);
    double sum = 0;
    for (Index t = 0; t < part[k].num_triangles(); ++t) {
      const Index* v = &part[k].corner_vertex[3 * static_cast<std::size_t>(t)];
      const auto& p = part[k].position;
      const RestFrame frame = rest_frame(p[v[0]], p[v[1]], p[v[2]]);
      const SingularValues s = singular_values(jacobian(frame, z[v[0]], z[v[1]], z[v[2]]));
      sum += 0.5 * area(frame) * (s.sigma_max - s.sigma_min) * (s.sigma_max - s.sigma_min);
    }
    return sum;
  }
  /// Energy over the boundary's mass, times the boundary's length.
  double quotient(int k, const std::vector<Vec2>& uv) const {
    const In<Vec2> z = of_part(k, uv);
    std::map<Index, double> mass;
    double length = 0;
    const auto along = [&](Index a, Index b) {
      const double l = norm(part[k].position[b] - part[k].position[a]);
      mass[a] += 0.5 * l, mass[b] += 0.5 * l, length += l;
    };
    for (Index i = 0; i + 1 < kSide; ++i) {
      along(i, i + 1);
      along((kSide - 1) * kSide + i, (kSide - 1) * kSide + i + 1);
      along(i * kSide, (i + 1) * kSide);
      along(i * kSide + kSide - 1, (i + 1) * kSide + kSide - 1);
    }
    Vec2 mean;
    for (const auto& [v, m] : mass) mean += (m / length) * z[v];
    double whole = 0;
    for (const auto& [v, m] : mass) whole += m * dot(z[v] - mean, z[v] - mean);
    return energy(k, uv) / whole * length;
  }
};

}  // namespace

TEST_CASE("lscm, spectral: one relation between components turns them, and changes neither's shape") {
  for (const Method method : {Method::Lscm, Method::Spectral}) {
    Tied apart, tied;
    tied.relate("row0", "row1", 0);
    const std::vector<Vec2> alone = apart.map(method), together = tied.map(method);
    for (const int k : {0, 1}) {
      const In<Vec2> a = apart.of_part(k, alone), b = tied.of_part(k, together);
      const double scale = norm(b.back() - b.front()) / norm(a.back() - a.front());
      for (std::size_t v = 1; v < a.size(); ++v)
        CHECK(norm(b[v] - b[0]) == Approx(scale * norm(a[v] - a[0])).epsilon(1e-6));
    }
  }
}

TEST_CASE("lscm: two relations between pinned components give the least sum of their energies") {
  Tied free;
  free.pin();
  free.relate("row0", "row1", 0);
  free.relate("column0", "column1", 0);
  const std::vector<Vec2> uv = free.map(Method::Lscm);
  const double degrees = free.degrees(0, uv), least = free.energy(0, uv) + free.energy(1, uv);
  CHECK(free.degrees(1, uv) == Approx(degrees).epsilon(1e-9));
  for (const double off : {-0.5, 0.5}) {
    Tied fixed = free;
    fixed.relate("row0", "column0", degrees + off);
    const std::vector<Vec2> other = fixed.map(Method::Lscm);
    CHECK(fixed.degrees(0, other) == Approx(degrees + off).epsilon(1e-9));
    CHECK(fixed.energy(0, other) + fixed.energy(1, other) > least * (1 + 1e-6));
  }
}

TEST_CASE("spectral: two relations between components give the least sum of their quotients times lengths") {
  Tied apart, free;
  free.relate("row0", "row1", 0);
  free.relate("column0", "column1", 0);
  const std::vector<Vec2> alone = apart.map(Method::Spectral), uv = free.map(Method::Spectral);
  const double degrees = free.degrees(0, uv), least = free.quotient(0, uv) + free.quotient(1, uv);
  CHECK(degrees < apart.degrees(0, alone) - 1);
  CHECK(degrees > apart.degrees(1, alone) + 1);
  for (const double off : {-0.5, 0.5}) {
    Tied fixed = free;
    fixed.relate("row0", "column0", degrees + off);
    const std::vector<Vec2> other = fixed.map(Method::Spectral);
    CHECK(fixed.quotient(0, other) + fixed.quotient(1, other) > least * (1 + 1e-6));
  }
}

TEST_CASE("lscm, spectral: a scale group over two components is refused, one within a component is not") {
  for (const Method method : {Method::Lscm, Method::Spectral}) {
    for (const bool over_both : {true, false}) {
      Tied tied;
      for (const int f : {0, over_both ? 2 : 1})
        std::get<LineConstraint>(tied.set.constraints[f].rule).scale.group = "g";
      FlattenOptions options;
      options.method = method;
      const auto flat = flatten(tied.mesh.surface(), {&tied.set, &tied.features}, options);
      CHECK(flat.has_value() == !over_both);
      if (!flat) CHECK(flat.error().code == ErrorCode::ConstraintUnsupported);
    }
  }
}

TEST_CASE("lscm: components without pins that two relations tie agree on an angle between their own") {
  Tied apart, tied;
  tied.relate("row0", "row1", 0);
  tied.relate("column0", "column1", 0);
  const std::vector<Vec2> alone = apart.map(Method::Lscm), uv = tied.map(Method::Lscm);
  CHECK(tied.degrees(0, uv) == Approx(tied.degrees(1, uv)).epsilon(1e-9));
  CHECK(tied.degrees(0, uv) < apart.degrees(0, alone) - 1);
  CHECK(tied.degrees(0, uv) > apart.degrees(1, alone) + 1);
}
