// What users of a packaged solver do: local/global ARAP with Eigen's SimplicialLDLT from a harmonic map onto a circle, file to
// file, until the energy is at most a bound. Prints {"seconds", "steps", "energy"}.
//
// usage: eigen_peer MESH BOUND OUT.ply      BOUND: of the ARAP energy per area
#include <Eigen/SparseCholesky>

#include <chrono>
#include <cstdio>
#include <fstream>

#include "engine/workpiece.hpp"
#include "io/mesh_files.hpp"
#include "kernels/local/proxy.hpp"

namespace {

using namespace planish;
using Sparse = Eigen::SparseMatrix<double>;

constexpr int kMostSteps = 500;

class Peer {
 public:
  explicit Peer(const Workpiece& piece) : piece_(piece), n_(piece.mesh().num_vertices()) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index c = 0; c < 3 * piece.mesh().num_triangles(); ++c) {
      const double w = 0.5 * piece.geometry.cotangent[c];
      const Index a = vertex(next_corner(c)), b = vertex(previous_corner(c));
      for (const auto& [i, j, value] : {std::tuple{a, a, w}, {b, b, w}, {a, b, -w}, {b, a, -w}})
        entries.emplace_back(i, j, value);
    }
    laplacian_.resize(n_, n_);
    laplacian_.setFromTriplets(entries.begin(), entries.end());
  }

  /// The longest boundary loop to a circle of the mesh's area, the rest harmonic.
  Eigen::MatrixX2d harmonic() const {
    const Topology& topology = piece_.topology();
    Eigen::MatrixX2d uv = Eigen::MatrixX2d::Zero(n_, 2);
    std::vector<std::uint8_t> fixed(n_, 0);
    const double radius = std::sqrt(piece_.geometry.area / kPi);
    double along = 0;
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(0))) {
      fixed[vertex(c)] = 1;
      uv.row(vertex(c)) << radius * std::cos(2 * kPi * along / topology.loop_length[0]),
          radius * std::sin(2 * kPi * along / topology.loop_length[0]);
      along += norm(edge_vectors(piece_.geometry.frame[c / 3])[c % 3]);
    }
    const Eigen::MatrixX2d rhs = -(laplacian_ * uv);
    Eigen::MatrixX2d held = rhs;
    for (Index v = 0; v < n_; ++v) {
      if (fixed[v]) held.row(v) = uv.row(v);
    }
    return Eigen::SimplicialLDLT<Sparse>(held_matrix(fixed)).solve(held);
  }

  /// Steps until the energy is at most bound; their number, and the energy.
  std::pair<int, double> flatten(Eigen::MatrixX2d& uv, double bound) const {
    std::vector<std::uint8_t> fixed(n_, 0);
    fixed[0] = 1;
    const Eigen::SimplicialLDLT<Sparse> ldlt(held_matrix(fixed));
    for (int step = 0;; ++step) {
      Eigen::MatrixX2d force = Eigen::MatrixX2d::Zero(n_, 2);
      double energy = 0;
      for (Index t = 0; t < piece_.mesh().num_triangles(); ++t) energy += add_forces(t, uv, force);
      energy /= piece_.geometry.area;
      if (energy <= bound || step == kMostSteps) return {step, energy};
      force.row(0).setZero();
      uv -= ldlt.solve(force);
    }
  }

 private:
  Index vertex(Index c) const { return piece_.mesh().corner_vertex[c]; }

  double add_forces(Index t, const Eigen::MatrixX2d& uv, Eigen::MatrixX2d& force) const {
    std::array<Vec2, 3> z;
    for (Index i = 0; i < 3; ++i) z[i] = {uv(vertex(3 * t + i), 0), uv(vertex(3 * t + i), 1)};
    const double* cotangent = &piece_.geometry.cotangent[3 * t];
    const RestFrame& frame = piece_.geometry.frame[t];
    const ProxyForces proxy = proxy_forces(z, cotangent, frame, closest_rotation(z, cotangent, frame));
    for (Index i = 0; i < 3; ++i) {
      force(vertex(3 * t + i), 0) += proxy.force[i].x;
      force(vertex(3 * t + i), 1) += proxy.force[i].y;
    }
    return proxy.energy;
  }

  /// The Laplacian with unit rows and columns for fixed vertices.
  Sparse held_matrix(const std::vector<std::uint8_t>& fixed) const {
    Sparse matrix = laplacian_;
    matrix.prune([&](Index i, Index j, double) { return i == j || (!fixed[i] && !fixed[j]); });
    for (Index v = 0; v < n_; ++v) {
      if (fixed[v]) matrix.coeffRef(v, v) = 1;
    }
    return matrix;
  }
  const Workpiece& piece_;
  Index n_;
  Sparse laplacian_;
};

void write_points(const char* path, const Eigen::MatrixX2d& uv) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << uv.rows()
       << "\nproperty double x\nproperty double y\nend_header\n";
  const Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> rows = uv;
  file.write(reinterpret_cast<const char*>(rows.data()),
             static_cast<std::streamsize>(rows.size() * sizeof(double)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto begin = std::chrono::steady_clock::now();
  const Exec exec;
  const auto mesh = read_mesh(exec, argv[1]);
  if (!mesh) return 3;
  const auto piece = make_workpiece(exec, mesh->surface());
  if (!piece) return 4;
  const Peer peer(*piece);
  Eigen::MatrixX2d uv = peer.harmonic();
  const auto [steps, energy] = peer.flatten(uv, std::atof(argv[2]));
  write_points(argv[3], uv);
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("{\"seconds\": %.3f, \"steps\": %d, \"energy\": %.9e}\n", taken, steps, energy);
  return energy <= std::atof(argv[2]) ? 0 : 6;
}
