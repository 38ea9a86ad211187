#include "io/carry_over.hpp"

#include "io/uv_set.hpp"
#include "tests/io/io_support.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using namespace planish::test;

namespace {

/// Replaces triangles of the mesh by three around a point inside each, or both sides of an edge by two each.
class Refiner {
 public:
  explicit Refiner(const Mesh& mesh) : mesh_(mesh) {
    embedding_.position = mesh.position;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      part_.push_back({{corner(t, 0), corner(t, 1), corner(t, 2)}, t});
    }
  }

  void split_inside(Index t, Vec3 barycentric) {
    const Index v = add(t, barycentric);
    const Part whole = part_[t];
    for (int i = 0; i < 3; ++i) {
      Part part = whole;
      part.vertex[i] = v;
      i == 0 ? part_[t] = part : part_.emplace_back(part);
    }
  }

  /// The edge from corner i of t to the next; given as a point of triangle t only.
  void split_edge(Index t, int i, double share) {
    double b[3] = {0, 0, 0};
    b[i] = 1 - share;
    b[(i + 1) % 3] = share;
    const Index from = corner(t, i), to = corner(t, (i + 1) % 3);
    const Index v = add(t, {b[0], b[1], b[2]});
    for (std::size_t k = 0, n = part_.size(); k < n; ++k) {
      const auto at = [&](Index w) {
        return std::ranges::find(part_[k].vertex, w) - part_[k].vertex.begin();
      };
      if (at(from) == 3 || at(to) == 3) continue;
      Part other = part_[k];
      other.vertex[at(from)] = v;
      part_[k].vertex[at(to)] = v;
      part_.push_back(other);
    }
  }

  Embedding done() {
    for (const Part& part : part_) {
      embedding_.corner_vertex.insert(embedding_.corner_vertex.end(), part.vertex.begin(), part.vertex.end());
      embedding_.triangle_origin.push_back(part.origin);
    }
    return embedding_;
  }

 private:
  struct Part {
    std::array<Index, 3> vertex;
    Index origin;
  };
  Index corner(Index t, int i) const { return mesh_.corner_vertex[3 * t + i]; }
  Index add(Index t, Vec3 b) {
    const auto p = [&](int i) { return mesh_.position[corner(t, i)]; };
    embedding_.position.push_back(b.x * p(0) + b.y * p(1) + b.z * p(2));
    embedding_.vertex_origin.push_back({t, b});
    return static_cast<Index>(embedding_.position.size()) - 1;
  }

  const Mesh& mesh_;
  Embedding embedding_;
  std::vector<Part> part_;
};

Embedding unchanged(const Mesh& mesh) { return Refiner(mesh).done(); }

/// Inner points and edge points of many triangles.
Embedding refined(const Mesh& mesh, std::uint64_t seed) {
  Refiner refiner(mesh);
  shapes::Random random(seed);
  for (Index t = 0; t < mesh.num_triangles(); t += 3) {
    const double a = random.uniform() / 2, b = random.uniform() / 2;
    t % 2 == 0 ? refiner.split_inside(t, {a, b, 1 - a - b}) : refiner.split_edge(t, t % 3, a + 0.25);
  }
  return refiner.done();
}

Mesh adorned(Index n) {
  Mesh mesh = grid(n);
  std::vector<double> height;
  std::vector<float> thickness;
  for (const Vec3& p : mesh.position) {
    height.push_back(2 * p.x - 3 * p.y);
    thickness.push_back(static_cast<float>(p.x));
  }
  std::vector<std::int16_t> label;
  for (Index t = 0; t < mesh.num_triangles(); ++t) label.push_back(static_cast<std::int16_t>(t - 5));
  mesh.vertex_attributes = {column("height", Scalar::Float64, height),
                            column("thickness", Scalar::Float32, thickness)};
  mesh.triangle_attributes = {column("label", Scalar::Int16, label)};
  UvSet whole{"st", {}, true}, torn{"vt", {}, false};
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
    const Vec3 p = mesh.position[mesh.corner_vertex[c]];
    whole.corner_uv.push_back({0.1 * p.x, 0.3 * p.y});
    torn.corner_uv.push_back({0.1 * p.x + (c / 3 < 40 ? 7 : 0), 0.3 * p.y});
  }
  mesh.uv_sets = {whole, torn};
  mesh.comments = {"by hand"};
  mesh.warnings = {"a warning"};
  return mesh;
}

