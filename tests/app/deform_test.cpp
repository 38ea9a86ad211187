// planish deform: maps of every spelling are brought to their constraints, and what is written is judged by a check that
// knows nothing of planish.
#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

// ---- maps by hand ----

using Complex = std::complex<double>;

/// The dome with a map of one vt a vertex.
std::string mapped_dome(const std::function<Complex(double, double)>& map) {
  std::ostringstream text;
  text.precision(17);
  std::istringstream lines(dome());
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("f ")) {
      text << line << '\n';
      continue;
    }
    int v[3] = {};
    std::istringstream(line.substr(2)) >> v[0] >> v[1] >> v[2];
    text << "f " << v[0] << '/' << v[0] << ' ' << v[1] << '/' << v[1] << ' ' << v[2] << '/' << v[2] << '\n';
  }
  for (int j = 0; j <= 6; ++j) {
    for (int i = 0; i <= 6; ++i) text << "vt " << map(i, j).real() << ' ' << map(i, j).imag() << '\n';
  }
  return text.str();
}

Complex as_seen(double x, double y) { return {x, y}; }

/// The pipe unrolled by hand, a bit too wide and sheared: the vertices of column 0 have two vt each.
std::string mapped_pipe() {
  std::ostringstream text;
  std::istringstream lines(pipe());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("v ")) text << line << '\n';
  }
  text << "o unrolled by hand\n";
  for (int j = 0; j <= 8; ++j) {
    for (int i = 0; i <= 24; ++i) text << "vt " << 0.27 * i + 0.01 * j << ' ' << 0.5 * j << '\n';
  }
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 24; ++i) {
      const int a = 24 * j + i + 1, b = 24 * j + (i + 1) % 24 + 1, s = 25 * j + i + 1;
      text << "f " << a << '/' << s << ' ' << b << '/' << s + 1 << ' ' << b + 24 << '/' << s + 26 << '\n';
      text << "f " << a << '/' << s << ' ' << b + 24 << '/' << s + 26 << ' ' << a + 24 << '/' << s + 25
           << '\n';
    }
  }
  return text.str();
}

/// The map as an ASCII PLY, in one of the spellings.
std::string ply_of_dome(const std::string& u, const std::string& v, bool per_corner) {
  const auto z = [](int vertex) { return as_seen(vertex % 7, vertex / 7); };
  std::ostringstream text;
  text.precision(17);
  text << "ply\nformat ascii 1.0\nelement vertex 49\nproperty double x\nproperty double y\nproperty double "
          "z\n";
  if (!per_corner) text << "property double " << u << "\nproperty double " << v << '\n';
  text << "element face 72\nproperty list uchar int vertex_indices\n";
  if (per_corner) text << "property list uchar double texcoord\n";
  text << "end_header\n";
  for (int k = 0; k < 49; ++k) {
    text << k % 7 << ' ' << k / 7 << ' ' << height(k % 7, k / 7, 6);
    if (!per_corner) text << ' ' << z(k).real() << ' ' << z(k).imag();
    text << '\n';
  }
  std::istringstream lines(dome());
  for (std::string line; std::getline(lines, line);) {
    int c[3] = {};
    if (!line.starts_with("f ")) continue;
    std::istringstream(line.substr(2)) >> c[0] >> c[1] >> c[2];
    text << 3;
    for (const int i : c) text << ' ' << i - 1;
    if (per_corner) {
      text << " 6";
      for (const int i : c) text << ' ' << z(i - 1).real() << ' ' << z(i - 1).imag();
    }
    text << '\n';
  }
  return text.str();
}

// ---- runs ----

const std::string kEvery = lines({"row"}) + ", " + lines({"high"}, R"(, "lengths": "free")") + ", " +
                           R"({"type": "circle", "feature": "ring"}, {"type": "curve", "feature": "south"},
    {"type": "perpendicular", "features": ["row", "west"], "measure": "chord"},
    {"type": "direction", "feature": "row", "degrees": 30})";

