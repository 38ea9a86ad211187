#include "engine/flatten.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/sample/panels.hpp"
#include "kernels/exact/orient2.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

Flattening flattened(const Mesh& mesh, FlattenOptions options = {}) {
  auto result = flatten(mesh.surface(), options);
  if (!result) FAIL(describe(result.error()));
  return std::move(*result);
}

double distance(const Flattening& f, Index a, Index b) { return norm(f.uv[a] - f.uv[b]); }

/// Largest relative change of an edge length.
double worst_edge(const Mesh& mesh, const Flattening& f) {
  double worst = 0;
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index a = mesh.corner_vertex[c], b = mesh.corner_vertex[next_corner(c)];
    const double length = norm(mesh.position[b] - mesh.position[a]);
    worst = std::max(worst, std::abs(distance(f, a, b) / length - 1));
  }
  return worst;
}

double hill(double x, double y) { return 0.4 * std::exp(-2 * (x * x + y * y)); }

}  // namespace

TEST_CASE("flatten: developable sheets come out isometric, energy below 1e-12") {
  for (const std::string kind : {"cylinder", "cone", "tangent-developable"}) {
    CAPTURE(kind);
    const auto sample = make_sample(Exec(1), {.kind = kind, .triangles = 3000});
    REQUIRE(sample);
    for (const Init init : {Init::Uniform, Init::Cotangent, Init::Identity}) {
      const Flattening f = flattened(sample->mesh, {.init = init});
      CHECK(f.converged);
      CHECK(f.certificate.arap < 1e-12);
      CHECK(f.certificate.symmetric_dirichlet == Approx(4));
      CHECK(f.certificate.flipped_triangles == 0);
      CHECK(worst_edge(sample->mesh, f) < 1e-6);
    }
  }
}

TEST_CASE("flatten: a cone lies in the plane as the sector that unrolls it") {
  const auto sample = make_sample(Exec(1), {.kind = "cone", .triangles = 2000});
  REQUIRE(sample);
  REQUIRE(sample->flat.size() == sample->mesh.position.size());
  const Flattening f = flattened(sample->mesh);
  // All distances of the unrolling, not only along edges.
  double worst = 0;
  const Index n = sample->mesh.num_vertices();
  for (Index a = 0; a < n; a += 17) {
    for (Index b = 0; b < n; b += 23) {
      worst = std::max(worst, std::abs(distance(f, a, b) - norm(sample->flat[a] - sample->flat[b])));
    }
  }
  CHECK(worst < 1e-7);
}

TEST_CASE("flatten: a flat mesh is returned unchanged up to a rigid motion") {
  const Mesh mesh = shapes::rigid_motion(shapes::height_field(15, shapes::flat), 4);
  const Flattening f = flattened(mesh);
  CHECK(f.iterations == 0);
  CHECK(f.certificate.arap < 1e-24);
  for (Index a = 0; a < mesh.num_vertices(); a += 7) {
    for (Index b = 0; b < a; b += 5) {
      CHECK(distance(f, a, b) == Approx(norm(mesh.position[a] - mesh.position[b])).epsilon(1e-12));
    }
  }
}

TEST_CASE("flatten: a flat frame with a hole is returned unchanged, at once but for the harmonic start") {
  const Mesh mesh = shapes::frame(25, shapes::flat);
  for (const Init init : {Init::Uniform, Init::Cotangent, Init::Identity}) {
    const Flattening f = flattened(mesh, {.init = init});
    CHECK(f.iterations <= 1);
    CHECK(f.certificate.arap < 1e-24);
  }
  CHECK(flattened(mesh, {.init = Init::Harmonic}).certificate.arap < 1e-12);
}

TEST_CASE(
    "flatten: around a curved hole the start is good: far less energy than unfolding alone, and no flips") {
  const Mesh mesh = shapes::frame(60, hill);
  const Flattening uniform = flattened(mesh, {.max_iterations = 0});
  const Flattening identity = flattened(mesh, {.init = Init::Identity, .max_iterations = 0});
  CHECK(uniform.certificate.arap < 0.2 * identity.certificate.arap);
  CHECK(uniform.certificate.flipped_triangles == 0);
  CHECK(uniform.certificate.overlapping_pairs == 0);
}