/// What is in force at each triangle, keyword by keyword.
std::vector<std::string> in_force(const Mesh& mesh, const std::vector<std::string>& keywords) {
  std::vector<std::string> result;
  std::vector<std::string> current(keywords.size());
  std::size_t next = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    for (; next < mesh.statements.size() && mesh.statements[next].triangle <= t; ++next) {
      const std::string& text = mesh.statements[next].text;
      for (std::size_t k = 0; k < keywords.size(); ++k) {
        const bool empty = text == keywords[k] || text == "s off";
        if (text.substr(0, text.find(' ')) == keywords[k]) current[k] = empty ? "" : text;
      }
    }
    std::string all;
    for (const std::string& text : current) all += text + "|";
    result.push_back(all);
  }
  return result;
}

}  // namespace

TEST_CASE("carry over: an embedding that changes nothing gives the input back") {
  Mesh mesh = adorned(9);
  mesh.statements = {{0, "mtllib a.mtl"}, {0, "g a"}, {5, "g a"}, {5, "s 1"}, {mesh.num_triangles(), "g"}};
  CHECK(same_mesh(carry_over(Exec(2), mesh, unchanged(mesh)), mesh));
}

TEST_CASE("carry over: linear vertex attributes and uv stay linear") {
  const Mesh mesh = adorned(12);
  const Embedding e = refined(mesh, 3);
  const Mesh carried = carry_over(Exec(2), mesh, e);
  CHECK(columns_fit(carried));
  const auto height = values<double>(carried.vertex_attributes, "height");
  const auto thickness = values<float>(carried.vertex_attributes, "thickness");
  REQUIRE(carried.num_vertices() > mesh.num_vertices() + 50);
  for (Index v = 0; v < carried.num_vertices(); ++v) {
    const Vec3 p = carried.position[v];
    CHECK(height[v] == doctest::Approx(2 * p.x - 3 * p.y));
    CHECK(thickness[v] == doctest::Approx(p.x).epsilon(1e-6));
  }
  for (std::size_t c = 0; c < carried.corner_vertex.size(); ++c) {
    const Vec3 p = carried.position[carried.corner_vertex[c]];
    CHECK(carried.uv_sets[0].corner_uv[c].x == doctest::Approx(0.1 * p.x));
    const double shift = e.triangle_origin[c / 3] < 40 ? 7 : 0;
    CHECK(carried.uv_sets[1].corner_uv[c].x == doctest::Approx(0.1 * p.x + shift));
    CHECK(carried.uv_sets[1].corner_uv[c].y == doctest::Approx(0.3 * p.y));
  }
  CHECK(carried.comments == mesh.comments);
  CHECK(carried.warnings == mesh.warnings);
}

TEST_CASE("carry over: uv that were one a vertex are so to the last bit, on split edges too") {
  Mesh mesh = adorned(30);
  const auto moved = [&](std::uint64_t seed) {
    std::vector<Index> new_of_old;
    Mesh other = shapes::relabelled(mesh, seed, new_of_old);
    other.uv_sets = {{"st", {}, true}};
    for (const Index v : other.corner_vertex) {
      other.uv_sets[0].corner_uv.push_back({other.position[v].x / 7, other.position[v].y / 11});
    }
    return other;
  };
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Mesh input = moved(seed);
    const Mesh carried = carry_over(Exec(2), input, refined(input, seed));
    CHECK(
        is_per_vertex(Exec(1), carried.corner_vertex, carried.uv_sets[0].corner_uv, carried.num_vertices()));
  }
}

