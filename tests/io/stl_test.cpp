#include "io/weld.hpp"
#include "tests/io/io_support.hpp"

using namespace planish;
using namespace planish::test;

namespace {

Mesh read(std::string_view bytes) { return must_read(read_stl, bytes); }

std::string binary_stl(const Mesh& mesh, const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.num_triangles()));
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.f);
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.position[mesh.corner_vertex[3 * t + i]];
      for (const double x : {p.x, p.y, p.z}) put(bytes, static_cast<float>(x));
    }
    put(bytes, std::uint16_t{0x1234});
  }
  return bytes;
}

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}

/// Vertices in the order in which triangles first name them.
Mesh by_first_use(const Mesh& mesh) {
  Mesh result;
  std::vector<Index> renamed(mesh.num_vertices(), kNone);
  for (const Index v : mesh.corner_vertex) {
    if (renamed[v] == kNone) {
      renamed[v] = result.num_vertices();
      const Vec3 p = mesh.position[v];
      result.position.push_back({float(p.x), float(p.y), float(p.z)});
    }
    result.corner_vertex.push_back(renamed[v]);
  }
  return result;
}

}  // namespace

TEST_CASE("stl: binary files are welded, whatever their header says") {
  const Mesh mesh = grid(30);
  const Mesh wanted = by_first_use(mesh);
  for (const char* header : {"planish", "solid part\nfacet normal", ""}) {
    CHECK(same_mesh(read(binary_stl(mesh, header)), wanted));
  }
}

TEST_CASE("stl: ascii, words in any case, several solids, any line ends") {
  const Mesh mesh =
      read("SOLID a part\r\n" + facet("0 0 0", "1 0 0", "1 1 0") + "endsolid a part\n\n" +
           "solid\nFacet Normal nan -nan(ind) 1.#QNAN Outer Loop vertex 0 0 0 vertex 1 1 0 vertex 0 1 .1 "
           "EndLoop EndFacet\nendsolid");
  CHECK(mesh.position == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}});
  CHECK(mesh.corner_vertex == std::vector<Index>{0, 1, 2, 0, 2, 3});
}

TEST_CASE("stl: -0 is 0, but the next number is another vertex; nan and inf pass") {
  const Mesh mesh = read("solid\n" + facet("0 0 0", "-0 0 -0", "5e-324 0 0") +
                         facet("nan 0 0", "inf 0 0", "nan -0 0") + "endsolid\n");
  CHECK(mesh.corner_vertex == std::vector<Index>{0, 0, 1, 2, 3, 2});
  CHECK_FALSE(std::signbit(mesh.position[0].x));
  CHECK(std::isnan(mesh.position[2].x));
}

TEST_CASE("stl: errors of ascii files have a place") {
  const auto check = [](const std::string& text, Offset line, Offset column, const char* what) {
    const Error error = must_fail(read_stl, text);
    CHECK(error.what == what);
    CHECK(error.place.line == line);
    CHECK(error.place.column == column);
  };
  const std::string head = "solid\n" + facet("0 0 0", "1 0 0", "1 1 0");
  check(head + "facet normal 0 0 1\nouter loop\nvertex 0 0 a\n", 11, 12, "expected a coordinate, found 'a'");
  check(head + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", 12, 1,
        "expected 'vertex', found 'endloop'");
  check(head, 9, 1, "expected 'facet' or 'endsolid', found the end of the file");
  check(head + "endsolid\nrubbish\n", 10, 1, "expected 'solid', found 'rubbish'");
}

TEST_CASE("stl: a binary file of another length") {
  const std::string bytes = binary_stl(grid(3), "solid");
  const Error error = must_fail(read_stl, bytes.substr(0, bytes.size() - 1));
  CHECK(error.code == ErrorCode::Truncated);
  CHECK(error.place.byte == static_cast<Offset>(bytes.size()) - 1);
  CHECK(error.what == "8 triangles need 484 bytes, the file has 483");
  const Mesh longer = read(bytes + "xyz");
  CHECK(longer.num_triangles() == 8);
  CHECK(longer.warnings == std::vector<std::string>{"3 bytes after the last triangle are left out"});
}

TEST_CASE("stl: 1, 2 and 7 threads give the same mesh, binary and ascii over many chunks") {
  const Mesh mesh = grid(150);
  std::string text = "solid grid\n";
  const auto words = [&](Index c) {
    const Vec3& p = mesh.position[mesh.corner_vertex[c]];
    return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
  };
  for (Index c = 0; c < 3 * mesh.num_triangles(); c += 3) text += facet(words(c), words(c + 1), words(c + 2));
  text += "endsolid grid\n";
  REQUIRE(text.size() > 2'000'000);
  for (const std::string& bytes : {binary_stl(mesh, "grid"), text}) {
    const auto one = read_stl(Exec(1), bytes, "part");
    REQUIRE(one.has_value());
    CHECK(one->num_vertices() == mesh.num_vertices());
    CHECK(one->corner_vertex == by_first_use(mesh).corner_vertex);
    for (const int threads : {2, 7}) CHECK(same_mesh(*read_stl(Exec(threads), bytes, "part"), *one));
  }
  text.insert(text.size() - 200, "x");
  const auto broken = read_stl(Exec(2), text, "part");
  REQUIRE(!broken.has_value());
  CHECK(broken.error().place.line > 7 * mesh.num_triangles() - 12);
}

TEST_CASE("weld: many corners at one position and none at all") {
  const Welded none = weld(Exec(2), 0, [](Index) { return Vec3{}; });
  CHECK(none.position.empty());
  const Welded one = weld(Exec(2), 100'000, [](Index c) { return Vec3{c % 2 == 0 ? 0.0 : -0.0, 1, 2}; });
  CHECK(one.position == std::vector<Vec3>{{0, 1, 2}});
  CHECK(std::ranges::count(one.corner_vertex, 0) == 100'000);
}

TEST_CASE("weld: equal exactly where positions are equal") {
  const auto position = [](Index c) {
    const auto h = static_cast<std::uint32_t>(c) * 2654435761u;
    return Vec3{double(h % 23), double(h / 23 % 29), double(h / 1000 % 31)};
  };
  constexpr Index kCorners = 50'000;
  const Welded welded = weld(Exec(2), kCorners, position);
  Index seen = 0;  // vertices are numbered by first occurrence, each at its own position
  for (Index c = 0; c < kCorners; ++c) {
    const Index v = welded.corner_vertex[c];
    REQUIRE(v <= seen);
    seen += v == seen;
    REQUIRE(welded.position[v] == position(c));
  }
  std::vector<Vec3> sorted = welded.position;
  const auto key = [](const Vec3& p) { return (p.x * 100 + p.y) * 100 + p.z; };
  std::ranges::sort(sorted, {}, key);
  CHECK(std::ranges::adjacent_find(sorted) == sorted.end());
  CHECK(seen == static_cast<Index>(welded.position.size()));
}

TEST_CASE("weld: equal hashes of different positions are told apart") {
  const std::vector<Vec3> position = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  std::vector<KeyedIndex> group;
  for (Index c = 0; c < 5; ++c) group.push_back({.key = 77, .index = c});
  std::vector<Index> table, first(5, kNone);
  weld_detail::find_first(
      group, [&](Index c) { return position[c]; }, table, first);
  CHECK(first == std::vector<Index>{0, 1, 0, 3, 1});
}
