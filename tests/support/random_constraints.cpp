#include "tests/support/random_constraints.hpp"

#include <algorithm>
#include <ostream>

#include "engine/constraints/disjoint_sets.hpp"
#include "tests/support/constraint_residuals.hpp"
#include "tests/support/shapes.hpp"

namespace planish {
namespace {

constexpr double kDegree = kPi / 180;
constexpr Index kMostSets = 256;

/// Numbers for one item.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) { random_.bits(); }
  Index below(Index n) { return static_cast<Index>(random_.bits() % static_cast<std::uint64_t>(n)); }
  /// In [low, high].
  Index between(Index low, Index high) { return low + below(high - low + 1); }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  bool chance(double p) { return random_.uniform() < p; }

 private:
  shapes::Random random_;
};

struct Corner {
  Index i, j;
};

/// Adds features and constraints, as long as they can be met together.
class Maker {
 public:
  explicit Maker(const CaseSeeds& seeds) : grid_(random_grid(seeds.mesh, seeds.triangles)) {
    c_.mesh = grid_.mesh;
    count_.assign(c_.mesh.position.size(), 0);
    first_.assign(c_.mesh.position.size(), kNone);
    pinned_.assign(c_.mesh.position.size(), 0);
    Dice dice(seeds.mesh + 17);
    turn_ = dice.between(0.0, 2 * kPi);
    shift_ = {dice.between(-3.0, 3.0), dice.between(-3.0, 3.0)};
  }

  ConstrainedCase finish() { return std::move(c_); }

  void add_items(const std::vector<std::uint32_t>& items) {
    for (int pass = 0; pass < 3; ++pass) {
      for (const std::uint32_t item : items) {
        Dice dice(item);
        const Index kind = dice.below(100);
        if (pass == 0 && kind < 65) add_feature(dice);
        if (pass == 1 && kind >= 65 && kind < 85) add_relation(dice);
        if (pass == 2 && kind >= 85) add_pin(dice);
      }
    }
  }

  void contradict(int kind, Dice& dice, std::vector<std::string>& named);

 private:
  /// A feature that has been placed; entry 0 stands for the u axis.
  struct Placed {
    std::string name;
    bool open = false;
    double natural = 0, target = 0;  ///< direction of its chord, radians
    bool keep_line = false, free_alone = false;
    std::array<Index, 2> edge = {kNone, kNone};
  };

  // ---- places ----

  std::vector<Index> path(const std::vector<Corner>& corner) const {
    std::vector<Index> vertex = {grid_.at(corner[0].i, corner[0].j)};
    for (std::size_t k = 1; k < corner.size(); ++k) {
      Corner at = corner[k - 1];
      while (at.i != corner[k].i || at.j != corner[k].j) {
        at.i += (corner[k].i > at.i) - (corner[k].i < at.i);
        at.j += (corner[k].j > at.j) - (corner[k].j < at.j);
        vertex.push_back(grid_.at(at.i, at.j));
      }
    }
    if (std::find(vertex.begin(), vertex.end(), kNone) != vertex.end()) vertex.clear();
    return vertex;
  }

  std::vector<Index> loop(Index i0, Index j0, Index i1, Index j1) const {
    std::vector<Index> vertex = path({{i0, j0}, {i1, j0}, {i1, j1}, {i0, j1}, {i0, j0}});
    if (!vertex.empty()) vertex.pop_back();
    return vertex;
  }

  std::vector<Index> block(Index i0, Index j0, Index i1, Index j1) const {
    std::vector<Index> triangle;
    for (Index j = j0; j < j1; ++j) {
      for (Index i = i0; i < i1; ++i) {
        const Index t = grid_.triangle_of_cell[static_cast<std::size_t>(j) * (grid_.columns - 1) + i];
        if (t == kNone) return {};
        triangle.insert(triangle.end(), {t, t + 1});
      }
    }
    std::sort(triangle.begin(), triangle.end());
    return triangle;
  }

