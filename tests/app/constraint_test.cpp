// Constraints through the program: contradictions are named, options do what they say, and what is written is judged by
// a check that knows nothing of planish.
#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

// ---- contradictions ----

enum class On { Dome, Wedge, Pipe, DomeWithoutFeatures };

struct Bad {
  std::string constraints;
  const char* pointer;
  std::vector<const char*> message;  // parts of it: names, what differs, by how much
  On on = On::Dome;
  const char* code = "constraints-conflict";
  const char* more = "";
  int exit_code = 5;
};

const char* const kInvalid = "constraint-invalid";

const std::vector<Bad> kContradictions = {
    {lines({"row"}) + R"(, {"type": "circle", "feature": "row", "sweep_degrees": 90})",
     "/constraints/0",
     {R"(constraints "line row" and "circle row" cannot all hold)",
      "on the 7 vertices that they share their shapes differ by 0.67", "agreement allows 0.001"}},
    {lines({"bent"}) + R"(, {"type": "curve", "feature": "bent"})",
     "/constraints/0",
     {R"("line bent" and "curve bent")", "their shapes differ by"}},
    {R"({"type": "circle", "feature": "ring"}, {"type": "curve", "feature": "ring"})",
     "/constraints/0",
     {R"("circle ring" and "curve ring")", "on the 8 vertices that they share"}},
    {R"({"type": "circle", "feature": "ring", "name": "one", "scale": 1}, {"type": "circle", "feature": "ring", "name": "two", "scale": 2})",
     "/constraints/0",
     {R"(constraints "one" and "two" cannot all hold)"}},
    {lines({"low", "row"}) +
         R"(, {"type": "parallel", "features": ["low", "row"]}, {"type": "perpendicular", "features": ["low", "row"]})",
     "/constraints/2",
     {R"(constraints "parallel low row" and "perpendicular low row" cannot all hold)",
      "miss one another by 90 degrees"}},
    {R"({"type": "direction", "feature": "low", "degrees": 10}, {"type": "direction", "feature": "row", "degrees": 25},
        {"type": "angle", "features": ["low", "row"], "degrees": 16})",
     "/constraints/0",
     {R"("direction low", "direction row" and "angle low row")", "by 1 degrees"}},
    {lines({"a", "b", "c"}, kScaled) +
         R"(, {"type": "angle", "features": ["a", "b"], "degrees": 90}, {"type": "angle", "features": ["b", "c"], "degrees": 50},
            {"type": "angle", "features": ["c", "a"], "degrees": 45})",
     "/constraints/3",
     {R"("angle a b", "angle b c" and "angle c a")", "their angles do not add up", "by 5 degrees"}},
    {lines(kSideList) + ", " + right_angles(kSides),
     "/constraints/0",
     {R"("line south", "line east", "line north", "line west")", "where they meet a gap of "},
     On::Wedge},
    {lines(kSideList, R"(, "lengths": "scale", "scale_group": "g")") + ", " + right_angles(kSides),
     "/constraints/0",
     {R"("line south", "line east", "line north", "line west")", "no size above 0.001"},
     On::Wedge},
    {lines({"row"}) + R"(, {"type": "pin", "vertices": [28, 34], "uv": [[0, 0], [5, 0]]})",
     "/constraints/0",
     {R"(constraints "line row" and "pin 28 34" cannot all hold)", "misses its 2 pins by 0.5"}},
    {lines({"row"}, kScaled) +
         R"(, {"type": "pin", "vertices": [28, 31, 34], "uv": [[0, 0], [1, 0], [5, 0]]})",
     "/constraints/0",
     {R"("line row" and "pin 28 31 34")", "misses its 3 pins by 1"}},
    {lines({"row"}, kScaled) +
         R"(, {"type": "direction", "feature": "row", "degrees": 30}, {"type": "pin", "vertices": [28, 34], "uv": [[0, 0], [5, 0]]})",
     "/constraints/0",
     {R"("line row", "direction row" and "pin 28 34")", "where they meet a gap of 1.0"}},
    {R"({"type": "pin", "vertices": [21], "uv": [[0, 0]]}, {"type": "pin", "name": "q", "vertices": [3, 21], "uv": [[1, 0], [0, 1]]})",
     "/constraints/0",
     {R"(constraints "pin 21" and "q" cannot all hold: vertex 21 is pinned to two places)"}},
    {R"({"type": "region", "feature": "plate"}, )" + lines({"bent"}),
     "/constraints/0",
     {R"(constraints "region plate" and "line bent" cannot all hold)", "on the 4 vertices that they share"}},
    {lines({"ring"}), "/constraints/0", {R"(constraint "line ring": "ring" is closed)", "no straight line"}},
    {R"({"type": "region", "feature": "top"})",
     "/constraints/0",
     {R"(constraint "region top": )", "it turns by 360 degrees too much", "add a seam"},
     On::Pipe},
    // Pins that fold triangle 14, of the vertices 8, 9 and 16.
    {R"({"type": "pin", "vertices": [8, 9, 16], "uv": [[0, 0], [1, 0], [1, -1]]})",
     "/constraints/0",
     {R"(constraint "pin 8 9 16": the places that they give to all corners turn over)", "(triangle 14)"}},
    {R"({"type": "pin", "name": "p", "vertices": [8, 9], "uv": [[0, 0], [1, 0]]}, {"type": "pin", "name": "q", "vertices": [16], "uv": [[2, 0]]})",
     "/constraints/0",
     {R"(constraints "p" and "q" cannot all hold)", "turn over or flatten triangles", "(triangle 14)"},
     On::DomeWithoutFeatures},
    {lines({"row"}) +
         R"(, {"type": "direction", "feature": "row", "degrees": 0, "oriented": true}, {"type": "pin", "name": "p", "vertices": [28], "uv": [[0, 0]]},
             {"type": "pin", "name": "q", "vertices": [36], "uv": [[1, -1]]})",
     "/constraints/0",
     {R"(constraints "line row", "p" and "q" cannot all hold)", "(triangle 48)"}},
};

