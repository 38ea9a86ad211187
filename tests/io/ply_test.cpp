#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

Mesh read(std::string_view bytes) { return must_read(read_ply, bytes); }

const std::string kHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kRows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

/// Every scalar type in one binary file: a triangle and a quad with lists and attributes of all kinds.
std::string binary_file(bool big_endian) {
  const bool swapped = big_endian == (std::endian::native == std::endian::little);
  std::string bytes =
      std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\ncomment made by hand\n"
      "element camera 1\nproperty double focus\nproperty list ushort short knots\n"
      "element face 2\nproperty char i8\nproperty uint8 u8\nproperty list uint uint16 vertex_index\n"
      "property float32 f\nproperty list uchar float texcoord\nproperty list int8 double extra\n"
      "element vertex 5\nproperty short z\nproperty uint label\nproperty double x\nproperty float t\n"
      "property float y\nproperty float s\nproperty int16 small\nend_header\n";
  const auto add = [&]<class... T>(T... value) { (put(bytes, value, swapped), ...); };
  add(35.0, std::uint16_t{2}, std::int16_t{7}, std::int16_t{8});
  add(std::int8_t{-3}, std::uint8_t{200}, std::uint32_t{3}, std::uint16_t{0}, std::uint16_t{1},
      std::uint16_t{4});
  add(1.5f, std::uint8_t{6}, 0.f, 0.f, 1.f, 0.f, .5f, 1.f, std::int8_t{1}, 2.0);
  add(std::int8_t{4}, std::uint8_t{100}, std::uint32_t{4}, std::uint16_t{0}, std::uint16_t{1},
      std::uint16_t{2}, std::uint16_t{3});
  add(-2.5f, std::uint8_t{8}, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f, 1.f, std::int8_t{0});
  for (short v = 0; v < 5; ++v) {
    const bool up = v >= 2;
    add(std::int16_t(v), std::uint32_t(4'000'000'000u + v), v == 0 || v == 3 ? 0.1 : 1.0,
        static_cast<float>(v) * 2, up ? 1.f : 0.f, static_cast<float>(v), std::int16_t(-v));
  }
  return bytes;
}

}  // namespace

TEST_CASE("ply: ascii with polygons") {
  const Mesh mesh = read(kHeader + kRows);
  CHECK(mesh.position == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(mesh.corner_vertex == std::vector<Index>{0, 1, 2, 0, 2, 3});
}

TEST_CASE("ply: both byte orders, any types and order of properties and elements") {
  const Mesh little = read(binary_file(false)), big = read(binary_file(true));
  CHECK(same_mesh(little, big));
  CHECK(little.position == std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 1}, {1, 1, 2}, {0.1, 1, 3}, {1, 1, 4}});
  CHECK(little.corner_vertex == std::vector<Index>{0, 1, 4, 0, 1, 2, 0, 2, 3});
  CHECK(values<std::int8_t>(little.triangle_attributes, "i8") == std::vector<std::int8_t>{-3, 4, 4});
  CHECK(values<std::uint8_t>(little.triangle_attributes, "u8") == std::vector<std::uint8_t>{200, 100, 100});
  CHECK(values<float>(little.triangle_attributes, "f") == std::vector<float>{1.5f, -2.5f, -2.5f});
  CHECK(values<std::uint32_t>(little.vertex_attributes, "label")[4] == 4'000'000'004u);
  CHECK(values<std::int16_t>(little.vertex_attributes, "small")[3] == -3);
  CHECK(little.vertex_attributes.size() == 2);
  CHECK(little.comments == std::vector<std::string>{"made by hand"});
  CHECK(little.warnings == std::vector<std::string>{"element 'camera' (1 rows) is left out",
                                                    "list 'extra' of element 'face' is left out"});
  REQUIRE(little.uv_sets.size() == 2);
  CHECK(little.uv_sets[0].name == "st");
  CHECK(little.uv_sets[0].per_vertex);
  CHECK(little.uv_sets[0].corner_uv[2] == Vec2{4, 8});
  CHECK(little.uv_sets[1].name == "texcoord");
  CHECK(little.uv_sets[1].corner_uv ==
        std::vector<Vec2>{{0, 0}, {1, 0}, {.5, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}});
}