  std::vector<Index> vertices_of(const std::vector<Index>& triangle) const {
    std::vector<Index> vertex;
    for (const Index t : triangle) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) vertex.push_back(c_.mesh.corner_vertex[c]);
    }
    std::sort(vertex.begin(), vertex.end());
    vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
    return vertex;
  }

  /// Two features at most meet in a vertex, and none meets what hangs together twice: joints form a forest.
  bool fits(const std::vector<Index>& vertex) {
    std::vector<Index> met;
    for (const Index v : vertex) {
      if (count_[v] >= 2) return false;
      if (count_[v] > 0) met.push_back(assembly_.root(first_[v]));
    }
    std::sort(met.begin(), met.end());
    return !vertex.empty() && std::adjacent_find(met.begin(), met.end()) == met.end() &&
           static_cast<Index>(placed_.size()) + 4 < kMostSets;
  }

  Index occupy(const std::vector<Index>& vertex, Placed placed) {
    const auto id = static_cast<Index>(placed_.size());
    for (const Index v : vertex) {
      if (count_[v]++ == 0) first_[v] = id;
      assembly_.unite(first_[v], id);
    }
    placed_.push_back(std::move(placed));
    pins_.push_back(0);
    return id;
  }

  double natural_direction(Index from, Index to) const {
    const Vec3 d = c_.mesh.position[to] - c_.mesh.position[from];
    return std::atan2(d.y, d.x);
  }

  std::string next_name(const std::string& prefix) { return prefix + std::to_string(c_.features.size()); }

  Index place_chain(const std::string& name, std::vector<Index> vertex, bool closed, Dice& dice,
                    const std::vector<Index>* occupied = nullptr) {
    if (dice.chance(0.5)) std::reverse(vertex.begin(), vertex.end());
    Placed placed{.name = name, .open = !closed};
    placed.natural = natural_direction(vertex.front(), vertex.back());
    placed.target = placed.natural + turn_ + dice.between(-10.0, 10.0) * kDegree;
    const Index id = occupy(occupied ? *occupied : vertex, std::move(placed));
    Feature feature{.name = name, .vertex = std::move(vertex), .closed = closed, .triangle = {}};
    c_.features.push_back(std::move(feature));
    return id;
  }

  void constrain(const std::string& type, const std::string& on, decltype(Constraint::rule) rule) {
    c_.set.constraints.push_back({type + " " + on, type, std::move(rule)});
  }

  // ---- features ----

  Scale random_scale(Dice& dice) {
    const Index kind = dice.below(10);
    if (kind < 4) return {};
    if (kind < 6) return {.factor = dice.between(0.8, 1.25), .group = {}};
    return {.factor = std::nullopt, .group = kind == 9 ? "g" : ""};
  }
  static bool is_free_alone(const Scale& scale) { return !scale.factor && scale.group.empty(); }
  static std::optional<bool> random_mirror(Dice& dice) {
    const Index kind = dice.below(4);
    return kind < 2 ? std::nullopt : std::optional(kind == 3);
  }

  void add_feature(Dice& dice) {
    const Index kind = dice.below(10);
    if (kind < 4) return add_straight_chain(dice);
    if (kind == 4) return add_bent_chain(dice);
    if (kind == 5) return add_loop(dice);
    if (kind == 6) return add_boundary_loop(dice);
    if (kind == 7) return add_region(dice);
    if (kind == 8) return add_quadrilateral(dice);
    add_part_of_line(dice);
  }

  std::vector<Index> random_straight(Dice& dice, Index least) {
    const bool row = dice.chance(0.5);
    const Index n = row ? grid_.columns : grid_.rows, lines = row ? grid_.rows : grid_.columns;
    const Index from = dice.below(n - least), to = dice.between(from + least, n - 1),
                line = dice.below(lines);
    return row ? path({{from, line}, {to, line}}) : path({{line, from}, {line, to}});
  }

  void add_straight_chain(Dice& dice) {
    const std::vector<Index> chain = random_straight(dice, 2);
    if (chain.empty()) return;
    const Index shape = dice.below(20);
    if (shape < 2) {  // only measured: its ends make a chord
      const std::vector<Index> ends = {chain.front(), chain.back()};
      if (fits(ends)) place_chain(next_name("chord"), chain, false, dice, &ends);
      return;
    }
    if (!fits(chain)) return;
    const std::string name = next_name("chain");
    Placed& placed = placed_[place_chain(name, chain, false, dice)];
    if (shape < 12) {
      LineConstraint rule{.feature = name, .lengths = LineConstraint::Lengths::Keep, .scale = {}};
      const Index lengths = dice.below(10);
      if (lengths < 4) {
        rule.lengths = LineConstraint::Lengths::Scale;
        rule.scale = random_scale(dice);
        placed.free_alone = is_free_alone(rule.scale);
      } else if (lengths < 6) {
        rule.lengths = LineConstraint::Lengths::Free;
      } else {
        placed.keep_line = true;
      }
      constrain("line", name, rule);
    } else if (shape < 15) {
      CircleConstraint rule{.feature = name,
                            .scale = random_scale(dice),
                            .radius = {},
                            .sweep_degrees = dice.between(15.0, 70.0),
                            .mirror = random_mirror(dice)};
      placed.free_alone = is_free_alone(rule.scale);
      constrain("circle", name, rule);
    } else {
      add_curve(name, placed, shape < 18, dice);
    }
  }

  void add_curve(const std::string& name, Placed& placed, bool plane, Dice& dice, bool bent = false) {
    const Feature& feature = c_.feature(name);
    std::vector<Vec3> point;
    for (const Index v : feature.vertex) point.push_back(c_.mesh.position[v]);
    constexpr double kClearPlane = 5e-3;
    const double bend = straightness(point);
    CurveConstraint rule{.feature = name,
                         .shape = CurveConstraint::Shape::Geodesic,
                         .scale = random_scale(dice),
                         .mirror = {}};
    if (plane && (bend > kClearPlane || bend < 1e-12)) rule.shape = CurveConstraint::Shape::Plane;
    if (!feature.closed && !bent) rule.mirror = random_mirror(dice);  // a bent one would turn over its corner
    placed.free_alone = is_free_alone(rule.scale);
    constrain("curve", name, rule);
  }

  void add_bent_chain(Dice& dice) {
    const Index i = dice.between(0, grid_.columns - 1), j = dice.between(0, grid_.rows - 1);
    const Index to_i = dice.below(grid_.columns), to_j = dice.below(grid_.rows);
    if (std::abs(to_i - i) < 2 || std::abs(to_j - j) < 2) return;
    const std::vector<Index> chain = path({{i, j}, {to_i, j}, {to_i, to_j}});
    if (!fits(chain)) return;
    const std::string name = next_name("bent");
    add_curve(name, placed_[place_chain(name, chain, false, dice)], dice.chance(0.7), dice, true);
  }

  void add_closed(const std::string& name, const std::vector<Index>& chain, Dice& dice) {
    if (!fits(chain)) return;
    Placed& placed = placed_[place_chain(name, chain, true, dice)];
    if (dice.chance(0.5)) return add_curve(name, placed, dice.chance(0.7), dice);
    CircleConstraint rule{.feature = name,
                          .scale = {.factor = {}, .group = {}},
                          .radius = {},
                          .sweep_degrees = {},
                          .mirror = {}};
    if (dice.chance(0.3)) {
      rule.radius = dice.between(0.8, 1.2) * length_of(chain) / (2 * kPi);
    } else {
      rule.scale = random_scale(dice);
      placed.free_alone = is_free_alone(rule.scale);
    }
    constrain("circle", name, rule);
  }

  double length_of(const std::vector<Index>& loop) const {
    double length = 0;
    for (std::size_t i = 0; i < loop.size(); ++i)
      length += norm(c_.mesh.position[loop[(i + 1) % loop.size()]] - c_.mesh.position[loop[i]]);
    return length;
  }

  struct Box {
    Index i0, j0, i1, j1;
  };
  Box random_box(Dice& dice, Index least, Index most) {
    const Index width = std::min(dice.between(least, most), grid_.columns - 1),
                height = std::min(dice.between(least, most), grid_.rows - 1);
    const Index i = dice.below(grid_.columns - width), j = dice.below(grid_.rows - height);
    return {i, j, i + width, j + height};
  }

  void add_loop(Dice& dice) {
    const Box b = random_box(dice, 2, std::max(grid_.columns, grid_.rows) / 2);
    add_closed(next_name("loop"), loop(b.i0, b.j0, b.i1, b.j1), dice);
  }

  void add_boundary_loop(Dice& dice) {
    const bool hole = grid_.has_hole() && dice.chance(0.6);
    add_closed(next_name(hole ? "hole" : "outer"),
               hole ? loop(grid_.hole[0], grid_.hole[1], grid_.hole[2], grid_.hole[3])
                    : loop(0, 0, grid_.columns - 1, grid_.rows - 1),
               dice);
  }

  void add_region(Dice& dice) {
    const Box b = random_box(dice, 1, 4);
    const std::vector<Index> triangle = block(b.i0, b.j0, b.i1, b.j1);
    const std::vector<Index> vertex = vertices_of(triangle);
    if (triangle.empty() || !fits(vertex)) return;
    place_region(next_name("region"), triangle, vertex, dice);
  }

  void place_region(const std::string& name, const std::vector<Index>& triangle,
                    const std::vector<Index>& vertex, Dice& dice) {
    Placed& placed = placed_[occupy(vertex, {.name = name})];
    RegionConstraint rule{name, random_scale(dice)};
    placed.free_alone = is_free_alone(rule.scale);
    c_.features.push_back({.name = name, .vertex = {}, .triangle = triangle});
    constrain("region", name, rule);
  }

  /// Four lines around a block: a rectangle of free sides, or a linkage that keeps its lengths.
  void add_quadrilateral(Dice& dice) {
    const Box b = random_box(dice, 2, 6);
    if (block(b.i0, b.j0, b.i1, b.j1).empty()) return;
    add_sides(b, dice.chance(0.6), dice);
  }

  bool add_sides(const Box& b, bool rectangle, Dice& dice) {
    const Corner corner[4] = {{b.i0, b.j0}, {b.i1, b.j0}, {b.i1, b.j1}, {b.i0, b.j1}};
    if (!fits(loop(b.i0, b.j0, b.i1, b.j1))) return false;
    for (const Corner at : corner) {
      if (count_[grid_.at(at.i, at.j)] > 0) return false;
    }
    const double off = dice.between(-10.0, 10.0) * kDegree;
    Index first = kNone;
    std::string before;
    for (int k = 0; k < 4; ++k) {
      const std::string name = next_name("side");
      const Index id = place_chain(name, path({corner[k], corner[(k + 1) % 4]}), false, dice);
      placed_[id].target = placed_[id].natural + turn_ + off;
      constrain("line", name,
                LineConstraint{name,
                               rectangle ? LineConstraint::Lengths::Scale : LineConstraint::Lengths::Keep,
                               {.factor = rectangle ? std::nullopt : std::optional(1.0), .group = {}}});
      if (k > 0) {
        relation_.unite(first, id);
        assembly_.unite(first, id);
        if (rectangle)
          constrain("perpendicular", before + " " + name, AngleConstraint{{before, name}, {}, {}, 90, false});
      } else {
        first = id;
      }
      before = name;
    }
    return true;
  }

  void add_part_of_line(Dice& dice) {
    std::vector<Index> lines;
    for (Index k = 0; k < static_cast<Index>(placed_.size()); ++k) {
      if (placed_[k].keep_line && c_.feature(placed_[k].name).vertex.size() > 3) lines.push_back(k);
    }
    if (lines.empty()) return;
    const Index parent = lines[dice.below(static_cast<Index>(lines.size()))];
    const std::vector<Index> whole = c_.feature(placed_[parent].name).vertex;
    const auto n = static_cast<Index>(whole.size());
    const Index from = dice.below(n - 2), to = dice.between(from + 2, n - 1);
    const std::vector<Index> part(whole.begin() + from, whole.begin() + to + 1);
    const std::string name = next_name("part");
    const Index id = place_chain(name, part, false, dice, nullptr);
    placed_[id].target = placed_[id].natural + placed_[parent].target - placed_[parent].natural;
    if (std::abs(std::remainder(placed_[id].natural - placed_[parent].natural, kPi)) > 1e-12) {
      // Their chords differ in space, but not in the plane.
      const bool same_way = std::cos(placed_[id].natural - placed_[parent].natural) > 0;
      placed_[id].target = placed_[parent].target + (same_way ? 0 : kPi);
    }
    relation_.unite(parent, id);
    assembly_.unite(parent, id);
    constrain("line", name,
              LineConstraint{.feature = name, .lengths = LineConstraint::Lengths::Keep, .scale = {}});
  }

  // ---- relations ----

  void add_relation(Dice& dice) {
    if (dice.chance(0.25)) return add_edge_relation(dice);
    std::vector<Index> open;
    for (Index k = 1; k < static_cast<Index>(placed_.size()); ++k) {
      if (placed_[k].open && placed_[k].edge[0] == kNone) open.push_back(k);
    }
    if (open.empty()) return;
    const Index b = open[dice.below(static_cast<Index>(open.size()))];
    if (dice.chance(0.25)) {
      if (!relation_.unite(0, b)) return;
      placed_[b].free_alone = false;
      const bool oriented = dice.chance(0.5);
      const double degrees = wrapped(placed_[b].target / kDegree, oriented ? 360 : 180);
      either_way_ |= !oriented;
      constrain("direction", placed_[b].name,
                DirectionConstraint{placed_[b].name, {}, {}, degrees, oriented});
      return;
    }
    const Index a = open[dice.below(static_cast<Index>(open.size()))];
    if (relation_.root(a) == relation_.root(b)) return;
    const bool alone = relation_size(b) == 1;
    relation_.unite(a, b);
    placed_[a].free_alone = placed_[b].free_alone = false;
    const double right = 90 * kDegree;
    const double squared =
        placed_[a].target + right * std::round((placed_[b].target - placed_[a].target) / right);
    const bool near_square = std::abs(squared - placed_[b].natural - turn_) < 12 * kDegree;
    if (alone && near_square && dice.chance(0.5)) {
      placed_[b].target = squared;
      const bool parallel = std::abs(std::remainder(squared - placed_[a].target, 2 * right)) < 0.5;
      constrain(parallel ? "parallel" : "perpendicular", placed_[a].name + " " + placed_[b].name,
                AngleConstraint{{placed_[a].name, placed_[b].name}, {}, {}, parallel ? 0.0 : 90.0, false});
      return;
    }
    const bool oriented = dice.chance(0.5);
    const double degrees = wrapped((placed_[b].target - placed_[a].target) / kDegree, oriented ? 360 : 180);
    constrain("angle", placed_[a].name + " " + placed_[b].name,
              AngleConstraint{{placed_[a].name, placed_[b].name}, {}, {}, degrees, oriented});
  }

  static double wrapped(double degrees, double period) {
    const double x = degrees - period * std::floor(degrees / period);
    return x < period ? x : 0;
  }

  int relation_size(Index b) {
    int size = 0;
    for (Index k = 0; k < static_cast<Index>(placed_.size()); ++k)
      size += relation_.root(k) == relation_.root(b);
    return size;
  }

  void add_edge_relation(Dice& dice) {
    std::array<Index, 2> edge[2];
    for (auto& e : edge) {
      const Index c = dice.below(static_cast<Index>(c_.mesh.corner_vertex.size()));
      e = {c_.mesh.corner_vertex[c], c_.mesh.corner_vertex[next_corner(c)]};
      if (count_[e[0]] > 0 || count_[e[1]] > 0) return;
    }
    for (const Index v : edge[0]) {
      if (v == edge[1][0] || v == edge[1][1]) return;
    }
    const double turn = dice.between(-10.0, 10.0);
    const double a = natural_direction(edge[0][0], edge[0][1]) / kDegree,
                 b = natural_direction(edge[1][0], edge[1][1]) / kDegree;
    const std::string on = std::to_string(edge[0][0]) + "-" + std::to_string(edge[0][1]);
    for (int k = 0; k < 2; ++k)
      occupy({edge[k].begin(), edge[k].end()}, {.name = {}, .open = true, .edge = edge[k]});
    if (dice.chance(0.3)) {
      constrain("direction", on,
                DirectionConstraint{"", edge[0], {}, wrapped(a + turn_ / kDegree + turn, 360), true});
      return;
    }
    constrain("angle", on, AngleConstraint{{}, {edge[0], edge[1]}, {}, wrapped(b - a + turn, 180), false});
  }

  // ---- pins ----

  Vec2 expected_place(Index v) const {
    const Vec3 p = c_.mesh.position[v];
    return multiply(unit(turn_), {p.x, p.y}) + shift_;
  }

  void add_pin(Dice& dice) {
    const Index v = dice.below(c_.mesh.num_vertices());
    if (pinned_[v]) return;
    if (either_way_ && num_pins_ > 0) return;  // a direction may take the half-turn that several pins do not
    if (count_[v] > 0) {
      int members = 0;
      const Index root = assembly_.root(first_[v]);
      for (Index k = 1; k < static_cast<Index>(placed_.size()); ++k) members += assembly_.root(k) == root;
      const int most = members == 1 && placed_[first_[v]].free_alone ? 2 : 1;
      if (pins_[root] >= most) return;
      ++pins_[root];
    }
    pinned_[v] = 1;
    ++num_pins_;
    const Vec2 off{dice.between(-0.05, 0.05), dice.between(-0.05, 0.05)};
    const Vec2 uv = expected_place(v) + off;
    if (dice.chance(0.5)) {
      for (Constraint& constraint : c_.set.constraints) {
        auto* pin = std::get_if<PinConstraint>(&constraint.rule);
        if (!pin) continue;
        pin->vertex.push_back(v);
        pin->uv.push_back(uv);
        return;
      }
    }
    constrain("pin", std::to_string(v), PinConstraint{{v}, {uv}});
  }

  GridMesh grid_;
  ConstrainedCase c_;
  std::vector<int> count_;       // features at each vertex
  std::vector<Index> first_;     // the first of them
  std::vector<char> pinned_;     // per vertex
  std::vector<int> pins_ = {0};  // per assembly's root
  std::vector<Placed> placed_ = {{}};
  DisjointSets assembly_{kMostSets}, relation_{kMostSets};
  bool either_way_ = false;  // there is a direction modulo 180 degrees
  int num_pins_ = 0;
  double turn_ = 0;  // of the plane against the grid
  Vec2 shift_;
};