const std::vector<Bad> kUnfit = {
    {lines({"patch"}),
     "/constraints/0/feature",
     {"'patch' is a region, a curve is needed here"},
     On::Dome,
     kInvalid},
    {R"({"type": "region", "feature": "row"})",
     "/constraints/0/feature",
     {"'row' is a curve, a region is needed here"},
     On::Dome,
     kInvalid},
    {R"({"type": "parallel", "features": ["row", "plate"]})",
     "/constraints/0/features/1",
     {"'plate' is a region"},
     On::Dome,
     kInvalid},
    {R"({"type": "parallel", "features": ["row", "ring"]})",
     "/constraints/0",
     {R"("parallel row ring": "ring" is closed, and has no direction)"},
     On::Dome,
     kInvalid},
    {R"({"type": "parallel", "features": ["row", "low"], "measure": "line"})",
     "/constraints/0",
     {R"("row" is to be measured as a line, but no constraint makes it one)"},
     On::Dome,
     kInvalid},
    {R"({"type": "circle", "feature": "ring", "mirror": true})",
     "/constraints/0",
     {R"(mirror is for arcs, but "ring" is closed)"},
     On::Dome,
     kInvalid},
    {R"({"type": "curve", "feature": "ring", "mirror": true})",
     "/constraints/0",
     {R"(mirror is for open curves, but "ring" is closed)"},
     On::Dome,
     kInvalid},
    {R"({"type": "circle", "feature": "ring", "sweep_degrees": 90})",
     "/constraints/0",
     {R"(sweep_degrees is for arcs, but "ring" is closed)"},
     On::Dome,
     kInvalid},
    {lines({"row"}),
     "/outer",
     {R"(outer: "ring" is no boundary loop)"},
     On::Dome,
     kInvalid,
     R"(, "outer": "ring")"},
    {lines({"row"}), "/outer", {"unknown feature 'rim'"}, On::Dome, "bad-syntax", R"(, "outer": "rim")", 3},
    {R"({"type": "pin", "vertices": [999], "uv": [[0, 0]]})",
     "/constraints/0/vertices/0",
     {"names a vertex that does not exist, the mesh has 49"},
     On::DomeWithoutFeatures,
     kInvalid},
    {R"({"type": "direction", "edge": [5, 20], "degrees": 0})",
     "/constraints/0/edge",
     {"names two vertices that share no edge"},
     On::DomeWithoutFeatures,
     kInvalid},
};

