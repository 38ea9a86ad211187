#include "io/mesh_files.hpp"

#include <fstream>

#include "io/file.hpp"
#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

constexpr double kTiny = 4.9406564584124654e-324;

/// A grid whose coordinates are hard to write and read.
Mesh awkward_grid() {
  Mesh mesh = grid(20);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mesh.position[0] = {-0.0, kTiny, 1.7976931348623157e308};
  mesh.position[1] = {0.1 + 0.2, 1e22, 123456789012345680.0};
  mesh.position[2] = {nan, kInfinity, -kInfinity};
  return mesh;
}

std::vector<Vec2> some_uv(const Mesh& mesh, double scale) {
  std::vector<Vec2> uv;
  for (Index v = 0; v < mesh.num_vertices(); ++v) uv.push_back({scale * v / 3.0, -scale / (v + 7.0)});
  return uv;
}

std::vector<Vec2> at_corners(const Mesh& mesh, const std::vector<Vec2>& uv) {
  std::vector<Vec2> corner_uv;
  for (const Index v : mesh.corner_vertex) corner_uv.push_back(uv[v]);
  return corner_uv;
}

template <class T>
std::vector<T> counted(Index n) {
  std::vector<T> numbers;
  for (Index i = 0; i < n; ++i) numbers.push_back(static_cast<T>(0.1 * i - 3));
  return numbers;
}

struct Written {
  std::string bytes;
  std::vector<std::string> warnings;
};

Written as_obj(const MeshOutput& output, int threads = 2) {
  Written written;
  written.bytes = format_obj(Exec(threads), output, written.warnings);
  return written;
}

Written as_ply(const MeshOutput& output, int threads = 2) {
  Written written;
  written.bytes = format_ply(Exec(threads), output, written.warnings);
  return written;
}

std::vector<std::string> set_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const UvSet& set : mesh.uv_sets) names.push_back(set.name);
  return names;
}

bool contains(const std::vector<std::string>& lines, const std::string& line) {
  return std::ranges::count(lines, line) > 0;
}

}  // namespace

TEST_CASE("write obj: positions, colours, uv, statements and comments read back bit for bit") {
  Mesh mesh = awkward_grid();
  for (const char* name : {"red", "green", "blue"}) {
    mesh.vertex_attributes.push_back(column(name, Scalar::Float64, counted<double>(mesh.num_vertices())));
  }
  const Index last = mesh.num_triangles();
  mesh.statements = {{0, "mtllib a.mtl"}, {0, "g left"}, {5, "usemtl red"}, {5, "s 1"}, {last, "g"}};
  mesh.comments = {"first", "second"};
  const std::vector<Vec2> uv = some_uv(mesh, 1e-3);
  const Written written = as_obj({.mesh = &mesh, .uv = uv});
  CHECK(written.warnings.empty());
  mesh.uv_sets.push_back({.name = "vt", .corner_uv = at_corners(mesh, uv), .per_vertex = true});
  mesh.position[2].x = std::abs(mesh.position[2].x);
  CHECK(same_mesh(must_read(read_obj, written.bytes), mesh));
  const Written plain = as_obj({.mesh = &mesh});
  CHECK(plain.bytes.find('/') == std::string::npos);
  CHECK(plain.bytes.find("vt") == std::string::npos);
}

TEST_CASE("write obj: colours of other types") {
  Mesh mesh = grid(2);
  for (const char* name : {"red", "green", "blue"}) {
    mesh.vertex_attributes.push_back(column<std::uint8_t>(name, Scalar::UInt8, {0, 51, 128, 255}));
  }
  Mesh back = must_read(read_obj, as_obj({.mesh = &mesh}).bytes);
  CHECK(values<double>(back.vertex_attributes, "green") == std::vector<double>{0, 0.2, 128 / 255.0, 1});
  mesh.vertex_attributes.clear();
  const std::vector<float> fractions = {0.1f, 0.7f, 1e-30f, 1};
  for (const char* name : {"red", "green", "blue"}) {
    mesh.vertex_attributes.push_back(column(name, Scalar::Float32, fractions));
  }
  back = must_read(read_obj, as_obj({.mesh = &mesh}).bytes);
  const std::vector<double> read = values<double>(back.vertex_attributes, "blue");
  for (std::size_t v = 0; v < 4; ++v) CHECK(static_cast<float>(read[v]) == fractions[v]);
}

