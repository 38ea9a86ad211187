// planish verify: what it finds in files, right ones and wrong ones.
#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

/// Of each kind one, on the dome.
const std::string kEvery = lines({"row"}) + ", " + lines({"high"}, R"(, "lengths": "free")") + ", " +
                           lines({"north"}, R"(, "lengths": "scale", "scale": 1.01)") +
                           R"(, {"type": "circle", "feature": "ring"}, {"type": "curve", "feature": "south"},
    {"type": "region", "feature": "tip"}, {"type": "parallel", "features": ["row", "high"]},
    {"type": "direction", "feature": "row", "degrees": 0},
    {"type": "angle", "features": ["row", "north"], "degrees": 1}, {"type": "pin", "vertices": [48], "uv": [[0, 0]]})";

/// A flattened mesh with its files.
class Flat {
 public:
  Flat(const std::string& mesh, const std::string& features, const std::string& constraints,
       const std::string& output = "o.obj", const std::string& more = "", const std::string& options = "")
      : output_(scratch_.file(output)) {
    write(scratch_.file("in.obj"), mesh);
    write(set(), file_of(features, constraints, more));
    const Ran ran = run("flatten " + scratch_.file("in.obj") + " -c " + set() + " -o " + output_ +
                        " --report " + report() + options);
    REQUIRE_MESSAGE((ran.code == 0 || ran.code == 6), ran.err);
  }

  const std::string& output() const { return output_; }
  std::string set() const { return scratch_.file("c.json"); }
  std::string report() const { return scratch_.file("r.json"); }
  std::string file(const std::string& name) const { return scratch_.file(name); }

  Ran alone() const { return run("verify " + output_); }
  Ran with_report() const { return run("verify " + output_ + " --report " + report()); }
  Ran with_all(const std::string& more = "") const {
    return run("verify " + output_ + " -c " + set() + " --report " + report() + more);
  }

  /// Replaces what stands at a place of the report or of the constraint file.
  void change_report(const std::string& pointer, const json& value) { change(report(), pointer, value); }
  void change_set(const std::string& pointer, const json& value) { change(set(), pointer, value); }

  /// Moves a corner of a triangle of an OBJ across the opposite edge.
  void turn_over(std::size_t triangle, std::array<std::size_t, 3> vertex, std::size_t corner) {
    const auto z = images(output_);
    move(triangle, corner, z[vertex[0]] + z[vertex[1]] + z[vertex[2]] - 3.0 * z[vertex[corner]]);
  }

  /// Mirrors the map of an OBJ.
  void mirror() {
    std::istringstream text(content_of(output_));
    std::ostringstream all;
    for (std::string line; std::getline(text, line); all << line << '\n') {
      const std::size_t v = line.rfind(' ') + 1;
      if (line.starts_with("vt ")) line = line[v] == '-' ? line.erase(v, 1) : line.insert(v, "-");
    }
    write(output_, all.str());
  }

  /// Moves the `vt` of the k-th corner (from 0) of a triangle of an OBJ.
  void move(std::size_t triangle, std::size_t corner, std::complex<double> by) {
    std::istringstream text(content_of(output_));
    std::vector<std::string> rows;
    std::vector<std::size_t> coordinate;
    std::size_t faces = 0, chosen = 0;
    for (std::string line; std::getline(text, line); rows.push_back(line)) {
      if (line.starts_with("vt ")) coordinate.push_back(rows.size());
      if (!line.starts_with("f ") || faces++ != triangle) continue;
      std::istringstream words(line.substr(2));
      std::string word;
      for (std::size_t k = 0; k <= corner; ++k) words >> word;
      chosen = std::stoul(word.substr(word.find('/') + 1)) - 1;
    }
    std::istringstream old(rows[coordinate[chosen]].substr(3));
    double u = 0, v = 0;
    old >> u >> v;
    std::ostringstream moved, all;
    moved.precision(17);
    moved << "vt " << u + by.real() << ' ' << v + by.imag();
    rows[coordinate[chosen]] = moved.str();
    for (const std::string& row : rows) all << row << '\n';
    write(output_, all.str());
  }