void check_refused(const Bad& bad) {
  CAPTURE(bad.constraints);
  const Scratch scratch;
  write(scratch.file("in.obj"), bad.on == On::Pipe ? pipe() : bad.on == On::Wedge ? wedge() : dome());
  const char* features = bad.on == On::Pipe                  ? kPipeFeatures
                         : bad.on == On::DomeWithoutFeatures ? ""
                                                             : kFeatures;
  write(scratch.file("c.json"), file_of(features, bad.constraints, bad.more));
  const std::string arguments = " " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                                scratch.file("o.ply") + " --report " + scratch.file("r.json") +
                                " --picture " + scratch.file("p.png");
  const Ran plain = run("flatten" + arguments);
  CHECK(plain.code == bad.exit_code);
  CHECK(plain.out.empty());
  CHECK_MESSAGE(plain.err.find('\n') == plain.err.size() - 1, plain.err);
  CHECK(has(plain.err, "c.json: " + std::string(bad.pointer) + ": "));
  for (const char* part : bad.message) CHECK_MESSAGE(has(plain.err, part), plain.err);
  const json error = json::parse(run("flatten --json-errors" + arguments).err).at("error");
  CHECK(error.at("code") == bad.code);
  CHECK(error.at("pointer") == bad.pointer);
  CHECK(scratch.count() == 2);
}

}  // namespace

TEST_CASE(
    "constraints: contradictions are refused by name, with what differs and by how much, and nothing is "
    "written") {
  for (const Bad& bad : kContradictions) check_refused(bad);
}

TEST_CASE(
    "constraints: what does not fit its feature, or does not exist, is refused, and nothing is written") {
  for (const Bad& bad : kUnfit) check_refused(bad);
}

TEST_CASE(
    "constraints: a line keeps its lengths, scales them by a given or a free factor, or leaves them free") {
  CHECK(solve(dome(), lines({"row"})).scale("line row") == doctest::Approx(1).epsilon(1e-12));
  const std::string given = R"(, "lengths": "scale", "scale": 1.05)";
  CHECK(solve(dome(), lines({"row"}, given)).scale("line row") == doctest::Approx(1.05).epsilon(1e-12));
  CHECK(solve(dome(), lines({"row"}, kScaled)).scale("line row") <
        1);  // a chain over the top is longer than needed
  const Solved free = solve(dome(), lines({"row"}, R"(, "lengths": "free")"));
  CHECK(free.entry("line row").at("scale").is_null());
  CHECK(free.entry("line row").at("template").is_null());
  CHECK(free.entry("line row").at("keeps_order") == true);
}

TEST_CASE("constraints: free scales of a group are one, of lines and circles alike") {
  const std::string group = R"(, "lengths": "scale", "scale_group": "g")";
  const Solved two = solve(dome(), lines({"low", "high"}, group));
  CHECK(two.scale("line low") == doctest::Approx(two.scale("line high")).epsilon(1e-12));
  const Solved both = solve(
      dome(), lines({"high"}, group) + R"(, {"type": "circle", "feature": "ring", "scale_group": "g"})");
  CHECK(both.scale("line high") == doctest::Approx(both.scale("circle ring")).epsilon(1e-12));
}

TEST_CASE("constraints: circles and arcs of given radius, scale, sweep and side") {
  const Scratch scratch;
  const Solved circle = solve(scratch, dome(), R"({"type": "circle", "feature": "ring", "radius": 1.1})");
  const auto image = images(scratch.file("o.obj"));
  std::complex<double> centre = 0;
  for (const int v : {8, 10, 24, 22}) centre += image[v] / 4.0;
  for (const int v : {8, 10, 24, 22})
    CHECK(std::abs(image[v] - centre) == doctest::Approx(1.1).epsilon(2e-3));
  for (const char* keys : {"", R"(, "scale": 1)"})
    solve(dome(), R"({"type": "circle", "feature": "ring")" + std::string(keys) + "}");
  for (const char* keys :
       {"", R"(, "sweep_degrees": 60)", R"(, "sweep_degrees": 200)", R"(, "mirror": false)",
        R"(, "mirror": true)", R"(, "radius": 3, "sweep_degrees": 60)", R"(, "scale": 0.9)"}) {
    const Solved arc = solve(dome(), R"({"type": "circle", "feature": "bow")" + std::string(keys) + "}");
    CHECK(arc.entry("circle bow").at("mirrored") == has(keys, "true"));
  }
}

