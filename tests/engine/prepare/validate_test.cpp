#include "engine/prepare/validate.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/prepare/prepare.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

Diagnosis diagnosis_of(const Mesh& mesh) { return diagnose(Exec(2), mesh.surface()).value(); }

const Defect* find(const Diagnosis& diagnosis, ErrorCode code) {
  const auto found = std::find_if(diagnosis.defects.begin(), diagnosis.defects.end(),
                                  [&](const Defect& d) { return d.code == code; });
  return found == diagnosis.defects.end() ? nullptr : &*found;
}

/// The only kind of defect, with exactly these ids.
void check_only(const Mesh& mesh, ErrorCode code, const std::vector<Index>& ids) {
  const Diagnosis diagnosis = diagnosis_of(mesh);
  REQUIRE(diagnosis.defects.size() == 1);
  CHECK(diagnosis.defects[0].code == code);
  CHECK(diagnosis.defects[0].ids == ids);
}

}  // namespace

TEST_CASE("validate: a sound disk has no defect and its facts are right") {
  const Diagnosis d = diagnosis_of(shapes::height_field(11, shapes::flat));
  CHECK(d.usable());
  CHECK(d.components == 1);
  CHECK(d.boundary_loops == 1);
  CHECK(d.boundary_edges == 40);
  CHECK(d.euler == 1);
  CHECK(d.genus == 0);
  CHECK(d.area == doctest::Approx(4));
  CHECK(d.upper.x - d.lower.x == doctest::Approx(2));
}

TEST_CASE("validate: unreferenced vertices are counted and are no defect") {
  Mesh mesh = shapes::wavy_disk(100);
  mesh.position.insert(mesh.position.begin(), Vec3{1e9, std::nan(""), 0});
  for (Index& v : mesh.corner_vertex) ++v;
  const Diagnosis d = diagnosis_of(mesh);
  CHECK(d.usable());
  CHECK(d.unreferenced_vertices == 1);
}

TEST_CASE("validate: no triangles") {
  Mesh mesh;
  mesh.position = {{0, 0, 0}};
  CHECK(diagnosis_of(mesh).defects.at(0).code == ErrorCode::NoTriangles);
}

TEST_CASE("validate: an index out of range is an error that names the triangle") {
  Mesh mesh = shapes::wavy_disk(100);
  mesh.corner_vertex[3 * 17 + 1] = 100'000;
  mesh.corner_vertex[3 * 40] = -1;
  const auto d = diagnose(Exec(1), mesh.surface());
  REQUIRE_FALSE(d);
  CHECK(d.error().code == ErrorCode::IndexOutOfRange);
  CHECK(d.error().ids == std::vector<Index>{17, 40});
}

TEST_CASE("validate: vertices that are not finite are named") {
  Mesh mesh = shapes::wavy_disk(200);
  mesh.position[30].y = std::nan("");
  mesh.position[50].x = kInfinity;
  const Diagnosis diagnosis = diagnosis_of(mesh);
  const Defect* defect = find(diagnosis, ErrorCode::NonFinitePosition);
  REQUIRE(defect);
  CHECK(defect->ids == std::vector<Index>{30, 50});
}

TEST_CASE("validate: a triangle that names a vertex twice, one without area, a copy, a fin, a turned one") {
  Mesh mesh = shapes::height_field(11, shapes::flat, 0);
  const Index last = mesh.num_triangles();
  SUBCASE("repeated vertex") {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {5, 5, 6});
    const Diagnosis diagnosis = diagnosis_of(mesh);
    const Defect* defect = find(diagnosis, ErrorCode::RepeatedVertex);
    REQUIRE(defect);
    CHECK(defect->ids == std::vector<Index>{last});
  }
  SUBCASE("no area") {
    mesh.position[mesh.corner_vertex[0]] = mesh.position[mesh.corner_vertex[1]];
    const Diagnosis diagnosis = diagnosis_of(mesh);
    CHECK(find(diagnosis, ErrorCode::DegenerateTriangle));
  }
  SUBCASE("copy") {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), mesh.corner_vertex.begin() + 30,
                              mesh.corner_vertex.begin() + 33);
    const Diagnosis diagnosis = diagnosis_of(mesh);
    const Defect* defect = find(diagnosis, ErrorCode::DuplicateTriangle);
    REQUIRE(defect);
    CHECK(defect->ids == std::vector<Index>{last});
  }
  SUBCASE("fin") {
    const Index a = mesh.corner_vertex[0], b = mesh.corner_vertex[2];  // a diagonal: interior
    mesh.position.push_back({0, 0, 1});
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, mesh.num_vertices() - 1});
    check_only(mesh, ErrorCode::NonManifoldEdge, {std::min(a, b), std::max(a, b)});
  }
  SUBCASE("turned") {
    std::swap(mesh.corner_vertex[3 * 111], mesh.corner_vertex[3 * 111 + 1]);  // not at the boundary
    const Diagnosis diagnosis = diagnosis_of(mesh);
    REQUIRE(diagnosis.defects.size() == 1);
    CHECK(diagnosis.defects[0].code == ErrorCode::InconsistentOrientation);
    CHECK(diagnosis.defects[0].count == 3);
  }
}

