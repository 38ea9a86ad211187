// Real and broken meshes, where they are at hand.
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>

#include "tests/app/program.hpp"

using namespace planish::tests;

namespace {

struct Expected {
  const char* file;
  int code;
  const char* message;  // part of the error, or of the warning
};

// Every file of bad/: exit code and message of `flatten`.
constexpr Expected kBad[] = {
    {"chair_model.obj", 4, "6377 triangles are copies of earlier ones"},
    {"featuretype.STL", 4, "1 component with handles (genus above 0)"},
    {"hourglass_ico.obj", 4,
     "1 vertex joins triangles that form no single fan (vertex 22); also 2 components without boundary; use "
     "--repair"},
    {"inverted_triangles.obj", 4, "23889 edges have their two triangles facing opposite sides"},
    {"made_collapsed_edge.obj", 4,
     "2 triangles have no area within the precision of their coordinates (triangles 860, 934); use --repair"},
    {"made_duplicate_face.obj", 4, "1 triangle is a copy of an earlier one (triangle 1229); also 3 edges"},
    {"made_empty.obj", 4, "the mesh has no triangles"},
    {"made_far_away.obj", 0, ""},
    {"made_fin.obj", 4, "1 edge has more than two triangles (edge 401-411)"},
    {"made_flipped_patch.obj", 4, "47 edges have their two triangles facing opposite sides"},
    {"made_index_out_of_range.obj", 3,
     "made_index_out_of_range.obj:758:6: face names vertex 714, only 706 are defined [index-out-of-range]"},
    {"made_nan.obj", 4, "2 vertices have a coordinate that is not a finite number (vertices 100, 200)"},
    {"made_repeated_index.obj", 4, "1 triangle names a vertex twice (triangle 1229)"},
    {"made_tiny_units.obj", 0, ""},
    {"made_truncated.ply", 3, "byte 22116"},
    {"made_two_copies.obj", 0, ""},
    {"made_unreferenced.obj", 0, ""},
    {"made_unwelded.obj", 0,
     "2981 vertices lie at the position of another one; if they are one surface, use --repair"},
    {"made_vertices_only.obj", 4, "the mesh has no triangles"},
    {"made_wrong_count.ply", 3, "byte 33179"},
    {"moebius.obj", 4, "1 component that cannot be oriented"},
    {"not_convex.obj", 0, "244 vertices lie at the position of another one"},
    {"openscad-nonmanifold-crash.obj", 4,
     "1 triangle has no area within the precision of its coordinates (triangle 1359)"},
    {"soup.stl", 0, ""},
    {"toy.obj", 4, "1 edge has more than two triangles (edge 10548-10549)"},
    {"triple_vierbein.obj", 4, "20 edges have more than two triangles"},
    {"truck.obj", 4, "54 edges have more than two triangles"},
    {"wallhole.obj", 0, "use --repair to merge them"},
    {"zero_area_face.obj", 4, "1 triangle has no area within the precision of its coordinates (triangle 0)"},
};

constexpr Expected kClosed[] = {
    {"closed/fertility.off", 4, "1 component without boundary (triangle 0); also 1 component with handles"},
    {"closed/punctured-torus.obj", 4,
     "1 component with handles (genus above 0) (triangle 0); use --cut auto"},
    {"closed/rocker-arm.obj", 4, "use --cut auto, or name a seam that opens it"},
    {"automotive/drivaer_body.obj.gz", 4, "33 edges have more than two triangles"},
};

bool absent(const std::string& folder) {
  if (std::filesystem::exists(folder)) return false;
  MESSAGE("left out: no ", folder);
  return true;
}

void check(const std::string& folder, const Expected& expected) {
  CAPTURE(expected.file);
  const Scratch scratch;
  const auto begin = std::chrono::steady_clock::now();
  const Ran ran = run("flatten " + folder + expected.file + " -o " + scratch.file("o.ply"));
  CHECK(ran.code == expected.code);
  CHECK_MESSAGE(ran.err.find(expected.message) != std::string::npos, ran.err);
  CHECK(scratch.count() == (expected.code == 0 ? 1 : 0));
  // Generous, so that it holds under sanitizers too: what it excludes is a hang.
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
}

}  // namespace

TEST_CASE("shared data: every broken file gives the exit code and the message that fit it") {
  const std::string folder = PLANISH_SHARED_DATA "/bad/";
  if (absent(folder)) return;
  for (const Expected& expected : kBad) check(folder, expected);
}

TEST_CASE("shared data: closed meshes are refused with what to do") {
  const std::string folder = PLANISH_SHARED_DATA "/";
  if (absent(folder)) return;
  for (const Expected& expected : kClosed) check(folder, expected);
}

TEST_CASE("shared data: panels pass the independent check") {
  const std::string folder = PLANISH_SHARED_DATA "/";
  if (absent(folder)) return;
  const Scratch scratch;
  for (const std::string file :
       {"automotive/hood.ply", "automotive/front_fender_left.ply", "automotive/side_left.ply",
        "cad/tray_top.ply", "cad/plate_skin.ply", "holes/holes.off", "bad/made_far_away.obj"}) {
    CAPTURE(file);
    for (const std::string output : {"o.ply", "o.obj"}) {
      REQUIRE(run("flatten " + folder + file + " -o " + scratch.file(output) + " --report " +
                  scratch.file("r.json"))
                  .code == 0);
      const std::string command = "python3 -B " PLANISH_TESTS "/independent_check.py " + folder + file + " " +
                                  scratch.file(output) + " " + scratch.file("r.json") + " >" +
                                  scratch.file("said") + " 2>&1";
      CHECK_MESSAGE(std::system(command.c_str()) == 0, content_of(scratch.file("said")));
    }
  }
}