TEST_CASE("constraints: curves and regions keep their shape, at a given or a free scale") {
  for (const char* shape : {"plane", "geodesic"}) {
    for (const char* keys : {"", R"(, "scale": "free")", R"(, "scale": 1.02)"}) {
      for (const char* feature : {"ring", "bow"}) {
        const std::string curve = std::string(R"({"type": "curve", "feature": ")") + feature +
                                  R"(", "shape": ")" + shape + "\"" + keys + "}";
        const Solved solved = solve(dome(), curve);
        const double scale = solved.scale(std::string("curve ") + feature);
        if (!has(keys, "free")) CHECK(scale == doctest::Approx(has(keys, "1.02") ? 1.02 : 1).epsilon(1e-12));
      }
    }
  }
  for (const char* keys : {"", R"(, "scale": 0.9)", R"(, "scale": "free")"}) {
    for (const char* feature : {"patch", "plate"})
      solve(dome(), std::string(R"({"type": "region", "feature": ")") + feature + "\"" + keys + "}");
  }
}

TEST_CASE("constraints: one, two and three pins, on free vertices and on features, and with a direction") {
  const auto pin = [](const std::string& vertices, const std::string& uv) {
    return R"({"type": "pin", "vertices": [)" + vertices + R"(], "uv": [)" + uv + "]}";
  };
  const auto place_of = [](const std::string& constraints, std::size_t vertex) {
    const Scratch scratch;
    solve(scratch, dome(), constraints);
    return images(scratch.file("o.obj"))[vertex];
  };
  CHECK(place_of(pin("24", "[10, 20]"), 24) == std::complex<double>(10, 20));
  CHECK(place_of(pin("0, 48", "[10, 20], [10, 29]"), 48) == std::complex<double>(10, 29));
  CHECK(place_of(pin("0, 6, 48", "[0, 0], [6, 0], [6, 7]"), 6) == std::complex<double>(6, 0));
  CHECK(place_of(pin("8, 9, 16", "[0, 0], [1, 0], [1, 1]"), 9) == std::complex<double>(1, 0));
  solve(dome(), lines({"row"}) + ", " + pin("31", "[10, 20]"));
  solve(dome(), lines({"row"}, kScaled) + ", " + pin("28, 34", "[10, 20], [14, 20]"));
  solve(dome(), lines({"row"}, R"(, "lengths": "free")") + ", " + pin("28, 31", "[10, 20], [12, 20]"));
  solve(dome(), R"({"type": "circle", "feature": "ring"}, )" + pin("8, 24", "[0, 0], [2, 2]"));
  const std::string direction =
      R"({"type": "direction", "feature": "row", "degrees": 210, "oriented": true})";
  const Solved directed = solve(dome(), lines({"row"}) + ", " + direction + ", " + pin("28", "[1, 1]"));
  CHECK(directed.entry("direction row").at("degrees").get<double>() == doctest::Approx(-150).epsilon(1e-9));
  solve(dome(), lines({"row"}) + ", " + direction + ", " + pin("3", "[1, 1]"));
}