TEST_CASE("flatten: every start reaches the same minimum, and the energy never rises") {
  const Mesh mesh = shapes::wavy_disk(2000);
  const double least = flattened(mesh).certificate.arap;
  for (const Init init : {Init::Uniform, Init::Cotangent, Init::Harmonic, Init::Identity}) {
    const Flattening f = flattened(mesh, {.init = init});
    CHECK(f.converged);
    CHECK(f.gradient <= 1e-6);
    CHECK(f.certificate.arap == Approx(least).epsilon(1e-9));
    for (std::size_t k = 1; k < f.history.size(); ++k) {
      CHECK(f.history[k].energy <= f.history[k - 1].energy * (1 + 1e-13));
    }
    CHECK(f.history.back().energy == Approx(f.certificate.arap).epsilon(1e-9));
  }
}

TEST_CASE("flatten: at the minimum no small move of the vertices lowers the energy") {
  const Mesh mesh = shapes::wavy_disk(300);
  const Flattening f = flattened(mesh, {.tolerance = 1e-9});
  // A rigid start from a perturbed surface would hide in the gauge: compare energies of a flat copy moved by
  // hand.
  const auto energy_of = [&](const std::vector<Vec2>& uv) {
    double sum = 0, area = 0;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const Index* v = &mesh.corner_vertex[3 * t];
      const Vec3 e1 = mesh.position[v[1]] - mesh.position[v[0]],
                 e2 = mesh.position[v[2]] - mesh.position[v[0]];
      const double x1 = norm(e1), x2 = dot(e1, e2) / x1, y2 = norm(cross(e1, e2)) / x1;
      const Vec2 du = (1 / x1) * (uv[v[1]] - uv[v[0]]), dv = (1 / y2) * (uv[v[2]] - uv[v[0]] - x2 * du);
      const double a = std::hypot(du.x + dv.y, du.y - dv.x) / 2, b = std::hypot(du.x - dv.y, du.y + dv.x) / 2;
      sum += 0.5 * x1 * y2 * 2 * ((a - 1) * (a - 1) + b * b);
      area += 0.5 * x1 * y2;
    }
    return sum / area;
  };
  const double least = energy_of(f.uv);
  CHECK(least == Approx(f.certificate.arap).epsilon(1e-12));
  shapes::Random random(8);
  for (int k = 0; k < 50; ++k) {
    std::vector<Vec2> moved = f.uv;
    for (Vec2& z : moved) z += 1e-4 * Vec2{random.uniform() - 0.5, random.uniform() - 0.5};
    CHECK(energy_of(moved) >= least);
  }
}

TEST_CASE("flatten: rigid motion, scale, tiny units and far away change nothing but the scale") {
  const Mesh mesh = shapes::wavy_disk(1000);
  const Flattening f = flattened(mesh);
  const auto same_shape = [&](const Mesh& other, double scale, double tolerance) {
    const Flattening g = flattened(other);
    CHECK(g.certificate.arap == Approx(f.certificate.arap).epsilon(tolerance));
    for (Index v = 0; v < mesh.num_vertices(); v += 13) {
      CHECK(distance(g, v, 0) == Approx(scale * distance(f, v, 0)).epsilon(tolerance));
    }
  };
  same_shape(shapes::rigid_motion(mesh, 3), 1, 1e-5);
  same_shape(shapes::scaled(mesh, 1e-9), 1e-9, 1e-5);
  Mesh far = mesh;
  for (Vec3& p : far.position) p = p + Vec3{450000, 5e6, 100};
  same_shape(far, 1, 1e-5);
}

TEST_CASE("flatten: relabelled vertices and triangles give the same map") {
  const Mesh mesh = shapes::wavy_disk(1500);
  std::vector<Index> new_of_old;
  const Mesh other = shapes::relabelled(mesh, 5, new_of_old);
  const Flattening f = flattened(mesh), g = flattened(other);
  CHECK(g.certificate.arap == Approx(f.certificate.arap).epsilon(1e-9));
  for (Index v = 0; v < mesh.num_vertices(); ++v) CHECK(norm(g.uv[new_of_old[v]] - f.uv[v]) < 1e-5);
}

