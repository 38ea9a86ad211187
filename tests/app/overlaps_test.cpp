// Overlaps removed by the program: what becomes of maps that fold over themselves.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

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

/// A flat sheet of 40 x 20 squares with two tabs at its lower edge, one bent up, one down, that lean towards one another: in the
/// plane their tips come to lie on one another.
std::string tabs_obj() {
  constexpr int kWide = 40, kHigh = 20, kDeep = 3;
  std::ostringstream vertices, faces;
  const auto square = [&](int a, int b, int c, int d) {
    faces << "f " << a << ' ' << b << ' ' << c << "\nf " << a << ' ' << c << ' ' << d << '\n';
  };
  for (int j = 0; j <= kHigh; ++j) {
    for (int i = 0; i <= kWide; ++i) vertices << vertex_line({double(i), double(j), 0});
  }
  constexpr int kRow = kWide + 1;
  for (int j = 0; j < kHigh; ++j) {
    for (int i = 1; i <= kWide; ++i)
      square(j * kRow + i, j * kRow + i + 1, (j + 1) * kRow + i + 1, (j + 1) * kRow + i);
  }
  int next = kRow * (kHigh + 1) + 1;
  for (const int side : {1, -1}) {
    const int first = side > 0 ? 18 : 21;  // of three on the edge
    int above = first;
    for (int k = 1; k <= kDeep; ++k, next += 3) {
      for (int i = 0; i < 3; ++i)
        vertices << vertex_line({first - 1 + i + side * 0.4 * k, -0.02 * k, double(side * k)});
      for (int i = 0; i < 2; ++i) square(next + i, next + i + 1, above + i + 1, above + i);
      above = next;
    }
  }
  return vertices.str() + faces.str();
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

TEST_CASE("overlaps: where nothing is said they are removed from untangled maps, and reported of others") {
  const Ramp ramp;
  REQUIRE(ramp.flatten("").code == 0);
  CHECK(ramp.report().at("overlaps").at("method") == "remove");
  CHECK(ramp.report().at("overlapping_pairs") == 0);
  for (const char* options : {"--flips keep", "--flips weights", "--paper", "--method lscm"}) {
    ramp.flatten(options);
    CHECK(ramp.report().at("overlaps").at("method") == "report");
  }
}

TEST_CASE(
    "overlaps: where memory is too short for their removal that is an error, where there are none it is "
    "not") {
  constexpr const char* kLimit = " --memory-limit 16400000";  // between local/global and Newton steps
  const Ramp ramp;
  const Ran ran = ramp.flatten(kLimit);
  CHECK(ran.code == 4);
  CHECK_MESSAGE(has(ran.err, "Newton steps that remove overlaps need more memory than the limit"), ran.err);
  CHECK(ramp.flatten(std::string("--overlaps report") + kLimit).code == 0);
  CHECK(Ramp(300).flatten(kLimit).code == 0);
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

TEST_CASE("overlaps: a ramp whose ends are to lie at an angle is kept apart, and the angle holds") {
  const Ramp ramp;
  const std::string constraints = ramp.scratch.file("c.json");
  for (const char* degrees : {"5", "20"}) {
    write(constraints, std::string(R"({"version": 1,
    "features": {"first": {"vertices": [0, 1, 2, 3]}, "last": {"vertices": [360, 361, 362, 363]}},
    "constraints": [{"type": "line", "feature": "first"}, {"type": "line", "feature": "last"},
                    {"type": "angle", "features": ["first", "last"], "degrees": )") +
                           degrees + "}]}");
    REQUIRE(ramp.flatten("-c " + constraints + " --overlaps report").code == 0);
    CHECK(ramp.report().at("overlapping_pairs").get<int>() > 0);
    const Ran ran = ramp.flatten("-c " + constraints + " --overlaps remove");
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const json report = ramp.report();
    CHECK(report.at("overlapping_pairs") == 0);
    CHECK(report.at("overlaps").at("start") == "unconstrained");
    CHECK(report.at("converged") == true);
    const Ran check = checked(constraints, ramp.scratch.file("o.ply"), ramp.scratch.file("r.json"));
    CHECK_MESSAGE(check.code == 0, check.out);
    CHECK(verified(constraints, ramp.scratch.file("o.ply"), ramp.scratch.file("r.json")).code == 0);
  }
}

TEST_CASE("overlaps: where a few lie in one place the map begins from there, what is far away hardly moves") {
  const Scratch scratch;
  write(scratch.file("tabs.obj"), tabs_obj());
  const auto flatten = [&](const std::string& options) {
    REQUIRE(run("flatten " + scratch.file("tabs.obj") + " -o " + scratch.file("o.ply") + " --report " +
                scratch.file("r.json") + options)
                .code == 0);
    return json::parse(content_of(scratch.file("r.json")));
  };
  CHECK(flatten(" --overlaps report").at("overlapping_pairs") > 0);
  const json report = flatten("");
  CHECK(report.at("overlaps").at("start") == "straightened");
  CHECK(report.at("overlapping_pairs") == 0);
  CHECK(report.at("flipped_triangles") == 0);
  CHECK(report.at("converged") == true);
  CHECK(report.at("stretch").at("sigma_max").at("p50").get<double>() == doctest::Approx(1).epsilon(1e-3));
  CHECK(run("verify " + scratch.file("o.ply")).code == 0);
}

TEST_CASE("overlaps: energies fall from the map that the removal begins at to the one it ends at") {
  const Ramp ramp;
  REQUIRE(ramp.flatten("--overlaps remove").code == 0);
  const json report = ramp.report();
  double before = 0;
  int steps = 0;
  for (const json& step : report.at("history")) {
    if (step.at("phase") != "separate") continue;
    const double now = step.at("energy").get<double>();
    if (steps++ > 0) CHECK(now <= before * (1 + 1e-12));
    before = now;
  }
  CHECK(steps > 2);
}

TEST_CASE("overlaps: where pins ask for them the map stays, and it is said") {
  // The ends are pinned across one another: no map that meets the pins is free of overlaps.
  const Ramp ramp;
  const std::string constraints = ramp.scratch.file("c.json");
  write(constraints, R"({"version": 1, "features": {},
    "constraints": [{"type": "pin", "vertices": [0, 1, 2, 3], "uv": [[1, 0], [1.1, 0], [1.2, 0], [1.3, 0]]},
                    {"type": "pin", "vertices": [360, 361, 362, 363],
                     "uv": [[1.15, -0.15], [1.15, -0.05], [1.15, 0.05], [1.15, 0.15]]}]})");
  REQUIRE(ramp.flatten("-c " + constraints + " --overlaps report").code == 0);
  const std::string reported = content_of(ramp.scratch.file("o.ply"));
  const Ran ran = ramp.flatten("-c " + constraints + " --overlaps remove");
  CHECK(ran.code == 6);
  CHECK(has(ran.err, "pairs of triangles lie on one another in the map ("));
  CHECK(has(ran.err,
            "there are none without \"pin 0 1 2 and 1 more\", or without \"pin 360 361 362 and 1 more\""));
  CHECK_FALSE(ramp.report().at("overlapping_ids").empty());
  CHECK(content_of(ramp.scratch.file("o.ply")) == reported);
  CHECK(ramp.report().at("overlaps").at("start") == "none");
}

TEST_CASE("overlaps: deform takes them apart, whether the given map has them or not") {
  const Ramp ramp;
  const std::string constraints = ramp.scratch.file("c.json");
  write(constraints, R"({"version": 1,
    "features": {"first": {"vertices": [0, 1, 2, 3]}, "last": {"vertices": [360, 361, 362, 363]}},
    "constraints": [{"type": "line", "feature": "first"}, {"type": "line", "feature": "last"},
                    {"type": "angle", "features": ["first", "last"], "degrees": 5}]})");
  const auto deform = [&](const std::string& options) {
    const Ran ran =
        run("deform " + ramp.scratch.file("given.ply") + " -c " + constraints + " -o " +
            ramp.scratch.file("o.ply") + " --report " + ramp.scratch.file("r.json") + " " + options);
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const Ran check = checked(constraints, ramp.scratch.file("o.ply"), ramp.scratch.file("r.json"));
    CHECK_MESSAGE(check.code == 0, check.out);
    return ramp.report();
  };
  for (const std::string given : {"report", "remove"}) {
    REQUIRE(ramp.flatten("--overlaps " + given).code == 0);
    std::filesystem::copy_file(ramp.scratch.file("o.ply"), ramp.scratch.file("given.ply"),
                               std::filesystem::copy_options::overwrite_existing);
    const json with = deform("--poses free"), without = deform("--poses free --overlaps remove");
    CHECK(with.at("overlapping_pairs").get<int>() > 0);
    CHECK(without.at("overlapping_pairs") == 0);
    CHECK(without.at("flipped_triangles") == 0);
    CHECK(without.at("overlaps").at("pairs_before") == with.at("overlapping_pairs"));
    CHECK(without.at("deformation").at("release") == (given == "report" ? "map" : "none"));
    CHECK(verified(constraints, ramp.scratch.file("o.ply"), ramp.scratch.file("r.json")).code == 0);
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
