// Other methods than ARAP through the program: what they take, what they refuse, and how compare sets them side by side.
#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

struct Files {
  Files(const std::string& mesh, const std::string& constraints) {
    write(in, mesh);
    write(c, file_of(kFeatures, constraints, ""));
  }
  Ran flatten(const std::string& options) const {
    return run("flatten " + in + " -c " + c + " -o " + o + " --report " + r + " " + options);
  }
  Ran compare(const std::string& options) const {
    return run("compare " + in + " -c " + c + " -o " + d + " " + options);
  }
  json report() const { return json::parse(content_of(r)); }
  json row(const std::string& method) const {
    const json rows = json::parse(content_of(d + "/compare.json")).at("rows");
    for (const json& row : rows) {
      if (row.at("method") == method) return row;
    }
    FAIL("no row of " << method);
    return {};
  }

  Scratch scratch;
  std::string in = scratch.file("in.obj"), c = scratch.file("c.json"), o = scratch.file("o.obj"),
              r = scratch.file("r.json"), d = scratch.file("d");
};

constexpr const char* kFreeSizes = R"(
  {"type": "line", "feature": "row", "lengths": "scale"}, {"type": "line", "feature": "up", "lengths": "free"},
  {"type": "circle", "feature": "ring"}, {"type": "angle", "features": ["row", "up"], "degrees": 80},
  {"type": "curve", "feature": "north", "scale": "free"})";

double worst_share(const json& report) {
  double worst = 0;
  for (const json& c : report.at("constraints"))
    worst = std::max(worst, c.at("residual").get<double>() / (c.contains("degrees") ? 1e-7 : 1e-9));
  return worst;
}

}  // namespace

TEST_CASE(
    "methods: conformal maps meet lines, circles, curves and angles, as a check that knows nothing of "
    "planish finds") {
  for (const std::string method : {"lscm", "dncp", "spectral"}) {
    CAPTURE(method);
    const Files files(dome(), kFreeSizes);
    const Ran ran = files.flatten("--method " + method);
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const json report = files.report();
    CHECK(report.at("method") == method);
    CHECK_FALSE(report.contains("up_to_scale"));
    CHECK(worst_share(report) < 1);
    const Ran check = checked(files.c, files.o, files.r);
    CHECK_MESSAGE(check.code == 0, check.out);
    const Ran own = verified(files.c, files.o, files.r);
    CHECK_MESSAGE(own.code == 0, own.out);
    CHECK(!schema_fault("report.schema.json", files.r).starts_with("invalid"));
  }
}

TEST_CASE("methods: regions keep their shapes exactly up to a factor, and what lets go of sizes says so") {
  for (const std::string method : {"lscm", "spectral"}) {
    const Files files(
        dome(),
        R"({"name": "kept", "type": "region", "feature": "patch"}, {"type": "line", "feature": "south"})");
    const Ran ran = files.flatten("--method " + method);
    REQUIRE(ran.code == 0);
    CHECK(has(ran.err, "those of 2 constraints are free (\"kept\", \"line south\")"));
    const json report = files.report();
    CHECK(report.at("up_to_scale") == json({"kept", "line south"}));
    CHECK(worst_share(report) < 1);
    CHECK(!schema_fault("report.schema.json", files.r).starts_with("invalid"));
  }
}

TEST_CASE("methods: directions and pins hold in conformal maps") {
  const Files directed(
      dome(), R"({"type": "line", "feature": "row"}, {"type": "direction", "feature": "row", "degrees": 30},
                                  {"type": "line", "feature": "up", "lengths": "scale"}, {"type": "perpendicular", "features": ["row", "up"]})");
  for (const std::string method : {"lscm", "spectral"}) {
    REQUIRE(directed.flatten("--method " + method).code == 0);
    CHECK(worst_share(directed.report()) < 1);
  }
  const Files pinned(dome(), R"({"type": "pin", "vertices": [0, 48, 20], "uv": [[0, 0], [7, 7], [6, 2]]},
                                {"type": "line", "feature": "up"})");
  REQUIRE(pinned.flatten("--method lscm").code == 0);
  CHECK(worst_share(pinned.report()) < 1);
  const auto image = images(pinned.o);
  CHECK(std::abs(image[48] - std::complex<double>(7, 7)) < 1e-12);
}

TEST_CASE("methods: deform meets the constraints from the map without them") {
  const Files files(dome(), R"({"type": "line", "feature": "row"}, {"type": "curve", "feature": "north"})");
  const Ran ran = files.flatten("--method deform");
  REQUIRE_MESSAGE(ran.code == 0, ran.err);
  CHECK(files.report().at("method") == "deform");
  CHECK(worst_share(files.report()) < 1);
  const Ran own = verified(files.c, files.o, files.r);
  CHECK_MESSAGE(own.code == 0, own.out);
}