TEST_CASE("flatten: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh = shapes::frame(90, hill);
  const Flattening one = flattened(mesh, {.threads = 1});
  for (const int threads : {2, 7}) {
    const Flattening other = flattened(mesh, {.threads = threads});
    CHECK(other.uv == one.uv);
    CHECK(other.certificate.arap == one.certificate.arap);
    CHECK(other.threads == threads);
  }
}

TEST_CASE(
    "flatten: the gauge is the centroid at the origin, the long axis along u, the heavy tail to the right") {
  Mesh mesh = shapes::rigid_motion(shapes::height_field(9, shapes::flat), 9);
  for (int k = 0; k < 2; ++k) {
    const Flattening f = flattened(mesh);
    Vec2 centroid{};
    double area = 0, uu = 0, vv = 0, uv = 0;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const Vec2 a = f.uv[mesh.corner_vertex[3 * t]], b = f.uv[mesh.corner_vertex[3 * t + 1]],
                 c = f.uv[mesh.corner_vertex[3 * t + 2]];
      const double weight = 0.5 * cross(b - a, c - a);
      const Vec2 m = (1.0 / 3) * (a + b + c);
      CHECK(weight > 0);
      area += weight;
      centroid += weight * m;
      uu += weight * m.x * m.x, vv += weight * m.y * m.y, uv += weight * m.x * m.y;
    }
    CHECK(norm((1 / area) * centroid) < 1e-12);
    if (k == 1) {
      CHECK(uu > 1.5 * vv);
      CHECK(std::abs(uv) < 0.02 * uu);
    }
    for (Vec3& p : mesh.position) p.x *= 2;
    mesh.corner_vertex.resize(mesh.corner_vertex.size() / 2 / 3 * 3);
  }
}

TEST_CASE("flatten: components are flattened each as alone and laid out without overlap") {
  const Mesh part = shapes::wavy_disk(600);
  Mesh both = shapes::joined(part, shapes::joined(shapes::scaled(part, 0.5), part));
  const Flattening alone = flattened(part), f = flattened(both);
  CHECK(f.mesh.components == 3);
  CHECK(f.certificate.overlapping_pairs == 0);
  CHECK(f.certificate.arap == Approx(alone.certificate.arap).epsilon(1e-8));
  const Index n = part.num_vertices();
  for (Index v = 0; v < n; v += 11) {
    CHECK(distance(f, v, 0) == Approx(distance(alone, v, 0)).epsilon(1e-5));
    CHECK(distance(f, n + v, n) == Approx(0.5 * distance(alone, v, 0)).epsilon(1e-5));
  }
}

TEST_CASE("flatten: unreferenced vertices get uv 0 0 and change nothing") {
  const Mesh mesh = shapes::wavy_disk(300);
  Mesh more = mesh;
  more.position.push_back({1e6, 0, 0});
  const Flattening f = flattened(mesh), g = flattened(more);
  REQUIRE(g.uv.size() == f.uv.size() + 1);
  CHECK(g.uv.back() == Vec2{0, 0});
  CHECK(std::equal(f.uv.begin(), f.uv.end(), g.uv.begin()));
}

TEST_CASE("flatten: needles are floored, said so, and leave a flat mesh flat") {
  Mesh mesh = shapes::height_field(9, shapes::flat, 0);
  const Index v = mesh.corner_vertex[3 * 60 + 1];
  for (const Index t : {60}) {  // push one vertex almost onto the opposite edge
    const Vec3 a = mesh.position[mesh.corner_vertex[3 * t]], b = mesh.position[mesh.corner_vertex[3 * t + 2]];
    mesh.position[v] = 0.5 * (a + b) + 1e-9 * (mesh.position[v] - a);
  }
  const Flattening f = flattened(mesh);
  CHECK(f.mesh.mollified_triangles > 0);
  CHECK(f.certificate.arap < 1e-12);
  CHECK(f.certificate.flipped_triangles == 0);
}

TEST_CASE("flatten: --normalize fits the map into the unit square") {
  const Flattening f = flattened(shapes::scaled(shapes::wavy_disk(200), 50), {.normalize = true});
  double least = 1, most = 0;
  for (const Vec2 z : f.uv) {
    least = std::min({least, z.x, z.y});
    most = std::max({most, z.x, z.y});
  }
  CHECK(least == 0);
  CHECK(most == Approx(1));
}