TEST_CASE("constraints: angles between lines, chords and edges, oriented or not, and against the u axis") {
  const auto degrees_of = [](const std::string& constraints, const std::string& name) {
    const double degrees = solve(dome(), constraints).entry(name).at("degrees");
    return std::abs(degrees) < 1e-9 ? 0 : degrees;
  };
  const std::string two = lines({"low", "row"}) + ", ";
  CHECK(degrees_of(two + R"({"type": "parallel", "features": ["low", "row"], "name": "p"})", "p") == 0);
  CHECK(std::abs(degrees_of(
            two + R"({"type": "angle", "features": ["low", "row"], "degrees": 170, "name": "p"})", "p")) ==
        doctest::Approx(10).epsilon(1e-9));
  CHECK(degrees_of(
            R"({"type": "angle", "features": ["low", "row"], "degrees": 350, "oriented": true, "name": "p"})",
            "p") == doctest::Approx(-10).epsilon(1e-9));
  CHECK(degrees_of(
            R"({"type": "angle", "edges": [[8, 9], [37, 38]], "degrees": 15, "oriented": true, "name": "p"})",
            "p") == doctest::Approx(15).epsilon(1e-9));
  CHECK(degrees_of(R"({"type": "direction", "edge": [24, 25], "degrees": 77, "oriented": true, "name": "p"})",
                   "p") == doctest::Approx(77).epsilon(1e-9));
  for (const char* keys : {"", R"(, "measure": "line")", R"(, "measure": "chord")"}) {
    solve(dome(),
          lines({"row", "up"}) + R"(, {"type": "perpendicular", "features": ["row", "up"])" + keys + "}");
  }
  // Of a line and of a chord; of the two ends of an arc and a line; two sides of one triangle.
  solve(dome(), lines({"row"}) + R"(, {"type": "parallel", "features": ["row", "low"]})");
  solve(dome(),
        lines({"row"}) +
            R"(, {"type": "circle", "feature": "bow"}, {"type": "parallel", "features": ["row", "bow"]})");
  solve(dome(), R"({"type": "angle", "edges": [[8, 9], [9, 16]], "degrees": 80},
                   {"type": "angle", "edges": [[9, 16], [16, 8]], "degrees": 60})");
}

TEST_CASE("constraints: a triangle of lines whose angles are given") {
  solve(dome(),
        lines({"a", "b", "c"}, kScaled) + R"(, {"type": "angle", "features": ["a", "b"], "degrees": 90},
      {"type": "angle", "features": ["b", "c"], "degrees": 50}, {"type": "angle", "features": ["c", "a"], "degrees": 40})");
}

TEST_CASE("constraints: a profile curve that agrees with another one only mirrored is laid mirrored") {
  // The row's own plane stands across the dome, so that the surface does not say which way round it lies.
  const Solved solved = solve(dome(), R"({"type": "curve", "feature": "row", "name": "open"},
                                         {"type": "curve", "feature": "row", "name": "given", "mirror": true})");
  CHECK(solved.entry("open").at("mirrored") == true);
  CHECK(solved.entry("open").at("chirality_open") == true);
}

TEST_CASE("constraints: the outer loop is the one that is named") {
  const std::string mesh = grid(
      7, 0,
      [](double x, double y) {
        return Point{x, y, height(x, y, 7)};
      },
      3);
  for (const char* outer : {"", "rim", "hole"}) {
    const Scratch scratch;
    write(scratch.file("in.obj"), mesh);
    const std::string more = *outer ? R"(, "outer": ")" + std::string(outer) + "\"" : "";
    write(scratch.file("c.json"), file_of(R"("rim": {"loop": 0}, "hole": {"boundary_near": [3.5, 3.5, 0]})",
                                          R"({"type": "circle", "feature": "hole"})", more));
    const Ran ran = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                        scratch.file("o.ply") + " --report " + scratch.file("r.json") + " --overlaps report");
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const json report = json::parse(content_of(scratch.file("r.json")));
    CHECK(report.at("mesh").at("outer") == json({has(outer, "hole") ? 1 : 0}));
    const Ran check = checked(scratch.file("c.json"), scratch.file("o.ply"), scratch.file("r.json"));
    CHECK_MESSAGE(check.code == 0, check.out);
  }
}

TEST_CASE(
    "constraints: shapes that nearly agree yield as far as agreement allows, and the report says how far") {
  const std::string both = R"({"type": "curve", "feature": "bow"}, {"type": "line", "feature": "low"})";
  const Solved solved = solve(dome(), both, R"(, "agreement": 0.05)");
  CHECK(solved.entry("curve bow").at("yielded") == json({8, 9, 10, 11}));
  CHECK(solved.entry("curve bow").at("mismatch").get<double>() > 0);
  CHECK(solved.entry("line low").at("yielded").empty());
  check_refused({both,
                 "/constraints/0",
                 {R"(constraints "curve bow" and "line low" cannot all hold)", "agreement allows 1e-06"},
                 On::Dome,
                 "constraints-conflict",
                 R"(, "agreement": 1e-6)"});
}