// ---- contradictions ----

constexpr const char* kContradictions[kNumContradictions] = {
    "a line and an arc on one chain",
    "parallel and perpendicular",
    "pins at the wrong distance on a line that keeps its lengths",
    "three angles that do not sum to 180 degrees",
    "a rectangle whose opposite sides have different given lengths",
    "a closed chain to a line",
    "a region's bent border to a line",
    "two places for one vertex",
    "two radii for one circle",
    "two directions of one line"};

void Maker::contradict(int kind, Dice& dice, std::vector<std::string>& named) {
  const Index far_i = grid_.columns - 1, far_j = grid_.rows - 1;
  const auto chain = [&](const std::string& name, const std::vector<Corner>& corner) {
    return place_chain(name, path(corner), corner.size() > 4, dice);
  };
  const auto keep = [&](const std::string& name) {
    constrain("line", name,
              LineConstraint{.feature = name, .lengths = LineConstraint::Lengths::Keep, .scale = {}});
  };
  const auto angle = [&](const std::string& type, const std::string& a, const std::string& b,
                         double degrees) {
    constrain(type, a + " " + b, AngleConstraint{{a, b}, {}, {}, degrees, false});
  };
  switch (kind) {
    case 0:
      chain("X", {{0, 1}, {far_i, 1}});
      constrain("line", "X",
                LineConstraint{"X", LineConstraint::Lengths::Scale, {.factor = {}, .group = {}}});
      constrain("circle", "X", CircleConstraint{"X", {.factor = {}, .group = {}}, {}, 60, false});
      named = {"line X", "circle X"};
      break;
    case 1:
      chain("X", {{0, 1}, {far_i, 1}});
      chain("Y", {{1, far_j}, {far_i, far_j}});
      keep("X"), keep("Y");
      angle("parallel", "X", "Y", 0);
      angle("perpendicular", "X", "Y", 90);
      named = {"parallel X Y", "perpendicular X Y"};
      break;
    case 2: {
      chain("X", {{0, 1}, {far_i, 1}});
      keep("X");
      const std::vector<Index>& x = c_.feature("X").vertex;
      const Vec2 a = expected_place(x.front()), b = expected_place(x.back());
      constrain("pin", "P", PinConstraint{{x.front()}, {a}});
      constrain("pin", "Q", PinConstraint{{x.back()}, {b + 0.5 * (b - a)}});
      pinned_[x.front()] = pinned_[x.back()] = 1;
      pins_[assembly_.root(first_[x.front()])] = 2;
      named = {"line X", "pin P", "pin Q"};
      break;
    }
    case 3:
      chain("X", {{0, 0}, {far_i, 0}});
      chain("Y", {{0, 2}, {far_i, 2}});
      chain("Z", {{0, far_j}, {far_i, far_j}});
      angle("angle", "X", "Y", 50), angle("angle", "Y", "Z", 60), angle("angle", "Z", "X", 50);
      named = {"angle X Y", "angle Y Z", "angle Z X"};
      break;
    case 4:
      add_sides({0, 0, 3, 3}, true, dice);
      for (std::size_t k = 0, side = 0; k < c_.set.constraints.size(); ++k) {
        auto* line = std::get_if<LineConstraint>(&c_.set.constraints[k].rule);
        if (!line) continue;
        line->scale.factor = side++ == 0 ? 1.4 : 1.0;
        named.push_back(c_.set.constraints[k].name);
      }
      break;
    case 5:
      chain("X", {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 1}});
      keep("X");
      named = {"line X"};
      break;
    case 6: {
      const std::vector<Index> triangle = block(0, 0, 3, 3);
      place_region("R", triangle, vertices_of(triangle), dice);
      chain("X", {{3, 0}, {3, 3}, {0, 3}});
      keep("X");
      named = {"region R", "line X"};
      break;
    }
    case 7: {
      const Index v = grid_.at(2, 1);
      constrain("pin", "P", PinConstraint{{v}, {expected_place(v)}});
      constrain("pin", "Q", PinConstraint{{v}, {expected_place(v) + Vec2{0.1, 0}}});
      pinned_[v] = 1;
      named = {"pin P", "pin Q"};
      break;
    }
    case 8:
      chain("X", {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 1}});
      for (const double radius : {0.3, 0.4}) {
        constrain(radius < 0.35 ? "circle" : "circle of another radius", "X",
                  CircleConstraint{"X", {}, radius, {}, {}});
      }
      c_.set.constraints.back().type = "circle";
      named = {"circle X", "circle of another radius X"};
      break;
    case 9:
      chain("X", {{0, 1}, {far_i, 1}});
      keep("X");
      relation_.unite(0, 1);
      constrain("direction", "X", DirectionConstraint{"X", {}, {}, 10, false});
      constrain("other direction", "X", DirectionConstraint{"X", {}, {}, 50, true});
      c_.set.constraints.back().type = "direction";
      named = {"direction X", "other direction X"};
      break;
    default: break;
  }
}

}  // namespace