 private:
  static void change(const std::string& path, const std::string& pointer, const json& value) {
    json content = json::parse(content_of(path));
    content[json::json_pointer(pointer)] = value;
    write(path, content.dump());
  }

  Scratch scratch_;
  std::string output_;
};

/// The place of a constraint in the report.
std::string entry(const Flat& flat, const std::string& name) {
  const json report = json::parse(content_of(flat.report()));
  for (std::size_t k = 0; k < report.at("constraints").size(); ++k) {
    if (report["constraints"][k]["name"] == name) return "/constraints/" + std::to_string(k);
  }
  FAIL("no entry ", name);
  return "";
}

void check_all_holds(const Ran& ran) {
  CHECK_MESSAGE(ran.code == 0, (ran.out + ran.err));
  CHECK_MESSAGE(has(ran.out, "all holds"), ran.out);
  CHECK_MESSAGE(!has(ran.out, "wrong:"), ran.out);
}

void check_says(const Ran& ran, const std::string& part) {
  CAPTURE(part);
  CHECK_MESSAGE(ran.code == 6, (ran.out + ran.err));
  CHECK_MESSAGE(has(ran.out, part), ran.out);
}

void check_refused(const std::string& arguments, int code, const std::string& part) {
  CAPTURE(arguments);
  const Ran ran = run("verify " + arguments);
  CHECK(ran.code == code);
  CHECK_MESSAGE(has(ran.err, part), ran.err);
  CHECK(ran.out.empty());
}

const std::string kDomeFeatures = std::string(kFeatures) + R"(, "tip": {"triangles": [0, 1]})";

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

}  // namespace

// ---- what is right ----

TEST_CASE("verify: what flatten writes holds, in every format, with and without the files beside it") {
  for (const char* output : {"o.obj", "o.ply", "o.obj.gz", "o.ply.gz"}) {
    CAPTURE(output);
    const Flat flat(dome(), kDomeFeatures, kEvery, output);
    check_all_holds(flat.alone());
    check_all_holds(flat.with_report());
    const Ran all = flat.with_all();
    check_all_holds(all);
    CHECK_MESSAGE(has(all.out, R"(constraint "line row" (line): residual )"), all.out);
    CHECK(has(flat.with_report().out,
              R"(constraint "pin 48" (pin): not measured, its places are in the constraint file)"));
  }
}

TEST_CASE("verify: uv of a PLY are found under all spellings, and the answer says under which") {
  const Flat flat(dome(), kDomeFeatures, kEvery, "o.ply");
  const std::string written = content_of(flat.output());
  for (const auto& [u, v, name] :
       {std::array{"u", "v", "uv"}, std::array{"texture_u", "texture_v", "texture_uv"}}) {
    std::string renamed = written;
    for (const auto& [from, to] : {std::pair{"double s\n", u}, std::pair{"double t\n", v}})
      renamed.replace(renamed.find(from), std::string(from).size(), "double " + std::string(to) + "\n");
    write(flat.output(), renamed);
    const Ran ran = flat.with_all();
    check_all_holds(ran);
    CHECK_MESSAGE(has(ran.out, "uv from " + std::string(name)), ran.out);
  }
}

