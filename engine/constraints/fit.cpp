#include "engine/constraints/fit.hpp"

#include <algorithm>
#include <Eigen/Dense>

namespace planish {
namespace {

Vec3 to_vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void measure_distance(FittedPlane& plane, In<Vec3> point) {
  plane.farthest = 0;
  for (const Vec3 p : point)
    plane.farthest = std::max(plane.farthest, std::abs(dot(p - plane.mean, plane.normal)));
}

template <class Point>
Point mean_of(In<Point> point) {
  Point sum{};
  for (const Point& p : point) sum = sum + p;
  return (1.0 / static_cast<double>(point.size())) * sum;
}

}  // namespace

FittedPlane fit_plane(In<Vec3> point) {
  FittedPlane plane;
  plane.mean = mean_of(point);
  Eigen::MatrixX3d centred(static_cast<Eigen::Index>(point.size()), 3);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Vec3 d = point[i] - plane.mean;
    centred.row(static_cast<Eigen::Index>(i)) << d.x, d.y, d.z;
  }
  // The triangular factor has the same singular values and right vectors.
  Eigen::Matrix3d triangle = Eigen::Matrix3d::Zero();
  const Eigen::HouseholderQR<Eigen::MatrixX3d> qr(centred);
  const auto rows = std::min<Eigen::Index>(3, centred.rows());
  triangle.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(triangle, Eigen::ComputeFullV);
  plane.first = to_vec3(svd.matrixV().col(0));
  plane.normal = to_vec3(svd.matrixV().col(2));
  plane.second = cross(plane.normal, plane.first);
  for (int i = 0; i < 3; ++i) plane.spread[i] = svd.singularValues()[i];
  measure_distance(plane, point);
  return plane;
}

void turn_towards(FittedPlane& plane, In<Vec3> point, Vec3 towards) {
  const Vec3 across = towards - dot(towards, plane.first) * plane.first;
  const double length = norm(across);
  if (!(length > 0)) return;
  plane.normal = (1 / length) * across;
  plane.second = cross(plane.normal, plane.first);
  measure_distance(plane, point);
}

BestCircle best_circle(In<Vec2> point) {
  const Vec2 mean = mean_of(point);
  const auto n = static_cast<Eigen::Index>(point.size());
  Eigen::MatrixX3d rows(n, 3);
  Eigen::VectorXd rhs(n);
  double size = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec2 d = point[i] - mean;
    size = std::max(size, norm(d));
    rows.row(i) << 2 * d.x, 2 * d.y, 1;
    rhs[i] = dot(d, d);
  }
  constexpr double kFlat = 1e6;  // radius over size: as good as a line
  // The algebraic fit of points on a line is any circle.
  const Vec2 along = best_line(point).direction;
  double thickness = 0;
  for (const Vec2 p : point) thickness = std::max(thickness, std::abs(cross(along, p - mean)));
  if (thickness <= size / (4 * kFlat)) return {mean, kInfinity};
  const Eigen::Vector3d algebraic = rows.colPivHouseholderQr().solve(rhs);
  BestCircle circle{mean + Vec2{algebraic[0], algebraic[1]}, 0};
  circle.radius =
      std::sqrt(std::max(0.0, algebraic[2] + algebraic[0] * algebraic[0] + algebraic[1] * algebraic[1]));
  constexpr int kSteps = 20;
  for (int step = 0; step < kSteps; ++step) {
    if (!std::isfinite(circle.radius) || circle.radius > kFlat * size) return {circle.centre, kInfinity};
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec2 d = point[i] - circle.centre;
      const double r = std::max(norm(d), 1e-300);
      rows.row(i) << d.x / r, d.y / r, 1;
      rhs[i] = r - circle.radius;
    }
    const Eigen::Vector3d change = rows.colPivHouseholderQr().solve(rhs);
    circle.centre += Vec2{change[0], change[1]};
    circle.radius += change[2];
    if (change.norm() <= 1e-14 * circle.radius) break;
  }
  return circle;
}

BestLine best_line(In<Vec2> point) {
  const Vec2 mean = mean_of(point);
  Vec2 doubled{};  // sum of squares as complex numbers: twice the angle of the axis
  for (const Vec2 p : point) doubled += multiply(p - mean, p - mean);
  return {mean, unit(0.5 * argument(doubled))};
}

Placement best_placement(In<Vec2> shape, In<Vec2> point, double scale) {
  const Vec2 shape_mean = mean_of(shape), point_mean = mean_of(point);
  Vec2 product{};
  double square = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vec2 t = shape[i] - shape_mean;
    product += multiply(conjugate(t), point[i] - point_mean);
    square += dot(t, t);
  }
  Placement placement;
  if (scale > 0) {
    const double length = norm(product);
    placement.c = length > 0 ? (scale / length) * product : Vec2{scale, 0};
  } else {
    placement.c = square > 0 ? (1 / square) * product : Vec2{1, 0};
  }
  placement.p = point_mean - multiply(placement.c, shape_mean);
  return placement;
}

}  // namespace planish