TEST_CASE("flatten: options out of range and unusable meshes are errors") {
  const Mesh mesh = shapes::wavy_disk(100);
  const auto code_of = [](const Result<Flattening>& r) { return r ? "none" : name(r.error().code); };
  CHECK(std::string(code_of(flatten(mesh.surface(), {.tolerance = 0}))) == "usage");
  CHECK(std::string(code_of(flatten(mesh.surface(), {.tolerance = std::nan("")}))) == "usage");
  CHECK(std::string(code_of(flatten(mesh.surface(), {.max_iterations = -1}))) == "usage");
  CHECK(std::string(code_of(flatten(shapes::cube(1).surface()))) == "closed-component");
  CHECK(std::string(code_of(flatten(shapes::moebius(9).surface()))) == "not-orientable");
  CHECK(std::string(code_of(flatten(Mesh{}.surface()))) == "no-triangles");
}

TEST_CASE("flatten: the monitor sees the phases in order and can stop at any call") {
  const Mesh mesh = shapes::wavy_disk(500);
  std::vector<Progress> seen;
  CHECK(flatten(mesh.surface(), {}, [&](const Progress& p) {
    seen.push_back(p);
    return Verdict::Continue;
  }));
  CHECK(std::is_sorted(seen.begin(), seen.end(), [](auto& a, auto& b) { return a.phase < b.phase; }));
  for (std::size_t stop = 0; stop < seen.size(); stop += 3) {
    std::size_t calls = 0;
    const auto result = flatten(mesh.surface(), {}, [&](const Progress&) {
      return calls++ == stop ? Verdict::Stop : Verdict::Continue;
    });
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::Cancelled);
    CHECK(calls == stop + 1);
  }
}

TEST_CASE("flatten: flips are those of the exact predicate on the coordinates returned") {
  const auto hemisphere_and_more =
      make_sample(Exec(1), {.kind = "sphere-cap", .triangles = 4000, .noise = 0.01});
  REQUIRE(hemisphere_and_more);
  const Mesh& mesh = hemisphere_and_more->mesh;
  const Flattening f = flattened(mesh);
  std::vector<Index> flipped;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    if (orient2(f.uv[mesh.corner_vertex[3 * t]], f.uv[mesh.corner_vertex[3 * t + 1]],
                f.uv[mesh.corner_vertex[3 * t + 2]]) <= 0) {
      flipped.push_back(t);
    }
  }
  CHECK(f.certificate.flipped == flipped);
}

TEST_CASE("flatten: as much memory as planned will do, with less it is refused, the bits are the same") {
  const Mesh mesh = shapes::wavy_disk(5000);
  const auto planned = plan(mesh.surface(), {});
  REQUIRE(planned);
  const Offset need = planned->memory_bytes;
  const auto limited = flatten(mesh.surface(), {.memory_limit = need});
  REQUIRE(limited);
  CHECK(limited->uv == flattened(mesh).uv);
  for (const Offset limit : {need - 1, Offset{1}}) {
    for (const auto& error : {flatten(mesh.surface(), {.memory_limit = limit}).error(),
                              plan(mesh.surface(), {}, {.memory_limit = limit}).error()}) {
      CHECK(error.code == ErrorCode::OutOfMemory);
      CHECK(error.what.find("the limit is") != std::string::npos);
    }
  }
}

TEST_CASE(
    "flatten: flips that Newton steps cannot be afforded for are an error, and kept where they may be") {
  const Mesh mesh =
      shapes::height_field(40, [](double x, double y) { return std::sin(9 * x) * std::cos(8 * y); });
  const auto planned = plan(mesh.surface(), {});
  REQUIRE(planned);
  CHECK(planned->newton_bytes > planned->memory_bytes);
  const FlattenOptions limited{.memory_limit = planned->memory_bytes};
  const auto refused = flatten(mesh.surface(), limited);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK(refused.error().what.find("Newton steps") != std::string::npos);
  FlattenOptions keeping = limited;
  keeping.flips = Flips::Keep;
  const auto kept = flatten(mesh.surface(), keeping);
  REQUIRE(kept);
  CHECK(kept->certificate.flipped_triangles > 0);
}
