#include "io/feature_files.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "io/file.hpp"
#include "io/polyline_chain.hpp"
#include "tests/io/io_support.hpp"

using namespace planish;
using test::put;
using test::TemporaryFolder;

namespace {

using Points = std::vector<Vec3>;
using Segments = std::vector<std::array<Index, 2>>;

Result<PolylineSource> csv(const std::string& text) { return parse_polyline_csv(text, "p.csv"); }
Result<PolylineSource> obj(const std::string& text) { return parse_polyline_obj(text, "p.obj"); }
Result<PolylineSource> ply(const std::string& text) { return parse_polyline_ply(Exec(), text, "p.ply"); }

PolylineSource good(Result<PolylineSource> polyline) {
  if (!polyline) FAIL(describe(polyline.error()));
  CHECK(!polyline->max_distance.has_value());
  return std::move(*polyline);
}

/// x of every point: enough to tell points of the tests apart.
std::vector<double> xs(const PolylineSource& polyline) {
  std::vector<double> x;
  for (const Vec3& p : polyline.point) x.push_back(p.x);
  return x;
}

void check_fault(const Result<PolylineSource>& polyline, Offset line, const std::string& message,
                 ErrorCode code = ErrorCode::BadSyntax) {
  REQUIRE(!polyline.has_value());
  CHECK(polyline.error().code == code);
  CHECK(polyline.error().place.line == line);
  CHECK_MESSAGE(polyline.error().what.find(message) != std::string::npos, polyline.error().what);
}

/// v 0 0 0, v 1 0 0, ... v 9 0 0.
const std::string kTen = [] {
  std::string text;
  for (int i = 0; i < 10; ++i) text += "v " + std::to_string(i) + " 0 0\n";
  return text;
}();

/// n distinct points in no order of their coordinates.
Points scattered(Index n) {
  Points points;
  for (Index i = 0; i < n; ++i) points.push_back({std::sin(1.7 * i), std::cos(0.3 * i * i), i / 3.0});
  return points;
}

/// A fixed shuffle.
std::vector<Index> shuffled(Index n) {
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::uint64_t state = 1;
  for (Index i = n; i-- > 1;) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    std::swap(order[i], order[static_cast<Index>((state >> 33) % static_cast<std::uint64_t>(i + 1))]);
  }
  return order;
}

std::string binary_ply(bool swapped, const std::vector<std::array<std::int32_t, 2>>& edges) {
  std::string bytes =
      std::string("ply\nformat binary_") + (swapped ? "big" : "little") +
      "_endian 1.0\nelement vertex 4\nproperty float z\nproperty uchar red\nproperty double x\n"
      "property float y\nelement face 1\nproperty list uchar int vertex_indices\nelement edge " +
      std::to_string(edges.size()) +
      "\nproperty float weight\nproperty int vertex2\nproperty int vertex1\nend_header\n";
  for (int v = 0; v < 4; ++v) {
    put(bytes, 0.5F * static_cast<float>(v), swapped);
    bytes += 'r';
    put(bytes, v * 1.0, swapped);
    put(bytes, 0.25F * static_cast<float>(v), swapped);
  }
  bytes += '\3';
  for (const std::int32_t v : {0, 1, 2}) put(bytes, v, swapped);
  for (const auto& edge : edges) {
    put(bytes, 1.5F, swapped);
    put(bytes, edge[1], swapped);
    put(bytes, edge[0], swapped);
  }
  return bytes;
}

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element edge 3\nproperty int vertex1\nproperty int vertex2\nend_header\n";

}  // namespace