TEST_CASE("validate: two sheets that touch in a vertex") {
  Mesh mesh = shapes::joined(shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                             shapes::triangle({0, 0, 0}, {0, 0, 1}, {1, 1, 1}));
  mesh.corner_vertex[3] = 0;
  check_only(mesh, ErrorCode::NonManifoldVertex, {0});
}

TEST_CASE("validate: closed, with handles, one-sided") {
  check_only(shapes::cube(1), ErrorCode::ClosedComponent, {0});
  Mesh torus = shapes::torus(12);
  CHECK(find(diagnosis_of(torus), ErrorCode::HasHandles));
  torus.corner_vertex.resize(torus.corner_vertex.size() - 3);  // now it has a boundary, and still a handle
  check_only(torus, ErrorCode::HasHandles, {0});
  CHECK(find(diagnosis_of(shapes::moebius(20)), ErrorCode::NotOrientable));
}

namespace {

/// A flat sheet with a third triangle on one of its edges.
Mesh sheet_with_fin() {
  Mesh mesh = shapes::height_field(5, shapes::flat, 0);
  const Index a = mesh.corner_vertex[0], b = mesh.corner_vertex[2];  // a diagonal: interior
  mesh.position.push_back({0, 0, 1});
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, mesh.num_vertices() - 1});
  return mesh;
}

/// A torus without some of its triangles.
Mesh torus_without(std::initializer_list<Index> triangles) {
  Mesh mesh = shapes::torus(12);
  for (const Index t : triangles) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) mesh.corner_vertex[c] = kNone;
  }
  std::erase(mesh.corner_vertex, kNone);
  return mesh;
}

void turn(Mesh& mesh, Index t) { std::swap(mesh.corner_vertex[3 * t + 1], mesh.corner_vertex[3 * t + 2]); }

std::vector<Index> ids_of(const Diagnosis& diagnosis, ErrorCode code) {
  const Defect* defect = find(diagnosis, code);
  return defect ? defect->ids : std::vector<Index>{};
}

/// Components of every kind, some vertices unused.
Mesh manifold_parts() {
  Mesh all = shapes::cube(1);
  for (const Mesh& part :
       {shapes::wavy_disk(60), shapes::torus(7), torus_without({5}), shapes::frame(6, shapes::flat),
        torus_without({0, 100, 101, 200}), shapes::cube(2), torus_without({40, 41})}) {
    all = shapes::joined(all, part);
  }
  return all;
}

}  // namespace

TEST_CASE("validate: sound components are judged alike with and without a broken one beside them") {
  const Mesh parts = manifold_parts();
  const Diagnosis alone = diagnosis_of(parts);
  REQUIRE(find(alone, ErrorCode::ClosedComponent)->count == 3);
  REQUIRE(find(alone, ErrorCode::HasHandles)->count == 4);
  CHECK(alone.genus == 4);
  Mesh doubled = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  doubled.corner_vertex.insert(doubled.corner_vertex.end(), {0, 1, 2});
  for (const auto& [broken, code] : {std::pair{sheet_with_fin(), ErrorCode::NonManifoldEdge},
                                     {shapes::moebius(20), ErrorCode::NotOrientable},
                                     {doubled, ErrorCode::DuplicateTriangle}}) {
    const Diagnosis beside = diagnosis_of(shapes::joined(parts, broken));
    CAPTURE(name(code));
    CHECK(find(beside, code));
    CHECK(beside.genus == kNone);
    for (const ErrorCode judged : {ErrorCode::ClosedComponent, ErrorCode::HasHandles}) {
      CHECK(ids_of(beside, judged) == ids_of(alone, judged));
    }
  }
}

