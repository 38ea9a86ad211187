// Features put into edges, seams and cuts, from outside: what is written is judged by a check that knows nothing
// of planish.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <future>
#include <map>
#include <set>
#include <sstream>
#include <vector>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

using namespace planish::tests;
using nlohmann::json;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string vertex_line(double x, double y, double z) {
  std::ostringstream line;
  line.precision(17);
  line << "v " << x << ' ' << y << ' ' << z << '\n';
  return line.str();
}

/// Two triangles a unit square of the grid [x0, x0 + n] x [0, n], z = 0, without the square at (hole, hole); its
/// vertices are counted row by row from `first`. A square has the diagonal from lower left to upper right.
std::string grid(int n, double x0, int first, int hole = -1) {
  std::ostringstream text;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) text << vertex_line(x0 + i, j, 0);
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

/// 5 x 5 squares with a hole in the middle (vertices 0 to 35), and apart from them 2 x 2 squares (36 to 44).
std::string plate() { return grid(5, 0, 0, 2) + grid(2, 10, 36); }

/// The unit cube; vertices 0 1 2 3 around the bottom, 4 5 6 7 above them.
constexpr const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 "
    "5 8\n";

/// A torus of n x n vertices, radii 2 and 1.
std::string torus(int n) {
  std::ostringstream text;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double a = 2 * 3.14159265358979 * i / n, b = 2 * 3.14159265358979 * j / n;
      text << vertex_line((2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b));
    }
  }
  const auto at = [n](int i, int j) { return std::to_string((i % n) * n + j % n + 1) + " "; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      text << "f " << at(i, j) << at(i + 1, j) << at(i + 1, j + 1) << "\nf " << at(i, j) << at(i + 1, j + 1)
           << at(i, j + 1) << '\n';
    }
  }
  return text.str();
}

std::string with_features(const std::string& features) {
  return "{\"version\": 1, \"features\": {" + features + "}}";
}

/// Exit code and words of the independent check.
Ran checked(const std::string& input, const std::string& output, const std::string& report,
            const std::string& constraints) {
  const Scratch scratch;
  const std::string command = "python3 -B " PLANISH_TESTS "/independent_embedding_check.py " + input + " " +
                              output + " " + report + " " + constraints + " >" + scratch.file("said") +
                              " 2>&1";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(scratch.file("said")), ""};
}

/// Embeds and checks; "" or what went wrong.
std::string fault_of(const std::string& mesh, const std::string& constraints) {
  const Scratch scratch;
  const Ran ran = run("embed --quiet " + mesh + " -c " + constraints + " -o " + scratch.file("o.ply") +
                      " --report " + scratch.file("r.json"));
  if (ran.code != 0) return constraints + ": exit " + std::to_string(ran.code) + ": " + ran.err;
  const Ran check = checked(mesh, scratch.file("o.ply"), scratch.file("r.json"), constraints);
  return check.code == 0 ? "" : constraints + ": " + check.out;
}

struct Job {
  std::string mesh, constraints;
};

/// All *.constraints.json with their meshes; of meshes above 20,000 triangles only the first set.
std::vector<Job> shared_jobs(const std::filesystem::path& root) {
  constexpr std::array<const char*, 4> kLarge = {"violin", "beetle", "cowhead", "camelhead"};
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().string().ends_with(".constraints.json")) files.insert(entry.path());
  }
  std::vector<Job> jobs;
  for (const auto& file : files) {
    const std::string name = file.filename().string(), stem = name.substr(0, name.find('.'));
    if (std::ranges::find(kLarge, stem) != kLarge.end() && !has(name, ".a.")) continue;
    for (const char* extension : {".obj", ".ply", ".off", ".stl"}) {
      const auto mesh = file.parent_path() / (stem + extension);
      if (std::filesystem::exists(mesh)) jobs.push_back({mesh.string(), file.string()});
    }
  }
  return jobs;
}

/// Every second job from `first` on, so that two cores have the same to do.
std::vector<std::string> faults_of(const std::vector<Job>& jobs, std::size_t first) {
  std::vector<std::string> faults;
  for (std::size_t k = first; k < jobs.size(); k += 2)
    faults.push_back(fault_of(jobs[k].mesh, jobs[k].constraints));
  return faults;
}

