// Small meshes with known answers, and what can be done to a mesh without changing its flattening.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/model/mesh.hpp"

namespace planish::shapes {

Mesh triangle(Vec3 a, Vec3 b, Vec3 c);

/// Surface of the cube [0, edge]^3, 12 triangles.
Mesh cube(double edge);

/// n x n vertices over [-1, 1]^2 with height z(x, y), interior vertices jittered by `jitter` of a cell.
Mesh height_field(Index n, double (*z)(double, double), double jitter = 0.25);

/// A smooth, doubly curved disk of about `triangles` triangles.
Mesh wavy_disk(Index triangles);

/// The square frame [-1, 1]^2 without its middle, with height z(x, y); one hole.
Mesh frame(Index n, double (*z)(double, double));

/// Flat, in the xy plane.
double flat(double, double);

/// Regular torus, closed, genus 1.
Mesh torus(Index n);

/// Rows of triangles of a Moebius strip.
Mesh moebius(Index n);

Mesh rigid_motion(Mesh mesh, std::uint64_t seed);
Mesh scaled(Mesh mesh, double factor);
/// Vertices and triangles in another order; corner order of triangles rotated. new_of_old [V].
Mesh relabelled(const Mesh& mesh, std::uint64_t seed, std::vector<Index>& new_of_old);
Mesh joined(const Mesh& a, const Mesh& b);

/// Deterministic numbers in [0, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

}  // namespace planish::shapes
