#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

Mesh read(std::string_view text) { return must_read(read_off, text); }

}  // namespace

TEST_CASE("off: header words, counts on the same line, comments, missing edge count") {
  const std::string rows = "0 0 0\n1 0 0 # corner\n\n1 1 0\n0 1 0\n# faces\n4 0 1 2 3\n3 0 1 2\n";
  for (const char* head :
       {"OFF\n4 2 0\n", "OFF 4 2 0\n", "# first\nOFF # second\n\n4 2\n", "OFF\r\n 4 2 5\r\n"}) {
    const Mesh mesh = read(head + rows);
    CHECK(mesh.position == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(mesh.corner_vertex == std::vector<Index>{0, 1, 2, 0, 2, 3, 0, 1, 2});
    CHECK(mesh.warnings.empty());
  }
}

TEST_CASE("off: colours of vertices are kept, those of faces are not") {
  const Mesh bytes = read("COFF\n3 1 0\n0 0 0 255 0 1 128\n1 0 0 0 1 2 3\n0 1 0 9 8 7 6\n3 0 1 2 255 0 0\n");
  CHECK(values<std::uint8_t>(bytes.vertex_attributes, "red") == std::vector<std::uint8_t>{255, 0, 9});
  CHECK(values<std::uint8_t>(bytes.vertex_attributes, "alpha") == std::vector<std::uint8_t>{128, 3, 6});
  CHECK(bytes.triangle_attributes.empty());
  const Mesh fractions = read("COFF\n3 1 0\n0 0 0 1 0 0.1\n1 0 0 0 1 0\n0 1 0 0 0 0\n3 0 1 2 0.1 0.2 0.3\n");
  CHECK(values<double>(fractions.vertex_attributes, "blue") == std::vector<double>{0.1, 0, 0});
  CHECK(fractions.vertex_attributes.size() == 3);
}

TEST_CASE("off: normals are attributes, other numbers are left out with a warning") {
  const Mesh normals = read("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
  CHECK(values<double>(normals.vertex_attributes, "nz") == std::vector<double>{1, 1, 1});
  const Mesh more = read("OFF\n3 1 0\n0 0 0 7 7 7\n1 0 0\n0 1 0\n3 0 1 2\n");
  CHECK(more.vertex_attributes.empty());
  CHECK(more.warnings ==
        std::vector<std::string>{"numbers after the coordinates of 1 vertices are left out"});
}

TEST_CASE("off: errors have a line") {
  const auto check = [](const char* text, ErrorCode code, Offset line) {
    const Error error = must_fail(read_off, text);
    CHECK(error.code == code);
    CHECK(error.place.line == line);
  };
  check("", ErrorCode::Truncated, 1);
  check("OOF\n", ErrorCode::BadSyntax, 1);
  check("OFF BINARY\n", ErrorCode::BadSyntax, 1);
  check("OFF\n3 x 0\n", ErrorCode::BadSyntax, 2);
  check("OFF\n3 1 0\n0 0 0\n1 0 0\n", ErrorCode::Truncated, 5);
  check("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ErrorCode::BadSyntax, 4);
  check("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ErrorCode::BadSyntax, 6);
  check("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ErrorCode::IndexOutOfRange, 6);
  check("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", ErrorCode::BadSyntax, 6);
  check("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", ErrorCode::BadSyntax, 7);
  check("OFF\n9999999999 1 0\n0 0 0\n", ErrorCode::Truncated, 4);
}

TEST_CASE("off: 1, 2 and 7 threads give the same mesh") {
  std::string text = "OFF 30000 29998 0\n";
  for (Index v = 0; v < 30000; ++v) text += std::to_string(v) + " 0." + std::to_string(v % 10) + " 1\n";
  for (Index t = 0; t < 29998; ++t) {
    text += "3 " + std::to_string(t) + " " + std::to_string(t + 1) + " " + std::to_string(t + 2) + "\n";
  }
  REQUIRE(text.size() > 800'000);
  const auto one = read_off(Exec(1), text, "part");
  REQUIRE(one.has_value());
  CHECK(one->position[29999] == Vec3{29999, 0.9, 1});
  CHECK(one->corner_vertex.back() == 29999);
  for (const int threads : {2, 7}) CHECK(same_mesh(*read_off(Exec(threads), text, "part"), *one));
}