const char* contradiction_name(int kind) { return kContradictions[kind]; }

GridMesh random_grid(std::uint32_t seed, Index triangles) {
  Dice dice(seed);
  GridMesh grid;
  const double cells = 0.5 * triangles;
  grid.columns = std::max<Index>(7, static_cast<Index>(std::sqrt(cells * dice.between(0.6, 1.6))) + 1);
  grid.rows = std::max<Index>(7, static_cast<Index>(cells / (grid.columns - 1)) + 1);
  if (dice.chance(0.4) && std::min(grid.columns, grid.rows) > 9) {
    const Index wide = dice.between(2, grid.columns / 3), high = dice.between(2, grid.rows / 3);
    const Index i = dice.between(4, grid.columns - 3 - wide), j = dice.between(4, grid.rows - 3 - high);
    grid.hole[0] = i, grid.hole[1] = j, grid.hole[2] = i + wide, grid.hole[3] = j + high;
  }
  struct Wave {
    double amplitude, kx, ky, phase;
  };
  std::vector<Wave> waves;
  const bool flat = dice.chance(0.15);
  for (int k = 0; k < 3 && !flat; ++k) {
    const double length = dice.between(1.2, 4.0), angle = dice.between(0.0, kPi);
    waves.push_back({dice.between(0.02, 0.06) * length, 2 * kPi / length * std::cos(angle),
                     2 * kPi / length * std::sin(angle), dice.between(0.0, 2 * kPi)});
  }
  const double jitter = dice.between(0.05, 0.3);
  const double cell = 2.0 / static_cast<double>(std::max(grid.columns, grid.rows) - 1);
  const auto in_hole = [&](Index i, Index j) {
    return grid.has_hole() && i > grid.hole[0] && i < grid.hole[2] && j > grid.hole[1] && j < grid.hole[3];
  };
  for (Index j = 0; j < grid.rows; ++j) {
    for (Index i = 0; i < grid.columns; ++i) {
      const bool inside = i > 0 && j > 0 && i + 1 < grid.columns && j + 1 < grid.rows;
      const double dx = dice.between(-0.5, 0.5), dy = dice.between(-0.5, 0.5);
      const double x = cell * (i + (inside ? jitter * dx : 0)) - 1,
                   y = cell * (j + (inside ? jitter * dy : 0)) - 1;
      double z = 0;
      for (const Wave& w : waves) z += w.amplitude * std::sin(w.kx * x + w.ky * y + w.phase);
      grid.vertex_at.push_back(in_hole(i, j) ? kNone : grid.mesh.num_vertices());
      if (!in_hole(i, j)) grid.mesh.position.push_back({x, y, z});
    }
  }
  for (Index j = 0; j + 1 < grid.rows; ++j) {
    for (Index i = 0; i + 1 < grid.columns; ++i) {
      const bool left_out =
          grid.has_hole() && i >= grid.hole[0] && i < grid.hole[2] && j >= grid.hole[1] && j < grid.hole[3];
      grid.triangle_of_cell.push_back(left_out ? kNone : grid.mesh.num_triangles());
      if (left_out) continue;
      const Index a = grid.at(i, j), b = grid.at(i + 1, j), c = grid.at(i, j + 1), d = grid.at(i + 1, j + 1);
      auto& corner = grid.mesh.corner_vertex;
      if ((i + j) % 2 == 0) {
        corner.insert(corner.end(), {a, b, d, a, d, c});
      } else {
        corner.insert(corner.end(), {a, b, c, b, d, c});
      }
    }
  }
  return grid;
}