TEST_CASE("validate: triangles turned around do not hide that a component is closed or has handles") {
  Mesh parts = manifold_parts();
  const Diagnosis sound = diagnosis_of(parts);
  shapes::Random random(3);
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 30; ++i) {
      turn(parts, static_cast<Index>(random.uniform() * parts.num_triangles()));
    }
    const Diagnosis turned = diagnosis_of(parts);
    REQUIRE(find(turned, ErrorCode::InconsistentOrientation));
    for (const ErrorCode judged : {ErrorCode::ClosedComponent, ErrorCode::HasHandles}) {
      CHECK(ids_of(turned, judged) == ids_of(sound, judged));
    }
  }
}

TEST_CASE("validate: two closed components that touch in a vertex are closed each") {
  Mesh mesh = shapes::joined(shapes::cube(1), shapes::cube(1));
  std::replace(mesh.corner_vertex.begin() + 36, mesh.corner_vertex.end(), 8, 0);
  const Diagnosis diagnosis = diagnosis_of(mesh);
  CHECK(ids_of(diagnosis, ErrorCode::NonManifoldVertex) == std::vector<Index>{0});
  CHECK(ids_of(diagnosis, ErrorCode::ClosedComponent) == std::vector<Index>{0, 12});
}

TEST_CASE("validate: components that are no manifold themselves are not called closed or with handles") {
  SUBCASE("closed, with a fin") {
    Mesh mesh = shapes::cube(1);
    mesh.position.push_back({2, 2, 2});
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {mesh.corner_vertex[0], mesh.corner_vertex[1], 8});
    CHECK(diagnosis_of(mesh).defects.size() == 1);
    CHECK(find(diagnosis_of(mesh), ErrorCode::NonManifoldEdge));
  }
  SUBCASE("closed, touching itself in a vertex") {
    Mesh mesh = shapes::torus(12);
    std::replace(mesh.corner_vertex.begin(), mesh.corner_vertex.end(), 78, 0);
    check_only(mesh, ErrorCode::NonManifoldVertex, {0});
  }
  SUBCASE("a Klein bottle") {
    Mesh mesh = shapes::torus(12);
    // The last row of quads meets the first vertices in the opposite direction.
    for (Index c = 6 * 12 * 11; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
      Index& v = mesh.corner_vertex[c];
      if (v < 12) v = (12 - v) % 12;
    }
    const Diagnosis diagnosis = diagnosis_of(mesh);
    CHECK(find(diagnosis, ErrorCode::NotOrientable));
    CHECK_FALSE(find(diagnosis, ErrorCode::ClosedComponent));
    CHECK_FALSE(find(diagnosis, ErrorCode::HasHandles));
  }
}

TEST_CASE("validate: coordinates that doubles cannot scale are refused for what they are") {
  const Mesh mesh = shapes::wavy_disk(200);  // 2 wide
  for (const double factor : {1.7e308, 1e-309}) {
    CAPTURE(factor);
    const Diagnosis diagnosis = diagnosis_of(shapes::scaled(mesh, factor));
    REQUIRE(diagnosis.defects.size() == 1);
    CHECK(diagnosis.defects[0].ids.empty());
    CHECK(diagnosis.defects[0].what ==
          (factor > 1 ? "the coordinates of the vertices span more than doubles can hold"
                      : "the coordinates of the vertices span less than doubles can scale"));
    CHECK(exit_code(refusal(diagnosis).code) == 4);
    CHECK(refusal(diagnosis).what == diagnosis.defects[0].what);
  }
  for (const double factor : {0.4e308, 1e-307}) {
    CAPTURE(factor);
    CHECK(diagnosis_of(shapes::scaled(mesh, factor)).usable());
  }
}

TEST_CASE("validate: a thin triangle is refused only below the precision of its coordinates") {
  const auto sliver = [](double offset, double height) {
    return shapes::triangle({offset, 0, 0}, {offset + 1, 0, 0}, {offset + 0.5, height, 0});
  };
  CHECK(diagnosis_of(sliver(0, 1e-13)).usable());
  CHECK_FALSE(diagnosis_of(sliver(0, 1e-16)).usable());
  CHECK_FALSE(
      diagnosis_of(sliver(1e6, 1e-13)).usable());  // a million units away the coordinates end at 1e-10
  CHECK(diagnosis_of(sliver(1e6, 1e-6)).usable());
}