/// Deforms in.obj, and has the result checked. What is written is o.obj.
Solved deform(const Scratch& scratch, const std::string& mesh, const std::string& constraints,
              const std::string& options = "") {
  CAPTURE(constraints);
  write(scratch.file("in.obj"), mesh);
  write(scratch.file("c.json"), file_of(has(mesh, "unrolled") ? kPipeFeatures : kFeatures, constraints, ""));
  Solved solved;
  solved.ran = run("deform " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                   scratch.file("o.obj") + " --report " + scratch.file("r.json") + " " + options);
  REQUIRE_MESSAGE(solved.ran.code == 0, solved.ran.err);
  solved.report = json::parse(content_of(scratch.file("r.json")));
  const Ran check = checked(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
  CHECK_MESSAGE(check.code == 0, check.out);
  const Ran own = verified(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
  CHECK_MESSAGE(own.code == 0, (own.out + own.err));
  return solved;
}

double farthest(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, std::abs(a[v] - b[v]));
  return most;
}

std::size_t count_lines(const std::string& text, const std::string& start) {
  std::size_t count = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) count += line.starts_with(start);
  return count;
}

/// Flattens the dome without constraints: a map at its minimum.
std::string free_map(const Scratch& scratch) {
  write(scratch.file("bare.obj"), dome());
  REQUIRE(
      run("flatten " + scratch.file("bare.obj") + " -o " + scratch.file("free.obj") + " --tolerance 1e-10")
          .code == 0);
  return content_of(scratch.file("free.obj"));
}

}  // namespace

TEST_CASE("deform: every kind of constraint is met to rounding, by a check that knows nothing of planish") {
  const Scratch scratch;
  const Solved solved = deform(scratch, mapped_dome(as_seen), kEvery);
  for (const json& entry : solved.report.at("constraints"))
    CHECK(entry.at("residual") < (entry.contains("degrees") ? 1e-7 : 1e-9));
  CHECK(solved.report.at("flipped_triangles") == 0);
  CHECK(!schema_fault("report.schema.json", scratch.file("r.json")).starts_with("invalid"));
  CHECK(solved.report.at("deformation").at("release") == "none");
}

TEST_CASE("deform: regions and pins are met") {
  deform(
      Scratch(), mapped_dome(as_seen),
      R"({"type": "region", "feature": "patch"}, {"type": "pin", "vertices": [0, 6], "uv": [[0, 0], [6.2, 0.1]]})");
}

TEST_CASE("deform: an OBJ with seams, written by hand, keeps its seams") {
  const Scratch scratch;
  const Solved solved =
      deform(scratch, mapped_pipe(),
             lines({"back"}) + R"(, {"type": "direction", "feature": "back", "degrees": 90})");
  const std::string written = content_of(scratch.file("o.obj"));
  CHECK(solved.report.at("cut").at("cut_edges") == 9);
  CHECK(solved.report.at("cut").at("charts") == 1);
  CHECK(count_lines(written, "v ") == 216 + 48);        // the belt adds some
  CHECK(count_lines(written, "vt ") == 216 + 48 + 10);  // those of the seam have two
  CHECK(has(written, "o unrolled by hand"));
  CHECK(!has(solved.ran.err, "not kept"));  // the given map is what was deformed
  CHECK(solved.report.at("energy").at("arap") < 1e-3);
}

TEST_CASE("deform: all spellings of uv give the same map") {
  const Scratch scratch;
  write(scratch.file("c.json"), file_of(kFeatures, lines({"row"}), ""));
  const auto deformed = [&](const std::string& name, const std::string& content) {
    write(scratch.file(name), content);
    const Ran ran = run("deform " + scratch.file(name) + " -c " + scratch.file("c.json") + " -o " +
                        scratch.file("o.obj"));
    CHECK_MESSAGE(ran.code == 0, ran.err);
    return images(scratch.file("o.obj"));
  };
  const auto first = deformed("vt.obj", mapped_dome(as_seen));
  CHECK(deformed("st.ply", ply_of_dome("s", "t", false)) == first);
  CHECK(deformed("uv.ply", ply_of_dome("u", "v", false)) == first);
  CHECK(deformed("texture.ply", ply_of_dome("texture_u", "texture_v", false)) == first);
  CHECK(deformed("texcoord.ply", ply_of_dome("", "", true)) == first);
}

TEST_CASE("deform: a map at its minimum that meets its constraints stays where it is") {
  const Scratch scratch;
  const std::string map = free_map(scratch);
  const auto before = images(scratch.file("free.obj"));
  std::ostringstream pin;
  pin.precision(17);
  pin << R"({"type": "pin", "vertices": [3, 40], "uv": [)";
  pin << '[' << before[3].real() << ", " << before[3].imag() << "], [" << before[40].real() << ", "
      << before[40].imag() << "]]}";
  deform(scratch, map, pin.str());
  CHECK(farthest(images(scratch.file("o.obj")), before) < 1e-5);
}