TEST_CASE("feature_files: all separators of a CSV give the same points") {
  const Points expected = {{1, -2.5, 3e-3}, {4, 5, 6}};
  for (const char* text : {"1,-2.5,3e-3\n4,5,6\n", "1;-2.5;3e-3\n4;5;6", "1 -2.5 3e-3\n4\t5  6\n",
                           "1 , -2.5 ; +3e-3 \r\n\r\n4, 5, 6\r\n", "x,y,z\n1,-2.5,3e-3\n4,5,6\n",
                           "# a comment\n\nX Y Z\n1 -2.5 3e-3 # here too\n#\n4 5 6\n",
                           "\xef\xbb\xbf"
                           "1,-2.5,3e-3\n4,5,6\n",
                           "\xef\xbb\xbf\"x\";\"y\";\"z\"\n1;-2.5;3e-3\n4;5;6\n"}) {
    CAPTURE(text);
    const PolylineSource polyline = good(csv(text));
    CHECK(polyline.point == expected);
    CHECK(!polyline.closed);
  }
}

TEST_CASE("feature_files: a CSV whose last point is its first is closed and does not repeat it") {
  const PolylineSource ring = good(csv("0 0 0\n1 0 0\n1 1 0\n0 0 0\n"));
  CHECK(ring.closed);
  CHECK(ring.point == Points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  CHECK(!good(csv("0 0 0\n1 0 0\n1 1 0\n0 0 1e-300\n")).closed);
  check_fault(csv("0 0 0\n1 0 0\n0 0 0\n"), 3, "three points");
}

TEST_CASE("feature_files: what is no CSV of points names its line") {
  check_fault(csv(""), 1, "expected a point");
  check_fault(csv("x y z\n"), 2, "expected a point");
  check_fault(csv("x y z\na b c\n"), 2, "number 1 is 'a'");
  check_fault(csv("0 0 0\n1 2\n"), 2, "number 3 is the end of the line");
  check_fault(csv("0 0 0\n1,,2\n"), 2, "number 2");
  check_fault(csv("0 0 0\n\n1 2 3 4\n"), 3, "after three numbers");
  check_fault(csv("0,5;1,5;2,5\n"), 1, "decimal point");
  check_fault(csv("0 0 0\n1 2 3,\n"), 2, "after three numbers");
  check_fault(csv("0 0 0\n1 nan 3\n"), 2, "not a finite number");
  check_fault(csv("nan 0 0\n1 2 3\n"), 1, "not a finite number");
  check_fault(csv("0 0 0\n1 2 1e999\n"), 2, "not a finite number");
  check_fault(csv("0 0 0\n1 2x 3\n"), 2, "number 2 is '2x'");
  const auto place = csv("0 0 0\n1 2x 3\n").error().place;
  CHECK(place.file == "p.csv");
  CHECK(place.column == 3);
}

TEST_CASE("feature_files: lines of an OBJ that meet are one polyline, as the first of them runs") {
  CHECK(xs(good(obj(kTen + "l 1 2 3 4\n"))) == std::vector<double>{0, 1, 2, 3});
  CHECK(xs(good(obj(kTen + "l 3 4\nl 4 5\nl 2 3\nl 1 2\n"))) == std::vector<double>{0, 1, 2, 3, 4});
  CHECK(xs(good(obj(kTen + "l 4 3\nl 4 5\nl 2 3\nl 1 2\n"))) == std::vector<double>{4, 3, 2, 1, 0});
  CHECK(xs(good(obj(kTen + "l 8/1 9/2 10/3\nf 1 2 3\ng x\nl 5 -3\n"))) == std::vector<double>{4, 7, 8, 9});
  CHECK(xs(good(obj("l 2 1\n" + kTen))) == std::vector<double>{1, 0});
  CHECK(xs(good(obj(kTen + "l 1 \\\n 2 # on\nl 2 3"))) == std::vector<double>{0, 1, 2});
}

TEST_CASE("feature_files: an OBJ polyline that returns is closed, from its first vertex on") {
  for (const char* lines : {"l 3 4 5 3\n", "l 3 4\nl 4 5\nl 5 3\n", "l 3 4\nl 3 5\nl 5 4\n"}) {
    CAPTURE(lines);
    const PolylineSource ring = good(obj(kTen + lines));
    CHECK(ring.closed);
    CHECK(xs(ring) == std::vector<double>{2, 3, 4});
  }
}

TEST_CASE("feature_files: vertices at the same position join lines") {
  const auto joined =
      good(obj("v 0 0 0\nv 1 0 0\nl 1 2\nv 1 0 -0.0\nv 2 0 0\nl 3 4\nv 3 0 0\nv 2 0 0\nl 5 6\n"));
  CHECK(xs(joined) == std::vector<double>{0, 1, 2, 3});
}

TEST_CASE("feature_files: OBJ lines that are no single polyline name the vertices to blame") {
  const auto branching = obj(kTen + "l 1 2 3\nl 2 4\n");
  check_fault(branching, 12, "branches");
  CHECK(branching.error().ids == std::vector<Index>{1});
  CHECK(branching.error().element == ElementKind::Vertex);
  const auto pieces = obj(kTen + "l 1 2\nl 4 5\nl 7 8\n");
  check_fault(pieces, 12, "several pieces");
  CHECK(pieces.error().ids == std::vector<Index>{3, 4, 6, 7});
  CHECK(pieces.error().count == 4);
  const auto ring_and_line = obj(kTen + "l 1 2 3 1\nl 4 5\n");
  check_fault(ring_and_line, 12, "several pieces");
  const auto repeated = obj(kTen + "l 1 2\nl 3 3 2\n");
  check_fault(repeated, 12, "without length");
  CHECK(repeated.error().ids == std::vector<Index>{2});
  check_fault(obj(kTen + "l 1 2\nl 2 1\n"), 11, "three points");
}

TEST_CASE("feature_files: what is no OBJ with lines names its line") {
  check_fault(obj(kTen), 11, "expected a polyline");
  check_fault(obj(kTen + "l 1\n"), 11, "two vertices, found 1");
  check_fault(obj(kTen + "l\n"), 11, "two vertices, found 0");
  check_fault(obj(kTen + "l 1 two\n"), 11, "found 'two'");
  check_fault(obj(kTen + "l 1 2x\n"), 11, "found '2x'");
  check_fault(obj(kTen + "l 1 11\n"), 11, "names vertex 11, only 10", ErrorCode::IndexOutOfRange);
  check_fault(obj(kTen + "l 1 0\n"), 11, "names vertex 0", ErrorCode::IndexOutOfRange);
  check_fault(obj(kTen + "l 1 -11\n"), 11, "names vertex -11", ErrorCode::IndexOutOfRange);
  check_fault(obj(kTen + "l 1 99999999999999999999\n"), 11, "names vertex", ErrorCode::IndexOutOfRange);
  check_fault(obj("v 0 0 0\nv 1 nan 0\nl 1 2\n"), 3, "vertex 2 of the line");
  check_fault(obj("v 0 0 0\nv 1 0\nl 1 2\n"), 2, "expected a number of a vertex");
}

TEST_CASE("feature_files: edges of a PLY, ascii and binary in both byte orders") {
  const PolylineSource text = good(ply(kPlyHead + "0 0 0\n1 0.25 0.5\n2 0.5 1\n3 0.75 1.5\n2 1\n3 2\n0 1\n"));
  CHECK(xs(text) == std::vector<double>{3, 2, 1, 0});
  CHECK(!text.closed);
  for (const bool swapped : {false, true}) {
    const PolylineSource open = good(ply(binary_ply(swapped, {{2, 1}, {3, 2}, {0, 1}})));
    CHECK(open.point == text.point);
    const PolylineSource ring = good(ply(binary_ply(swapped, {{1, 0}, {3, 2}, {0, 3}, {2, 1}})));
    CHECK(ring.closed);
    CHECK(xs(ring) == std::vector<double>{1, 0, 3, 2});
  }
}

TEST_CASE("feature_files: what is no PLY with edges is refused with its place") {
  const std::string points = "0 0 0\n1 0 0\n2 0 0\n3 0 0\n";
  check_fault(ply(kPlyHead + points + "0 1\n1 2\n2 4\n"), 17, "names vertex 4, only 4",
              ErrorCode::IndexOutOfRange);
  check_fault(ply(kPlyHead + points + "0 1\n-1 2\n2 3\n"), 16, "names vertex -1", ErrorCode::IndexOutOfRange);
  check_fault(ply(kPlyHead + "0 0 0\nnan 0 0\n2 0 0\n3 0 0\n0 2\n2 1\n2 3\n"), 16, "vertex 1 of the edge");
  const auto branching = ply(kPlyHead + points + "0 1\n1 2\n1 3\n");
  check_fault(branching, 17, "branches");
  CHECK(branching.error().ids == std::vector<Index>{1});
  const auto branching_binary = ply(binary_ply(true, {{0, 1}, {1, 2}, {1, 3}}));
  REQUIRE(!branching_binary.has_value());
  CHECK(branching_binary.error().place.byte ==
        static_cast<Offset>(binary_ply(true, {{0, 1}, {1, 2}, {1, 3}}).size()) - 12);
  check_fault(
      ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n0 0 0\n"),
      1, "no element 'edge'");
  check_fault(ply("ply\nformat ascii 1.0\nelement edge 1\nproperty int vertex1\nproperty int "
                  "vertex2\nend_header\n0 1\n"),
              1, "no element 'vertex'");
  check_fault(
      ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "element edge 1\nproperty float vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 0\n"),
      1, "without integers vertex1 and vertex2");
  const std::string whole = binary_ply(false, {{0, 1}, {1, 2}});
  for (std::size_t size = 0; size < whole.size(); ++size) CHECK(!ply(whole.substr(0, size)).has_value());
}

