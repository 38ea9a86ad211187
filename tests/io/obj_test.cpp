#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh read(std::string_view text) { return must_read(read_obj, text); }

void check_place(const Error& error, Offset line, Offset column) {
  CHECK(error.place.line == line);
  CHECK(error.place.column == column);
}

/// Long enough for several chunks, with everything that crosses their borders.
std::string long_file(Index n) {
  std::string text = "# head\n";
  for (Index i = 0; i < n; ++i) {
    text += "v " + std::to_string(i) + ".125 \\\n " + std::to_string(i % 17) + " 1e-3\r\n";
    text += "vt 0.5 " + std::to_string(i) + "\n";
    if (i % 100 == 0) text += "g part " + std::to_string(i) + "\n# a comment \\\n";
    if (i >= 3) text += "f -1/-1 -2/-2 " + std::to_string(i - 1) + "/" + std::to_string(i - 1) + "/5 -4/-4\n";
  }
  return text;
}

/// A grid cut along its middle column: the uv of the right half are moved.
std::vector<Vec2> torn_uv(const Mesh& mesh, Index n) {
  std::vector<Vec2> corner_uv;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const bool right = t / 2 % (n - 1) >= n / 2;
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = mesh.position[mesh.corner_vertex[3 * t + i]];
      corner_uv.push_back({p.x + (right ? 100 : 0), p.y / 3});
    }
  }
  return corner_uv;
}

std::string written(const MeshOutput& output, int threads = 2) {
  std::vector<std::string> warnings;
  return format_obj(Exec(threads), output, warnings);
}

Index count_lines(const std::string& text, const std::string& head) {
  Index n = 0;
  for (std::size_t at = text.find("\n" + head); at != std::string::npos; at = text.find("\n" + head, at + 1))
    ++n;
  return n;
}

}  // namespace

TEST_CASE("obj: all forms of a face corner, absolute and relative") {
  const std::string head = kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
  const std::vector<Index> wanted = {0, 1, 2};
  const std::pair<const char*, bool> faces[] = {
      {"f 1 2 3", false},          {"f 1/1 2/2 3/3", true},
      {"f 1//1 2//1 3//1", false}, {"f 1/1/1 2/2/1 3/3/1", true},
      {"f -4 -3 -2", false},       {"f -4/-3 -3/-2/1 -2/-1/-1", true},
      {"f\t1  2 3  ", false},      {"f 1/ 2/ 3/", false},
      {"f 1// 2// 3//", false},    {"f +1 2 3 # last", false}};
  for (const auto& [face, has_uv] : faces) {
    CAPTURE(face);
    const Mesh mesh = read(head + face);
    CHECK(mesh.corner_vertex == wanted);
    REQUIRE(mesh.uv_sets.size() == (has_uv ? 1 : 0));
    if (has_uv) CHECK(mesh.uv_sets[0].corner_uv == std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}});
  }
}

TEST_CASE("obj: relative indices count from the line they stand on") {
  const Mesh mesh = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n");
  CHECK(mesh.corner_vertex == std::vector<Index>{0, 1, 2, 0, 2, 3});
}

TEST_CASE("obj: vertices may be defined after the face that names them") {
  CHECK(read("f 1 2 3\n" + kSquare).corner_vertex == std::vector<Index>{0, 1, 2});
}

TEST_CASE("obj: quads and concave polygons are cut inside") {
  CHECK(read(kSquare + "f 1 2 3 4\n").corner_vertex == std::vector<Index>{0, 1, 2, 0, 2, 3});
  const Mesh arrow = read("v 2 -1 0\nv 0.5 0 0\nv 2 1 0\nv 0 0 0\nf 1 2 3 4\nf 1 2 4\n");
  CHECK(arrow.corner_vertex == std::vector<Index>{1, 2, 3, 0, 1, 3, 0, 1, 3});
}

