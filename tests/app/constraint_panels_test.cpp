// Whole panels under constraints: rectangles, the figures of the paper, every set of the shared data.
#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

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
  if (check.code != 0) return name + check.out;
  const Ran own = verified(job.constraints, scratch.file("o.ply"), scratch.file("r.json"));
  const bool holds = !flips && report.at("overlapping_pairs") == 0;
  return own.code == (holds ? 0 : 6) && !has(own.out, "wrong:") ? "" : name + own.out + own.err;
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