TEST_CASE("feature_files: a polyline cut into segments in any order is found again") {
  for (const Index n : {2, 3, 4, 17, 1000}) {
    for (const bool closed : {false, true}) {
      if (closed && n < 3) continue;
      CAPTURE(n);
      CAPTURE(closed);
      const Points points = scattered(n);
      const std::vector<Index> order = shuffled(closed ? n : n - 1);
      Segments segments;
      for (const Index s : order) {
        const Index a = s, b = (s + 1) % n;
        segments.push_back(s % 3 == 1 && !segments.empty() ? std::array{b, a} : std::array{a, b});
      }
      const ChainOfSegments chain = join_segments(points, segments);
      REQUIRE(!chain.fault);
      CHECK(chain.polyline.closed == closed);
      Points expected = points;  // the first segment runs forwards
      if (closed) std::ranges::rotate(expected, expected.begin() + order[0]);
      CHECK(chain.polyline.point == expected);
    }
  }
}

TEST_CASE("feature_files: the extension tells the format, compressed or not") {
  const TemporaryFolder folder;
  const Exec exec;
  REQUIRE(write_file(folder / "a.CSV", "0 0 0\n1 0 0\n"));
  REQUIRE(write_file(folder / "a.xyz", "0 0 0\n1 0 0\n"));
  REQUIRE(write_file(folder / "a.txt.gz", "0 0 0\n1 0 0\n"));
  REQUIRE(write_file(folder / "a.obj.gz", kTen + "l 1 2\n"));
  REQUIRE(write_file(folder / "a.ply", kPlyHead + "0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1\n1 2\n2 3\n"));
  for (const char* name : {"a.CSV", "a.xyz", "a.txt.gz", "a.obj.gz"}) {
    CAPTURE(name);
    CHECK(xs(good(read_feature_file(exec, folder / name))) == std::vector<double>{0, 1});
  }
  CHECK(xs(good(read_feature_file(exec, folder / "a.ply"))) == std::vector<double>{0, 1, 2, 3});
  const auto unknown = read_feature_file(exec, folder / "a.igs");
  REQUIRE(!unknown.has_value());
  CHECK(unknown.error().what.find(".csv") != std::string::npos);
  const auto none = read_feature_file(exec, folder / "none.csv");
  REQUIRE(!none.has_value());
  CHECK(none.error().code == ErrorCode::CannotOpen);
}