TEST_CASE("write obj: what it cannot hold is named") {
  Mesh mesh = grid(2);
  mesh.vertex_attributes.push_back(column("quality", Scalar::Float32, counted<float>(4)));
  mesh.vertex_attributes.push_back(column("red", Scalar::Float32, counted<float>(4)));
  mesh.triangle_attributes.push_back(column("label", Scalar::Int32, counted<std::int32_t>(2)));
  mesh.uv_sets.push_back({.name = "st", .corner_uv = std::vector<Vec2>(6), .per_vertex = true});
  const Written written = as_obj({.mesh = &mesh});
  CHECK(
      written.warnings ==
      std::vector<std::string>{"OBJ cannot hold the vertex property 'quality'; write PLY to keep it",
                               "OBJ cannot hold the vertex property 'red'; write PLY to keep it",
                               "OBJ cannot hold the face property 'label'; write PLY to keep it",
                               "the input's parameterization 'st' is not kept in OBJ; write PLY to keep it"});
  CHECK(must_read(read_obj, written.bytes).vertex_attributes.empty());
}

TEST_CASE("write ply: everything reads back bit for bit, attributes of all types") {
  Mesh mesh = awkward_grid();
  const Index v = mesh.num_vertices(), t = mesh.num_triangles();
  mesh.vertex_attributes = {column("quality", Scalar::Float32, counted<float>(v)),
                            column("exact", Scalar::Float64, counted<double>(v)),
                            column("i8", Scalar::Int8, counted<std::int8_t>(v)),
                            column("red", Scalar::UInt8, counted<std::uint8_t>(v))};
  mesh.triangle_attributes = {column("i16", Scalar::Int16, counted<std::int16_t>(t)),
                              column("u16", Scalar::UInt16, counted<std::uint16_t>(t)),
                              column("i32", Scalar::Int32, counted<std::int32_t>(t)),
                              column("u32", Scalar::UInt32, std::vector<std::uint32_t>(t, 4'000'000'000u))};
  mesh.comments = {"one", "two words"};
  const std::vector<Vec2> uv = some_uv(mesh, 1e-3);
  const Written written = as_ply({.mesh = &mesh, .uv = uv});
  CHECK(written.warnings.empty());
  const Mesh back = must_read(read_ply, written.bytes);
  mesh.uv_sets.push_back({.name = "st", .corner_uv = at_corners(mesh, uv), .per_vertex = true});
  CHECK(same_mesh(back, mesh));
}

TEST_CASE("write ply: provenance columns, and old ones of the same name give way") {
  Mesh mesh = grid(2);
  mesh.vertex_attributes.push_back(column("b1", Scalar::Float32, counted<float>(4)));
  mesh.triangle_attributes.push_back(column("origin", Scalar::Float32, counted<float>(2)));
  const std::vector<Index> triangle_origin = {7, 3}, vertex_origin = {1, 2, 3, 4};
  const std::vector<Vec3> barycentric = {{1, 0, 0}, {0.1, 0.2, 0.7}, {0, 0, 1}, {0, 1, 0}};
  const Written written = as_ply({.mesh = &mesh,
                                  .triangle_origin = triangle_origin,
                                  .vertex_origin_triangle = vertex_origin,
                                  .vertex_barycentric = barycentric});
  CHECK(written.warnings ==
        std::vector<std::string>{"the input's property 'b1' is replaced by a new one of this name",
                                 "the input's property 'origin' is replaced by a new one of this name"});
  const Mesh back = must_read(read_ply, written.bytes);
  CHECK(values<Index>(back.triangle_attributes, "origin") == triangle_origin);
  CHECK(values<Index>(back.vertex_attributes, "origin_triangle") == vertex_origin);
  CHECK(values<double>(back.vertex_attributes, "b1") == std::vector<double>{0, 0.2, 0, 1});
  CHECK(values<double>(back.vertex_attributes, "b2") == std::vector<double>{0, 0.7, 1, 0});
  // Without provenance of our own nothing has to give way.
  CHECK(as_ply({.mesh = &mesh}).warnings.empty());
}

TEST_CASE("write ply: earlier parameterizations are kept beside the new one") {
  Mesh mesh = grid(3);
  const std::vector<Vec2> uv = some_uv(mesh, 1);
  const auto set = [&](const char* name, double scale) {
    return UvSet{.name = name, .corner_uv = at_corners(mesh, some_uv(mesh, scale)), .per_vertex = true};
  };
  const auto read_back = [&](std::vector<UvSet> sets, bool with_new) {
    mesh.uv_sets = std::move(sets);
    const Written written = as_ply({.mesh = &mesh, .uv = with_new ? In<Vec2>(uv) : In<Vec2>()});
    CHECK(written.warnings.empty());
    return must_read(read_ply, written.bytes);
  };
  using Names = std::vector<std::string>;
  const Mesh old_st = read_back({set("st", 2)}, true);
  CHECK(set_names(old_st) == Names{"st", "texture_uv"});
  CHECK(old_st.uv_sets[0].corner_uv == at_corners(mesh, uv));
  CHECK(old_st.uv_sets[1].corner_uv == at_corners(mesh, some_uv(mesh, 2)));
  CHECK(set_names(read_back({set("vt", 2)}, true)) == Names{"st", "texture_uv"});
  CHECK(set_names(read_back({set("uv", 2)}, true)) == Names{"st", "uv"});
  const Mesh three = read_back({set("st", 2), set("texture_uv", 3)}, true);
  CHECK(set_names(three) == Names{"st", "uv", "texture_uv"});
  CHECK(three.uv_sets[1].corner_uv == at_corners(mesh, some_uv(mesh, 2)));
  CHECK(three.uv_sets[2].corner_uv == at_corners(mesh, some_uv(mesh, 3)));
  // Without a new one each keeps its place.
  CHECK(set_names(read_back({set("st", 2), set("uv", 3)}, false)) == Names{"st", "uv"});
}

TEST_CASE("write ply: a parameterization with seams is kept as six numbers a face") {
  Mesh mesh = grid(3);
  std::vector<Vec2> corner_uv;
  for (Index c = 0; c < 3 * mesh.num_triangles(); ++c) corner_uv.push_back({c / 3.0, -1.0 / (c + 1.0)});
  mesh.uv_sets.push_back({.name = "vt", .corner_uv = corner_uv, .per_vertex = false});
  const std::vector<Vec2> uv = some_uv(mesh, 1);
  const Written written = as_ply({.mesh = &mesh, .uv = uv});
  CHECK(written.warnings.empty());
  const Mesh back = must_read(read_ply, written.bytes);
  CHECK(set_names(back) == std::vector<std::string>{"st"});
  const char* const names[] = {"u0", "v0", "u1", "v1", "u2", "v2"};
  for (int i = 0; i < 6; ++i) {
    const auto numbers = values<double>(back.triangle_attributes, names[i]);
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const Vec2 wanted = corner_uv[3 * t + i / 2];
      CHECK(numbers[t] == (i % 2 == 0 ? wanted.x : wanted.y));
    }
  }
  // A second set with seams, or a fourth one a vertex, has no names left.
  mesh.uv_sets.push_back({.name = "texcoord", .corner_uv = corner_uv, .per_vertex = false});
  CHECK(as_ply({.mesh = &mesh, .uv = uv}).warnings ==
        std::vector<std::string>{"the input's parameterization 'texcoord' is not kept: its names are taken"});
}

TEST_CASE("write ply: groups and materials of obj become numbers with names in the comments") {
  Mesh mesh = grid(3);
  mesh.statements = {
      {0, "mtllib a.mtl"}, {2, "g left door"}, {2, "usemtl red"}, {4, "g  roof"}, {6, "g left door"}};
  const Written written = as_ply({.mesh = &mesh});
  CHECK(written.warnings ==
        std::vector<std::string>{
            "PLY cannot hold the statements 'mtllib' of the input; write OBJ to keep them"});
  const Mesh back = must_read(read_ply, written.bytes);
  CHECK(values<Index>(back.triangle_attributes, "group") == std::vector<Index>{-1, -1, 0, 0, 1, 1, 0, 0});
  CHECK(values<Index>(back.triangle_attributes, "material") == std::vector<Index>{-1, -1, 0, 0, 0, 0, 0, 0});
  CHECK(back.comments == std::vector<std::string>{"planish group 0 left door", "planish group 1 roof",
                                                  "planish material 0 red"});
}

TEST_CASE("write: meshes without triangles or vertices") {
  const Mesh empty;
  CHECK(same_mesh(must_read(read_ply, as_ply({.mesh = &empty}).bytes), empty));
  CHECK(same_mesh(must_read(read_obj, as_obj({.mesh = &empty}).bytes), empty));
  Mesh points = grid(3);
  points.corner_vertex.clear();
  CHECK(same_mesh(must_read(read_ply, as_ply({.mesh = &points}).bytes), points));
}

TEST_CASE("write: 1, 2 and 7 threads give the same bytes over many blocks") {
  Mesh mesh = grid(160);
  mesh.statements = {{0, "g a"}, {20'000, "g b"}, {50'000, "g c"}};
  const std::vector<Vec2> uv = some_uv(mesh, 1e-5);
  const MeshOutput output{.mesh = &mesh, .uv = uv};
  for (const int threads : {2, 7}) {
    CHECK(as_obj(output, threads).bytes == as_obj(output, 1).bytes);
    CHECK(as_ply(output, threads).bytes == as_ply(output, 1).bytes);
  }
  CHECK(must_read(read_obj, as_obj(output).bytes).statements[2].triangle == 50'000);
}

TEST_CASE("mesh files: the extension tells the format, with .gz and in any case") {
  const TemporaryFolder folder;
  const Mesh mesh = grid(10);
  std::vector<std::string> warnings;
  for (const char* name : {"a.obj", "a.PLY", "a.obj.gz", "b.Ply.GZ"}) {
    REQUIRE(write_mesh(Exec(2), folder / name, {.mesh = &mesh}, warnings));
    const auto back = read_mesh(Exec(2), folder / name);
    REQUIRE(back.has_value());
    CHECK(same_mesh(*back, mesh));
  }
  const auto refused = write_mesh(Exec(2), folder / "a.stl", {.mesh = &mesh}, warnings);
  CHECK(refused.error().code == ErrorCode::UnknownFormat);
  CHECK_FALSE(std::filesystem::exists(folder / "a.stl"));
}

TEST_CASE("mesh files: the first bytes tell the format where the name does not") {
  const TemporaryFolder folder;
  const Mesh square = grid(2);
  const std::pair<const char*, std::string> files[] = {
      {"a", "# by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"b.txt", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"c.mesh", as_ply({.mesh = &square}).bytes},
      {"d",
       "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet "
       "endsolid\n"}};
  for (const auto& [name, bytes] : files) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    const auto mesh = read_mesh(Exec(2), folder / name);
    REQUIRE(mesh.has_value());
    CHECK(mesh->num_triangles() >= 1);
  }
  std::ofstream(folder / "e") << "hello";
  const auto unknown = read_mesh(Exec(2), folder / "e");
  CHECK(unknown.error().code == ErrorCode::UnknownFormat);
  CHECK(contains({unknown.error().place.file}, folder / "e"));
  CHECK(read_mesh(Exec(2), folder / "none.obj").error().code == ErrorCode::CannotOpen);
}
