#include "engine/solve/local_phase.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/solve/map_energy.hpp"
#include "engine/workpiece.hpp"
#include "kernels/local/distortion.hpp"
#include "kernels/local/proxy.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A surface, and an image of it that is no isometry.
struct Case {
  Workpiece piece;
  std::vector<std::uint8_t> fixed;
  std::vector<Vec2> uv, rotation;

  Case(const Exec& exec, const Mesh& mesh) : piece(*make_workpiece(exec, mesh.surface())) {
    const OrderedMesh& ordered = piece.mesh();
    fixed.assign(ordered.num_vertices(), 0);
    fixed[ordered.num_vertices() / 2] = 1;
    shapes::Random random(5);
    for (const Vec3 p : ordered.position)
      uv.push_back({p.x + 0.001 * random.uniform(), 0.8 * p.y + 0.3 * p.z});
    for (Index t = 0; t < ordered.num_triangles(); ++t) rotation.push_back(unit(random.uniform()));
  }
  ArapEnergy energy() const { return piece.energy(fixed); }
};

/// Triangle after triangle, each force added where it acts.
double plain_local_phase(const Case& c, bool closest, std::vector<Vec2>& force) {
  const ArapEnergy e = c.energy();
  force.assign(c.uv.size(), {});
  double energy = 0;
  for (Index t = 0; t < e.num_triangles(); ++t) {
    const auto z = corner_images(e.corner_vertex, t, c.uv);
    const double* cot = &e.cotangent[3 * t];
    const auto f =
        proxy_forces(z, cot, e.frame[t], closest ? closest_rotation(z, cot, e.frame[t]) : c.rotation[t]);
    energy += f.energy;
    for (Index i = 0; i < 3; ++i) force[e.corner_vertex[3 * t + i]] += f.force[i];
  }
  for (std::size_t v = 0; v < force.size(); ++v) {
    if (c.fixed[v]) force[v] = {};
  }
  return energy;
}

void check_near(In<Vec2> a, In<Vec2> b) {
  double worst = 0, size = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    worst = std::max(worst, norm(a[v] - b[v]));
    size = std::max(size, norm(b[v]));
  }
  CHECK(size > 0);
  CHECK(worst <= 1e-13 * size);
}

}  // namespace

TEST_CASE("local phase: forces and energy are those of the triangles one after the other") {
  const Exec exec(2);
  // Less than a block, a block and a bit, many; and parts that no block has to itself.
  for (const Mesh& mesh : {shapes::wavy_disk(300), shapes::wavy_disk(2300), shapes::wavy_disk(30000),
                           shapes::joined(shapes::wavy_disk(1500), shapes::wavy_disk(1501))}) {
    const Case c(exec, mesh);
    LocalPhase local(exec, c.energy());
    std::vector<Vec2> force(c.uv.size(), Vec2{7, 7}), plain;
    const double energy = local.evaluate(c.uv, force), expected = plain_local_phase(c, true, plain);
    CHECK(energy == doctest::Approx(expected).epsilon(1e-12));
    check_near(force, plain);
    local.evaluate_rotations(c.uv, c.rotation, force);
    plain_local_phase(c, false, plain);
    check_near(force, plain);
  }
}

TEST_CASE("local phase: 1, 2 and 7 threads give the same bits") {
  const Exec one(1);
  const Case c(one, shapes::wavy_disk(30000));
  std::vector<Vec2> expected(c.uv.size());
  const double energy = LocalPhase(one, c.energy()).evaluate(c.uv, expected);
  for (const int threads : {2, 7}) {
    const Exec exec(threads);
    std::vector<Vec2> force(c.uv.size());
    CHECK(LocalPhase(exec, c.energy()).evaluate(c.uv, force) == energy);
    CHECK(force == expected);
  }
}

TEST_CASE("star blocks: every corner is summed up once, with its block or after all") {
  const Exec exec(2);
  const Case c(exec, shapes::wavy_disk(5000));
  const ArapEnergy e = c.energy();
  constexpr Index kBlockTriangles = 512;
  const StarBlocks blocks = star_blocks(exec, e.corner_vertex, e.stars, e.star_corner, kBlockTriangles);
  std::vector<int> seen(e.corner_vertex.size(), 0);
  for (Index b = 0; b + 1 < static_cast<Index>(blocks.run_begin.size()); ++b) {
    for (const StarRun& run : blocks.runs_of(b)) {
      Index slot = run.slot_begin;
      for (Index i = run.begin; i < run.end; ++i) {
        for (Index k = 0; k < run.degree; ++k) {
          const Index corner = 3 * kBlockTriangles * b + blocks.slot[slot++];
          CHECK(e.corner_vertex[corner] == blocks.inner[i]);
          ++seen[corner];
        }
      }
    }
  }
  CHECK(blocks.outward.size() == static_cast<std::size_t>(blocks.num_kept()));
  for (const Index k : blocks.outward) ++seen[k];
  CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
  CHECK(blocks.shared.size() < c.uv.size() / 4);
}