TEST_CASE("methods: a constraint that a method cannot express is refused by flatten, and a row of compare") {
  const Files files(
      dome(),
      R"({"name": "wheel", "type": "circle", "feature": "ring", "radius": 2}, {"type": "line", "feature": "south"})");
  const Ran ran = files.flatten("--method lscm");
  CHECK(ran.code == 5);
  CHECK(has(ran.err, "c.json: /constraints/0: method lscm cannot express \"wheel\""));
  CHECK(has(ran.err, "[constraint-unsupported]"));
  CHECK_FALSE(std::filesystem::exists(files.o));
  REQUIRE(files.compare("--methods lscm,arap").code == 0);
  CHECK(files.row("lscm").at("supported") == false);
  CHECK(has(files.row("lscm").at("reason"), "\"wheel\""));
  CHECK(files.row("lscm").at("arap").is_null());
  CHECK(files.row("arap").at("supported") == true);
  CHECK(files.row("arap").at("reason") == "");
  CHECK(!schema_fault("compare.schema.json", files.d + "/compare.json").starts_with("invalid"));
  CHECK_FALSE(std::filesystem::exists(files.d + "/lscm.ply"));

  const Files pinned(dome(), R"({"name": "here", "type": "pin", "vertices": [0], "uv": [[0, 0]]})");
  const Ran spectral = pinned.flatten("--method spectral");
  CHECK(spectral.code == 5);
  CHECK(has(spectral.err, "an eigenvector is known up to a factor"));
}

TEST_CASE("methods: constraints that leave nothing to choose are an error that says so") {
  // The whole surface keeps its shape, and is not turned.
  std::string all = "0";
  for (int t = 1; t < 72; ++t) all += ", " + std::to_string(t);
  Files files(grid(6, 0, [](double x, double y) { return Point{x, y, 0}; }), "");
  write(
      files.c,
      R"({"version": 1, "features": {"all": {"triangles": [)" + all +
          R"(]}}, "constraints": [{"type": "region", "feature": "all"}, {"type": "direction", "edge": [0, 1], "degrees": 0}]})");
  const Ran ran = files.flatten("--method spectral");
  CHECK(ran.code == 4);
  CHECK_MESSAGE(has(ran.err, "fewer than two unknowns"), ran.err);
  CHECK_FALSE(std::filesystem::exists(files.o));
}

TEST_CASE(
    "methods: options of ARAP are refused beside another method, even where they ask for what is the "
    "default") {
  const Files files(dome(), R"({"type": "line", "feature": "south"})");
  for (const std::string option : {"--flips untangle", "--energy arap", "--overlaps report", "--init uniform",
                                   "--tolerance 1e-6", "--max-iterations 500", "--paper", "--price"}) {
    CAPTURE(option);
    const Ran ran = files.flatten("--method spectral " + option);
    CHECK(ran.code == 2);
    CHECK(has(ran.err, option.substr(0, option.find(' ')) + " has no meaning with --method spectral"));
  }
  CHECK(files.flatten("--method deform --paper").code == 2);
  CHECK(has(files.flatten("--method deform --memory-limit 1G").err, "has no limit of memory"));
  CHECK(files.flatten("--method spectral --memory-limit 1G").code == 0);
  CHECK(files.flatten("--method deform --flips untangle --tolerance 1e-5").code == 0);
  const Ran unknown = files.flatten("--method angles");
  CHECK(unknown.code == 2);
}

TEST_CASE("compare: every method has its map, its picture and its row, and one sheet has them all") {
  const Files files(dome(), kFreeSizes);
  const Ran ran = files.compare("");
  REQUIRE_MESSAGE(ran.code == 0, ran.err);
  const std::vector<std::string> methods = {"unconstrained", "arap", "lscm", "dncp", "spectral", "deform"};
  for (const std::string& method : methods) {
    CAPTURE(method);
    const json row = files.row(method);
    CHECK(row.at("supported") == true);
    CHECK(row.at("reason") == "");
    CHECK(row.at("flipped_triangles") == 0);
    CHECK(row.at("seconds") > 0);
    CHECK(has(ran.out, method));
    CHECK(content_of(files.d + "/" + method + ".png").starts_with("\x89PNG"));
    // The numbers are those of the map that was written.
    const Ran own = run("verify " + files.d + "/" + method + ".ply --json");
    CHECK(json::parse(own.out).at("energy").at("arap").get<double>() ==
          doctest::Approx(row.at("arap").get<double>()).epsilon(1e-9));
  }
  CHECK(!schema_fault("compare.schema.json", files.d + "/compare.json").starts_with("invalid"));
  CHECK(content_of(files.d + "/compare.png").starts_with("\x89PNG"));
  const std::string table = content_of(files.d + "/compare.md");
  for (const std::string& method : methods) CHECK(has(table, "| " + method + " |"));
  CHECK(files.row("arap").at("arap") < files.row("lscm").at("arap"));
  CHECK(files.row("lscm").at("benchmark").at("average_angle_error") <
        files.row("arap").at("benchmark").at("average_angle_error"));
  CHECK(files.row("lscm").at("conformal") < files.row("arap").at("conformal"));
}

