#include "engine/constraints/geodesic.hpp"

#include <Eigen/Dense>

namespace planish {
namespace {

/// Sum of the corner angles at v from the edge to `from` counter-clockwise to the edge to `to`; none where the boundary
/// comes between.
std::optional<double> angle_between(const RestSurface& rest, Index v, Index from, Index to) {
  const Topology& topology = *rest.topology;
  const auto& vertex = rest.mesh->corner_vertex;
  const In<Index> star = slice(In<Index>(topology.star_corner), topology.stars().group(v));
  std::size_t k = 0;
  while (k < star.size() && vertex[next_corner(star[k])] != from) ++k;
  double sum = 0;
  for (std::size_t n = 0; n < star.size() && k < star.size(); ++n) {
    const Index c = star[k];
    sum += corner_angles(rest.frame[c / 3])[c % 3];
    if (vertex[previous_corner(c)] == to) return sum;
    k = k + 1 == star.size() && !topology.is_boundary(v) ? 0 : k + 1;
  }
  return std::nullopt;
}

double turning(const RestSurface& rest, Index before, Index v, Index after) {
  const auto left = angle_between(rest, v, after, before), right = angle_between(rest, v, before, after);
  if (left && right) return 0.5 * (*right - *left);
  if (left) return kPi - *left;
  return right ? *right - kPi : 0;
}

/// Ends of the edges: edge j has direction angle[0] + ... + angle[j].
std::vector<Vec2> walk(In<double> length, In<double> angle) {
  std::vector<Vec2> point = {Vec2{}};
  double direction = 0;
  for (std::size_t j = 0; j < length.size(); ++j) {
    direction += angle[j];
    point.push_back(point.back() + length[j] * unit(direction));
  }
  return point;
}

/// Changes turning angles until the walk returns to its start with the given total; false where it does not.
bool close(In<double> length, double total, std::vector<double>& angle) {
  const auto n = static_cast<Eigen::Index>(angle.size());
  double perimeter = 0, sum = 0;
  for (const double l : length) perimeter += l;
  for (const double a : angle) sum += a;
  for (double& a : angle) a += (total - sum) / static_cast<double>(n);
  constexpr int kSteps = 50;
  for (int step = 0; step < kSteps; ++step) {
    const std::vector<Vec2> point = walk(length, angle);
    const Vec2 gap = point.back();
    if (norm(gap) <= 1e-15 * perimeter * std::sqrt(static_cast<double>(n))) return true;
    Eigen::Matrix3Xd change(3, n);  // of the total and the gap with each angle: the rest of the walk turns
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec2 rest = gap - point[i];
      change.col(i) << 1, -rest.y, rest.x;
    }
    const Eigen::Vector3d wanted(0, -gap.x, -gap.y);
    const Eigen::Matrix3d normal = change * change.transpose();
    const Eigen::VectorXd update = change.transpose() * normal.ldlt().solve(wanted);
    if (!update.allFinite() || update.cwiseAbs().maxCoeff() > 1) return false;
    for (Eigen::Index i = 0; i < n; ++i) angle[i] += update[i];
  }
  return norm(walk(length, angle).back()) <= 1e-13 * perimeter;
}

}  // namespace

std::optional<std::vector<Vec2>> geodesic_shape(const RestSurface& rest, In<Index> chain,
                                                std::optional<bool> counter_clockwise) {
  const std::size_t n = chain.size();
  const bool closed = counter_clockwise.has_value();
  std::vector<double> length, angle;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
    const Index v = chain[i], next = chain[(i + 1) % n];
    length.push_back(norm(rest.mesh->position[next] - rest.mesh->position[v]));
    angle.push_back(i == 0 && !closed ? 0 : turning(rest, chain[(i + n - 1) % n], v, next));
  }
  if (closed && !close(length, *counter_clockwise ? 2 * kPi : -2 * kPi, angle)) return std::nullopt;
  std::vector<Vec2> point = walk(length, angle);
  if (closed) point.pop_back();
  return point;
}

}  // namespace planish