TEST_CASE("obj: numbers are read to the last bit, nan and inf too") {
  const Mesh mesh = read("v 0.1 -0 +1e-320\nv 1.7976931348623157e308 5e-324 .5\nv nan inf -INF\n");
  CHECK(mesh.position[0] == Vec3{0.1, 0, 1e-320});
  CHECK(std::signbit(mesh.position[0].y));
  CHECK(mesh.position[1] == Vec3{1.7976931348623157e308, 5e-324, 0.5});
  CHECK(std::isnan(mesh.position[2].x));
  CHECK(mesh.position[2].y == kInfinity);
  CHECK(mesh.position[2].z == -kInfinity);
}

TEST_CASE("obj: lines are joined by a backslash, but not out of a comment") {
  const Mesh mesh =
      read("# folder C:\\\nv 0 0 \\\r\n 0\nv 1 0\\\n 0\nv 1 1 0 # end \\\nf 1 \\\n 2 \\\n 3\ng a \\\n b\n");
  CHECK(mesh.num_vertices() == 3);
  CHECK(mesh.corner_vertex == std::vector<Index>{0, 1, 2});
  CHECK(mesh.statements.at(0).text == "g a   b");
}

TEST_CASE("obj: colours become attributes; a weight does not") {
  const Mesh mesh = read("v 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 0.5 0.25 1\n");
  CHECK(values<double>(mesh.vertex_attributes, "red") == std::vector<double>{0.1, 1});
  CHECK(values<double>(mesh.vertex_attributes, "green") == std::vector<double>{0.2, 0.5});
  CHECK(values<double>(mesh.vertex_attributes, "blue") == std::vector<double>{0.3, 0.25});
  CHECK(read("v 0 0 0 1\n").vertex_attributes.empty());
  const Mesh mixed = read("v 0 0 0 0.1 0.2 0.3\nv 1 0 0\n");
  CHECK(mixed.vertex_attributes.empty());
  CHECK(mixed.warnings ==
        std::vector<std::string>{"vertex colours are left out: only 1 of 2 vertices have one"});
}

TEST_CASE("obj: statements are kept with the triangle they precede") {
  const Mesh mesh =
      read("mtllib a b.mtl\n" + kSquare + "o body \nf 1 2 3 4\nusemtl  red#1\r\ns off\nf 1 2 3\ng\n");
  const std::vector<std::pair<Index, std::string>> wanted = {
      {0, "mtllib a b.mtl"}, {0, "o body"}, {2, "usemtl  red#1"}, {2, "s off"}, {3, "g"}};
  REQUIRE(mesh.statements.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    CHECK(mesh.statements[i].triangle == wanted[i].first);
    CHECK(mesh.statements[i].text == wanted[i].second);
  }
}

TEST_CASE("obj: texture coordinates of corners, and whether they are of vertices") {
  const std::string uv = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 0\nvt 0.5\n";
  const Mesh whole = read(kSquare + uv + "f 1/1 2/2 3/3 4/4\n");
  REQUIRE(whole.uv_sets.size() == 1);
  CHECK(whole.uv_sets[0].name == "vt");
  CHECK(whole.uv_sets[0].per_vertex);
  CHECK(whole.uv_sets[0].corner_uv == std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}});
  const Mesh seam = read(kSquare + uv + "f 1/1 2/2 3/3\nf 1/5 3/3 4/4\n");
  CHECK_FALSE(seam.uv_sets.at(0).per_vertex);
  CHECK(seam.uv_sets[0].corner_uv[3] == Vec2{0.5, 0});
}

TEST_CASE("obj: corners without texture coordinates in a file that has some") {
  const Mesh mesh = read(kSquare + "vt 0 0\nf 1/1 2/1 3\nf 1 3 4\n");
  CHECK(mesh.uv_sets.empty());
  CHECK(mesh.warnings ==
        std::vector<std::string>{"texture coordinates are left out: only 2 of 6 face corners have one"});
}

