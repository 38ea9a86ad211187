// Small meshes and constraint files for the program's tests, and results that are checked by what knows nothing of planish.
#pragma once

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
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

namespace planish::tests {

using nlohmann::json;

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// ---- meshes ----

using Point = std::array<double, 3>;

inline std::string vertex_line(Point p) {
  std::ostringstream line;
  line.precision(17);
  line << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  return line.str();
}

/// Two triangles a square of n x n squares, without the square at (hole, hole); vertices are counted row by row from
/// `first`. A square has the diagonal from lower left to upper right.
inline std::string grid(int n, int first, const std::function<Point(double, double)>& at, int hole = -1) {
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
inline double height(double x, double y, int n) {
  const double s = 2 * x / n - 1, t = 2 * y / n - 1;
  return 0.3 * (1 - s * s) * (1 - t * t) + 0.05 * x;
}

/// 6 x 6 squares: vertices 0 to 48, 7 a row.
inline std::string dome() {
  return grid(6, 0, [](double x, double y) { return Point{x, y, height(x, y, 6)}; });
}

/// The dome, wider at its upper end.
inline std::string wedge() {
  return grid(6, 0, [](double x, double y) { return Point{x * (1 + 0.1 * y), y, height(x, y, 6)}; });
}

/// A pipe of 24 x 8 squares, radius 1, along z.
inline std::string pipe() {
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

inline std::string file_of(const std::string& features, const std::string& constraints,
                           const std::string& more) {
  return "{\"version\": 1, \"features\": {" + features + "}, \"constraints\": [" + constraints + "]" + more +
         "}";
}

inline std::string join(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// Lines with the same further keys.
inline std::string lines(const std::vector<std::string>& names, const std::string& keys = "") {
  std::vector<std::string> parts;
  for (const std::string& name : names)
    parts.push_back(R"({"type": "line", "feature": ")" + name + "\"" + keys + "}");
  return join(parts);
}

constexpr const char* kScaled = R"(, "lengths": "scale")";

/// Three right angles between four sides.
inline std::string right_angles(const std::array<std::string, 4>& side) {
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
inline Ran checked(const std::string& constraints, const std::string& output, const std::string& report) {
  const Scratch scratch;
  const std::string command = "python3 -B " PLANISH_TESTS "/independent_constraint_check.py " + constraints +
                              " " + output + " " + report + " >" + scratch.file("said") + " 2>&1";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(scratch.file("said")), ""};
}

/// The program's own answer about what it wrote.
inline Ran verified(const std::string& constraints, const std::string& output, const std::string& report) {
  return run("verify " + output + " -c " + constraints + " --report " + report);
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
inline Solved solve(const Scratch& scratch, const std::string& mesh, const std::string& constraints,
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
  const Ran own = verified(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
  CHECK_MESSAGE(own.code == (solved.report.at("overlapping_pairs") == 0 ? 0 : 6), (own.out + own.err));
  CHECK_MESSAGE(!has(own.out, "wrong:"), own.out);
  return solved;
}

inline Solved solve(const std::string& mesh, const std::string& constraints, const std::string& more = "") {
  return solve(Scratch(), mesh, constraints, more);
}

/// The image of each vertex in an OBJ; of several the last.
inline std::vector<std::complex<double>> images(const std::string& path) {
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

/// What a schema of docs has against a file, "" where nothing; "absent" where there is no jsonschema to ask.
inline std::string schema_fault(const std::string& schema, const std::string& file) {
  const Scratch scratch;
  write(scratch.file("validate.py"), R"(
import json, sys
try: import jsonschema
except ImportError: sys.exit("absent")
schema, answer = (json.load(open(path)) for path in sys.argv[1:])
jsonschema.Draft202012Validator.check_schema(schema)
faults = [f"{e.json_path}: {e.message}" for e in jsonschema.Draft202012Validator(schema).iter_errors(answer)]
sys.exit("; ".join(faults)[:2000] if faults else 0)
)");
  const std::string command = "python3 -B " + scratch.file("validate.py") + " " PLANISH_DOCS "/" + schema +
                              " " + file + " 2>" + scratch.file("said");
  const bool valid = std::system(command.c_str()) == 0;
  const std::string said = content_of(scratch.file("said"));
  return valid ? "" : said.starts_with("absent") ? "absent" : "invalid: " + said;
}

inline bool absent(const std::string& folder) {
  if (std::filesystem::exists(folder)) return false;
  MESSAGE("left out: no ", folder);
  return true;
}

}  // namespace planish::tests