TEST_CASE("verify: of several uv sets the first counts, and is named") {
  const Scratch scratch;
  write(scratch.file("m.ply"),
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nproperty double s\nproperty double t\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0 0 0\n1 0 0 0 1 1 0\n0 1 0 1 0 0 1\n3 0 1 2\n");
  const Ran ran = run("verify " + scratch.file("m.ply"));
  check_all_holds(ran);
  CHECK_MESSAGE(has(ran.out, "uv from st, the first of 2 sets"), ran.out);
}

TEST_CASE("verify: on a seam each side holds, and a copy that leaves its own side is found there") {
  for (const char* output : {"o.obj", "o.ply"}) {
    CAPTURE(output);
    const Flat flat(pipe(), kPipeFeatures, lines({"seam", "back"}), output, R"(, "seams": ["seam"])");
    const Ran ran = flat.with_all();
    check_all_holds(ran);
    check_all_holds(flat.with_report());
    CHECK(has(ran.out, R"("line seam" (line, side 1))"));
    CHECK(has(ran.out, R"("line seam" (line, side 2))"));
  }
  Flat flat(pipe(), kPipeFeatures, lines({"seam", "back"}), "o.obj", R"(, "seams": ["seam"])");
  flat.move(48, 0, {0, 1e-6});  // vertex 24, left of the seam
  const Ran ran = flat.with_report();
  CHECK(ran.code == 6);
  const std::size_t left = ran.out.find("side 1"), right = ran.out.find("side 2");
  const std::string first = ran.out.substr(left, right - left), second = ran.out.substr(right);
  CHECK_MESSAGE(
      has(first.substr(0, first.find('\n')), "wrong:") != has(second.substr(0, second.find('\n')), "wrong:"),
      ran.out);
}

TEST_CASE("verify: a region that a seam runs through holds by its template, three points a triangle") {
  // The slit ends in the middle of the region.
  Flat flat(
      dome(),
      R"("slit": {"vertices": [3, 10, 17, 24]}, "around": {"triangles": [28, 29, 30, 31, 40, 41, 42, 43]})",
      R"({"type": "region", "feature": "around"})", "o.ply", R"(, "seams": ["slit"])");
  check_all_holds(flat.with_all());
  json report = json::parse(content_of(flat.report()));
  CHECK(report["constraints"][0]["template"].size() == 3 * 8);
  flat.change_report("/constraints/0/template/5/0", 17);
  check_says(flat.with_all(), "its residual is");
}

TEST_CASE("verify: a closed part that was cut open holds as its report says") {
  const Scratch scratch;
  REQUIRE(run("sample cylinder --triangles 400 -o " + scratch.file("in.ply")).code == 0);
  const Ran flat = run("flatten " + scratch.file("in.ply") + " --cut auto -o " + scratch.file("o.ply") +
                       " --report " + scratch.file("r.json"));
  REQUIRE_MESSAGE(flat.code == 0, flat.err);
  check_all_holds(run("verify " + scratch.file("o.ply") + " --report " + scratch.file("r.json")));
}

// ---- what is wrong ----

TEST_CASE("verify: a vertex that was moved by 1e-6 is found, by its constraint and by the energy") {
  Flat flat(dome(), kDomeFeatures, lines({"row"}));
  flat.move(50, 0, {0, 1e-6});  // vertex 29, inside the row
  check_says(flat.with_report(), R"(constraint "line row" (line): residual 1)");
  check_says(flat.with_report(), "arap energy");
  check_all_holds(flat.alone());
  CHECK(checked(flat.set(), flat.output(), flat.report()).code == 1);
}

TEST_CASE("verify: a flipped triangle is found without a report, and with one the report is wrong") {
  Flat flat(dome(), kDomeFeatures, lines({"row"}));
  flat.turn_over(10, {5, 6, 13}, 1);  // vertex 6 has no other triangle
  check_says(flat.alone(), "flipped triangles 1 (triangles 10)");
  check_says(flat.alone(), "does not hold: 1 flipped triangles");
  check_says(flat.with_report(), "wrong: the report says 0 flipped triangles, the map has 1");
}

TEST_CASE("verify: a fan that winds twice around its middle is overwound") {
  std::ostringstream fan;
  fan << "v 0 0 0.5\nvt 0 0\n";
  for (int i = 0; i < 12; ++i) {
    const auto p = std::polar(1.0, i * 3.14159265358979 / 6), z = p * p;
    fan << vertex_line({p.real(), p.imag(), 0}) << "vt " << z.real() << ' ' << z.imag() << '\n';
  }
  for (int i = 0; i < 12; ++i) {
    const int a = i + 2, b = (i + 1) % 12 + 2;
    fan << "f 1/1 " << a << '/' << a << ' ' << b << '/' << b << '\n';
  }
  const Scratch scratch;
  write(scratch.file("o.obj"), fan.str());
  const Ran ran = run("verify " + scratch.file("o.obj"));
  check_says(ran, "overwound vertices 1 (vertices 0)");
  check_says(ran, "flipped triangles 0");
}

TEST_CASE("verify: two parts that lie on one another overlap, and the pair is named") {
  const Scratch scratch;
  write(scratch.file("o.obj"), kTriangle + std::string("v 5 0 0\nv 6 0 0\nv 5 1 0\nf 4/1 5/2 6/3\n"));
  const Ran ran = run("verify " + scratch.file("o.obj"));
  check_says(ran, "overlapping pairs 1, 0.5 of the area (triangles 0-1)");
  CHECK(has(ran.out, "2 triangles in 2 charts"));
}

TEST_CASE("verify: lies in a report are named") {
  const auto check_lie = [](const std::string& constraint, const std::string& key, const json& value,
                            const std::string& said) {
    Flat flat(dome(), kDomeFeatures, kEvery);
    flat.change_report((constraint.empty() ? "" : entry(flat, constraint)) + key, value);
    check_says(flat.with_all(), said);
    check_says(flat.with_report(), said);
  };
  check_lie("", "/energy/arap", 1e-3, "wrong: the report says an arap energy of 0.001");
  check_lie("", "/flipped_triangles", 1, "wrong: the report says 1 flipped triangles, the map has 0");
  check_lie("", "/overlapping_pairs", 2, "wrong: the report says 2 overlapping pairs, the map has 0");
  check_lie("line row", "/residual", 1e-6, "the report says a residual of 1e-06");
  check_lie("line row", "/keeps_order", false, "the report says that the order along the line is lost");
  check_lie("line row", "/orientation", 45, "its orientation in the map is ");
  check_lie("circle ring", "/scale", 2, "the report says 2");
  check_lie("curve south", "/template/1/1", 0.5, "its residual is");
  check_lie("region tip", "/planarity", 0.5, "its template changes lengths by");
  check_lie("angle row north", "/degrees", 30, "degrees, the report says 30");
}

TEST_CASE("verify: an entry that speaks of another feature than the constraint file is found") {
  Flat flat(dome(), kDomeFeatures, kEvery);
  flat.change_report(entry(flat, "curve south") + "/feature", "north");
  check_says(flat.with_all(),
             "the report and the constraint file name different features, edges or vertices");
}

TEST_CASE("verify: a mirrored template is found") {
  Flat flat(dome(), kDomeFeatures,
            R"({"type": "curve", "feature": "bow"}, {"type": "curve", "feature": "ring"})");
  check_all_holds(flat.with_all());
  for (const char* name : {"curve bow", "curve ring"}) {
    const std::string place = entry(flat, name) + "/template";
    json shape = json::parse(content_of(flat.report()))[json::json_pointer(place)];
    for (json& point : shape) point[1] = -point[1].get<double>();
    flat.change_report(place, shape);
  }
  const Ran ran = flat.with_report();
  check_says(ran, "its template and its image run round in opposite directions");
  check_says(ran, "does not hold: 2 constraints that are wrong");
}

TEST_CASE("verify: map and template that are mirrored both are found by the constraint file") {
  Flat flat(dome(), kDomeFeatures, R"({"type": "curve", "feature": "bow"})");
  const std::string place = entry(flat, "curve bow") + "/template";
  json shape = json::parse(content_of(flat.report()))[json::json_pointer(place)];
  for (json& point : shape) point[1] = -point[1].get<double>();
  flat.change_report(place, shape);
  flat.mirror();
  check_says(flat.with_all(), "its template lies ");
  check_says(flat.with_all(), "flipped triangles 72 (triangles 0, 1, 2, 3, 4, ...)");
}

TEST_CASE("verify: a line whose vertices lost their order is found") {
  Flat flat(dome(), kDomeFeatures, lines({"row"}, R"(, "lengths": "free")"));
  check_all_holds(flat.with_all());
  const json direction = json::parse(content_of(flat.report()))["constraints"][0]["orientation"];
  flat.move(50, 0, std::polar(1.2, direction.get<double>() * 3.14159265358979323846 / 180));
  const Ran ran = flat.with_report();
  check_says(ran, "1 vertices lost their order along the line, the first is 30");
}

TEST_CASE("verify: a report that answers another constraint file is found") {
  const auto check_other = [](const std::string& key, const json& value, const std::string& said) {
    Flat flat(dome(), kDomeFeatures, kEvery);
    flat.change_set(key, value);
    check_all_holds(flat.with_report());
    check_says(flat.with_all(), said);
  };
  check_other("/constraints/2/scale", 1.02,
              "its scale in the map is 1.01, the constraint file asks for 1.02");
  check_other("/constraints/3/scale", 1, "the constraint file asks for 1");
  check_other("/constraints/3", {{"type", "circle"}, {"feature", "ring"}, {"radius", 3}}, "its residual is");
  check_other("/constraints/7/degrees", 2, "its residual is 2 degrees");
  check_other("/constraints/8/degrees", 2, "degrees, 1e-07 is allowed");
  check_other("/constraints/9/uv/0/0", 1e-6, R"(constraint "pin 48" (pin): residual )");
  check_other("/constraints/0/feature", "up", R"(wrong: constraint "line up" has no answer in the report)");
  check_other("/constraints/0", {{"type", "curve"}, {"feature", "row"}, {"name", "line row"}},
              "it is a line in the report, a curve in the constraint file");
  check_other("/constraints/1", {{"type", "line"}, {"feature", "high"}},
              "its template has 0 points in the report, its feature 7");
}

TEST_CASE("verify: an arc with another sweep or radius than the file asks for is found") {
  Flat flat(dome(), kDomeFeatures, R"({"type": "circle", "feature": "row", "sweep_degrees": 30})");
  check_all_holds(flat.with_all());
  flat.change_set("/constraints/0/sweep_degrees", 31);
  check_says(flat.with_all(), "its residual is");
  flat.change_set("/constraints/0/sweep_degrees", 30);
  flat.change_set("/constraints/0/radius", 3);
  check_says(flat.with_all(), "lengths and sweep make a radius of");
}

// ---- what cannot be verified ----

TEST_CASE("verify: a mesh without uv is refused with the remedy and what the reader left out") {
  const Scratch scratch;
  write(scratch.file("m.obj"), dome());
  check_refused(scratch.file("m.obj"), 4,
                "m.obj: the mesh has no uv; give a file that flatten wrote, or another one with uv");
  write(scratch.file("m.ply"),
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float "
        "texcoord\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 4 0 0 1 0\n");
  check_refused(scratch.file("m.ply"), 4,
                "the mesh has no uv; also the list 'texcoord' is left out: face 0 has 4 values");
  write(scratch.file("h.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nf 2 4 3\n");
  check_refused(scratch.file("h.obj"), 4,
                "also texture coordinates are left out: only 3 of 6 face corners have one");
}

TEST_CASE("verify: files that cannot be read are refused with their place") {
  Flat flat(dome(), kDomeFeatures, lines({"row"}));
  const std::string mesh = flat.output();
  check_refused("/nowhere/o.ply", 3, "/nowhere/o.ply: cannot open");
  check_refused(mesh + " --report /nowhere/r.json", 3, "/nowhere/r.json: cannot open");
  check_refused(mesh + " -c /nowhere/c.json --report " + flat.report(), 3, "/nowhere/c.json: cannot open");
  check_refused(mesh + " -c " + flat.set(), 2, "--constraints needs --report");
  write(flat.file("cut.json"), content_of(flat.report()).substr(0, 300));
  check_refused(mesh + " --report " + flat.file("cut.json"), 3, "cut.json:");
  flat.change_report("/version", 7);
  check_refused(mesh + " --report " + flat.report(), 3, "r.json: /version: this program reads version 1");
  flat.change_report("/version", 1);
  flat.change_report("/features/row/vertices/3", 49);
  check_refused(mesh + " --report " + flat.report(), 3,
                "r.json: /features/row/vertices/3: the report names vertex 49, the mesh has 49");
  write(flat.file("t.obj"), kTriangle);
  check_refused(
      flat.file("t.obj") + " --report " + flat.report(), 3,
      "the report is of a mesh with 72 triangles, this one has 1; give the report that was written together");
}

TEST_CASE("verify: uv that are no numbers and surfaces that are none are refused") {
  const Scratch scratch;
  std::string text = kTriangle;
  text.replace(text.find("vt 1 0"), 6, "vt nan 0");
  write(scratch.file("nan.obj"), text);
  check_refused(scratch.file("nan.obj"), 4, "1 triangles have a uv that is not a finite number (triangle 0)");
  write(scratch.file("twice.obj"), kTriangle + std::string("f 1/1 2/2 3/3\n"));
  check_refused(scratch.file("twice.obj"), 4, "duplicate-triangle");
  write(scratch.file("none.obj"), "v 0 0 0\n");
  check_refused(scratch.file("none.obj"), 4, "the mesh has no triangles");
}

// ---- the answer ----

TEST_CASE("verify: --json gives the whole answer by its schema, with the exit code of the text") {
  Flat flat(dome(), kDomeFeatures, kEvery);
  const Ran fine = flat.with_all(" --json");
  CHECK(fine.code == 0);
  const json answer = json::parse(fine.out);
  CHECK(answer.at("holds") == true);
  CHECK(answer.at("triangles") == json::parse(content_of(flat.report())).at("mesh").at("triangles"));
  CHECK(answer.at("constraints").size() == 10);
  for (const json& finding : answer.at("constraints")) CHECK(finding.at("residual") <= finding.at("allowed"));
  flat.move(0, 0, {7, 5});
  const Ran wrong = flat.with_all(" --json");
  CHECK(wrong.code == 6);
  CHECK(!json::parse(wrong.out).at("flipped_ids").empty());
  CHECK(json::parse(wrong.out).at("holds") == false);
  for (const std::string& out : {fine.out, wrong.out}) {
    write(flat.file("answer.json"), out);
    const std::string fault = schema_fault("verify.schema.json", flat.file("answer.json"));
    if (fault == "absent") {
      MESSAGE("left out: no jsonschema for python3");
      return;
    }
    CHECK_MESSAGE(fault.empty(), fault);
  }
}

TEST_CASE("verify: --quiet says what is wrong and nothing else") {
  Flat flat(dome(), kDomeFeatures, lines({"row"}));
  CHECK(run("verify --quiet " + flat.output() + " --report " + flat.report()).out.empty());
  flat.change_report("/flipped_triangles", 1);
  const Ran ran = run("verify --quiet " + flat.output() + " --report " + flat.report());
  CHECK(ran.out ==
        "wrong: the report says 1 flipped triangles, the map has 0\ndoes not hold: 1 other faults of the "
        "report\n");
}

TEST_CASE("verify: the help names the command and its options") {
  CHECK(has(run("--help").out, "verify"));
  const Ran help = run("verify --help");
  for (const char* option : {"--constraints", "--report", "--json"}) CHECK(has(help.out, option));
}
