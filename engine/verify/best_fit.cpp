#include "engine/verify/best_fit.hpp"

#include <algorithm>
#include <Eigen/Dense>

namespace planish::fit {
namespace {

double largest_norm(In<Vec2> points) {
  double largest = 0;
  for (const Vec2 p : points) largest = std::max(largest, norm(p));
  return largest;
}

/// Kasa's fit: x^2 + y^2 + d x + e y + f = 0.
std::optional<Circle> algebraic_circle(In<Vec2> points) {
  Eigen::MatrixX3d rows(points.size(), 3);
  Eigen::VectorXd right(points.size());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vec2 p = points[i];
    rows.row(i) << p.x, p.y, 1;
    right[i] = -dot(p, p);
  }
  const auto solver = rows.colPivHouseholderQr();
  if (solver.rank() < 3) return std::nullopt;
  const Eigen::Vector3d found = solver.solve(right);
  const Vec2 centre{-0.5 * found[0], -0.5 * found[1]};
  return Circle{centre, std::sqrt(std::max(0.0, dot(centre, centre) - found[2]))};
}

/// One step of Gauss and Newton; the last unknown is the radius where it is free.
Eigen::VectorXd newton_step(In<Vec2> points, const Circle& circle, bool free_radius) {
  Eigen::MatrixXd rows(points.size(), free_radius ? 3 : 2);
  Eigen::VectorXd right(points.size());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vec2 arm = points[i] - circle.centre;
    const double length = norm(arm);
    rows(i, 0) = arm.x / length;
    rows(i, 1) = arm.y / length;
    if (free_radius) rows(i, 2) = 1;
    right[i] = length - circle.radius;
  }
  return rows.colPivHouseholderQr().solve(right);
}

}  // namespace

Vec2 mean(In<Vec2> points) {
  Vec2 sum;
  for (const Vec2 p : points) sum += p - points[0];
  return points[0] + (1 / static_cast<double>(points.size())) * sum;
}

Line line_through(In<Vec2> points) {
  const Vec2 centre = mean(points);
  double xx = 0, xy = 0, yy = 0;
  for (const Vec2 p : points) {
    const Vec2 arm = p - centre;
    xx += arm.x * arm.x, xy += arm.x * arm.y, yy += arm.y * arm.y;
  }
  const Vec2 direction = unit(0.5 * std::atan2(2 * xy, xx - yy));
  return {centre, dot(direction, points.back() - points.front()) >= 0 ? direction : -direction};
}

std::optional<Circle> circle_through(In<Vec2> points, std::optional<double> radius) {
  constexpr int kMostSteps = 30;
  const Vec2 middle = mean(points);
  std::vector<Vec2> local;
  for (const Vec2 p : points) local.push_back(p - middle);
  const double size = largest_norm(local);
  for (Vec2& p : local) p = (1 / size) * p;
  auto circle = algebraic_circle(local);
  if (!circle) return std::nullopt;
  if (radius) circle->radius = *radius / size;
  for (int k = 0; k < kMostSteps; ++k) {
    const Eigen::VectorXd step = newton_step(local, *circle, !radius);
    circle->centre += {step[0], step[1]};
    if (!radius) circle->radius += step[2];
    if (step.lpNorm<Eigen::Infinity>() <= 1e-15 * circle->radius) break;
  }
  return Circle{middle + size * circle->centre, size * circle->radius};
}

Pose best_pose(In<Vec2> shape, In<Vec2> image, std::optional<double> scale) {
  Pose pose{.source = mean(shape), .target = mean(image), .turn = {}};
  double squared = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vec2 arm = shape[i] - pose.source;
    pose.turn += multiply(conjugate(arm), image[i] - pose.target);
    squared += dot(arm, arm);
  }
  pose.turn = (scale ? *scale / norm(pose.turn) : 1 / squared) * pose.turn;
  pose.spread = std::sqrt(squared / static_cast<double>(shape.size()));
  return pose;
}

Projection project(In<Vec3> points) {
  Vec3 sum;
  for (const Vec3 p : points) sum = sum + (p - points[0]);
  const Vec3 middle = points[0] + (1 / static_cast<double>(points.size())) * sum;
  Eigen::Matrix3Xd arm(3, points.size());
  for (Eigen::Index i = 0; i < arm.cols(); ++i) {
    const Vec3 a = points[i] - middle;
    arm.col(i) << a.x, a.y, a.z;
  }
  const double size = arm.colwise().norm().maxCoeff();
  const Eigen::Matrix3Xd local = arm / size;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(local * local.transpose());  // ascending
  const Eigen::Vector3d first = axes.eigenvectors().col(2), second = axes.eigenvectors().col(1),
                        up = first.cross(second);
  Projection seen;
  for (int i = 0; i < 3; ++i) seen.moment[i] = axes.eigenvalues()[2 - i];
  seen.normal = {up[0], up[1], up[2]};
  for (Eigen::Index i = 0; i < arm.cols(); ++i) {
    seen.image.push_back({first.dot(arm.col(i)), second.dot(arm.col(i))});
    seen.height.push_back(up.dot(arm.col(i)));
  }
  return seen;
}

double arc_radius(In<double> chord, double sweep) {
  const auto longest = std::max_element(chord.begin(), chord.end());
  const auto total = [&](double half) {  // of the sector of the longest chord
    double sum = half;
    for (auto l = chord.begin(); l != chord.end(); ++l) {
      if (l != longest) sum += std::asin(std::min(1.0, *l * std::sin(half) / *longest));
    }
    return 2 * sum;
  };
  double low = 0, high = kPi;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (total(middle) < sweep ? low : high) = middle;
  }
  return *longest / (2 * std::sin(low));
}

double sweep_about(Vec2 centre, In<Vec2> points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    sum += argument(multiply(points[i] - centre, conjugate(points[i - 1] - centre)));
  return std::abs(sum);
}

}  // namespace planish::fit
