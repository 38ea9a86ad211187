// Constraints through the program: contradictions are named, options do what they say, and what is written is judged by
// a check that knows nothing of planish.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <functional>
#include <future>
#include <set>
#include <sstream>
#include <vector>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

using namespace planish::tests;
using nlohmann::json;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// ---- meshes ----

using Point = std::array<double, 3>;

std::string vertex_line(Point p) {
  std::ostringstream line;
  line.precision(17);
  line << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  return line.str();
}

/// Two triangles a square of n x n squares, without the square at (hole, hole); vertices are counted row by row from
/// `first`. A square has the diagonal from lower left to upper right.
std::string grid(int n, int first, const std::function<Point(double, double)>& at, int hole = -1) {
  std::ostringstream text;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) text << vertex_line(at(i, j));
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if (i == hole && j == hole) continue;
      const int a = first + j * (n + 1) + i + 1, d = a + n + 1;
      text << "f " << a << ' ' << a + 1 << ' ' << d + 1 << "\nf " << a << ' ' << d + 1 << ' ' << d << '\n';
    }
  }
  return text.str();
}

/// Height of a shallow dome over [0, n] x [0, n], askew.
double height(double x, double y, int n) {
  const double s = 2 * x / n - 1, t = 2 * y / n - 1;
  return 0.3 * (1 - s * s) * (1 - t * t) + 0.05 * x;
}

/// 6 x 6 squares: vertices 0 to 48, 7 a row.
std::string dome() {
  return grid(6, 0, [](double x, double y) { return Point{x, y, height(x, y, 6)}; });
}

/// The dome, wider at its upper end.
std::string wedge() {
  return grid(6, 0, [](double x, double y) { return Point{x * (1 + 0.1 * y), y, height(x, y, 6)}; });
}

/// A pipe of 24 x 8 squares, radius 1, along z.
std::string pipe() {
  std::ostringstream text;
  for (int j = 0; j <= 8; ++j) {
    for (int i = 0; i < 24; ++i) {
      const double a = 2 * 3.14159265358979 * i / 24;
      text << vertex_line({std::cos(a), std::sin(a), 0.5 * j});
    }
  }
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 24; ++i) {
      const int a = 24 * j + i + 1, b = 24 * j + (i + 1) % 24 + 1;
      text << "f " << a << ' ' << b << ' ' << b + 24 << "\nf " << a << ' ' << b + 24 << ' ' << a + 24 << '\n';
    }
  }
  return text.str();
}

// ---- constraint files ----

/// Of the dome and the wedge. "bow" and "ring" run along "low" for a while, "a", "b" and "c" around a triangle.
constexpr const char* kFeatures = R"(
  "low": {"vertices": [7, 8, 9, 10, 11, 12, 13]}, "row": {"vertices": [28, 29, 30, 31, 32, 33, 34]},
  "high": {"vertices": [35, 36, 37, 38, 39, 40, 41]}, "up": {"vertices": [4, 11, 18, 25, 32, 39, 46]},
  "a": {"vertices": [8, 9, 10, 11]}, "b": {"vertices": [11, 18, 25, 32]}, "c": {"vertices": [32, 24, 16, 8]},
  "bow": {"vertices": [15, 8, 9, 10, 11, 19]},
  "ring": {"vertices": [8, 9, 10, 17, 24, 23, 22, 15], "closed": true}, "plate": {"enclosed_by": "ring"},
  "bent": {"vertices": [8, 9, 10, 17]}, "patch": {"triangles": [14, 15, 16, 17, 26, 27, 28, 29]},
  "south": {"vertices": [0, 1, 2, 3, 4, 5, 6]}, "east": {"vertices": [6, 13, 20, 27, 34, 41, 48]},
  "north": {"vertices": [42, 43, 44, 45, 46, 47, 48]}, "west": {"vertices": [0, 7, 14, 21, 28, 35, 42]})";

