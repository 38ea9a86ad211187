#include "engine/constraints/map_fit.hpp"

#include <algorithm>

namespace planish {
namespace {

std::vector<Vec2> images(const Body& body, In<Vec2> uv) {
  std::vector<Vec2> image;
  for (const Index v : body.vertex) image.push_back(uv[v]);
  return image;
}

/// Along the best-fit line, from the place that the template gives the first vertex on. An edge whose image has no length
/// or runs backwards keeps a small part of its own.
void project(const Body& body, In<Vec2> image, BodyFit& fit) {
  constexpr double kLeastPart = 0.01;
  const BestLine line = best_line(image);
  const Vec2 whole = image.back() - image.front();
  const Vec2 direction = dot(line.direction, whole) < 0 ? -line.direction : line.direction;
  fit.factor = direction;
  fit.along = {body.shape.front().x};
  for (std::size_t i = 1; i < image.size(); ++i) {
    const double rest = body.shape[i].x - body.shape[i - 1].x;
    const double now = dot(direction, image[i] - image[i - 1]);
    fit.along.push_back(fit.along.back() + std::max(now, kLeastPart * rest));
  }
}

}  // namespace

std::vector<BodyFit> fit_bodies(const Compiled& compiled, In<Vec2> uv) {
  std::vector<BodyFit> fits;
  for (const Body& body : compiled.bodies) {
    const std::vector<Vec2> image = images(body, uv);
    const Placement placement = best_placement(body.shape, image, body.scale.value_or(0));
    BodyFit fit{
        .centroid = placement.p, .factor = placement.c, .along = {}};  // templates have their mean at 0
    if (body.kind == Body::Kind::FreeLine) {
      fit.centroid = best_line(image).mean;
      project(body, image, fit);
    } else if (!(norm(fit.factor) >= kLeastScale)) {
      fit.factor = {1, 0};  // images in one place
    }
    fits.push_back(std::move(fit));
  }
  return fits;
}

double misfit(const Body& body, In<Vec2> shape, In<Vec2> uv) {
  const std::vector<Vec2> image = images(body, uv);
  const Placement placement = best_placement(shape, image, body.scale.value_or(0));
  double sum = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vec2 d = placement.p + multiply(placement.c, shape[i]) - image[i];
    sum += dot(d, d);
  }
  return sum;
}

}  // namespace planish