TEST_CASE("deform: a component moves as a whole where one pin, or pins that it fits, ask for another place") {
  const Scratch scratch;
  const std::string map = free_map(scratch);
  const auto before = images(scratch.file("free.obj"));
  const auto after_move = [&](const std::string& pins) {
    deform(scratch, map, pins);
    return images(scratch.file("o.obj"));
  };
  const auto shifted = after_move(R"({"type": "pin", "vertices": [24], "uv": [[100, 50]]})");
  CHECK(std::abs(shifted[24] - Complex(100, 50)) < 1e-12);
  for (std::size_t v = 0; v < before.size(); ++v)
    CHECK(std::abs((shifted[v] - shifted[24]) - (before[v] - before[24])) < 1e-4);
}

TEST_CASE("deform: with a direction the map is turned, by a right angle at most for undirected lines") {
  const Scratch scratch;
  const auto turn = [&](const char* degrees) {
    deform(scratch, mapped_dome(as_seen),
           lines({"row"}) + R"(, {"type": "direction", "feature": "row", "degrees": )" + degrees + "}");
    const auto z = images(scratch.file("o.obj"));
    return 180 / 3.14159265358979 * std::arg(z[34] - z[28]);
  };
  CHECK(turn("20") == doctest::Approx(20));
  CHECK(turn("170") == doctest::Approx(-10));
}

TEST_CASE(
    "deform: features that are as they should be stay, the others go to the places nearest to the map") {
  const Scratch scratch;
  deform(scratch,
         mapped_dome([](double x, double y) { return Complex(x, y + (y == 4 ? 0.1 * std::sin(x) : 0)); }),
         lines({"row"}, kScaled));
  const auto z = images(scratch.file("o.obj"));
  Complex mean{}, wanted{};
  for (int i = 0; i <= 6; ++i) {
    mean += z[28 + i] / 7.0;
    wanted += Complex(i, 4 + 0.1 * std::sin(i)) / 7.0;
  }
  CHECK(std::abs(mean - wanted) < 1e-12);
}

TEST_CASE("deform: angles turn both elements about their middles by equal and opposite amounts") {
  const Scratch scratch;
  deform(scratch, mapped_dome(as_seen),
         lines({"low", "high"}, kScaled) +
             R"(, {"type": "angle", "features": ["low", "high"], "degrees": 8, "oriented": true})");
  const auto z = images(scratch.file("o.obj"));
  const double low = std::arg(z[13] - z[7]), high = std::arg(z[41] - z[35]), degree = 3.14159265358979 / 180;
  CHECK(low == doctest::Approx(-4 * degree));
  CHECK(high == doctest::Approx(4 * degree));
  CHECK(std::abs(0.5 * (z[13] + z[7]) - Complex(3, 1)) < 0.05);
}

TEST_CASE("deform: steps go to the same end, and each is drawn") {
  const Scratch scratch;
  deform(scratch, mapped_dome(as_seen), kEvery, "--tolerance 1e-9");
  const auto at_once = images(scratch.file("o.obj"));
  deform(scratch, mapped_dome(as_seen), kEvery,
         "--tolerance 1e-9 --steps 5 --frames " + scratch.file("frames") + " --picture " +
             scratch.file("p.svg"));
  CHECK(farthest(images(scratch.file("o.obj")), at_once) < 1e-5);
  for (int step = 0; step <= 5; ++step)
    CHECK(content_of(scratch.file("frames/step_000" + std::to_string(step) + ".png")).starts_with("\x89PNG"));
  CHECK(!std::filesystem::exists(scratch.file("frames/step_0006.png")));
  CHECK(has(content_of(scratch.file("p.svg")), "<svg"));
}

TEST_CASE("deform: the report has the map after each step, from the given one to the last") {
  const Scratch scratch;
  const json report = deform(scratch, mapped_dome(as_seen), kEvery, "--steps 4").report;
  const json& way = report.at("deformation").at("way");
  REQUIRE(way.size() == 5);
  for (int k = 0; k <= 4; ++k) {
    CHECK(way[k].at("step") == k);
    CHECK(way[k].at("flipped_triangles") == 0);
  }
  CHECK(way[0].at("arap") == report.at("deformation").at("given_arap"));
  CHECK(way[4].at("arap") == report.at("energy").at("arap"));
  CHECK(deform(scratch, mapped_dome(as_seen), kEvery).report.at("deformation").at("way").empty());
}