constexpr const char* kPipeFeatures = R"(
  "seam": {"vertices": [0, 24, 48, 72, 96, 120, 144, 168, 192]},
  "back": {"vertices": [12, 36, 60, 84, 108, 132, 156, 180, 204]},
  "belt": {"plane_cut": {"point": [0, 0, 1.25], "normal": [0, 0, 1], "near": [1, 0, 1.25]}},
  "before": {"triangles": [92, 93, 94, 95, 140, 141, 142, 143]}, "behind": {"triangles": [48, 49, 50, 51, 96, 97, 98, 99]},
  "top": {"enclosed_by": "belt", "seed": [1, 0, 3]})";

std::string file_of(const std::string& features, const std::string& constraints, const std::string& more) {
  return "{\"version\": 1, \"features\": {" + features + "}, \"constraints\": [" + constraints + "]" + more +
         "}";
}

std::string join(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// Lines with the same further keys.
std::string lines(const std::vector<std::string>& names, const std::string& keys = "") {
  std::vector<std::string> parts;
  for (const std::string& name : names)
    parts.push_back(R"({"type": "line", "feature": ")" + name + "\"" + keys + "}");
  return join(parts);
}

constexpr const char* kScaled = R"(, "lengths": "scale")";

/// Three right angles between four sides.
std::string right_angles(const std::array<std::string, 4>& side) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < 3; ++k)
    parts.push_back(R"({"type": "perpendicular", "features": [")" + side[k] + R"(", ")" + side[k + 1] +
                    R"("]})");
  return join(parts);
}

const std::array<std::string, 4> kSides = {"south", "east", "north", "west"};
const std::vector<std::string> kSideList(kSides.begin(), kSides.end());

// ---- runs ----

/// Exit code and words of the independent check.
Ran checked(const std::string& constraints, const std::string& output, const std::string& report) {
  const Scratch scratch;
  const std::string command = "python3 -B " PLANISH_TESTS "/independent_constraint_check.py " + constraints +
                              " " + output + " " + report + " >" + scratch.file("said") + " 2>&1";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(scratch.file("said")), ""};
}

struct Solved {
  Ran ran;
  json report;
  const json& entry(const std::string& name, int side = 0) const {
    const json& all = report.at("constraints");
    const auto found = std::find_if(all.begin(), all.end(), [&](const json& e) {
      return e.at("name") == name && e.value("side", 0) == side;
    });
    REQUIRE(found != all.end());
    return *found;
  }
  double scale(const std::string& name) const { return entry(name).at("scale"); }
};

/// Flattens, and has the result checked. What is written is o.obj.
Solved solve(const Scratch& scratch, const std::string& mesh, const std::string& constraints,
             const std::string& more = "") {
  CAPTURE(constraints);
  const bool is_pipe = has(mesh, "v -1 ");
  write(scratch.file("in.obj"), mesh);
  write(scratch.file("c.json"), file_of(is_pipe ? kPipeFeatures : kFeatures, constraints, more));
  Solved solved;
  solved.ran = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                   scratch.file("o.obj") + " --report " + scratch.file("r.json"));
  REQUIRE_MESSAGE(solved.ran.code == 0, solved.ran.err);
  solved.report = json::parse(content_of(scratch.file("r.json")));
  CHECK(solved.report.at("converged") == true);
  const Ran check = checked(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
  CHECK_MESSAGE(check.code == 0, check.out);
  return solved;
}

Solved solve(const std::string& mesh, const std::string& constraints, const std::string& more = "") {
  return solve(Scratch(), mesh, constraints, more);
}

