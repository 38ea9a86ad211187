#include "engine/features/parted.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr Index kN = 9;

Feature chain(const std::string& name, std::vector<Index> vertex, bool closed = false) {
  return {.name = name, .vertex = std::move(vertex), .closed = closed};
}

ConstraintSet curves(const std::vector<std::string>& names) {
  ConstraintSet set;
  for (const std::string& name : names)
    set.constraints.push_back(named("curve " + name, CurveConstraint{.feature = name}));
  return set;
}

struct Opened {
  Mesh mesh = shapes::height_field(kN, shapes::flat);
  std::vector<Feature> features;
  Cut cut;

  Opened(std::vector<Feature> all, const std::vector<std::string>& seams) : features(std::move(all)) {
    auto opened = planish::cut(mesh.surface(), features, seams, {.threads = 1});
    REQUIRE(opened);
    cut = std::move(*opened);
  }
  Result<std::vector<Feature>> parted(const ConstraintSet& set) const {
    return features_on_cut(Exec(1), mesh.surface(), cut, features, set);
  }
  bool has_half_edge(Index u, Index v) const {
    for (Index c = 0; c < static_cast<Index>(cut.corner_vertex.size()); ++c) {
      if (cut.corner_vertex[c] == u && cut.corner_vertex[next_corner(c)] == v) return true;
    }
    return false;
  }
  std::vector<Index> origin(std::vector<Index> vertex) const {
    for (Index& v : vertex) v = cut.vertex_origin[v];
    return vertex;
  }
};

}  // namespace

TEST_CASE("features on a cut: a seam's two copies run as it does, the left one along triangles on the left") {
  // From the rim to the middle, and closed: once around.
  for (const Feature& seam :
       {chain("seam", grid_path(kN, 0, 4, 5, 4)), chain("seam", grid_loop(kN, 2, 2, 6, 6), true)}) {
    const Opened opened({seam}, {"seam"});
    const auto parted = opened.parted(curves({"seam"}));
    REQUIRE(parted);
    REQUIRE(parted->size() == 2);
    for (const int side : {1, 2}) {
      const Feature& copy = (*parted)[static_cast<std::size_t>(side) - 1];
      CHECK(copy.side == side);
      CHECK(copy.name == "seam");
      CHECK(copy.closed == seam.closed);
      CHECK(opened.origin(copy.vertex) == seam.vertex);
      for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < copy.vertex.size(); ++i) {
        const Index u = copy.vertex[i], v = copy.vertex[(i + 1) % copy.vertex.size()];
        CHECK(opened.has_half_edge(u, v) == (side == 1));
        CHECK(opened.has_half_edge(v, u) == (side == 2));
      }
    }
    // Copies differ but where the seam ends inside the surface.
    const auto& left = (*parted)[0].vertex;
    const auto& right = (*parted)[1].vertex;
    for (std::size_t i = 0; i < left.size(); ++i)
      CHECK((left[i] == right[i]) == (!seam.closed && i + 1 == left.size()));
  }
}

TEST_CASE("features on a cut: a chain that the seam leaves alone, or ends at, stays one") {
  const Opened opened(
      {chain("seam", grid_path(kN, 0, 4, 4, 4)), chain("beside", grid_path(kN, 1, 6, 7, 6)),
       chain("across its end", grid_path(kN, 4, 2, 4, 6)), chain("on", grid_path(kN, 4, 4, 7, 4))},
      {"seam"});
  const auto parted = opened.parted(curves({"beside", "across its end", "on"}));
  REQUIRE(parted);
  REQUIRE(parted->size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK((*parted)[k].side == 0);
    CHECK((*parted)[k].vertex == opened.features[k + 1].vertex);
  }
}

TEST_CASE(
    "features on a cut: a chain that a seam crosses is refused with the vertex, inside and on the rim") {
  const Index crossing = 4 * kN + 3, end = 4 * kN;
  for (const auto& [other, vertex] : {std::pair(chain("other", grid_path(kN, 3, 2, 3, 6)), crossing),
                                      {chain("other", grid_path(kN, 0, 1, 0, 7)), end},
                                      {chain("other", grid_loop(kN, 3, 1, 6, 6), true), crossing}}) {
    const Opened opened({chain("seam", grid_path(kN, 0, 4, 5, 4)), other}, {"seam"});
    const auto refused = opened.parted(curves({"other"}));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::ConstraintInvalid);
    CHECK(refused.error().what.find("\"other\"") != std::string::npos);
    CHECK(refused.error().ids == std::vector<Index>{vertex});
    CHECK(opened.parted(curves({"seam"})));  // nothing is asked of the other one: no refusal
  }
}

TEST_CASE("features on a cut: only features that constraints or the outer loop name are carried over") {
  const Feature patch{.name = "patch", .triangle = {0, 1, 2}};
  const Opened opened({chain("seam", grid_path(kN, 0, 4, 5, 4)), chain("a", grid_path(kN, 1, 6, 7, 6)),
                       chain("b", grid_path(kN, 1, 7, 7, 7)), chain("rim", grid_path(kN, 0, 0, 8, 0)), patch},
                      {"seam"});
  ConstraintSet set;
  set.outer = "rim";
  set.constraints = {named("p", RegionConstraint{.feature = "patch"}),
                     named("q", AngleConstraint{.features = {"a", "rim"}, .edges = {}, .measure = {}})};
  const auto parted = opened.parted(set);
  REQUIRE(parted);
  std::set<std::string> names;
  for (const Feature& f : *parted) names.insert(f.name);
  CHECK(names == std::set<std::string>{"a", "rim", "patch"});
  CHECK(parted->back().triangle == patch.triangle);
}
