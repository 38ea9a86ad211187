// Bodies, relations and pins given by hand, each of a constraint of its own.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "engine/constraints/agreement.hpp"
#include "engine/constraints/poses.hpp"

namespace planish::tests {

/// Constraint k is called "ck".
struct Bodies {
  Compiled compiled;
  ConstraintSet set;
  OrderedMesh mesh;  ///< unit 1

  Index add(Body::Kind kind, std::vector<Index> vertex, std::vector<Vec2> shape) {
    Body body{.kind = kind, .constraint = next_constraint(), .feature = 0, .vertex = std::move(vertex)};
    body.shape = std::move(shape);
    for (std::size_t i = 1; i < body.shape.size(); ++i) body.size += norm(body.shape[i] - body.shape[i - 1]);
    compiled.bodies.push_back(std::move(body));
    return static_cast<Index>(compiled.bodies.size()) - 1;
  }
  /// A straight one with these lengths, its mean at the origin.
  Index add_line(std::vector<Index> vertex, In<double> length, Body::Kind kind = Body::Kind::Line) {
    std::vector<Vec2> shape = {Vec2{}};
    for (const double l : length) shape.push_back(shape.back() + Vec2{l, 0});
    Vec2 sum{};
    for (const Vec2 t : shape) sum += t;
    for (Vec2& t : shape) t = t - (1.0 / static_cast<double>(shape.size())) * sum;
    return add(kind, std::move(vertex), std::move(shape));
  }
  void pin(Index vertex, Vec2 uv) { compiled.pins.push_back({next_constraint(), vertex, uv}); }
  /// a, b: kNone for the u axis.
  Index relate(Index a, Index b, double degrees, bool oriented = false) {
    compiled.relations.push_back(
        {.constraint = next_constraint(), .a = a, .b = b, .degrees = degrees, .oriented = oriented});
    return compiled.relations.back().constraint;
  }

  ConstraintView view() const { return {&set, {}, {}}; }
  Result<Agreement> agree() const { return planish::agree(compiled, view(), mesh); }

 private:
  Index next_constraint() {
    const auto number = static_cast<Index>(set.constraints.size());
    Constraint constraint;
    constraint.name = "c";
    constraint.name += std::to_string(number);
    set.constraints.push_back(std::move(constraint));
    return number;
  }
};

}  // namespace planish::tests