const Feature& ConstrainedCase::feature(const std::string& name) const {
  return *std::find_if(features.begin(), features.end(), [&](const Feature& f) { return f.name == name; });
}

ConstrainedCase feasible_case(const CaseSeeds& seeds) {
  Maker maker(seeds);
  maker.add_items(seeds.items);
  return maker.finish();
}

ConstrainedCase contradictory_case(const CaseSeeds& seeds, int kind, std::vector<std::string>& named) {
  Maker maker(seeds);
  Dice dice(seeds.mesh + 99);
  maker.contradict(kind, dice, named);
  maker.add_items(seeds.items);
  return maker.finish();
}

ConstrainedCase rigid_motion(const ConstrainedCase& c, std::uint64_t seed) {
  ConstrainedCase moved = c;
  moved.mesh = shapes::rigid_motion(c.mesh, seed);
  return moved;
}

ConstrainedCase relabelled(const ConstrainedCase& c, std::uint64_t seed, std::vector<Index>& new_of_old) {
  ConstrainedCase other = c;
  other.mesh = shapes::relabelled(c.mesh, seed, new_of_old);
  const auto rename = [&](Index& v) { v = new_of_old[v]; };
  // Triangles by their corners, the smallest first.
  const auto key = [](const Mesh& mesh, Index t, const std::vector<Index>* map) {
    std::array<Index, 3> v{};
    for (Index i = 0; i < 3; ++i)
      v[i] = map ? (*map)[mesh.corner_vertex[3 * t + i]] : mesh.corner_vertex[3 * t + i];
    std::sort(v.begin(), v.end());
    return v;
  };
  std::vector<std::pair<std::array<Index, 3>, Index>> triangle_at;
  for (Index t = 0; t < other.mesh.num_triangles(); ++t)
    triangle_at.emplace_back(key(other.mesh, t, nullptr), t);
  std::sort(triangle_at.begin(), triangle_at.end());
  for (Feature& feature : other.features) {
    for (Index& v : feature.vertex) rename(v);
    for (Index& t : feature.triangle)
      t = std::lower_bound(triangle_at.begin(), triangle_at.end(),
                           std::pair(key(c.mesh, t, &new_of_old), Index{0}))
              ->second;
    std::sort(feature.triangle.begin(), feature.triangle.end());
  }
  for (Constraint& constraint : other.set.constraints) {
    if (auto* pin = std::get_if<PinConstraint>(&constraint.rule)) {
      for (Index& v : pin->vertex) rename(v);
    } else if (auto* angle = std::get_if<AngleConstraint>(&constraint.rule)) {
      for (auto& edge : angle->edges) rename(edge[0]), rename(edge[1]);
    } else if (auto* direction = std::get_if<DirectionConstraint>(&constraint.rule)) {
      if (direction->edge) rename((*direction->edge)[0]), rename((*direction->edge)[1]);
    }
  }
  return other;
}

ConstrainedCase scaled(const ConstrainedCase& c, double factor) {
  ConstrainedCase other = c;
  other.mesh = shapes::scaled(c.mesh, factor);
  for (Constraint& constraint : other.set.constraints) {
    if (auto* pin = std::get_if<PinConstraint>(&constraint.rule)) {
      for (Vec2& z : pin->uv) z = factor * z;
    } else if (auto* circle = std::get_if<CircleConstraint>(&constraint.rule)) {
      if (circle->radius) *circle->radius *= factor;
    }
  }
  return other;
}

std::ostream& operator<<(std::ostream& os, const CaseSeeds& seeds) {
  os << "{.mesh = " << seeds.mesh << ", .triangles = " << seeds.triangles << ", .items = {";
  for (std::size_t k = 0; k < seeds.items.size(); ++k) os << (k ? ", " : "") << seeds.items[k];
  return os << "}}";
}

std::ostream& operator<<(std::ostream& os, const ConstrainedCase& c) {
  os << c.mesh.num_vertices() << " vertices, " << c.mesh.num_triangles() << " triangles;";
  for (const Constraint& constraint : c.set.constraints) os << " [" << constraint.name << "]";
  return os;
}

}  // namespace planish