TEST_CASE("validate: the refusal names the first ids, the number of all, the other kinds and the remedy") {
  Mesh mesh = shapes::wavy_disk(400);
  for (const Index t : {3, 4, 5, 6, 7, 8, 9}) mesh.corner_vertex[3 * t] = mesh.corner_vertex[3 * t + 1];
  const std::string text = describe(refusal(diagnosis_of(mesh)));
  CHECK(text.find("7 triangles name a vertex twice") == 0);
  CHECK(text.find("(triangles 3, 4, 5, 6, 7 and 2 more); also ") != std::string::npos);
  CHECK(text.find("[repeated-vertex]") != std::string::npos);
}

TEST_CASE("validate: corners that do not make whole triangles are an error") {
  Mesh mesh = shapes::wavy_disk(100);
  mesh.corner_vertex.pop_back();
  const auto d = diagnose(Exec(1), mesh.surface());
  REQUIRE_FALSE(d);
  CHECK(d.error().code == ErrorCode::BadUsage);
}

TEST_CASE("validate: many vertices that are not numbers are named as fast as few, the first 64 of them") {
  Mesh mesh = shapes::wavy_disk(200'000);
  for (Vec3& p : mesh.position) p.z = std::nan("");
  const Diagnosis d = diagnosis_of(mesh);
  CHECK(d.defects.at(0).count == mesh.num_vertices());
  CHECK(d.defects.at(0).ids.size() == kMaxListedIds);
}

TEST_CASE("validate: duplicate positions are counted") {
  const Mesh mesh = shapes::joined(shapes::wavy_disk(50), shapes::wavy_disk(50));
  CHECK(diagnosis_of(mesh).duplicate_positions == mesh.num_vertices() / 2);
}

TEST_CASE("validate: the adjacency of a manifold is refused where its diagnosis is, in the same words") {
  const auto said = [](const Mesh& mesh) {
    const auto topology = manifold_topology(Exec(2), mesh.surface());
    const auto checked = check_manifold(Exec(2), mesh.surface());
    CHECK(topology.has_value() == checked.has_value());
    if (!topology) {
      CHECK(topology.error().what == checked.error().what);
      CHECK(topology.error().ids == checked.error().ids);
    }
    return topology ? ErrorCode::InternalDefect : topology.error().code;
  };
  const Mesh disk = shapes::wavy_disk(200);
  CHECK(said(disk) == ErrorCode::InternalDefect);
  CHECK(manifold_topology(Exec(2), disk.surface())->corner_twin ==
        build_topology(Exec(1), disk.surface()).corner_twin);
  CHECK(said(shapes::torus(12)) == ErrorCode::InternalDefect);
  CHECK(said({}) == ErrorCode::NoTriangles);

  Mesh mesh = disk;
  mesh.corner_vertex[5] = 1'000'000;
  CHECK(said(mesh) == ErrorCode::IndexOutOfRange);
  mesh = disk;
  mesh.position[3].y = std::nan("");
  CHECK(said(mesh) == ErrorCode::NonFinitePosition);
  mesh = disk;
  for (Vec3& p : mesh.position) p = 1e308 * p;
  CHECK(said(mesh) == ErrorCode::NonFinitePosition);
  mesh = disk;
  mesh.corner_vertex[1] = mesh.corner_vertex[0];
  CHECK(said(mesh) == ErrorCode::RepeatedVertex);
  mesh = disk;
  for (int i = 0; i < 3; ++i) mesh.corner_vertex.push_back(mesh.corner_vertex[i]);
  CHECK(said(mesh) == ErrorCode::DuplicateTriangle);
  mesh = disk;
  std::swap(mesh.corner_vertex[0], mesh.corner_vertex[1]);
  CHECK(said(mesh) == ErrorCode::InconsistentOrientation);
  // So large that products of edges overflow.
  mesh = disk;
  const Index third = mesh.corner_vertex[2];
  mesh.position[third] = 0.5 * (mesh.position[mesh.corner_vertex[0]] + mesh.position[mesh.corner_vertex[1]]);
  for (Vec3& p : mesh.position) p = 1e140 * p;
  mesh.position[third].z += 1e110;
  CHECK(said(mesh) == ErrorCode::DegenerateTriangle);
  // A triangle whose vertices lie on one line, up to the precision of coordinates far from the origin.
  for (const double away : {0.0, 1e6}) {
    mesh = disk;
    const Index a = mesh.corner_vertex[0], b = mesh.corner_vertex[1], c = mesh.corner_vertex[2];
    mesh.position[c] = 0.5 * (mesh.position[a] + mesh.position[b]);
    mesh.position[c].z += 1e-16 * away;
    for (Vec3& p : mesh.position) p = p + Vec3{away, 0, 0};
    CHECK(said(mesh) == ErrorCode::DegenerateTriangle);
  }
}
