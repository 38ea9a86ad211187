// Meshes of other people's programs, where the shared data folder is at hand.
#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

struct Expected {
  const char* name;
  Index vertices, triangles;
};

// Counts of other readers (numpy script beside the data, trimesh, libigl).
constexpr Expected kFiles[] = {
    {"disk/camelhead.off", 11381, 22704},
    {"disk/cowhead.obj", 15049, 29999},
    {"disk/mannequin-devil.off", 12977, 25888},
    {"disk/maze.obj", 6120, 9174},
    {"disk/violin.obj", 30000, 59298},
    {"holes/holes.off", 4291, 8288},
    {"holes/lion.off", 7529, 14859},
    {"holes/stanford-bunny.obj", 35947, 69451},
    {"closed/fertility.off", 4494, 9000},
    {"closed/punctured-torus.obj", 4599, 9184},
    {"closed/rocker-arm.obj", 10044, 20088},
    {"automotive/drivaer_body.obj.gz", 125446, 250962},
    {"automotive/hood.ply", 3712, 7051},
    {"automotive/roof.obj", 3886, 7351},
    {"automotive/windscreen.ply", 2612, 4815},
    {"automotive/side_window_left.ply", 706, 1229},
    {"automotive/front_door_left.obj", 2644, 4963},
    {"automotive/front_fender_left.ply", 1424, 2580},
    {"automotive/side_left.ply", 7817, 14249},
    {"automotive/front_fascia.obj", 4102, 7046},
    {"automotive/beetle.obj", 30024, 58738},
    {"automotive/seat.obj", 1270, 2209},
    {"automotive/fairing.ply", 4083, 7742},
    {"cad/fandisk.off", 7229, 14454},
    {"cad/fandisk_open.obj", 3955, 7715},
    {"cad/flange.stl.gz", 3228, 6468},
    {"cad/flange_front.ply", 807, 1470},
    {"cad/1002_tray_bottom.STL", 2216, 4520},
    {"cad/tray_top.ply", 1108, 1310},
    {"cad/plate.ply", 8192, 16380},
    {"cad/plate_skin.ply", 4096, 7938},
    {"cad/mech-holes-shark.off", 5246, 10192},
    {"bad/toy.obj", 12098, 24194},
    {"bad/triple_vierbein.obj", 75, 108},
    {"bad/inverted_triangles.obj", 12577, 24685},
    {"bad/moebius.obj", 280, 448},
    {"bad/hourglass_ico.obj", 23, 40},
    {"bad/truck.obj", 2956, 4770},
    {"bad/chair_model.obj", 3186, 12756},
    {"bad/featuretype.STL", 2010, 3476},
    {"bad/not_convex.obj", 288, 96},
    {"bad/soup.stl", 300, 100},
    {"bad/wallhole.obj", 92, 66},
    {"bad/openscad-nonmanifold-crash.obj", 717, 1442},
    {"bad/zero_area_face.obj", 3, 1},
    {"bad/made_collapsed_edge.obj", 706, 1229},
    {"bad/made_duplicate_face.obj", 706, 1230},
    {"bad/made_empty.obj", 0, 0},
    {"bad/made_far_away.obj", 706, 1229},
    {"bad/made_fin.obj", 707, 1230},
    {"bad/made_flipped_patch.obj", 706, 1229},
    {"bad/made_nan.obj", 706, 1229},
    {"bad/made_repeated_index.obj", 706, 1230},
    {"bad/made_tiny_units.obj", 706, 1229},
    {"bad/made_two_copies.obj", 1412, 2458},
    {"bad/made_unreferenced.obj", 756, 1229},
    {"bad/made_unwelded.obj", 3687, 1229},
    {"bad/made_vertices_only.obj", 706, 0},
};

const std::string kFolder = PLANISH_SHARED_DATA "/";

bool have_data() {
  const bool found = std::filesystem::exists(kFolder + "disk");
  if (!found) MESSAGE("no shared data here");
  return found;
}

}  // namespace

TEST_CASE("real files: vertex and triangle counts agree with other readers'") {
  if (!have_data()) return;
  const Exec exec;
  for (const Expected& expected : kFiles) {
    CAPTURE(expected.name);
    const auto mesh = read_mesh(exec, kFolder + expected.name);
    if (!mesh) FAIL_CHECK(describe(mesh.error()));
    if (!mesh) continue;
    CHECK(mesh->num_vertices() == expected.vertices);
    CHECK(mesh->num_triangles() == expected.triangles);
    CHECK(indices_in_range(*mesh));
    CHECK(columns_fit(*mesh));
  }
}

TEST_CASE("real files: broken ones are refused with their place") {
  if (!have_data()) return;
  const Exec exec;
  const auto index = read_mesh(exec, kFolder + "bad/made_index_out_of_range.obj");
  REQUIRE(!index.has_value());
  CHECK(index.error().place.line == 758);
  CHECK(index.error().what == "face names vertex 714, only 706 are defined");
  for (const char* name : {"bad/made_truncated.ply", "bad/made_wrong_count.ply"}) {
    const auto mesh = read_mesh(exec, kFolder + name);
    REQUIRE(!mesh.has_value());
    CHECK(mesh.error().code == ErrorCode::Truncated);
    CHECK(mesh.error().place.byte > 0);
  }
}

TEST_CASE("real files: written and read again they are the same bit for bit") {
  if (!have_data()) return;
  const Exec exec;
  for (const char* name : {"disk/cowhead.obj", "closed/punctured-torus.obj", "cad/flange_front.ply",
                           "holes/lion.off", "bad/made_tiny_units.obj"}) {
    CAPTURE(name);
    Mesh mesh = *read_mesh(exec, kFolder + name);
    mesh.uv_sets.clear();
    mesh.warnings.clear();  // of normals, which are not written
    std::vector<std::string> warnings;
    CHECK(same_mesh(must_read(read_obj, format_obj(exec, {.mesh = &mesh}, warnings)), mesh));
    mesh.statements.clear();
    CHECK(same_mesh(must_read(read_ply, format_ply(exec, {.mesh = &mesh}, warnings)), mesh));
    CHECK(warnings.empty());
  }
}
