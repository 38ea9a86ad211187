#include "engine/constraints/dof_map.hpp"

#include <Eigen/Dense>

#include "engine/constraints/fit.hpp"
#include "engine/constraints/system.hpp"
#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr Index kN = 12;

double bump(double x, double y) { return 0.3 * std::exp(-2 * (x * x + y * y)); }

/// A constraint set on a bumpy grid, oriented; constraints on features of the same name as their type.
struct Mapped {
  Rest rest;
  std::vector<Feature> features;
  ConstraintSet set;
  ConstraintView view;
  std::unique_ptr<ConstraintSystem> system;

  explicit Mapped(const Mesh& mesh) : rest(mesh) {}
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;

  void add(const Feature& feature, decltype(Constraint::rule) rule) {
    features.push_back(feature);
    set.constraints.push_back(named(feature.name, std::move(rule)));
  }
  void build() {
    view = {&set, features, {}};
    auto made = ConstraintSystem::make(rest.surface, view, no_map, rest.component);
    REQUIRE_MESSAGE(made, (made ? "" : describe(made.error())));
    system = std::move(*made);
    const auto oriented = system->orient(Exec(1), rest.start_input(), Init::Uniform);
    REQUIRE_MESSAGE(oriented, (oriented ? "" : describe(oriented.error())));
  }
  std::unique_ptr<DofMap> dof(bool frozen) const {
    auto map = system->dof_map(frozen);
    REQUIRE(map);
    return std::move(*map);
  }
};

using Lengths = LineConstraint::Lengths;

/// A circle of free size, lines of all kinds joined at corners, a curve with a common scale, a right angle.
void add_everything(Mapped& m) {
  const Rest& r = m.rest;
  m.add(r.chain("circle", grid_loop(kN, 5, 5, 7, 7), true), CircleConstraint{.feature = "circle"});
  m.add(r.chain("keep", grid_path(kN, 1, 1, 5, 1)), LineConstraint{.feature = "keep"});
  m.add(r.chain("free", grid_path(kN, 5, 1, 9, 1)),
        LineConstraint{.feature = "free", .lengths = Lengths::Free});
  m.add(r.chain("scale", grid_path(kN, 9, 1, 9, 6)),
        LineConstraint{.feature = "scale", .lengths = Lengths::Scale, .scale = {.factor = {}}});
  m.add(r.chain("other", grid_path(kN, 1, 1, 1, 6)),
        LineConstraint{.feature = "other", .lengths = Lengths::Scale, .scale = {.factor = {}, .group = "g"}});
  m.add(r.chain("curve", grid_path(kN, 3, 9, 8, 9)),
        CurveConstraint{.feature = "curve", .scale = {.factor = {}, .group = "g"}});
  m.set.constraints.push_back(
      named("perpendicular", AngleConstraint{.features = {"keep", "other"}, .degrees = 90}));
}

/// sum over edges of a length's deviation, squared and weighted: no quadratic function of positions.
double energy(const Rest& rest, In<Vec2> x) {
  double sum = 0;
  const auto& vertex = rest.mesh().corner_vertex;
  for (Index c = 0; c < static_cast<Index>(vertex.size()); ++c) {
    const Vec2 e = x[vertex[next_corner(c)]] - x[vertex[c]];
    sum += std::pow(dot(e, e) - 0.01 * (1 + c % 5), 2) + dot(e, Vec2{0.3, 0.1 * (c % 3)});
  }
  return sum;
}

/// Half of its gradient.
std::vector<Vec2> half_gradient(const Rest& rest, In<Vec2> x, std::size_t size) {
  std::vector<Vec2> force(size);
  const auto& vertex = rest.mesh().corner_vertex;
  for (Index c = 0; c < static_cast<Index>(vertex.size()); ++c) {
    const Index u = vertex[c], v = vertex[next_corner(c)];
    const Vec2 e = x[v] - x[u];
    const Vec2 f = 2 * (dot(e, e) - 0.01 * (1 + c % 5)) * e + 0.5 * Vec2{0.3, 0.1 * (c % 3)};
    force[v] += f;
    force[u] += -f;
  }
  return force;
}

