#include "engine/methods/spectral_measure.hpp"

#include <algorithm>
#include <Eigen/Dense>

namespace planish {
namespace {

/// E and B between the place, the step and the step before, in one component.
struct Gram {
  Eigen::Matrix3d e = Eigen::Matrix3d::Zero(), b = Eigen::Matrix3d::Zero();
};

/// Shares of the step and of the step before that make E / B least.
Vec2 best_of(const Gram& gram, double mass, int size) {
  const Eigen::MatrixXd metric = gram.e.topLeftCorner(size, size) + gram.b.topLeftCorner(size, size) / mass;
  Eigen::VectorXd scale(size);
  for (int i = 0; i < size; ++i) scale[i] = metric(i, i) > 0 ? 1 / std::sqrt(metric(i, i)) : 0;
  const auto scaled = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return scale.asDiagonal() * m * scale.asDiagonal();
  };
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      scaled(gram.b.topLeftCorner(size, size)), scaled(metric));
  const bool solved = scale.minCoeff() > 0 && solver.info() == Eigen::Success;
  const Eigen::VectorXd best =
      solved ? Eigen::VectorXd(scale.asDiagonal() * solver.eigenvectors().col(size - 1)) : Eigen::VectorXd();
  if (solved && best[0] != 0 && best.allFinite())
    return {best[1] / best[0], size > 2 ? best[2] / best[0] : 0};
  return size > 2 ? best_of(gram, mass, 2) : Vec2{1, 0};  // the steps say the same, or are nothing
}

}  // namespace

SpectralMeasure::SpectralMeasure(const Exec& exec, const Workpiece& piece)
    : piece_(piece),
      mass_(boundary_mass(piece)),
      component_mass_(piece.topology().num_components, 0),
      energy_(exec, piece) {
  for (std::size_t v = 0; v < mass_.size(); ++v) component_mass_[component_of(v)] += mass_[v];
}

void SpectralMeasure::fill_products(Image& image) const {
  const In<Vec2> z = image.moved;
  image.e.resize(z.size());
  energy_.forces(z, image.e);
  image.b.resize(z.size());
  std::vector<Vec2> mean(num_components());
  for (std::size_t v = 0; v < z.size(); ++v) mean[component_of(v)] += mass_[v] * z[v];
  for (Index k = 0; k < num_components(); ++k) mean[k] = (1 / component_mass_[k]) * mean[k];
  for (std::size_t v = 0; v < z.size(); ++v) image.b[v] = mass_[v] * (z[v] - mean[component_of(v)]);
}

std::vector<Vec2> SpectralMeasure::products(In<Vec2> a, In<Vec2> b) const {
  std::vector<Vec2> sum(num_components());
  for (std::size_t v = 0; v < a.size(); ++v) sum[component_of(v)] += multiply(conjugate(a[v]), b[v]);
  return sum;
}

std::vector<double> SpectralMeasure::quotients(const Image& here) const {
  const std::vector<Vec2> e = products(here.moved, here.e), b = products(here.moved, here.b);
  std::vector<double> lambda(e.size());
  for (std::size_t k = 0; k < e.size(); ++k) lambda[k] = e[k].x / b[k].x;
  return lambda;
}

double SpectralMeasure::relative_size(const Image& step, const Image& here, In<Index> components) const {
  double largest = 0;
  const auto step_e = products(step.moved, step.e), step_b = products(step.moved, step.b),
             here_e = products(here.moved, here.e), here_b = products(here.moved, here.b),
             both_e = products(here.moved, step.e), both_b = products(here.moved, step.b);
  for (const Index k : components) {
    const auto in_metric = [&](const std::vector<Vec2>& e, const std::vector<Vec2>& b) {
      return e[k] + (1 / component_mass_[k]) * b[k];
    };
    const double map = in_metric(here_e, here_b).x;
    const Vec2 along = in_metric(both_e, both_b);
    const double across = in_metric(step_e, step_b).x - dot(along, along) / map;
    largest = std::max(largest, std::sqrt(std::max(0.0, across) / map));
  }
  return largest;
}

std::vector<Vec2> SpectralMeasure::best_shares(const Image& here, const Image& step, const Image& before,
                                               In<Index> components) const {
  const int size = before.change.empty() ? 2 : 3;
  std::vector<Gram> gram(num_components());
  const std::array<const Image*, 3> image = {&here, &step, &before};
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j <= i; ++j) {
      const auto e = products(image[i]->moved, image[j]->e), b = products(image[i]->moved, image[j]->b);
      for (const Index k : components) {
        gram[k].e(i, j) = gram[k].e(j, i) = e[k].x;
        gram[k].b(i, j) = gram[k].b(j, i) = b[k].x;
      }
    }
  }
  std::vector<Vec2> share(num_components());
  for (const Index k : components) share[k] = best_of(gram[k], component_mass_[k], size);
  return share;
}

std::vector<double> boundary_mass(const Workpiece& piece) {
  const Topology& topology = piece.topology();
  const OrderedMesh& mesh = piece.mesh();
  std::vector<double> mass(mesh.num_vertices(), 0);
  for (const Index c : topology.loop_corner) {
    const Index i = mesh.corner_vertex[c], j = mesh.corner_vertex[next_corner(c)];
    const double half = 0.5 * norm(mesh.position[j] - mesh.position[i]);
    mass[i] += half;
    mass[j] += half;
  }
  return mass;
}

}  // namespace planish
