// Overlaps removed by the program: what becomes of maps that fold over themselves.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

using namespace planish::tests;
using nlohmann::json;

namespace {

/// A ramp that winds by more than one turn around an axis: in the plane its ends come to lie on one another.
std::string ramp_obj(double degrees) {
  constexpr int kLong = 90, kAcross = 3;
  std::string text;
  for (int i = 0; i <= kLong; ++i) {
    const double turn = degrees * i / kLong * 3.14159265358979 / 180;
    for (int j = 0; j <= kAcross; ++j) {
      const double radius = 1 + 0.1 * j;
      text += "v " + std::to_string(radius * std::cos(turn)) + " " + std::to_string(radius * std::sin(turn)) +
              " " + std::to_string(0.05 * turn) + "\n";
    }
  }
  constexpr int kRow = kAcross + 1;
  for (int i = 0; i < kLong; ++i) {
    for (int j = 1; j <= kAcross; ++j) {
      const int a = i * kRow + j, b = a + kRow;
      const auto face = [&](int u, int v, int w) {
        text += "f " + std::to_string(u) + " " + std::to_string(v) + " " + std::to_string(w) + "\n";
      };
      face(a, a + 1, b + 1);
      face(a, b + 1, b);
    }
  }
  return text;
}

struct Ramp {
  Scratch scratch;
  explicit Ramp(double degrees = 400) { write(scratch.file("ramp.obj"), ramp_obj(degrees)); }
  Ran flatten(const std::string& options) const {
    return run("flatten " + scratch.file("ramp.obj") + " -o " + scratch.file("o.ply") + " --report " +
               scratch.file("r.json") + " " + options);
  }
  json report() const { return json::parse(content_of(scratch.file("r.json"))); }
};

}  // namespace

TEST_CASE(
    "overlaps: a ramp's ends lie on one another where that is only reported, and beside one another else") {
  const Ramp ramp;
  REQUIRE(ramp.flatten("--overlaps report").code == 0);
  const json with = ramp.report();
  CHECK(with.at("overlapping_pairs").get<int>() > 0);
  CHECK(with.at("overlaps") == json({{"method", "report"}}));
  CHECK(run("verify " + ramp.scratch.file("o.ply")).code == 6);
  REQUIRE(ramp.flatten("--overlaps remove").code == 0);
  const json without = ramp.report();
  CHECK(without.at("overlapping_pairs") == 0);
  CHECK(without.at("flipped_triangles") == 0);
  CHECK(without.at("converged") == true);
  CHECK(without.at("overlaps").at("pairs_before") == with.at("overlapping_pairs"));
  CHECK(without.at("overlaps").at("energy").get<double>() >= without.at("energy").at("arap").get<double>());
  CHECK(without.at("energy").at("arap").get<double>() > with.at("energy").at("arap").get<double>());
  CHECK(run("verify " + ramp.scratch.file("o.ply")).code == 0);
}

TEST_CASE("overlaps: where there are none nothing is done about them") {
  const Ramp ramp(300);
  REQUIRE(ramp.flatten("--overlaps report").code == 0);
  const std::string reported = content_of(ramp.scratch.file("o.ply"));
  REQUIRE(ramp.flatten("--overlaps remove").code == 0);
  CHECK(content_of(ramp.scratch.file("o.ply")) == reported);
  CHECK(ramp.report().at("overlaps") == json({{"method", "remove"}, {"pairs_before", 0}}));
}

TEST_CASE("overlaps: the same bits on one thread and on several") {
  const Ramp ramp;
  for (const char* energy : {"arap", "symmetric-dirichlet"}) {
    const std::string options = std::string("--overlaps remove --energy ") + energy;
    REQUIRE(ramp.flatten(options + " --threads 1").code == 0);
    const std::string once = content_of(ramp.scratch.file("o.ply"));
    for (const char* threads : {" --threads 2", " --threads 7"}) {
      REQUIRE(ramp.flatten(options + threads).code == 0);
      CHECK(content_of(ramp.scratch.file("o.ply")) == once);
    }
  }
}

TEST_CASE("overlaps: they are not removed from maps with flips") {
  const Ramp ramp;
  for (const char* options : {"--flips keep", "--flips weights", "--flips stiffening", "--paper"}) {
    const Ran ran = ramp.flatten(std::string("--overlaps remove ") + options);
    CHECK(ran.code == 2);
    CHECK(ran.err.find("untangled") != std::string::npos);
  }
}