int count_lines(const std::string& text, const std::string& begin) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) count += line.starts_with(begin) ? 1 : 0;
  return count;
}

/// The numbers of the v lines, bit for bit.
std::vector<double> coordinates(const std::string& obj) {
  std::istringstream lines(obj);
  std::vector<double> found;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("v ")) continue;
    std::istringstream words(line.substr(2));
    for (double x; words >> x;) found.push_back(x);
  }
  return found;
}

}  // namespace

TEST_CASE("embed: every constraint file of the shared data passes the independent check") {
  const std::string folder = PLANISH_SHARED_DATA;
  if (!std::filesystem::exists(folder)) {
    MESSAGE("left out: no ", folder);
    return;
  }
  const std::vector<Job> jobs = shared_jobs(folder);
  CHECK(jobs.size() >= 28);
  auto others = std::async(std::launch::async, [&] { return faults_of(jobs, 1); });
  for (const std::string& fault : faults_of(jobs, 0)) CHECK_MESSAGE(fault.empty(), fault);
  for (const std::string& fault : others.get()) CHECK_MESSAGE(fault.empty(), fault);
}

TEST_CASE("embed: sampled panels with their features pass the independent check") {
  for (const std::string kind : {"hood", "fender", "door"}) {
    const Scratch scratch;
    REQUIRE(run("sample " + kind + " --triangles 4000 --noise 0.0002 -o " + scratch.file("in.ply") +
                " --features " + scratch.file("c.json"))
                .code == 0);
    const std::string fault = fault_of(scratch.file("in.ply"), scratch.file("c.json"));
    CHECK_MESSAGE(fault.empty(), fault);
  }
}

