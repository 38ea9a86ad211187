#include "engine/constraints/rotation_problem.hpp"

#include <map>
#include <Eigen/Dense>

#include "engine/constraints/chain_shape.hpp"
#include "engine/constraints/cyclic_polygon.hpp"
#include "engine/solve/dual_weights.hpp"
#include "kernels/intrinsic/transport.hpp"
#include "tests/engine/constraints/laid_out.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

double bump(double x, double y) { return 0.4 * std::exp(-2 * (x * x + y * y)) + 0.1 * x * y; }

/// The rotation problem of a layout, and the same as dense rows: the test's own way from the layout to them.
struct Problem {
  Exec exec{1};
  Rest rest;
  Layout layout;
  std::vector<Index> edge;                // half-edges that name the free dual edges
  std::map<Index, Eigen::Index> unknown;  // of both half-edges
  std::vector<double> weight;             // k of each unknown

  explicit Problem(const Mesh& mesh) : rest(mesh), layout(empty_layout(rest)) {}

  void number(Init init) {
    edge.clear();
    unknown.clear();
    weight.clear();
    const StartInput input = rest.start_input();
    const FlooredWeights floored(Exec(1), input);
    for (Index c = 0; c < static_cast<Index>(layout.fixed_edge.size()); ++c) {
      const Index twin = rest.topology().corner_twin[c];
      if (twin == kNone || twin < c || layout.fixed_edge[c]) continue;
      unknown[c] = unknown[twin] = static_cast<Eigen::Index>(edge.size());
      edge.push_back(c);
      weight.push_back(init == Init::Cotangent ? floored(c) : 1);
    }
  }

  Result<RotationProblem> make(const StartInput& input, Init init) const {
    return RotationProblem::make(exec, rest.surface, input, layout, init);
  }