TEST_CASE("ply: uv spellings in order of preference") {
  const Mesh mesh = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float u\nproperty float texture_v\nproperty float "
      "x\n"
      "property float y\nproperty float z\nproperty float texture_u\nproperty float v\nproperty float s\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "1 2 0 0 0 3 4 5\n1 2 1 0 0 3 4 5\n1 2 0 1 0 3 4 5\n3 0 1 2\n");
  REQUIRE(mesh.uv_sets.size() == 2);
  CHECK(mesh.uv_sets[0].name == "uv");
  CHECK(mesh.uv_sets[0].corner_uv[0] == Vec2{1, 4});
  CHECK(mesh.uv_sets[1].name == "texture_uv");
  CHECK(mesh.uv_sets[1].corner_uv[0] == Vec2{3, 2});
  CHECK(values<float>(mesh.vertex_attributes, "s")[0] == 5);  // s without t is a property like any other
}

TEST_CASE("ply: texcoord of another length is left out with a warning") {
  const Mesh mesh = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float "
      "texcoord\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0\n");
  CHECK(mesh.uv_sets.empty());
  CHECK(mesh.warnings ==
        std::vector<std::string>{"the list 'texcoord' is left out: face 0 has 0 values for 3 corners"});
}

TEST_CASE("ply: floats of ascii files are rounded once, to their own type") {
  const Mesh mesh = read(
      "ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty double x\r\nproperty float y\r\nproperty "
      "float z\r\n"
      "property float q\r\nend_header\r\n0.1 0.1 nan 16777217.0000001\r\n");
  CHECK(mesh.position[0].x == 0.1);
  CHECK(mesh.position[0].y == double{0.1f});
  CHECK(std::isnan(mesh.position[0].z));
  CHECK(values<float>(mesh.vertex_attributes, "q")[0] == 16777218.f);
  CHECK(mesh.num_triangles() == 0);
}

TEST_CASE("ply: errors of ascii rows have line and column") {
  const auto check = [](const std::string& bytes, ErrorCode code, Offset line, const char* what) {
    const Error error = must_fail(read_ply, bytes);
    CHECK(error.code == code);
    CHECK(error.place.line == line);
    CHECK(error.what == what);
  };
  check(kHeader + "0 0 0\n1 0\n", ErrorCode::BadSyntax, 11,
        "expected a number for 'z' of element 'vertex', found the end of the line");
  check(kHeader + "0 0 0 0\n", ErrorCode::BadSyntax, 10,
        "a row of element 'vertex' has more numbers than properties");
  check(kHeader + "0 0 0\n1 0 0\n", ErrorCode::Truncated, 12,
        "the file ends after 2 of 4 rows of element 'vertex'");
  check(kHeader + kRows + "\n3 0 1 2\n", ErrorCode::BadSyntax, 16, "the header announces no more rows here");
  check(kHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 4\n", ErrorCode::IndexOutOfRange, 14,
        "face 0 names vertex 4, the last is 3");
  check(kHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 -1\n", ErrorCode::IndexOutOfRange, 14,
        "face 0 names vertex -1, the last is 3");
  check(kHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n300 0 1 2\n", ErrorCode::BadSyntax, 14,
        "expected an integer in range for 'vertex_indices' of element 'face', found '300'");
  check(kHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n", ErrorCode::BadSyntax, 14,
        "a face has 2 corners, at least 3 are needed");
}