TEST_CASE("embed: every kind of feature passes the independent check") {
  const Scratch scratch;
  write(scratch.file("plate.obj"), plate());
  write(scratch.file("cube.obj"), kCube);
  write(scratch.file("torus.obj"), torus(24));
  write(scratch.file("line.csv"), "x,y,z\n0.25,0.6,0\n4.75,0.6,0\n");
  const std::pair<const char*, const char*> cases[] = {
      {"plate.obj", R"("a": {"polyline": [[0.5, 0.5, 0.001], [4.5, 0.7, 0], [4.3, 4.5, 0]]},
                       "across": {"polyline": [[1.5, 0.2, 0], [1.5, 4.8, 0]]},
                       "through vertices": {"polyline": [[0, 4, 0], [1, 5, 0]]},
                       "ring": {"polyline": [[0.3, 0.3, 0], [1.7, 0.3, 0], [1.7, 1.6, 0]], "closed": true},
                       "inside": {"enclosed_by": "ring"}, "outside": {"enclosed_by": "ring", "seed": [3, 0.5, 0]})"},
      {"plate.obj",
       R"("rim": {"loop": 0}, "hole": {"boundary_near": [2.5, 2.5, 0]}, "patch": {"triangles": [0, 1, 3]},
                       "row": {"vertices": [6, 7, 8, 9]}, "far": {"vertices": [12, 29], "join": "shortest"},
                       "cut": {"plane_cut": {"point": [0, 0.3, 0], "normal": [0.1, 2, 0], "near": [1, 0.3, 0]}},
                       "csv": {"file": "line.csv"})"},
      {"cube.obj", R"("edge": {"sharp_edges": {"degrees": 40, "near": [0.5, 0, 0]}},
                      "belt": {"plane_cut": {"point": [0.5, 0.5, 0.4], "normal": [0.1, 0.2, 1], "near": [1, 0, 0.4]}},
                      "half": {"enclosed_by": "belt", "seed": [0.5, 0.5, 0]})"},
      {"torus.obj", R"("a": {"plane_cut": {"point": [0, 0, 0.1], "normal": [0, 0, 1], "near": [3, 0, 0.1]}},
                       "b": {"plane_cut": {"point": [0, 0, 0], "normal": [1, -1.1, 0], "near": [2, 2, 1]}})"}};
  for (const auto& [mesh, features] : cases) {
    write(scratch.file("c.json"), with_features(features));
    const std::string fault = fault_of(scratch.file(mesh), scratch.file("c.json"));
    CHECK_MESSAGE(fault.empty(), fault);
  }
}

TEST_CASE("embed: the independent check finds what is wrong") {
  const Scratch scratch;
  const std::string mesh = scratch.file("plate.obj"), wanted = scratch.file("c.json"),
                    output = scratch.file("o.ply"), report = scratch.file("r.json");
  write(mesh, plate());
  write(wanted, with_features(R"("a": {"polyline": [[0.5, 0.5, 0.001], [4.5, 0.7, 0]]})"));
  REQUIRE(run("embed " + mesh + " -c " + wanted + " -o " + output + " --report " + report).code == 0);
  REQUIRE(checked(mesh, output, report, wanted).code == 0);
  const std::string good = content_of(output);
  const auto refused = [&](const json& altered, const std::string& part) {
    write(report, altered.dump());
    const Ran check = checked(mesh, output, report, wanted);
    CHECK(check.code == 1);
    CHECK_MESSAGE(has(check.out, "DISAGREES " + part), check.out);
  };
  const json right = json::parse(content_of(report));
  json altered = right;
  altered["features"]["a"]["length"] = right["features"]["a"]["length"].get<double>() * (1 + 1e-11);
  refused(altered, "a: length");
  altered = right;
  altered["features"]["a"]["max_deviation"] = 0.0005;
  refused(altered, "a: max_deviation");
  altered = right;
  altered["features"]["a"]["vertices"].erase(3);
  refused(altered, "a: steps that are no edge");
  altered = right;
  altered["embedding"]["vertices_added"] = 1;
  refused(altered, "vertices_added");
  // A byte of x of the first and of the last vertex; a row is x y z, origin_triangle, b0 b1 b2.
  const std::size_t body = good.find("end_header\n") + 11, row = 6 * 8 + 4;
  const std::size_t added = right["embedding"]["vertices_added"].get<std::size_t>();
  for (const auto& [place, part] : {std::pair{std::size_t{6}, "vertices of the input that moved"},
                                    {(45 + added - 1) * row + 6, "new vertices farther than"}}) {
    std::string bytes = good;
    bytes[body + place] = static_cast<char>(bytes[body + place] ^ 1);
    write(output, bytes);
    refused(right, part);
  }
}

TEST_CASE("embed: the same bytes on 1, 2 and 7 threads") {
  const Scratch scratch;
  REQUIRE(run("sample hood --triangles 20000 -o " + scratch.file("in.ply") + " --features " +
              scratch.file("c.json"))
              .code == 0);
  const auto output = [&](const std::string& threads) {
    run("embed " + scratch.file("in.ply") + " -c " + scratch.file("c.json") + " --threads " + threads +
        " -o " + scratch.file("o.ply"));
    return content_of(scratch.file("o.ply"));
  };
  const std::string one = output("1");
  CHECK(one.size() > 20000 * 13);
  CHECK(output("2") == one);
  CHECK(output("7") == one);
}

TEST_CASE("embed: OBJ has the chains as l lines under their names, closed ones back to their start") {
  const Scratch scratch;
  write(scratch.file("plate.obj"), plate());
  write(scratch.file("c.json"), with_features(R"("sill": {"polyline": [[0.5, 0.5, 0], [4.5, 0.5, 0]]},
                                                 "hole": {"boundary_near": [2.5, 2.5, 0]})"));
  REQUIRE(run("embed " + scratch.file("plate.obj") + " -c " + scratch.file("c.json") + " -o " +
              scratch.file("o.obj") + " --report " + scratch.file("r.json") + " --picture " +
              scratch.file("p.svg"))
              .code == 0);
  const std::string obj = content_of(scratch.file("o.obj"));
  const json features = json::parse(content_of(scratch.file("r.json"))).at("features");
  for (const auto& [name, feature] : features.items()) {
    std::string line = "g " + name + "\nl";
    for (const int v : feature.at("vertices")) line += " " + std::to_string(v + 1);
    if (feature.at("closed")) line += " " + std::to_string(feature.at("vertices").front().get<int>() + 1);
    CHECK_MESSAGE(has(obj, line + "\n"), obj);
  }
  CHECK(count_lines(obj, "l ") == 2);
  const std::vector<double> before = coordinates(plate()), after = coordinates(obj);
  CHECK(after.size() > before.size());
  CHECK(std::equal(before.begin(), before.end(), after.begin()));
  CHECK(has(content_of(scratch.file("p.svg")), "<svg"));
}

namespace {

struct Bad {
  const char* features;  // or the whole file, where it begins with a brace
  int code;
  const char* name;     // of the error
  const char* pointer;  // JSON pointer of the place
  const char* message;  // part of it
  const char* ids;      // JSON
};

const Bad kBad[] = {
    // polylines
    {R"("a": {"polyline": [[0.5, 0.5, 0], [0.5, 7, 0]]})", 5, "feature-too-far", "/features/a",
     "feature \"a\": point 1 is 2 from the surface, 0.065 allowed", "[1]"},
    {R"("a": {"polyline": [[0.5, 0.5, 0], [1.5, 0.5, 0.5]], "max_distance": 0.1})", 5, "feature-too-far",
     "/features/a", "point 1 is 0.5 from the surface, 0.1 allowed", "[1]"},
    {R"("a": {"polyline": [[0.5, 2.5, 0], [4.5, 2.5, 0]]})", 5, "feature-leaves-surface", "/features/a",
     "no path over the surface stays within 0.04 of the polyline", "[0, 1]"},
    {R"("a": {"polyline": [[3.5, 0.5, 0], [4.5, 0.5, 0], [10.5, 0.5, 0]]})", 5, "feature-leaves-surface",
     "/features/a", "feature \"a\": point 2 lies on another component", "[2]"},
    {R"("a": {"polyline": [[0.5, 2.5, 0]]})", 5, "feature-broken", "/features/a",
     "a polyline needs 2 points, 1 given", "[]"},
    {R"("a": {"polyline": [[0, 0, 0], [1, 1, 0], [1, 1, 0]]})", 5, "feature-broken", "/features/a",
     "points that repeat the one before", "[2]"},
    {R"("a": {"polyline": [[0, 0, 0], [1, 1, 0], [0, 0, 0]], "closed": true})", 5, "feature-broken",
     "/features/a", "points that repeat the one before", "[0]"},
    {R"("a": {"polyline": [[0, 0, 0], [NaN, 1, 0]]})", 3, "bad-syntax", "/features/a/polyline/1/0",
     "JSON has neither NaN nor infinity", "[]"},
    {R"("a": {"polyline": [[0, 0, 0], [1e999, 1, 0]]})", 3, "bad-syntax", "/features/a/polyline/1/0",
     "number overflow", "[]"},
    {R"("a": {"polyline": [[0, 0, 0], [null, 1, 0]]})", 3, "bad-syntax", "/features/a/polyline/1/0",
     "expected a number, found null", "[]"},
    {R"("a": {"polyline": [[0, 0], [1, 1]]})", 3, "bad-syntax", "/features/a/polyline/0",
     "expected a point of 3 numbers, found an array of 2", "[]"},
    {R"("a": {"file": "absent.csv"})", 3, "cannot-open", "/features/a/file", "absent.csv: cannot open", "[]"},
    // chains
    {R"("a": {"vertices": [0, 1, 2]}, "b": {"vertices": [2, 1]})", 5, "features-overlap", "/features/b",
     "feature \"b\": it runs against feature \"a\"", "[2, 1]"},
    {R"("a": {"polyline": [[0, 1, 0], [4, 1, 0]]}, "b": {"vertices": [8, 7]})", 5, "features-overlap",
     "/features/b", "feature \"b\": it runs against feature \"a\"", "[8, 7]"},
    {R"("a": {"vertices": [0, 1, 3]})", 5, "feature-broken", "/features/a",
     "vertices 1 and 3 share no edge of the mesh", "[1, 3]"},
    {R"("a": {"vertices": [0, 1, 8], "closed": true})", 5, "feature-broken", "/features/a",
     "vertices 8 and 0 share no edge of the mesh", "[8, 0]"},
    {R"("a": {"vertices": [0, 1, 1]})", 5, "feature-broken", "/features/a", "some are listed several times",
     "[1]"},
    {R"("a": {"vertices": [0]})", 5, "feature-broken", "/features/a",
     "an open chain needs at least 2 vertices", "[]"},
    // indices
    {R"("a": {"vertices": [0, 99]})", 5, "feature-broken", "/features/a/vertices/1",
     "names vertex 99, but the mesh has 45 vertices", "[99]"},
    {R"("a": {"triangles": [0, 56]})", 5, "region-broken", "/features/a/triangles/1",
     "names triangle 56, but the mesh has 56 triangles", "[56]"},
    {R"("a": {"loop": 7})", 5, "feature-broken", "/features/a",
     "names boundary loop 7, but the surface has 3 loops", "[]"},
    {R"("a": {"vertices": [0, -1]})", 3, "bad-syntax", "/features/a/vertices/1",
     "expected an index (a whole number from 0 to 2147483647), found -1", "[]"},
    {R"({"version": 1, "features": {"a": {"loop": 0}}, "constraints": [{"type": "pin", "vertices": [999], "uv": [[0, 0]]}]})",
     5, "constraint-invalid", "/constraints/0/vertices/0", "names a vertex that does not exist", "[999]"},
    {R"("a": {"polyline": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]]})", 5, "feature-broken", "/features/a",
     "the last point is the first again", "[3]"},
    // regions
    {R"("a": {"vertices": [0, 1]}, "b": {"enclosed_by": "a"})", 5, "region-broken", "/features/b",
     "\"a\" is open; only a closed feature encloses triangles", "[]"},
    {R"("a": {"triangles": [0, 9]})", 5, "region-broken", "/features/a", "is in 2 pieces that share no edge",
     "[0, 9]"},
    // words
    {R"("a": {"polylin": [[0, 0, 0], [1, 1, 0]]})", 3, "bad-syntax", "/features/a/polylin",
     "unknown key 'polylin', the nearest known one is 'polyline'", "[]"},
    {R"({"version": 1, "feature": {}})", 3, "bad-syntax", "/feature",
     "unknown key 'feature', the nearest known one is 'features'", "[]"},
    {R"("a/b": {"polyline": "x"})", 3, "bad-syntax", "/features/a~1b/polyline",
     "expected an array of points, found the string 'x'", "[]"},
    {R"("a": {"loop": 0.5})", 3, "bad-syntax", "/features/a/loop", "expected an index", "[]"},
    {R"("sill": {"loop": 0}, "p": {"enclosed_by": "sil"})", 3, "bad-syntax", "/features/p/enclosed_by",
     "unknown feature 'sil', the nearest known one is 'sill'", "[]"},
    {R"({"version": 1, "features": {"sill": {"loop": 0}}, "seams": ["sil"]})", 3, "bad-syntax", "/seams/0",
     "unknown feature 'sil', the nearest known one is 'sill'", "[]"},
    {R"({"version": 1, "features": {"sill": {"loop": 0}}, "constraints": [{"type": "line", "feature": "sil"}]})",
     3, "bad-syntax", "/constraints/0/feature", "unknown feature 'sil', the nearest known one is 'sill'",
     "[]"},
    {R"("a": {"loop": 0}, "a": {"loop": 1})", 3, "bad-syntax", "/features/a",
     "the name 'a' stands twice in one object", "[]"},
    {R"({"version": 2})", 3, "bad-syntax", "/version", "this program reads version 1, found the number 2",
     "[]"},
    {R"({"version": 1})", 5, "constraint-invalid", "/features", "there are no features to embed", "[]"},
};

}  // namespace

TEST_CASE("embed: bad constraint files are refused with name, place and ids, and nothing is written") {
  const Scratch scratch;
  const std::string mesh = scratch.file("plate.obj"), constraints = scratch.file("c.json");
  write(mesh, plate());
  const std::string arguments = " " + mesh + " -c " + constraints + " -o " + scratch.file("o.ply") +
                                " --report " + scratch.file("r.json") + " --picture " + scratch.file("p.png");
  for (const Bad& bad : kBad) {
    CAPTURE(bad.features);
    write(constraints, bad.features[0] == '{' ? bad.features : with_features(bad.features));
    const Ran plain = run("embed" + arguments);
    CHECK(plain.code == bad.code);
    CHECK(plain.out.empty());
    CHECK_MESSAGE(plain.err.find('\n') == plain.err.size() - 1, plain.err);
    for (const std::string part : {bad.message, "c.json", bad.name}) {
      CHECK_MESSAGE(has(plain.err, part), plain.err);
    }
    CHECK(scratch.count() == 2);
    const Ran as_json = run("embed --json-errors" + arguments);
    const json error = json::parse(as_json.err).at("error");
    CHECK(as_json.code == bad.code);
    CHECK(error.at("exit_code") == bad.code);
    CHECK(error.at("code") == bad.name);
    CHECK(error.at("pointer") == bad.pointer);
    CHECK(error.at("ids") == json::parse(bad.ids));
    CHECK(scratch.count() == 2);
  }
}

namespace {

/// A map with several vt a vertex.
struct Obj {
  std::vector<std::array<double, 2>> uv;
  std::vector<std::array<std::pair<int, int>, 3>> faces;  // v and vt, from 1
};

Obj parse_obj(const std::string& text) {
  std::istringstream lines(text);
  Obj obj;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(std::min<std::size_t>(line.size(), line.find(' '))));
    if (line.starts_with("vt ")) {
      auto& uv = obj.uv.emplace_back();
      words >> uv[0] >> uv[1];
    } else if (line.starts_with("f ")) {
      char slash;
      for (auto& [v, vt] : obj.faces.emplace_back()) words >> v >> slash >> vt;
    }
  }
  return obj;
}

/// Undirected edges between triangles whose two sides lie apart in the map.
std::set<std::pair<int, int>> cut_edges(const Obj& obj) {
  std::map<std::pair<int, int>, std::set<std::pair<int, int>>> sides;
  for (const auto& face : obj.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      auto a = face[i], b = face[(i + 1) % 3];
      if (a > b) std::swap(a, b);
      sides[{a.first, b.first}].insert({a.second, b.second});
    }
  }
  std::set<std::pair<int, int>> cut;
  for (const auto& [edge, images] : sides) {
    if (images.size() > 1) cut.insert(edge);
  }
  return cut;
}