  /// w of a free dual edge, stepping from the left of its half-edge to the right, as angles have it.
  double w(In<double> theta, Index c) const {
    const Index twin = rest.topology().corner_twin[c];
    return reduce_angle(theta[twin / 3] - unfold_angle(theta[c / 3], c, twin, rest.geometry.frame));
  }
  Eigen::VectorXd w(In<double> theta) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(edge.size()));
    for (std::size_t k = 0; k < edge.size(); ++k) result[static_cast<Eigen::Index>(k)] = w(theta, edge[k]);
    return result;
  }

  struct Rows {
    std::vector<Eigen::VectorXd> row;
    std::vector<double> target;
    std::pair<Eigen::MatrixXd, Eigen::VectorXd> dense() const {
      Eigen::MatrixXd a(static_cast<Eigen::Index>(row.size()), row.front().size());
      for (std::size_t k = 0; k < row.size(); ++k) a.row(static_cast<Eigen::Index>(k)) = row[k].transpose();
      return {a, Eigen::Map<const Eigen::VectorXd>(target.data(), a.rows())};
    }
  };

  /// Rows of all fans between fixed edges, of whole stars and of holes (the fans of a hole that are not prescribed).
  Rows rows() const {
    Rows result;
    std::map<Index, std::pair<Eigen::VectorXd, double>> hole;
    const auto none = [&] { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(edge.size())).eval(); };
    const Topology& topology = rest.topology();
    const auto& vertex = rest.mesh().corner_vertex;
    for (Index v = 0; v < rest.mesh().num_vertices(); ++v) {
      std::vector<Index> star;
      for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v)))
        star.push_back(c);
      const bool boundary = topology.is_boundary(v);
      const auto fixed = [&](Index c) { return layout.fixed_edge[c] != 0; };
      const auto first = std::find_if(star.begin(), star.end(), fixed);
      if (!boundary && first != star.end()) std::rotate(star.begin(), first, star.end());
      // Fans: from a fixed edge or the boundary up to the next one.
      std::vector<std::vector<Index>> fans;
      for (const Index c : star) {
        if (fans.empty() || fixed(c)) fans.emplace_back();
        fans.back().push_back(c);
      }
      const Index loop = rest.loop_of[v];
      const bool in_hole = loop != kNone && loop != rest.outer[0];
      if (in_hole && !hole.contains(loop)) hole[loop] = {none(), 2 * kPi};
      for (const auto& fan : fans) {
        double angle = 0;
        for (const Index c : fan) angle += corner_angles(rest.geometry.frame[c / 3])[c % 3];
        const Index start = fan.front(), last = previous_corner(fan.back());
        const bool prescribed = fixed(start) && fixed(last);
        const bool whole = !boundary && !fixed(start);
        Eigen::VectorXd row = none();
        for (const Index c : fan) {
          if (const auto k = unknown.find(c); k != unknown.end()) row[k->second] += sign(k->second, c);
        }
        double target = 2 * kPi - angle;
        if (prescribed) {
          const Vec2 from = layout.point[vertex[next_corner(start)]] - layout.point[v];
          const Vec2 to = layout.point[vertex[last]] - layout.point[v];
          double beta = std::atan2(cross(from, to), dot(from, to));
          if (vertex[next_corner(start)] == vertex[last]) beta = 2 * kPi;
          target = (beta < 0 ? beta + 2 * kPi : beta) - angle;
        }
        if (whole || prescribed) {
          result.row.push_back(row);
          result.target.push_back(target);
          if (in_hole) hole[loop].second -= target;
        } else if (in_hole) {
          hole[loop].first += row;
        }
        if (in_hole) hole[loop].second -= angle;
      }
      if (in_hole) hole[loop].second += kPi;
    }
    for (const auto& [loop, row] : hole) {
      result.row.push_back(row.first);
      result.target.push_back(row.second);
    }
    return result;
  }

  /// theta of one triangle less that of another, along any way between them: coefficients of the unknowns.
  Eigen::VectorXd path(Index from, Index to) const {
    std::vector<Index> over(rest.mesh().num_triangles(), kNone), queue = {from};
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (Index c = 3 * queue[head]; c < 3 * queue[head] + 3; ++c) {
        const Index twin = rest.topology().corner_twin[c];
        if (twin == kNone || twin / 3 == from || over[twin / 3] != kNone) continue;
        over[twin / 3] = c;
        queue.push_back(twin / 3);
      }
    }
    Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(edge.size()));
    for (Index t = to; t != from; t = over[t] / 3) {
      const auto k = unknown.find(over[t]);
      // Stepping over half-edge c is +w where c names the edge, else back.
      if (k != unknown.end()) row[k->second] += edge[k->second] == over[t] ? 1 : -1;
    }
    return row;
  }

  /// The smallest solution in the norm of the weights: sum w^2 / k.
  Eigen::VectorXd smallest(const Rows& rows) const {
    auto [a, b] = rows.dense();
    const Eigen::VectorXd root = Eigen::Map<const Eigen::VectorXd>(weight.data(), a.cols()).cwiseSqrt();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-9);
    solver.compute(a * root.asDiagonal());
    const Eigen::VectorXd w = root.asDiagonal() * solver.solve(b);
    REQUIRE((a * w - b).cwiseAbs().maxCoeff() < 1e-10);  // the rows can be met
    return w;
  }

 private:
  /// An edge enters its tail with -1 and its head with +1.
  double sign(Eigen::Index k, Index c) const { return edge[k] == c ? -1 : 1; }
};

/// Across fixed edges triangles unfold.
void check_chains(const Problem& p, In<double> theta) {
  double worst = 0;
  for (Index c = 0; c < static_cast<Index>(p.layout.fixed_edge.size()); ++c) {
    if (p.layout.fixed_edge[c] && p.rest.topology().corner_twin[c] != kNone)
      worst = std::max(worst, std::abs(p.w(theta, c)));
  }
  CHECK(worst < 1e-10);
}