TEST_CASE("obj: the comments at the head are kept, unknown statements passed over") {
  const Mesh mesh =
      read("# one\n\n#two \n" + kSquare + "# later\nvn 0 0 1\nvp 1\nl 1 2\np 1\ncurv 0 1 1 2\nf 1 2 3\n");
  CHECK(mesh.comments == std::vector<std::string>{"one", "two"});
  CHECK(mesh.num_triangles() == 1);
  CHECK(mesh.warnings == std::vector<std::string>{"1 normal is not kept"});
}

TEST_CASE("obj: files without faces are meshes without triangles") {
  CHECK(read("").num_vertices() == 0);
  CHECK(read(kSquare).num_vertices() == 4);
  CHECK(read(kSquare).num_triangles() == 0);
}

TEST_CASE("obj: an index out of range is named with its place") {
  const Error error = must_fail(read_obj, kSquare + "f 1 2 3\nf 1  90210 3\n");
  CHECK(describe(error) == "part:6:6: face names vertex 90210, only 4 are defined [index-out-of-range]");
  check_place(must_fail(read_obj, kSquare + "f 1 2 0"), 5, 7);
  check_place(must_fail(read_obj, "v 0 0 0\nf -1 -1 -2\n" + kSquare), 2, 9);
  check_place(must_fail(read_obj, kSquare + "f 1 2 99999999999999999999\n"), 5, 7);
  const Error uv = must_fail(read_obj, kSquare + "vt 0 0\nf 1/1 2/2 3/1\n");
  CHECK(uv.what == "face names texture coordinate 2, only 1 are defined");
  check_place(uv, 6, 9);
}

TEST_CASE("obj: malformed v, vt and f are errors with line and column") {
  const auto check = [](const std::string& line, Offset column, const char* what) {
    const Error error = must_fail(read_obj, kSquare + line);
    CHECK(error.code == ErrorCode::BadSyntax);
    CHECK(error.what == what);
    check_place(error, 5, column);
  };
  check("v 0 x 0\n", 5, "expected a number of a vertex, found 'x'");
  check("v 0 1,5 0\n", 5, "expected a number of a vertex, found '1,5'");
  check("v 0 1\n", 6, "a vertex needs 3 numbers, found 2");
  check("v 0 1 2 3 4\n", 12, "a vertex has 3, 4, 6 or 7 numbers, found 5");
  check("v 0 1 2 3 4 5 6 7\n", 17, "more numbers than a vertex has");
  check("vt\n", 3, "a texture coordinate needs 1 numbers, found 0");
  check("f 1 2 a\n", 7, "expected a face corner (v, v/vt, v//vn or v/vt/vn), found 'a'");
  check("f 1 2 3.5\n", 7, "expected a face corner (v, v/vt, v//vn or v/vt/vn), found '3.5'");
  check("f 1 2\n", 2, "a face has 2 corners, at least 3 are needed");
}