/// The image of each vertex in an OBJ; of several the last.
std::vector<std::complex<double>> images(const std::string& path) {
  std::istringstream text(content_of(path));
  std::vector<std::complex<double>> coordinate, image;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line.substr(std::min(line.size(), line.find(' '))));
    double u = 0, v = 0;
    if (line.starts_with("vt ") && words >> u >> v) coordinate.emplace_back(u, v);
    if (line.starts_with("v ")) image.emplace_back();
    std::size_t vertex = 0, place = 0;
    char slash = 0;
    while (line.starts_with("f ") && words >> vertex >> slash >> place)
      image[vertex - 1] = coordinate[place - 1];
  }
  return image;
}

bool absent(const std::string& folder) {
  if (std::filesystem::exists(folder)) return false;
  MESSAGE("left out: no ", folder);
  return true;
}

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
                        scratch.file("o.ply") + " --report " + scratch.file("r.json"));
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

namespace {

/// What the schema has against a report, "" where nothing; "absent" where there is no jsonschema to ask.
std::string schema_fault(const std::string& report) {
  const Scratch scratch;
  write(scratch.file("validate.py"), R"(
import json, sys
try: import jsonschema
except ImportError: sys.exit("absent")
schema, report = (json.load(open(path)) for path in sys.argv[1:])
jsonschema.Draft202012Validator.check_schema(schema)
faults = [f"{e.json_path}: {e.message}" for e in jsonschema.Draft202012Validator(schema).iter_errors(report)]
sys.exit("; ".join(faults)[:2000] if faults else 0)
)");
  const std::string command = "python3 -B " + scratch.file("validate.py") +
                              " " PLANISH_DOCS "/report.schema.json " + report + " 2>" + scratch.file("said");
  const bool valid = std::system(command.c_str()) == 0;
  const std::string said = content_of(scratch.file("said"));
  return valid ? "" : said.starts_with("absent") ? "absent" : "invalid: " + said;
}

}  // namespace

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
  const std::string fault = schema_fault(report);
  if (fault == "absent") {
    MESSAGE("left out: no jsonschema for python3");
    return;
  }
  CHECK_MESSAGE(fault.empty(), fault);
  json slip = json::parse(content_of(report));
  slip["constraints"][0]["residul"] = 0;
  write(report, slip.dump());
  CHECK(has(schema_fault(report), "$.constraints[0]"));
  solve(scratch, pipe(), lines({"seam"}) + R"(, {"type": "direction", "feature": "seam", "degrees": 0})",
        R"(, "seams": ["seam"])");
  CHECK_MESSAGE(schema_fault(report).empty(), schema_fault(report));
}

// ---- rectangles ----