std::vector<Vec2> random_unknowns(const DofMap& dof, double border, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec2> x = dof.origin();
  for (Index k = 0; k < dof.num_nodes(); ++k) x[k] += Vec2{random.uniform() - 0.5, random.uniform() - 0.5};
  for (std::size_t k = dof.num_nodes(); k < x.size(); ++k) x[k] = {border * (2 * random.uniform() - 1), 0};
  return x;
}

bool is_unknown(const NodeMap& nodes, Index k) {
  const auto num_vertices = static_cast<Index>(nodes.node.size());
  return k >= num_vertices || nodes.node[k] == k;
}

void check_fold(const Mapped& m, DofMap& dof, std::uint64_t seed) {
  std::vector<Vec2> x = random_unknowns(dof, 0.05, seed);
  for (Index v = 0; v < dof.num_vertices(); ++v) {
    if (m.system->nodes().fixed[v]) x[v] = {};
  }
  REQUIRE(dof.expand(x));
  std::vector<Vec2> force = half_gradient(m.rest, x, dof.size());
  for (Index v = 0; v < dof.num_vertices(); ++v) {
    if (m.system->nodes().fixed[v]) force[v] = {};
  }
  dof.fold(force);
  const double step = 1e-5;
  double worst = 0, largest = 0;
  const auto value = [&](std::size_t k, Vec2 by) {
    std::vector<Vec2> moved = x;
    moved[k] += by;
    REQUIRE(dof.expand(moved));
    return energy(m.rest, moved);
  };
  for (std::size_t k = 0; k < dof.size(); ++k) {
    const bool border = static_cast<Index>(k) >= dof.num_nodes();
    if (!border && !is_unknown(m.system->nodes(), static_cast<Index>(k))) {
      CHECK(force[k] == Vec2{});
      continue;
    }
    const double u = (value(k, {step, 0}) - value(k, {-step, 0})) / (4 * step);
    worst = std::max(worst, std::abs(force[k].x - u));
    largest = std::max(largest, std::abs(u));
    if (border) continue;
    worst = std::max(worst, std::abs(force[k].y - (value(k, {0, step}) - value(k, {0, -step})) / (4 * step)));
  }
  CHECK(worst < 1e-6 * largest);
}

/// Forces that stay as they are, folded beside the base: how they change is the curvature.
void check_curvature(const Mapped& m, DofMap& dof, std::uint64_t seed) {
  std::vector<Vec2> x = random_unknowns(dof, 0.05, seed);
  REQUIRE(dof.expand(x));
  dof.rebase(x);
  REQUIRE(dof.expand(x));
  std::vector<Vec2> force = half_gradient(m.rest, x, dof.size());
  for (Index v = 0; v < dof.num_vertices(); ++v) {
    if (m.system->nodes().fixed[v]) force[v] = {};
  }
  const Index size = dof.num_border();
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(size, size), slope(size, size);
  for (const auto& [column, other, value] : dof.curvature(In<Vec2>(force).first(dof.num_vertices()))) {
    CHECK(other <= column);
    curvature(column, other) = curvature(other, column) = value;
  }
  constexpr double kStep = 1e-5;
  const auto folded_beside = [&](Index k, double by) {
    std::vector<Vec2> moved = x, folded = force;
    moved[dof.num_nodes() + k].x += by;
    REQUIRE(dof.expand(moved));
    dof.fold(folded);
    Eigen::VectorXd border(size);
    for (Index l = 0; l < size; ++l) border[l] = folded[dof.num_nodes() + l].x;
    return border;
  };
  for (Index k = 0; k < size; ++k)
    slope.col(k) = (folded_beside(k, kStep) - folded_beside(k, -kStep)) / (2 * kStep);
  REQUIRE(slope.cwiseAbs().maxCoeff() > 1e-3);
  CHECK((curvature - slope).cwiseAbs().maxCoeff() < 1e-6 * slope.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE(
    "dof map: folded forces are the gradient in the unknowns, with scales, turns, free lengths and joints") {
  Mapped m(shapes::height_field(kN, bump));
  add_everything(m);
  m.build();
  const auto free = m.dof(false), frozen = m.dof(true);
  CHECK(free->num_border() > frozen->num_border());
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    check_fold(m, *free, seed);
    check_fold(m, *frozen, seed);
    check_curvature(m, *free, seed);
  }
}

TEST_CASE("dof map: folded forces are the gradient where a four-bar linkage and pins hold shapes") {
  Mapped m(shapes::height_field(kN, bump));
  const Rest& r = m.rest;
  const std::vector<std::array<Index, 4>> side = {{2, 2, 8, 2}, {8, 2, 8, 10}, {8, 10, 2, 10}, {2, 10, 2, 2}};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string name = "side " + std::to_string(k);
    m.add(r.chain(name, grid_path(kN, side[k][0], side[k][1], side[k][2], side[k][3])),
          LineConstraint{.feature = name});
  }
  m.add(r.chain("curve", grid_path(kN, 4, 5, 6, 5)), CurveConstraint{.feature = "curve"});
  m.set.constraints.push_back(named("pins", PinConstraint{.vertex = {5 * kN + 4, 0, 11 * kN + 3},
                                                          .uv = {{0.1, 0.2}, {-1, -1}, {-0.4, 1.1}}}));
  m.build();
  const auto dof = m.dof(false);
  CHECK(dof->num_border() == 2 + 1);  // the linkage turns and folds, the curve turns about its pin
  check_fold(m, *dof, 3);
  check_curvature(m, *dof, 3);
}