TEST_CASE("carry over: triangles have the attributes of their origin") {
  const Mesh mesh = adorned(12);
  const Embedding e = refined(mesh, 5);
  const auto label = values<std::int16_t>(carry_over(Exec(2), mesh, e).triangle_attributes, "label");
  REQUIRE(label.size() == e.triangle_origin.size());
  for (std::size_t t = 0; t < label.size(); ++t) CHECK(label[t] == e.triangle_origin[t] - 5);
}

TEST_CASE("carry over: integers are rounded to the nearest and keep their limits") {
  Mesh mesh = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.vertex_attributes = {column<std::uint8_t>("red", Scalar::UInt8, {255, 255, 255}),
                            column<std::int32_t>("low", Scalar::Int32, {-2147483647 - 1, -2147483647 - 1, 0}),
                            column<std::int8_t>("small", Scalar::Int8, {0, -1, 7}),
                            column<std::uint32_t>("big", Scalar::UInt32, {4294967295u, 0, 4294967295u})};
  Refiner refiner(mesh);
  refiner.split_inside(0, {0.1, 0.7, 0.2});
  const Mesh carried = carry_over(Exec(1), mesh, refiner.done());
  CHECK(values<std::uint8_t>(carried.vertex_attributes, "red")[3] == 255);
  CHECK(values<std::int32_t>(carried.vertex_attributes, "low")[3] == -1717986918);
  CHECK(values<std::int8_t>(carried.vertex_attributes, "small")[3] == 1);
  CHECK(values<std::uint32_t>(carried.vertex_attributes, "big")[3] ==
        1288490189u);  // 0.3 (2^32 - 1) = ...188.5
}

TEST_CASE("carry over: a value that is not a number stays where it has weight") {
  Mesh mesh = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.vertex_attributes = {column<double>("q", Scalar::Float64, {1, 3, std::nan("")})};
  Refiner refiner(mesh);
  refiner.split_edge(0, 0, 0.5);
  refiner.split_edge(0, 1, 0.5);
  const auto q = values<double>(carry_over(Exec(1), mesh, refiner.done()).vertex_attributes, "q");
  CHECK(q[3] == 2);
  CHECK(std::isnan(q[4]));
}

TEST_CASE("carry over: every triangle has the statements of its origin in force, in any order of triangles") {
  Mesh mesh = adorned(8);
  mesh.statements = {{4, "mtllib a.mtl"}, {4, "usemtl red"},   {10, "g door"}, {10, "s 1"},    {30, "g roof"},
                     {30, "g sill"},      {41, "usemtl blue"}, {60, "s off"},  {70, "g door"}, {98, "g"}};
  const std::vector<std::string> keywords = {"g", "usemtl", "s"};
  const std::vector<std::string> wanted = in_force(mesh, keywords);
  Embedding e = refined(mesh, 9);
  shapes::Random random(4);
  for (int round = 0; round < 20; ++round) {
    const Mesh carried = carry_over(Exec(1), mesh, e);
    const std::vector<std::string> found = in_force(carried, keywords);
    for (std::size_t t = 0; t < found.size(); ++t) CHECK(found[t] == wanted[e.triangle_origin[t]]);
    CHECK(std::ranges::is_sorted(carried.statements, {}, &Statement::triangle));
    CHECK(std::ranges::count(carried.statements, "mtllib a.mtl", &Statement::text) == 1);
    CHECK(carried.statements.back().text == "g");
    CHECK(carried.statements.back().triangle == carried.num_triangles());
    for (std::size_t t = e.triangle_origin.size(); t-- > 1;) {  // the next order, by chance
      const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(t + 1));
      std::swap(e.triangle_origin[t], e.triangle_origin[other]);
      for (int i = 0; i < 3; ++i) std::swap(e.corner_vertex[3 * t + i], e.corner_vertex[3 * other + i]);
    }
  }
}

TEST_CASE("carry over: 1, 2 and 7 threads give the same mesh") {
  const Mesh mesh = adorned(110);
  const Embedding e = refined(mesh, 8);
  const Mesh one = carry_over(Exec(1), mesh, e);
  for (const int threads : {2, 7}) CHECK(same_mesh(carry_over(Exec(threads), mesh, e), one));
}