TEST_CASE("obj: 1, 2 and 7 threads give the same mesh over many chunks") {
  const std::string text = long_file(40'000);
  REQUIRE(text.size() > 2'000'000);
  const Result<Mesh> one = read_obj(Exec(1), text, "part");
  REQUIRE(one.has_value());
  CHECK(one->num_vertices() == 40'000);
  CHECK(one->num_triangles() == 2 * (40'000 - 3));
  CHECK(one->position[39'999] == Vec3{39'999.125, 39'999 % 17, 1e-3});
  CHECK(one->statements[7].triangle == 2 * (700 - 3));
  CHECK(one->uv_sets.at(0).per_vertex);
  // The last face names its own vertex, the two before and the one three before.
  std::vector<Index> last(one->corner_vertex.end() - 6, one->corner_vertex.end());
  std::ranges::sort(last);
  CHECK(last.front() == 39'996);
  CHECK(last.back() == 39'999);
  for (const int threads : {2, 7}) CHECK(same_mesh(*read_obj(Exec(threads), text, "part"), *one));
}

TEST_CASE("obj: lines are counted across chunks") {
  std::string text = long_file(40'000);
  const Offset lines = std::count(text.begin(), text.end(), '\n');
  text += "f 1 2 oops\n" + std::string(1'000'000, '\n') + "f 1 2 again\n";
  for (const int threads : {1, 7}) {
    const auto mesh = read_obj(Exec(threads), text, "part");
    REQUIRE(!mesh.has_value());
    check_place(mesh.error(), lines + 1, 7);
  }
}

TEST_CASE("write obj: uv at corners read back bit for bit, one vt for each different uv of a vertex") {
  constexpr Index kSize = 21;
  const Mesh mesh = grid(kSize);
  const std::vector<Vec2> corner_uv = torn_uv(mesh, kSize), other(mesh.num_vertices());
  const std::string text = written({.mesh = &mesh, .uv = other, .corner_uv = corner_uv});
  CHECK(count_lines(text, "vt ") == kSize * kSize + kSize);
  const Mesh back = read(text);
  CHECK(back.corner_vertex == mesh.corner_vertex);
  CHECK(same_bytes(back.position, mesh.position));
  REQUIRE(back.uv_sets.size() == 1);
  CHECK(same_bytes(back.uv_sets[0].corner_uv, corner_uv));
  CHECK_FALSE(back.uv_sets[0].per_vertex);
}

TEST_CASE("write obj: uv at corners are told apart by their bits") {
  Mesh mesh = read(kSquare + "v 5 5 5\nf 1 2 3 4\n");  // the last vertex is unreferenced
  const std::vector<Vec2> corner_uv = {{0.0, 1}, {2, 2}, {3, 3}, {-0.0, 1}, {3, 3}, {4, 4}};
  const std::string text = written({.mesh = &mesh, .corner_uv = corner_uv});
  CHECK(count_lines(text, "vt ") == 5);
  CHECK(same_bytes(read(text).uv_sets.at(0).corner_uv, corner_uv));
}

TEST_CASE("write obj: a vertex may have as many uv as corners") {
  constexpr Index kRim = 3000;
  Mesh fan;
  fan.position.resize(kRim + 1);
  std::vector<Vec2> corner_uv;
  for (Index t = 0; t < kRim; ++t) {
    for (const Index v : {0, 1 + t, 1 + (t + 1) % kRim}) fan.corner_vertex.push_back(v);
    for (int i = 0; i < 3; ++i) corner_uv.push_back({t * 0.1, double(i)});
  }
  const std::string text = written({.mesh = &fan, .corner_uv = corner_uv});
  CHECK(count_lines(text, "vt ") == 3 * kRim);
  CHECK(same_bytes(read(text).uv_sets.at(0).corner_uv, corner_uv));
}

TEST_CASE("write obj: chains are lines in groups of their names, after the faces") {
  Mesh mesh = read(kSquare + "g body\nf 1 2 3 4\n");
  const std::vector<Feature> features = {{"left sill#1\n", {0, 1, 2}, false, 2, 0, {}},
                                         {"plate", {}, false, 0, 0, {1}},
                                         {"", {2, 3, 0}, true, 3, 0, {}}};
  std::vector<std::string> warnings;
  const std::string text = format_obj(Exec(1), {.mesh = &mesh, .features = &features}, warnings);
  CHECK(text.ends_with("f 1 3 4\ng left_sill_1_\nl 1 2 3\ng _\nl 3 4 1 3\n"));
  CHECK(warnings == std::vector<std::string>{"OBJ cannot hold the region 'plate'; write PLY to keep it"});
  const Mesh back = read(text);
  CHECK(back.corner_vertex == mesh.corner_vertex);
  CHECK(back.statements.at(0).triangle == 0);
  for (std::size_t i = 1; i < back.statements.size(); ++i) CHECK(back.statements[i].triangle == 2);
}

TEST_CASE("write obj: 1, 2 and 7 threads give the same bytes with uv at corners") {
  const Mesh mesh = grid(150);
  const std::vector<Vec2> corner_uv = torn_uv(mesh, 150);
  const std::string one = written({.mesh = &mesh, .corner_uv = corner_uv}, 1);
  for (const int threads : {2, 7}) CHECK(written({.mesh = &mesh, .corner_uv = corner_uv}, threads) == one);
}