namespace {

/// The boundary of a mesh in four parts, from corner to corner: the vertices farthest along the diagonals of its free map.
struct Quarters {
  std::array<std::size_t, 4> corner;
  json features;
};

Quarters quarters(const std::string& mesh) {
  const Scratch scratch;
  write(scratch.file("c.json"), file_of(R"("rim": {"loop": 0})", "", ""));
  REQUIRE(run("flatten --quiet " + mesh + " -c " + scratch.file("c.json") + " -o " + scratch.file("o.obj") +
              " --report " + scratch.file("r.json"))
              .code == 0);
  const auto image = images(scratch.file("o.obj"));
  const std::vector<std::size_t> rim =
      json::parse(content_of(scratch.file("r.json"))).at("features").at("rim").at("vertices");
  Quarters result;
  std::array<std::size_t, 4> place{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto across = [&](std::size_t v) {
      return (k == 1 || k == 2 ? 1 : -1) * image[v].real() + (k > 1 ? 1 : -1) * image[v].imag();
    };
    const auto farthest =
        std::ranges::max_element(rim, [&](std::size_t u, std::size_t v) { return across(u) < across(v); });
    place[k] = static_cast<std::size_t>(farthest - rim.begin());
    result.corner[k] = *farthest;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<std::size_t> side = {result.corner[k]};
    for (std::size_t i = place[k]; i != place[(k + 1) % 4];) side.push_back(rim[i = (i + 1) % rim.size()]);
    result.features[kSides[k]] = {{"vertices", side}};
  }
  return result;
}

/// Flattens the quarters to a rectangle, proves it one, and returns its width over its height and that in space.
std::pair<double, double> aspect(const std::string& mesh, const Quarters& parts,
                                 const std::string& constraints) {
  const Scratch scratch;
  const std::string features = parts.features.dump();
  write(scratch.file("c.json"),
        file_of(features.substr(1, features.size() - 2), constraints + ", " + right_angles(kSides), ""));
  const Ran ran = run("flatten " + mesh + " -c " + scratch.file("c.json") + " -o " + scratch.file("o.obj") +
                      " --report " + scratch.file("r.json"));
  CHECK_MESSAGE(ran.code == 0, ran.err);
  REQUIRE(std::filesystem::exists(scratch.file("o.obj")));
  const Ran check = checked(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
  CHECK_MESSAGE(check.code == 0, check.out);
  const json report = json::parse(content_of(scratch.file("r.json")));
  CHECK(report.at("overlapping_pairs") == 0);
  const auto image = images(scratch.file("o.obj"));
  const auto at = [&](std::size_t k) { return image[parts.corner[k]]; };
  const double size = std::abs(at(2) - at(0));
  CHECK(std::abs(at(0) - at(1) + at(2) - at(3)) <= 1e-12 * size);
  CHECK(std::abs(std::abs(at(2) - at(0)) - std::abs(at(3) - at(1))) <= 1e-12 * size);
  const auto length = [&](const char* side) {
    return report.at("features").at(side).at("length").get<double>();
  };
  return {std::abs(at(1) - at(0)) / std::abs(at(2) - at(1)), length("south") / length("east")};
}

void check_rectangles(const std::string& mesh, double width, double tall) {
  CAPTURE(mesh);
  const Quarters parts = quarters(mesh);
  aspect(mesh, parts, lines(kSideList, kScaled));
  // Two sides of one scale.
  const auto [flat, solid] = aspect(mesh, parts,
                                    lines({"south", "east"}, R"(, "lengths": "scale", "scale_group": "g")") +
                                        ", " + lines({"north", "west"}, kScaled));
  CHECK(flat == doctest::Approx(solid).epsilon(1e-9));
  // Corners that are pinned.
  const auto [c0, c1, c2, c3] = parts.corner;
  const json pin = {{"type", "pin"},
                    {"vertices", {c0, c1, c2, c3}},
                    {"uv", {{0, 0}, {width, 0}, {width, tall}, {0, tall}}}};
  CHECK(aspect(mesh, parts, lines(kSideList, kScaled) + ", " + pin.dump()).first ==
        doctest::Approx(width / tall).epsilon(1e-12));
}

}  // namespace

TEST_CASE("constraints: a noisy panel becomes a rectangle of free, kept or pinned aspect ratio") {
  const Scratch scratch;
  REQUIRE(run("sample hood --triangles 8000 --noise 0.0005 -o " + scratch.file("hood.ply")).code == 0);
  check_rectangles(scratch.file("hood.ply"), 1.5, 1.2);
}

TEST_CASE("constraints: four sides of free lengths make a rectangle in order") {
  const Solved solved =
      solve(wedge(), lines(kSideList, R"(, "lengths": "free")") + ", " + right_angles(kSides));
  for (const std::string& side : kSides) CHECK(solved.entry("line " + side).at("keeps_order") == true);
}

TEST_CASE("constraints: sides that close but for the precision of the file yield a corner, pinned or not") {
  const std::string mesh = grid(6, 0, [](double x, double y) {
    return Point{x * (1 + 1e-8 * y), y, height(x, y, 6)};
  });
  const std::string rectangle = lines(kSideList) + ", " + right_angles(kSides);
  const auto mismatch = [&](const std::string& pins) {
    const Solved solved = solve(mesh, rectangle + pins);
    double most = 0;
    for (const std::string& side : kSides)
      most = std::max(most, solved.entry("line " + side).at("mismatch").get<double>());
    return most;
  };
  // The upper side is 6 * 6e-8 longer than the lower one.
  CHECK(mismatch("") == doctest::Approx(3.6e-7).epsilon(0.01));
  CHECK(mismatch(R"(, {"type": "pin", "vertices": [8, 40], "uv": [[0, 0], [5, 4]]})") > 1e-7);
  for (const char* corner : {"0", "6", "42", "48"}) {
    CAPTURE(corner);
    CHECK(mismatch(std::string(R"(, {"type": "pin", "vertices": [)") + corner + R"(], "uv": [[1, 2]]})") >
          1e-7);
  }
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

TEST_CASE("constraints: real panels become rectangles of free, kept or pinned aspect ratio") {
  if (absent(PLANISH_SHARED_DATA)) return;
  check_rectangles(PLANISH_SHARED_DATA "/cad/plate_skin.ply", 14, 13);
  check_rectangles(PLANISH_SHARED_DATA "/automotive/hood.ply", 1.45, 1.16);
}

// ---- the paper's figures ----

namespace {

/// A mesh of the shared data with constraints, flattened and checked; what flatten without them says of the same mesh.
struct Figure {
  Figure(const std::string& mesh, const json& constraints) {
    const Scratch scratch;
    write(scratch.file("c.json"), constraints.dump());
    const std::string common = " --report " + scratch.file("r.json") + " -o " + scratch.file("o.ply");
    const Ran plain = run("flatten " + mesh + common);
    unconstrained = json::parse(content_of(scratch.file("r.json")));
    ran = run("flatten " + mesh + " -c " + scratch.file("c.json") + common + " --picture " +
              scratch.file("p.png"));
    REQUIRE_MESSAGE((ran.code == 0 || ran.code == 6), ran.err);
    report = json::parse(content_of(scratch.file("r.json")));
    const Ran check = checked(scratch.file("c.json"), scratch.file("o.ply"), scratch.file("r.json"));
    CHECK_MESSAGE(check.code == 0, check.out);
    CHECK(std::filesystem::file_size(scratch.file("p.png")) > 10000);
  }
  Ran ran;
  json report, unconstrained;
};

double arap(const json& report) { return report.at("energy").at("arap"); }

json shared_set(const std::string& name) {
  return json::parse(content_of(PLANISH_SHARED_DATA "/" + name + ".constraints.json"));
}

/// The outer loop of a mesh.
std::vector<int> rim_of(const std::string& mesh) {
  const Scratch scratch;
  write(scratch.file("c.json"), R"({"version": 1, "features": {"rim": {"loop": 0}}})");
  REQUIRE(
      run("embed " + mesh + " -c " + scratch.file("c.json") + " --report " + scratch.file("r.json")).code ==
      0);
  return json::parse(content_of(scratch.file("r.json"))).at("features").at("rim").at("vertices");
}

}  // namespace

TEST_CASE("constraints: figure 1, a straight line and a planar curve share a boundary, both of free scale") {
  if (absent(PLANISH_SHARED_DATA)) return;
  const std::string mesh = PLANISH_SHARED_DATA "/automotive/windscreen.ply";
  const std::vector<int> rim = rim_of(mesh);
  const json top = shared_set("automotive/windscreen.a").at("features").at("top_edge");
  const auto middle =
      std::find(rim.begin(), rim.end(), top.at("vertices")[top.at("vertices").size() / 2].get<int>());
  REQUIRE(middle != rim.end());
  const std::size_t n = rim.size(), opposite = static_cast<std::size_t>(middle - rim.begin()) + n / 2;
  std::vector<int> bottom;
  for (std::size_t k = opposite - 40; k <= opposite + 40; ++k) bottom.push_back(rim[k % n]);
  const Figure figure(mesh, {{"version", 1},
                             {"features", {{"top", top}, {"bottom", {{"vertices", bottom}}}}},
                             {"constraints",
                              {{{"type", "line"}, {"feature", "bottom"}, {"lengths", "scale"}},
                               {{"type", "curve"}, {"feature", "top"}, {"scale", "free"}}}}});
  CHECK(figure.ran.code == 0);
  for (const json& c : figure.report.at("constraints"))
    CHECK(std::abs(c.at("scale").get<double>() - 1) > 1e-3);
  CHECK(arap(figure.report) > arap(figure.unconstrained));
  CHECK(arap(figure.report) < 2e-3);
}

TEST_CASE(
    "constraints: figures 7 and 9, a circle and a line on an organic mesh, planar faces of a mechanical "
    "part") {
  if (absent(PLANISH_SHARED_DATA)) return;
  json head = shared_set("disk/cowhead.a");
  const json profile = shared_set("disk/cowhead.b");
  head["features"].update(profile.at("features"));
  json line = profile.at("constraints")[0];
  line["lengths"] = "scale";
  head["constraints"].push_back(line);
  const Figure organic(PLANISH_SHARED_DATA "/disk/cowhead.obj", head);
  CHECK(organic.report.at("converged") == true);
  CHECK(arap(organic.report) > arap(organic.unconstrained));
  const Figure mechanical(PLANISH_SHARED_DATA "/cad/fandisk_open.obj", shared_set("cad/fandisk_open.b"));
  CHECK(mechanical.report.at("converged") == true);
  CHECK(arap(mechanical.report) > arap(mechanical.unconstrained));
}

// ---- the shared sets ----

namespace {

struct Job {
  std::string mesh, constraints;
};

std::vector<Job> shared_jobs() {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(PLANISH_SHARED_DATA)) {
    if (entry.path().string().ends_with(".constraints.json")) files.insert(entry.path());
  }
  std::vector<Job> jobs;
  for (const auto& file : files) {
    const std::string name = file.filename().string(), stem = name.substr(0, name.find('.'));
    for (const char* extension : {".obj", ".ply", ".off", ".stl"}) {
      const auto mesh = file.parent_path() / (stem + extension);
      if (std::filesystem::exists(mesh)) jobs.push_back({mesh.string(), file.string()});
    }
  }
  return jobs;
}

/// "" where the set is met and nothing but flips remains, else what went wrong.
std::string fault_of(const Job& job) {
  const Scratch scratch;
  const Ran ran = run("flatten " + job.mesh + " -c " + job.constraints + " -o " + scratch.file("o.ply") +
                      " --report " + scratch.file("r.json"));
  const std::string name = job.constraints + ": exit " + std::to_string(ran.code) + ": ";
  if (ran.code != 0 && ran.code != 6) return name + ran.err;
  const json report = json::parse(content_of(scratch.file("r.json")));
  const bool flips = report.at("flipped_triangles") > 0 || report.at("overwound_vertices") > 0;
  if (report.at("converged") != true) return name + "not converged";
  if ((ran.code == 6) != flips) return name + ran.err;
  const Ran check = checked(job.constraints, scratch.file("o.ply"), scratch.file("r.json"));
  return check.code == 0 ? "" : name + check.out;
}

}  // namespace

TEST_CASE("constraints: every set of the shared data is met, and nothing but flips remains") {
  if (absent(PLANISH_SHARED_DATA)) return;
  const std::vector<Job> jobs = shared_jobs();
  CHECK(jobs.size() >= 31);
  const auto faults_from = [&](std::size_t first) {
    std::vector<std::string> faults;
    for (std::size_t k = first; k < jobs.size(); k += 2) faults.push_back(fault_of(jobs[k]));
    return faults;
  };
  auto others = std::async(std::launch::async, faults_from, 1);
  for (const std::string& fault : faults_from(0)) CHECK_MESSAGE(fault.empty(), fault);
  for (const std::string& fault : others.get()) CHECK_MESSAGE(fault.empty(), fault);
}