TEST_CASE("ply: errors of the header name the line") {
  const auto check = [](const std::string& bytes, Offset line) {
    const Error error = must_fail(read_ply, bytes);
    CHECK(error.place.line == line);
  };
  check("", 1);
  check("plyx\n", 1);
  check("ply\nformat binary 1.0\nend_header\n", 2);
  check("ply\nformat ascii 2.0\nend_header\n", 2);
  check("ply\nformat ascii 1.0\nelement vertex -4\nend_header\n", 3);
  check("ply\nformat ascii 1.0\nelement vertex 4\nproperty quad x\nend_header\n", 4);
  check("ply\nformat ascii 1.0\nproperty float x\nend_header\n", 3);
  check("ply\nformat ascii 1.0\nelement vertex 4\nproperty list float int x\nend_header\n", 4);
  check("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty int x\nend_header\n", 5);
  check("ply\nformat ascii 1.0\nelement vertex 4\nelement vertex 4\nend_header\n", 4);
  check("ply\nformat ascii 1.0\nelephant\nend_header\n", 3);
  check("ply\nformat ascii 1.0\n", 3);
}

TEST_CASE("ply: huge counts and list lengths are refused before memory is asked for") {
  const std::string vertex = "property double x\nproperty double y\nproperty double z\n";
  const std::string face = "property list int int vertex_indices\nend_header\n";
  for (const char* count : {"999999999999", "4000000000", "99999999999999999999999"}) {
    for (const char* format : {"ascii", "binary_little_endian"}) {
      const std::string head = std::string("ply\nformat ") + format + " 1.0\nelement vertex ";
      CHECK(must_fail(read_ply, head + count + "\n" + vertex + "element face 1\n" + face).code ==
            ErrorCode::Truncated);
      CHECK(must_fail(read_ply, head + "0\n" + vertex + "element face " + count + "\n" + face).code ==
            ErrorCode::Truncated);
    }
  }
  std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 0\n" + vertex + "element face 1\n" + face;
  const auto byte = static_cast<Offset>(list.size());
  std::string longest = list, negative = list;
  put(longest, std::int32_t{0x7fffffff});
  put(negative, std::int32_t{-1});
  CHECK(must_fail(read_ply, longest).code == ErrorCode::Truncated);
  CHECK(must_fail(read_ply, negative).code == ErrorCode::BadSyntax);
  CHECK(must_fail(read_ply, negative).place.byte == byte);
}

TEST_CASE("ply: bytes after the last row are an error, line ends are none") {
  const std::string bytes = binary_file(false);
  CHECK(same_mesh(read(bytes + "\n"), read(bytes)));
  const Error error = must_fail(read_ply, bytes + "abc");
  CHECK(error.code == ErrorCode::BadSyntax);
  CHECK(error.place.byte == static_cast<Offset>(bytes.size()));
}

TEST_CASE("ply: 1, 2 and 7 threads give the same mesh") {
  Mesh mesh = grid(120);
  std::vector<float> quality;
  for (Index v = 0; v < mesh.num_vertices(); ++v) quality.push_back(0.1f * static_cast<float>(v));
  mesh.vertex_attributes.push_back(column("quality", Scalar::Float32, quality));
  std::vector<std::string> warnings;
  const std::string bytes = format_ply(Exec(1), {.mesh = &mesh}, warnings);
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 14400\nproperty double x\nproperty double y\n"
      "property double z\nelement face 14161\nproperty list uchar int vertex_indices\nend_header\n";
  for (Index v = 0; v < 14400; ++v)
    text += std::to_string(v % 120) + " " + std::to_string(v / 120) + " 1e-1\n";
  for (Index v = 0; v < 14161; ++v) {
    const Index a = v / 119 * 120 + v % 119;
    text += v % 3 == 0 ? "4 " : "3 ";
    for (const Index w : {a, a + 1, a + 121}) text += std::to_string(w) + " ";
    text += v % 3 == 0 ? std::to_string(a + 120) + "\n" : "\n";
  }
  REQUIRE(text.size() > 400'000);
  for (const std::string& file : {bytes, text}) {
    const auto one = read_ply(Exec(1), file, "part");
    REQUIRE(one.has_value());
    for (const int threads : {2, 7}) CHECK(same_mesh(*read_ply(Exec(threads), file, "part"), *one));
  }
}

TEST_CASE("write ply: uv at corners are the list texcoord and read back bit for bit") {
  Mesh mesh = grid(15);
  std::vector<Vec2> corner_uv, old_uv;
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    corner_uv.push_back({0.1 * static_cast<double>(c), -1e-320});
    const Vec3 p = mesh.position[mesh.corner_vertex[c]];
    old_uv.push_back({p.y, p.x});
  }
  mesh.uv_sets = {{.name = "st", .corner_uv = old_uv, .per_vertex = true}};
  std::vector<std::string> warnings;
  const std::string bytes = format_ply(Exec(2), {.mesh = &mesh, .corner_uv = corner_uv}, warnings);
  CHECK(warnings.empty());
  CHECK(bytes.find("property double s\n") == std::string::npos);
  const Mesh back = read(bytes);
  REQUIRE(back.uv_sets.size() == 2);
  CHECK(back.uv_sets[0].name == "texture_uv");
  CHECK(same_bytes(back.uv_sets[0].corner_uv, old_uv));
  CHECK(back.uv_sets[1].name == "texcoord");
  CHECK(same_bytes(back.uv_sets[1].corner_uv, corner_uv));
}

