#include "tests/support/shapes.hpp"

#include <algorithm>
#include <numeric>

namespace planish::shapes {

std::uint64_t Random::bits() {  // splitmix64
  std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

Mesh triangle(Vec3 a, Vec3 b, Vec3 c) {
  Mesh mesh;
  mesh.position = {a, b, c};
  mesh.corner_vertex = {0, 1, 2};
  return mesh;
}

Mesh cube(double edge) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.position.push_back({(i & 1) ? edge : 0, (i & 2) ? edge : 0, (i & 4) ? edge : 0});
  }
  mesh.corner_vertex = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return mesh;
}

namespace {

/// Cells of an n x n grid for which keep(i, j) holds, two triangles each; unused vertices dropped.
template <class Keep>
Mesh grid(Index n, double (*z)(double, double), double jitter, Keep keep) {
  Mesh mesh;
  Random random(7);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const bool inside = i > 0 && j > 0 && i + 1 < n && j + 1 < n;
      const double dx = inside ? jitter * (random.uniform() - 0.5) : 0,
                   dy = inside ? jitter * (random.uniform() - 0.5) : 0;
      const double x = 2 * (i + dx) / (n - 1) - 1, y = 2 * (j + dy) / (n - 1) - 1;
      mesh.position.push_back({x, y, z(x, y)});
    }
  }
  for (Index j = 0; j + 1 < n; ++j) {
    for (Index i = 0; i + 1 < n; ++i) {
      if (!keep(i, j)) continue;
      const Index a = j * n + i, b = a + 1, c = a + n, d = c + 1;
      if ((i + j) % 2 == 0) {
        mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, d, a, d, c});
      } else {
        mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, c, b, d, c});
      }
    }
  }
  return mesh;
}

}  // namespace

Mesh height_field(Index n, double (*z)(double, double), double jitter) {
  return grid(n, z, jitter, [](Index, Index) { return true; });
}

Mesh wavy_disk(Index triangles) {
  const auto n = static_cast<Index>(std::sqrt(triangles / 2.0)) + 1;
  return height_field(
      n, [](double x, double y) { return 0.3 * std::sin(3 * x) * std::cos(2 * y) + 0.2 * x * y; });
}

Mesh frame(Index n, double (*z)(double, double)) {
  const Index low = n / 3, high = n - 2 - n / 3;
  Mesh full = grid(n, z, 0.25, [&](Index i, Index j) { return i < low || j < low || i > high || j > high; });
  std::vector<Index> renumbered(full.position.size(), kNone);
  Mesh mesh;
  for (Index& v : full.corner_vertex) {
    if (renumbered[v] == kNone) {
      renumbered[v] = mesh.num_vertices();
      mesh.position.push_back(full.position[v]);
    }
    mesh.corner_vertex.push_back(renumbered[v]);
  }
  return mesh;
}

double flat(double, double) { return 0; }

Mesh torus(Index n) {
  Mesh mesh;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const double a = 2 * kPi * i / n, b = 2 * kPi * j / n, r = 2 + std::cos(b);
      mesh.position.push_back({r * std::cos(a), r * std::sin(a), std::sin(b)});
    }
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index p = j * n + i, q = j * n + (i + 1) % n, r = (j + 1) % n * n + i,
                  s = (j + 1) % n * n + (i + 1) % n;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {p, q, s, p, s, r});
    }
  }
  return mesh;
}

Mesh moebius(Index n) {
  Mesh mesh;
  for (Index i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    for (const double w : {-0.3, 0.3}) {
      const double r = 1 + w * std::cos(a / 2);
      mesh.position.push_back({r * std::cos(a), r * std::sin(a), w * std::sin(a / 2)});
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index a = 2 * i, b = a + 1;
    const Index c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;  // the last quad closes with a twist
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, c, d, a, d, b});
  }
  return mesh;
}

Mesh rigid_motion(Mesh mesh, std::uint64_t seed) {
  Random random(seed);
  const double a = 6 * random.uniform(), b = 6 * random.uniform();
  const Vec3 shift{random.uniform(), random.uniform(), random.uniform()};
  for (Vec3& p : mesh.position) {
    p = {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    p = Vec3{p.x, std::cos(b) * p.y - std::sin(b) * p.z, std::sin(b) * p.y + std::cos(b) * p.z} + shift;
  }
  return mesh;
}

Mesh scaled(Mesh mesh, double factor) {
  for (Vec3& p : mesh.position) p = factor * p;
  return mesh;
}

Mesh relabelled(const Mesh& mesh, std::uint64_t seed, std::vector<Index>& new_of_old) {
  Random random(seed);
  const auto shuffled = [&](Index n) {
    std::vector<Index> order(n);
    std::iota(order.begin(), order.end(), 0);
    for (Index i = n - 1; i > 0; --i) std::swap(order[i], order[static_cast<Index>(random.bits() % (i + 1))]);
    return order;
  };
  new_of_old = shuffled(mesh.num_vertices());
  Mesh result;
  result.position.resize(mesh.position.size());
  for (Index v = 0; v < mesh.num_vertices(); ++v) result.position[new_of_old[v]] = mesh.position[v];
  for (const Index t : shuffled(mesh.num_triangles())) {
    const auto first = static_cast<Index>(random.bits() % 3);
    for (Index i = 0; i < 3; ++i)
      result.corner_vertex.push_back(new_of_old[mesh.corner_vertex[3 * t + (first + i) % 3]]);
  }
  return result;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  mesh.position.insert(mesh.position.end(), b.position.begin(), b.position.end());
  for (const Index v : b.corner_vertex) mesh.corner_vertex.push_back(v + a.num_vertices());
  return mesh;
}

}  // namespace planish::shapes