void check_smallest(Problem& p, Init init) {
  p.number(init);
  const StartInput input = p.rest.start_input();
  const auto problem = p.make(input, init);
  REQUIRE(problem);
  std::vector<Index> at;
  const auto rotations = problem->solve(p.layout, at);
  REQUIRE_MESSAGE(rotations, (rotations ? "" : describe(rotations.error())));
  CHECK(rotations->residual < 1e-9);
  const auto rows = p.rows();
  const Eigen::VectorXd found = p.w(rotations->theta), expected = p.smallest(rows);
  CHECK((found - expected).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(expected.cwiseAbs().maxCoeff() > 1e-3);  // there is something to solve
  check_chains(p, rotations->theta);

  // Two further rows along paths.
  const Index last = p.rest.mesh().num_triangles() - 1;
  const std::vector<PathRow> paths = {{.end = {{last, 1}, {last / 3, -1}}, .change = 0.3},
                                      {.end = {{last / 2, 1}, {0, -1}}, .change = -0.2}};
  const auto adjusted = problem->adjust(p.layout, *rotations, paths);
  REQUIRE(adjusted);
  auto more = rows;
  for (const PathRow& path : paths) {
    more.row.push_back(p.path(path.end[1].triangle, path.end[0].triangle));
    more.target.push_back(more.row.back().dot(expected) + path.change);
    const auto turn = [&](In<double> theta) {
      return theta[path.end[0].triangle] - theta[path.end[1].triangle];
    };
    CHECK(std::abs(reduce_angle(turn(adjusted->theta) - turn(rotations->theta) - path.change)) < 1e-9);
  }
  CHECK((p.w(adjusted->theta) - p.smallest(more)).cwiseAbs().maxCoeff() < 1e-9);
  check_chains(p, adjusted->theta);
}

void check_both_norms(Problem& p) {
  check_smallest(p, Init::Uniform);
  check_smallest(p, Init::Cotangent);
}

/// The chain's edge lengths on a circle, as it runs on the surface.
std::vector<Vec2> on_a_circle(const Rest& rest, const Feature& chain, bool counter_clockwise = true) {
  auto polygon = cyclic_polygon(edge_lengths(rest.surface, chain.vertex, true));
  REQUIRE(polygon);
  if (!counter_clockwise) {
    for (Vec2& t : polygon->corner) t = conjugate(t);
  }
  return polygon->corner;
}

}  // namespace

TEST_CASE("rotations: without features they are the smallest of all that close every star, in both norms") {
  Problem p(shapes::height_field(9, bump));
  check_both_norms(p);
}

TEST_CASE(
    "rotations: a straight chain inside and one along the rim are rows of their own, met by the smallest") {
  Problem p(shapes::height_field(9, bump));
  const Feature inside = p.rest.chain("a", grid_path(9, 2, 3, 6, 3)),
                rim = p.rest.chain("b", grid_path(9, 0, 0, 8, 0));
  lay(p.rest, inside, straight(5), p.layout);
  lay(p.rest, rim, straight(9), p.layout);
  check_both_norms(p);
}

TEST_CASE("rotations: around a hole the row is kept, and with chains that end on it or run along it too") {
  const Mesh mesh = polar_mesh(4, 12, 1, 2.5, 2 * kPi);
  Mesh bent = mesh;
  for (Vec3& q : bent.position) q.z = bump(0.6 * q.x, 0.6 * q.y) + 0.1 * q.x;
  Problem free(bent);
  check_both_norms(free);
  Problem across(bent);  // from the hole outwards
  lay(across.rest, across.rest.chain("a", {3, 15, 27, 39}), straight(4), across.layout);
  check_both_norms(across);
  Problem along(bent);  // a part of the hole becomes straight
  lay(along.rest, along.rest.chain("a", {1, 2, 3, 4, 5}), straight(5), along.layout);
  check_both_norms(along);
}

TEST_CASE(
    "rotations: a circle round a part of the surface leaves that part one row too many, which is implied") {
  Problem p(shapes::height_field(11, bump));
  const Feature loop = p.rest.chain("a", grid_loop(11, 2, 2, 8, 6), true);  // no corner is a single triangle
  lay(p.rest, loop, on_a_circle(p.rest, loop), p.layout);
  check_both_norms(p);
}

TEST_CASE(
    "rotations: circles within circles, around holes and along the whole rim are consistent (Gauss-Bonnet)") {
  const Index n = 16;
  Mesh bent = polar_mesh(5, n, 1, 2.5, 2 * kPi);
  for (Vec3& q : bent.position) q.z = bump(0.6 * q.x, 0.6 * q.y) + 0.1 * q.x * q.y;
  for (const std::vector<Index>& rings :
       {std::vector<Index>{0}, {5}, {0, 5}, {2}, {1, 3}, {0, 2, 3, 5}, {0, 1, 2, 3, 4, 5}}) {
    Problem p(bent);
    for (const Index j : rings) {
      std::vector<Index> ring(n);
      std::iota(ring.begin(), ring.end(), j * n);
      const Feature chain = p.rest.chain("ring", ring, true);
      lay(p.rest, chain, on_a_circle(p.rest, chain), p.layout);
    }
    p.number(Init::Uniform);
    const StartInput input = p.rest.start_input();
    const auto problem = p.make(input, Init::Uniform);
    REQUIRE(problem);
    std::vector<Index> at;
    const auto rotations = problem->solve(p.layout, at);
    REQUIRE_MESSAGE(rotations, (rotations ? "" : describe(rotations.error())));
    CHECK((p.w(rotations->theta) - p.smallest(p.rows())).cwiseAbs().maxCoeff() < 1e-9);
    check_chains(p, rotations->theta);
  }
}