TEST_CASE("dof map: templates that share many vertices turn as one, with the curvature of that") {
  for (const bool free_scale : {false, true}) {
    Mapped m(shapes::height_field(kN, shapes::flat));
    const Scale scale{.factor = free_scale ? std::nullopt : std::optional(1.0)};
    m.add(m.rest.chain("curve", grid_path(kN, 3, 5, 8, 5)),
          CurveConstraint{.feature = "curve", .scale = scale});
    m.add(m.rest.chain("longer", grid_path(kN, 6, 5, 10, 5)),
          CurveConstraint{.feature = "longer", .scale = scale});
    m.add(m.rest.chain("line", grid_path(kN, 2, 9, 7, 9)),
          LineConstraint{.feature = "line", .lengths = Lengths::Scale, .scale = {.factor = {}}});
    m.set.constraints.push_back(
        named("parallel", AngleConstraint{.features = {"curve", "line"}, .degrees = 30}));
    m.build();
    const auto dof = m.dof(false);
    check_fold(m, *dof, 7);
    check_curvature(m, *dof, 7);
  }
}

TEST_CASE("dof map: every point of it has the shapes to rounding, shared vertices and angles included") {
  Mapped m(shapes::height_field(kN, bump));
  add_everything(m);
  m.build();
  const auto dof = m.dof(false);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<Vec2> x = random_unknowns(*dof, 0.1, seed);
    REQUIRE(dof->expand(x));
    for (Index b = 0; b < static_cast<Index>(m.system->compiled().bodies.size()); ++b) {
      const Body& body = m.system->compiled().bodies[b];
      std::vector<Vec2> image, placed;
      for (const Index v : body.vertex) image.push_back(x[v]);
      if (body.kind == Body::Kind::FreeLine) {
        const BestLine line = best_line(image);
        for (const Vec2 z : image) CHECK(std::abs(cross(line.direction, z - line.mean)) < 1e-12);
        continue;
      }
      const Placement at = best_placement(body.shape, image, body.scale.value_or(0));
      for (const Vec2 t : body.shape) placed.push_back(at.p + multiply(at.c, t));
      CHECK(largest_distance(placed, image) < 1e-12);
    }
    const auto outcomes = m.system->outcomes(x);
    CHECK(outcomes.back().residual < 1e-7);  // the right angle, degrees
  }
}