TEST_CASE("constraints: on a seam a constraint holds on each side, with a residual a side") {
  const std::string seam = R"(, "seams": ["seam"])", line = lines({"seam"});
  for (
      const std::string& constraints :
      {line, line + R"(, {"type": "direction", "feature": "seam", "degrees": 90})",
       lines({"seam"}, kScaled) + ", " + lines({"back"}) +
           R"(, {"type": "angle", "features": ["seam", "back"], "degrees": 3})",
       std::string(R"({"type": "curve", "feature": "seam"})"),
       std::string(R"({"type": "circle", "feature": "seam", "sweep_degrees": 30})"),
       lines({"seam", "back"}) +
           R"(, {"type": "parallel", "features": ["seam", "back"]}, {"type": "pin", "vertices": [12], "uv": [[0, 0]]})"}) {
    const Solved solved = solve(pipe(), constraints, seam);
    const json& all = solved.report.at("constraints");
    for (const int side : {1, 2}) {
      CHECK(std::ranges::count_if(all, [&](const json& e) {
              return e.value("side", 0) == side && e.value("feature", json()) == "seam" &&
                     e.at("type") != "direction";
            }) == 1);
    }
  }
}

TEST_CASE("constraints: a region keeps its shape on either side of a seam, and opened by it") {
  const std::string seam = R"(, "seams": ["seam"])";
  for (const char* region : {"before", "behind", "top"}) {
    const Solved solved =
        solve(pipe(), std::string(R"({"type": "region", "feature": ")") + region + "\"}", seam);
    const std::size_t points = solved.report.at("constraints").at(0).at("template").size();
    const std::size_t triangles = solved.report.at("features").at(region).at("triangles").size();
    CHECK((points == 3 * triangles) == has(region, "top"));
  }
}

TEST_CASE(
    "constraints: components are held apart, tied by angles and by scale groups, and pinned one by one") {
  const std::string mesh = dome() + grid(3, 49, [](double x, double y) {
                             return Point{10 + x, y, 0.1 * x * y};
                           });
  const std::string features = std::string(kFeatures) + R"(, "far": {"vertices": [53, 54, 55, 56]})";
  for (const std::string& constraints :
       {lines({"row", "far"}),
        lines({"row", "far"}) + R"(, {"type": "perpendicular", "features": ["row", "far"]})",
        lines({"row", "far"}, R"(, "lengths": "scale", "scale_group": "g")"),
        lines({"row"}) + R"(, {"type": "pin", "vertices": [49, 52], "uv": [[0, 0], [0, 3]]})"}) {
    const Scratch scratch;
    write(scratch.file("in.obj"), mesh);
    write(scratch.file("c.json"), file_of(features, constraints, ""));
    const Ran ran = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                        scratch.file("o.ply") + " --report " + scratch.file("r.json"));
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const Ran check = checked(scratch.file("c.json"), scratch.file("o.ply"), scratch.file("r.json"));
    CHECK_MESSAGE(check.code == 0, check.out);
  }
}

TEST_CASE(
    "constraints: a report with every kind of entry is valid by its schema, a report with a slip is not") {
  const std::string every =
      lines({"row"}) + ", " + lines({"high"}, R"(, "lengths": "free")") +
      R"(, {"type": "circle", "feature": "ring"}, {"type": "curve", "feature": "south"}, {"type": "region", "feature": "tip"},
          {"type": "angle", "features": ["row", "south"], "degrees": 1}, {"type": "perpendicular", "edges": [[1, 8], [44, 45]]},
          {"type": "direction", "edge": [36, 37], "degrees": 0}, {"type": "pin", "vertices": [48], "uv": [[0, 0]]})";
  const Scratch scratch;
  const std::string report = scratch.file("r.json");
  write(scratch.file("in.obj"), dome());
  write(scratch.file("c.json"),
        file_of(kFeatures + std::string(R"(, "tip": {"triangles": [0]})"), every, ""));
  const Ran ran =
      run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " --report " + report);
  REQUIRE_MESSAGE((ran.code == 0 || ran.code == 6), ran.err);
  const std::string fault = schema_fault("report.schema.json", report);
  if (fault == "absent") {
    MESSAGE("left out: no jsonschema for python3");
    return;
  }
  CHECK_MESSAGE(fault.empty(), fault);
  json slip = json::parse(content_of(report));
  slip["constraints"][0]["residul"] = 0;
  write(report, slip.dump());
  CHECK(has(schema_fault("report.schema.json", report), "$.constraints[0]"));
  solve(scratch, pipe(), lines({"seam"}) + R"(, {"type": "direction", "feature": "seam", "degrees": 0})",
        R"(, "seams": ["seam"])");
  CHECK_MESSAGE(schema_fault("report.schema.json", report).empty(),
                schema_fault("report.schema.json", report));
}