bool all_positive(const Obj& obj) {
  return std::ranges::all_of(obj.faces, [&](const auto& face) {
    const auto &a = obj.uv[face[0].second - 1], &b = obj.uv[face[1].second - 1],
               &c = obj.uv[face[2].second - 1];
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0;
  });
}

/// Flattens, and checks what any opened surface must keep.
Obj opened(const Scratch& scratch, const std::string& mesh, const std::string& options, json& report) {
  write(scratch.file("in.obj"), mesh);
  for (const char* output : {"o.ply", "o.obj"}) {
    const Ran ran = run("flatten " + scratch.file("in.obj") + options + " -o " + scratch.file(output) +
                        " --report " + scratch.file("r.json"));
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
  }
  report = json::parse(content_of(scratch.file("r.json")));
  const std::string obj = content_of(scratch.file("o.obj")), ply = content_of(scratch.file("o.ply"));
  const bool same_vertices = coordinates(obj) == coordinates(mesh);
  CHECK(same_vertices);
  CHECK(has(ply.substr(0, 1000), "element vertex " + std::to_string(count_lines(mesh, "v ")) + "\n"));
  CHECK(has(ply.substr(0, 1000), "property list uchar double texcoord\n"));
  Obj parsed = parse_obj(obj);
  CHECK(static_cast<int>(parsed.faces.size()) == count_lines(mesh, "f "));
  CHECK(parsed.uv.size() == report.at("mesh").at("vertices"));
  CHECK(all_positive(parsed));
  CHECK(report.at("flipped_triangles") == 0);
  CHECK(static_cast<std::size_t>(report.at("cut").at("cut_edges")) == cut_edges(parsed).size());
  return parsed;
}

}  // namespace