TEST_CASE("write ply: chains are rows of the element edge, with names in comments") {
  Mesh mesh = grid(3);
  mesh.comments = {"feature 0 of an earlier run", "features are good", "feature of a car"};
  const std::vector<Feature> features = {{"sill", {0, 1, 2}, false, 2, 0, {}},
                                         {"two\nlines", {4, 5, 8}, true, 3, 0, {}}};
  std::vector<std::string> warnings;
  const std::string bytes = format_ply(Exec(2), {.mesh = &mesh, .features = &features}, warnings);
  CHECK(warnings.empty());
  CHECK(bytes.find("element edge 5\nproperty int vertex1\nproperty int vertex2\nproperty int "
                   "feature\nend_header\n") != std::string::npos);
  std::string rows;
  for (const Index i : {0, 1, 0, 1, 2, 0, 4, 5, 1, 5, 8, 1, 8, 4, 1}) put(rows, i);
  CHECK(bytes.ends_with(rows));
  const Mesh back = read(bytes);
  CHECK(back.comments == std::vector<std::string>{"features are good", "feature of a car", "feature 0 sill",
                                                  "feature 1 two lines"});
  CHECK(back.corner_vertex == mesh.corner_vertex);
  CHECK(same_bytes(back.position, mesh.position));
  CHECK(back.warnings == std::vector<std::string>{"element 'edge' (5 rows) is left out"});
}

TEST_CASE("write ply: regions are a number a face, the last where they share one") {
  Mesh mesh = grid(3);
  mesh.triangle_attributes.push_back(column<float>("region", Scalar::Float32, std::vector<float>(8, 2)));
  const std::vector<Feature> features = {{"sill", {0, 1}, false, 1, 0, {}},
                                         {"plate", {}, false, 0, 0, {1, 2, 5}},
                                         {"patch", {}, false, 0, 0, {2, 3}}};
  std::vector<std::string> warnings;
  const Mesh back = read(format_ply(Exec(2), {.mesh = &mesh, .features = &features}, warnings));
  CHECK(values<std::int32_t>(back.triangle_attributes, "region") ==
        std::vector<std::int32_t>{-1, 1, 2, 2, -1, 1, -1, -1});
  CHECK(
      warnings ==
      std::vector<std::string>{
          "the input's property 'region' is replaced by a new one of this name",
          "the property 'region' holds one number a face: 1 faces of earlier regions are given to 'patch'"});
  const std::vector<Feature> chains = {features[0]}, none;
  CHECK(values<float>(
            read(format_ply(Exec(2), {.mesh = &mesh, .features = &chains}, warnings)).triangle_attributes,
            "region")[0] == 2);
  CHECK(format_ply(Exec(2), {.mesh = &mesh, .features = &none}, warnings) ==
        format_ply(Exec(2), {.mesh = &mesh}, warnings));
}