TEST_CASE(
    "rotations: a closed chain laid out the wrong way round contradicts the curvature inside, and is found") {
  Problem p(shapes::height_field(11, bump));
  const Feature loop = p.rest.chain("a", grid_loop(11, 2, 2, 8, 6), true);
  const Feature beside = p.rest.chain("b", grid_path(11, 3, 8, 7, 8));
  lay(p.rest, loop, on_a_circle(p.rest, loop, false), p.layout);
  lay(p.rest, beside, straight(5), p.layout);
  const StartInput input = p.rest.start_input();
  const auto problem = p.make(input, Init::Uniform);
  REQUIRE(problem);
  std::vector<Index> at;
  const auto rotations = problem->solve(p.layout, at);
  REQUIRE_FALSE(rotations);
  CHECK(rotations.error().code == ErrorCode::ConstraintsConflict);
  CHECK(rotations.error().what.find("720 degrees") != std::string::npos);
  std::sort(at.begin(), at.end());
  std::vector<Index> expected = loop.vertex;
  std::sort(expected.begin(), expected.end());
  CHECK(at == expected);
}

TEST_CASE(
    "rotations: edges laid out around a vertex in another order than on the surface are refused at it") {
  Problem p(shapes::height_field(9, shapes::flat, 0));
  const Index middle = 4 * 9 + 4;
  double direction = 0;
  for (const Index other :
       {middle + 1, middle + 9, middle - 1}) {  // counter-clockwise on the surface, not in the plane
    lay(p.rest, p.rest.chain("a", {middle, other}), std::vector<Vec2>{{0, 0}, unit(direction)}, p.layout);
    direction -= 2 * kPi / 3;
  }
  const StartInput input = p.rest.start_input();
  const auto problem = p.make(input, Init::Uniform);
  REQUIRE(problem);
  std::vector<Index> at;
  const auto rotations = problem->solve(p.layout, at);
  REQUIRE_FALSE(rotations);
  CHECK(at == std::vector<Index>{p.rest.here[middle]});
  CHECK(rotations.error().what.find("720 degrees") != std::string::npos);
}

TEST_CASE(
    "rotations: on a flat mesh with a chain as it lies every triangle has one turn, exactly that of the "
    "plane") {
  Problem p(shapes::height_field(9, shapes::flat));
  const std::vector<Index> path = grid_path(9, 2, 3, 6, 3);
  const Feature chain = p.rest.chain("a", path);
  std::vector<Vec2> image;
  for (const Index v : chain.vertex)
    image.push_back({p.rest.mesh().position[v].x, p.rest.mesh().position[v].y});
  lay(p.rest, chain, image, p.layout);
  const StartInput input = p.rest.start_input();
  const auto problem = p.make(input, Init::Uniform);
  std::vector<Index> at;
  const auto rotations = problem->solve(p.layout, at);
  REQUIRE(rotations);
  const auto turn = [&](Index t) {  // of the triangle's frame, seen from its first edge on the flat mesh
    const auto& vertex = p.rest.mesh().corner_vertex;
    const Vec3 e = p.rest.mesh().position[vertex[3 * t + 1]] - p.rest.mesh().position[vertex[3 * t]];
    return rotations->theta[t] - std::atan2(e.y, e.x);
  };
  for (Index t = 0; t < p.rest.mesh().num_triangles(); ++t)
    CHECK(std::abs(reduce_angle(turn(t) - turn(0))) < 1e-12);
}

TEST_CASE("rotations: rows along paths that repeat one another are refused") {
  Problem p(shapes::height_field(9, bump));
  const StartInput input = p.rest.start_input();
  const auto problem = p.make(input, Init::Uniform);
  std::vector<Index> at;
  const auto rotations = problem->solve(p.layout, at);
  REQUIRE(rotations);
  const PathRow row{.end = {{40, 1}, {3, -1}}, .change = 0.1};
  CHECK(problem->adjust(p.layout, *rotations, {row}));
  const auto twice = problem->adjust(p.layout, *rotations, {row, row});
  REQUIRE_FALSE(twice);
  CHECK(twice.error().code == ErrorCode::FactorizationFailed);
}