TEST_CASE("seams: a cube opens along the edges of its seams and along no others") {
  const Scratch scratch;
  // Three sides of the lid, the four upright edges: a cross of six squares.
  write(scratch.file("c.json"), R"({"version": 1, "features": {"lid": {"vertices": [5, 6, 7, 4]},
    "a": {"vertices": [0, 4]}, "b": {"vertices": [1, 5]}, "c": {"vertices": [2, 6]}, "d": {"vertices": [3, 7]}},
    "seams": ["lid", "a", "b", "c", "d"]})");
  json report;
  const Obj map = opened(scratch, kCube, " -c " + scratch.file("c.json"), report);
  const std::set<std::pair<int, int>> expected = {{6, 7}, {7, 8}, {5, 8}, {1, 5}, {2, 6}, {3, 7}, {4, 8}};
  CHECK(cut_edges(map) == expected);
  CHECK(map.uv.size() == 14);  // corners of a cross
  CHECK(report.at("mesh").at("euler") == 1);
  CHECK(report.at("cut").at("cut_length").get<double>() == doctest::Approx(7).epsilon(1e-14));
  CHECK(report.at("energy").at("arap").get<double>() < 1e-20);  // a cross is isometric
}

TEST_CASE("seams: a closed seam around the bottom of a cube makes two charts, a region is no seam") {
  const Scratch scratch;
  write(scratch.file("c.json"),
        R"({"version": 1, "features": {"a": {"vertices": [0, 1, 2, 3], "closed": true}}, "seams": ["a"]})");
  json report;
  const Obj map = opened(scratch, kCube, " -c " + scratch.file("c.json"), report);
  CHECK(cut_edges(map) == std::set<std::pair<int, int>>{{1, 2}, {2, 3}, {3, 4}, {1, 4}});
  CHECK(report.at("cut").at("charts") == 2);
  CHECK(report.at("overlapping_pairs") == 0);  // side by side
  write(scratch.file("c.json"),
        R"({"version": 1, "features": {"a": {"triangles": [0, 1]}}, "seams": ["a"]})");
  const std::size_t files = scratch.count();
  const Ran region = run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                         scratch.file("other.obj"));
  CHECK(region.code == 5);
  CHECK_MESSAGE(has(region.err, "/seams/0: 'a' is a region, a curve is needed here [constraint-invalid]"),
                region.err);
  CHECK(scratch.count() == files);
}