TEST_CASE("compare: ARAP without the constraints is a row of its own, at no more energy than with them") {
  const Files files(dome(), R"({"type": "line", "feature": "south"}, {"type": "circle", "feature": "ring"})");
  const Ran ran = files.compare("--methods unconstrained,arap,unconstrained");
  REQUIRE_MESSAGE(ran.code == 0, ran.err);
  CHECK(json::parse(content_of(files.d + "/compare.json")).at("rows").size() == 2);
  const json free = files.row("unconstrained"), arap = files.row("arap");
  CHECK(free.at("worst_residual").is_null());
  CHECK(arap.at("worst_residual") < 1e-9);
  CHECK(free.at("arap") < arap.at("arap"));
  CHECK(!schema_fault("compare.schema.json", files.d + "/compare.json").starts_with("invalid"));
  CHECK(has(content_of(files.d + "/compare.md"), "| unconstrained | none |"));
  CHECK(content_of(files.d + "/unconstrained.png").starts_with("\x89PNG"));
  // It is the map that flatten makes without a constraint file.
  REQUIRE(run("flatten " + files.in + " -o " + files.scratch.file("free.ply")).code == 0);
  const Ran own = run("verify " + files.scratch.file("free.ply") + " --json");
  CHECK(json::parse(own.out).at("energy").at("arap").get<double>() ==
        doctest::Approx(free.at("arap").get<double>()).epsilon(1e-6));
}

TEST_CASE("compare: a method that takes longer than it may has a row that says so, and no map") {
  const Files files(dome(), R"({"type": "line", "feature": "south"})");
  CHECK(files.compare("--methods arap,lscm --time-limit 1e-9").code == 6);
  for (const std::string method : {"arap", "lscm"}) {
    const json row = files.row(method);
    CHECK(row.at("supported") == true);
    CHECK(has(row.at("reason"), "stopped after"));
    CHECK(row.at("arap").is_null());
    CHECK_FALSE(std::filesystem::exists(files.d + "/" + method + ".ply"));
  }
  CHECK(files.compare("--methods arap,lscm --time-limit 1e9").code == 0);
  CHECK(files.row("lscm").at("reason") == "");
  CHECK(files.compare("--methods lscm --time-limit 0").code == 2);
}

TEST_CASE("compare: without a constraint file there is nothing to leave out") {
  const Files files(dome(), "");
  const Ran ran = run("compare " + files.in + " -o " + files.d + " --methods unconstrained,arap");
  CHECK(ran.code == 2);
  CHECK(has(ran.err, "ask for arap in place of unconstrained"));
}

TEST_CASE(
    "compare: without constraints there is no residual, and the methods asked for come once, in their "
    "order") {
  const Files files(dome(), "");
  REQUIRE(run("compare " + files.in + " -o " + files.d + " --methods spectral,arap,spectral").code == 0);
  const json all = json::parse(content_of(files.d + "/compare.json"));
  REQUIRE(all.at("rows").size() == 2);
  CHECK(all.at("rows")[0].at("method") == "spectral");
  CHECK(all.at("rows")[1].at("method") == "arap");
  CHECK(all.at("rows")[0].at("worst_residual").is_null());
  CHECK(all.at("constraint_file").is_null());
}

TEST_CASE("compare: what no method can work on is an error") {
  const Files files(dome(), R"({"type": "line", "feature": "nowhere"})");
  CHECK(files.compare("").code == 3);
  CHECK(run("compare " + files.in + " -o " + files.d + " --methods arap,angles").code == 2);
  CHECK(run("compare " + files.in + " -o " + files.in + "/below").code == 7);
  CHECK(run("compare " + files.scratch.file("none.obj") + " -o " + files.d).code == 3);
  CHECK(run("compare " + files.in).code == 2);
}