TEST_CASE("constraints: pins choose which way along the u axis an undirected direction runs") {
  const auto energy = [&](const char* uv) {
    return solve(dome(), lines({"low"}) + R"(, {"type": "direction", "feature": "low", "degrees": 0},
                 {"type": "pin", "vertices": [28, 34], "uv": )" +
                             uv + "}")
        .report.at("energy")
        .at("arap")
        .get<double>();
  };
  CHECK(energy("[[3, 0], [-3, 0]]") == doctest::Approx(energy("[[-3, 0], [3, 0]]")).epsilon(1e-6));
}

TEST_CASE("constraints: a region is known by its rim, though a hole in it is longer") {
  constexpr int n = 12;
  // A hole that winds to and fro, one square wide.
  const auto in_hole = [](int i, int j) {
    if (i < 1 || i > 10 || j < 1 || j > 9) return false;
    return j % 2 == 1 || (j % 4 == 2 ? i == 10 : i == 1);
  };
  std::string triangles;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int t = 2 * (j * n + i);
      if (!in_hole(i, j))
        triangles += (triangles.empty() ? "" : ", ") + std::to_string(t) + ", " + std::to_string(t + 1);
    }
  }
  const Scratch scratch;
  write(scratch.file("in.obj"), grid(n, 0, [](double x, double y) { return Point{x, y, 0}; }));
  write(scratch.file("c.json"), file_of(R"("plate": {"triangles": [)" + triangles + "]}",
                                        R"({"type": "region", "feature": "plate"})", ""));
  const Ran ran = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json"));
  CHECK_MESSAGE(ran.code == 0, ran.err);
}

TEST_CASE("constraints: a relation between edges on a seam holds on each side for itself") {
  const Solved solved = solve(pipe(), R"({"type": "parallel", "edges": [[24, 48], [96, 120]], "name": "p"})",
                              R"(, "seams": ["seam"])");
  CHECK(solved.entry("p", 1).at("residual").get<double>() < 1e-7);
  CHECK(solved.entry("p", 2).at("residual").get<double>() < 1e-7);
  CHECK(solved.report.at("constraints").size() == 2);
}

TEST_CASE("constraints: a line of free lengths that loses its order is written, and said with 6") {
  const Scratch scratch;
  write(scratch.file("in.obj"), dome());
  write(scratch.file("c.json"),
        file_of(R"("mid": {"vertices": [21, 22, 23, 24, 25, 26, 27]})",
                lines({"mid"}, R"(, "lengths": "free")") +
                    R"(, {"type": "pin", "vertices": [21, 24, 27], "uv": [[0, 0], [6, 0], [3, 0]]})",
                ""));
  const Ran ran = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " --report " +
                      scratch.file("r.json"));
  CHECK(ran.code == 6);
  CHECK_MESSAGE(has(ran.err, R"(the vertices of "line mid" lost their order along the line)"), ran.err);
  CHECK(json::parse(content_of(scratch.file("r.json"))).at("constraints")[0].at("keeps_order") == false);
}

TEST_CASE("constraints: directions that may turn lower the energy") {
  // Two lines of kept length that cross: the surface does not cross them at the angle of the best map.
  const std::string crossing = lines({"row", "up"});
  const Scratch scratch;
  const Solved solved = solve(scratch, wedge(), crossing);
  const Ran priced = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") +
                         " --price --report " + scratch.file("p.json"));
  REQUIRE(priced.code == 0);
  const json price = json::parse(content_of(scratch.file("p.json"))).at("price");
  CHECK(price.at("energy").get<double>() < price.at("without_refit").get<double>() * (1 - 1e-6));
}