TEST_CASE("cut: a cube and a torus are refused without --cut, and flatten with --cut auto") {
  for (const bool is_torus : {false, true}) {
    const Scratch scratch;
    const std::string mesh = is_torus ? torus(16) : kCube;
    write(scratch.file("in.obj"), mesh);
    const Ran refused = run("flatten " + scratch.file("in.obj") + " -o " + scratch.file("o.obj"));
    CHECK(refused.code == 4);
    CHECK_MESSAGE(has(refused.err, "use --cut auto, or name a seam that opens it [closed-component]"),
                  refused.err);
    CHECK(has(refused.err, "with handles") == is_torus);
    CHECK(scratch.count() == 1);
    json report;
    const Obj map = opened(scratch, mesh, " --cut auto", report);
    const std::size_t vertices = is_torus ? 256 : 8, cut = cut_edges(map).size();
    // A tree of k cut edges makes V + k - 1 vertices of V; two loops that open a torus, V + k + 1.
    CHECK(map.uv.size() == vertices + cut + (is_torus ? 1 : -1));
    CHECK(report.at("mesh").at("euler") == 1);
    CHECK(report.at("mesh").at("boundary_loops") == 1);
    CHECK(report.at("cut").at("charts") == 1);
  }
}

TEST_CASE("cut: two closed parts become two charts side by side, and an open mesh stays as it is") {
  const Scratch scratch;
  std::istringstream lines(kCube);
  std::string vertices, faces;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(1));
    double x = 0, y = 0, z = 0;
    words >> x >> y >> z;
    if (line[0] == 'v') vertices += vertex_line(x + 3, y, z);
    if (line[0] == 'f')
      faces += "f " + std::to_string(int(x) + 8) + " " + std::to_string(int(y) + 8) + " " +
               std::to_string(int(z) + 8) + "\n";
  }
  json report;
  opened(scratch, kCube + vertices + faces, " --cut auto", report);
  CHECK(report.at("cut").at("charts") == 2);
  CHECK(report.at("overlapping_pairs") == 0);
  write(scratch.file("plate.obj"), plate());
  const Ran plain = run("flatten " + scratch.file("plate.obj") + " -o " + scratch.file("a.ply"));
  const Ran cut = run("flatten --cut auto " + scratch.file("plate.obj") + " -o " + scratch.file("b.ply"));
  CHECK(plain.code == 0);
  CHECK(cut.code == 0);
  CHECK(has(cut.out, "cut 0 edges"));
}