TEST_CASE("deform: steps that are left with flips are named") {
  // The middle is pulled past its neighbours, which corners hold back.
  const Scratch scratch;
  write(scratch.file("in.obj"), mapped_dome(as_seen));
  write(scratch.file("c.json"), file_of(kFeatures,
                                        R"({"type": "pin", "vertices": [0, 6, 42, 48, 24, 25, 26],
                    "uv": [[0, 0], [6, 0], [0, 6], [6, 6], [5.5, 3], [4, 3], [5, 3]]})",
                                        ""));
  const Ran ran = run("deform " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                      scratch.file("o.obj") + " --steps 4 --report " + scratch.file("r.json"));
  CHECK(ran.code == 6);
  CHECK_MESSAGE(has(ran.out, "steps on the way with flipped triangles and overwound vertices: "), ran.out);
  const json way = json::parse(content_of(scratch.file("r.json"))).at("deformation").at("way");
  CHECK(way[0].at("flipped_triangles") == 0);
  CHECK(way[3].at("flipped_triangles") > 0);
}

TEST_CASE("deform: features whose poses are free end where the whole is less distorted than with them held") {
  const Scratch scratch;
  const std::string constraints =
      lines({"low", "high"}, kScaled) +
      R"(, {"type": "angle", "features": ["low", "high"], "degrees": 8, "oriented": true})";
  const json held = deform(scratch, mapped_dome(as_seen), constraints, "--tolerance 1e-9").report;
  const json free =
      deform(scratch, mapped_dome(as_seen), constraints, "--tolerance 1e-9 --poses free").report;
  CHECK(held.at("deformation").at("poses") == "held");
  CHECK(free.at("deformation").at("poses") == "free");
  CHECK(free.at("deformation").at("release") == "none");
  const auto arap = [](const json& report) { return report.at("energy").at("arap").get<double>(); };
  CHECK(arap(free) < 0.999 * arap(held));
  const auto at_once = images(scratch.file("o.obj"));
  deform(scratch, mapped_dome(as_seen), constraints, "--tolerance 1e-9 --poses free --steps 5");
  CHECK(farthest(images(scratch.file("o.obj")), at_once) < 1e-5);
  // The minimum that flatten finds, too.
  write(scratch.file("bare.obj"), dome());
  REQUIRE(run("flatten " + scratch.file("bare.obj") + " -c " + scratch.file("c.json") + " -o " +
              scratch.file("f.obj") + " --report " + scratch.file("f.json") + " --tolerance 1e-9")
              .code == 0);
  CHECK(arap(free) == doctest::Approx(arap(json::parse(content_of(scratch.file("f.json"))))).epsilon(1e-9));
}

TEST_CASE("deform: the reference says whose shape the triangles keep") {
  const Scratch scratch;
  const auto wide = [](double x, double y) { return Complex(1.2 * x, y); };
  const std::string pins = R"({"type": "pin", "vertices": [0, 6, 42], "uv": [[0, 0], [7.2, 0], [0, 6]]})";
  deform(scratch, mapped_dome(wide), pins, "--reference parameterization");
  const auto kept = images(scratch.file("o.obj"));
  for (int v = 0; v < 49; ++v) CHECK(std::abs(kept[v] - wide(v % 7, v / 7)) < 1e-6);
  deform(scratch, mapped_dome(wide), pins);
  CHECK(farthest(images(scratch.file("o.obj")), kept) > 0.05);
}

TEST_CASE("deform: maps in the unit square, or with their back up, are brought to the surface") {
  const Scratch scratch;
  const Solved plain = deform(scratch, mapped_dome(as_seen), lines({"row"}));
  const Solved small =
      deform(scratch, mapped_dome([](double x, double y) { return Complex(x / 6, y / 6); }), lines({"row"}));
  CHECK(has(small.ran.err, "not in mesh units"));
  CHECK(small.report.at("deformation").at("map_scale") == doctest::Approx(6).epsilon(0.05));
  const Solved turned =
      deform(scratch, mapped_dome([](double x, double y) { return Complex(-x, y); }), lines({"row"}));
  CHECK(has(turned.ran.err, "back up"));
  CHECK(turned.report.at("deformation").at("mirrored") == 1);
  const json &arap = plain.report.at("energy").at("arap"), &other = turned.report.at("energy").at("arap");
  CHECK(other.get<double>() == doctest::Approx(arap.get<double>()));
}