TEST_CASE("dof map: the border's columns and corner are the Laplacian seen through the map's slopes") {
  Mapped m(shapes::height_field(kN, bump));
  add_everything(m);
  m.build();
  const auto dof = m.dof(false);
  const NodeMap& nodes = m.system->nodes();
  const EdgeWeight weight = [](Index) { return 1.25; };  // twins alike
  const DofMap::Border border = dof->border(m.rest.mesh().corner_vertex, m.rest.topology(), weight);
  const Index n = dof->num_vertices(), border_size = dof->num_border();
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(n, n);
  const auto& vertex = m.rest.mesh().corner_vertex;
  for (Index c = 0; c < static_cast<Index>(vertex.size()); ++c) {
    const Index twin = m.rest.topology().corner_twin[c];
    if (twin != kNone && twin < c) continue;
    const Index u = vertex[c], v = vertex[next_corner(c)];
    laplacian(u, u) += weight(c), laplacian(v, v) += weight(c);
    laplacian(u, v) -= weight(c), laplacian(v, u) -= weight(c);
  }
  // Slopes of all positions with each border unknown, by central differences.
  const double step = 1e-5;
  Eigen::MatrixXcd field = Eigen::MatrixXcd::Zero(n, border_size);
  for (Index k = 0; k < border_size; ++k) {
    std::vector<Vec2> ahead = dof->origin(), behind = ahead;
    ahead[dof->num_nodes() + k].x = step, behind[dof->num_nodes() + k].x = -step;
    REQUIRE(dof->expand(ahead));
    REQUIRE(dof->expand(behind));
    for (Index v = 0; v < n; ++v) {
      const Vec2 slope = (0.5 / step) * (ahead[v] - behind[v]);
      field(v, k) = {slope.x, slope.y};
    }
  }
  Eigen::MatrixXd indicator = Eigen::MatrixXd::Zero(n, nodes.num_nodes);
  for (Index v = 0; v < n; ++v) {
    if (nodes.node[v] != kNone) indicator(v, nodes.node[v]) = 1;
  }
  const Eigen::MatrixXcd column = indicator.transpose() * laplacian * field;
  const Eigen::MatrixXd corner = (field.adjoint() * laplacian * field).real();
  Eigen::MatrixXcd found = Eigen::MatrixXcd::Zero(nodes.num_nodes, border_size);
  for (Index k = 0; k < border_size; ++k) {
    for (std::size_t i = 0; i < border.column[k].row.size(); ++i)
      found(border.column[k].row[i], k) +=
          std::complex<double>(border.column[k].value[i].x, border.column[k].value[i].y);
  }
  CHECK((found - column).cwiseAbs().maxCoeff() < 1e-7);
  double worst = 0;
  for (Index k = 0; k < border_size; ++k) {
    for (Index l = 0; l < border_size; ++l)
      worst = std::max(worst, std::abs(border.corner[k * border_size + l] - corner(k, l)));
  }
  CHECK(worst < 1e-7);
}

TEST_CASE("dof map: rebasing keeps all positions and sets the border's unknowns to 0") {
  Mapped m(shapes::height_field(kN, bump));
  add_everything(m);
  m.build();
  const auto dof = m.dof(false);
  std::vector<Vec2> x = random_unknowns(*dof, 0.1, 7);
  REQUIRE(dof->expand(x));
  std::vector<Vec2> rebased = x;
  dof->rebase(rebased);
  for (std::size_t k = dof->num_nodes(); k < rebased.size(); ++k) CHECK(rebased[k] == Vec2{});
  REQUIRE(dof->expand(rebased));
  CHECK(largest_distance(In<Vec2>(rebased).first(dof->num_nodes()), In<Vec2>(x).first(dof->num_nodes())) <
        1e-13);
}

TEST_CASE("dof map: one vertex of each component is held, none where pins hold it; pins are met") {
  const Mesh flat = shapes::height_field(5, shapes::flat);
  Mapped m(shapes::joined(flat, flat));
  m.set.constraints.push_back(named("pin", PinConstraint{.vertex = {30}, .uv = {{3, 4}}}));
  m.build();
  const NodeMap& nodes = m.system->nodes();
  CHECK(std::count(nodes.fixed.begin(), nodes.fixed.end(), 1) == 2);
  CHECK(nodes.fixed[m.rest.here[30]] == 1);
  const auto dof = m.dof(false);
  std::vector<Vec2> x = random_unknowns(*dof, 0, 1);
  REQUIRE(dof->expand(x));
  CHECK(norm(m.rest.mesh().unit * x[m.rest.here[30]] - Vec2{3, 4}) < 1e-14);
  for (Index v = 0; v < dof->num_vertices(); ++v) CHECK((nodes.node[v] == kNone) == (nodes.fixed[v] == 1));
}