TEST_CASE("deform: any number of threads writes the same bytes") {
  const Scratch scratch;
  deform(scratch, mapped_dome(as_seen), kEvery, "--threads 1");
  const std::string one = content_of(scratch.file("o.obj"));
  for (const char* threads : {"2", "7"}) {
    deform(scratch, mapped_dome(as_seen), kEvery, std::string("--threads ") + threads);
    CHECK(content_of(scratch.file("o.obj")) == one);
  }
}

TEST_CASE(
    "deform: maps that cannot be used are errors that name the place and what to do, and nothing is "
    "written") {
  const Scratch scratch;
  write(scratch.file("c.json"), file_of(kFeatures, lines({"row"}), ""));
  const auto refused = [&](const std::string& name, const std::string& content,
                           const std::string& options = "") {
    write(scratch.file(name), content);
    const Ran ran = run("deform " + scratch.file(name) + " -c " + scratch.file("c.json") + " -o " +
                        scratch.file("o.obj") + " --frames " + scratch.file("frames") + " " + options);
    CHECK(!std::filesystem::exists(scratch.file("o.obj")));
    CHECK(has(ran.err, scratch.file(name)));
    return ran;
  };
  const Ran bare = refused("bare.obj", dome());
  CHECK(bare.code == 4);
  CHECK(has(bare.err, "the mesh has no uv"));
  CHECK(has(bare.err, "give a file that flatten wrote"));

  std::string some = mapped_dome(as_seen);
  some.replace(some.find("f 1/1"), 5, "f 1");
  const Ran incomplete = refused("some.obj", some);
  CHECK(incomplete.code == 4);
  CHECK(has(incomplete.err, "only 215 of 216 face corners have one"));

  std::string ply = ply_of_dome("s", "t", false);
  ply.replace(ply.find("\n0 0 0 0 0\n"), 11, "\n0 0 0 nan 0\n");
  const Ran nan = refused("nan.ply", ply);
  CHECK(nan.code == 4);
  CHECK_MESSAGE(has(nan.err, "2 triangles have a uv that is not a finite number"), nan.err);
  CHECK_MESSAGE(has(nan.err, "(triangles 0, 1); correct or remove them"), nan.err);

  const Ran flat = refused("flat.obj", mapped_dome([](double x, double) { return Complex(x, 0); }));
  CHECK(flat.code == 4);
  CHECK(has(flat.err, "the map of component 0 has no area"));

  const auto folded = [](double x, double y) { return Complex(x, y == 1 ? 0 : y); };
  const Ran reference = refused("folded.obj", mapped_dome(folded), "--reference parameterization");
  CHECK(reference.code == 4);
  CHECK(has(reference.err, "12 triangles have no area in the map"));
}

TEST_CASE("deform: wrong options are refused") {
  const Scratch scratch;
  write(scratch.file("in.obj"), mapped_dome(as_seen));
  write(scratch.file("c.json"), file_of(kFeatures, lines({"row"}), ""));
  const std::string start = "deform " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " ";
  CHECK(run("deform " + scratch.file("in.obj")).code == 2);
  CHECK(run(start + "--steps 0").code == 2);
  CHECK(run(start + "--reference map").code == 2);
  CHECK(run(start + "--flips weights").code == 2);
  CHECK(run(start + "--flips keep --overlaps remove").code == 2);
  CHECK(run(start + "--poses loose").code == 2);
  CHECK(run(start + "--energy symmetric-dirichlet --flips keep").code == 2);
  CHECK(run(start + "--frames " + scratch.file("in.obj")).code == 7);
  CHECK(has(run("deform --help").out, "--reference"));
}

TEST_CASE("deform: contradictions are named as flatten names them") {
  const Scratch scratch;
  write(scratch.file("in.obj"), mapped_dome(as_seen));
  write(
      scratch.file("c.json"),
      file_of(
          kFeatures,
          lines({"low", "row"}) +
              R"(, {"type": "parallel", "features": ["low", "row"]}, {"type": "perpendicular", "features": ["low", "row"]})",
          ""));
  const Ran ran = run("deform " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " -o " +
                      scratch.file("o.obj"));
  CHECK(ran.code == 5);
  CHECK(has(ran.err, R"(constraints "parallel low row" and "perpendicular low row" cannot all hold)"));
  CHECK(!std::filesystem::exists(scratch.file("o.obj")));
}
