#include "engine/verify/shape_checks.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace planish {
namespace {

constexpr double kRadians = kPi / 180;

template <class Figure>
std::vector<double> distances(const Figure& figure, In<Vec2> image) {
  std::vector<double> all;
  for (const Vec2 z : image) all.push_back(figure.distance(z));
  return all;
}

// ---- lines ----

void check_order(EntryCheck& check, const MeasuredChain& chain, const fit::Line& axis) {
  std::vector<Index> lost;
  for (std::size_t k = 1; k < chain.image.size(); ++k) {
    if (!(axis.along(chain.image[k - 1]) < axis.along(chain.image[k]))) lost.push_back(chain.vertex[k]);
  }
  if (!lost.empty())
    check.fault(fmt::format("{} vertices lost their order along the line, the first is {}", lost.size(),
                            lost.front()));
  else if (!check.entry().keeps_order)
    check.fault("the report says that the order along the line is lost, the map keeps it");
}

// ---- circles ----

/// In the map, where the file determines it.
std::optional<double> known_radius(EntryCheck& check, const MeasuredChain& chain) {
  const Prescription& asked = check.asked();
  if (!asked.sweep_degrees || chain.closed) return asked.radius;
  const double of_sweep = chain.factor() * fit::arc_radius(chain.lengths(), kRadians * *asked.sweep_degrees);
  if (asked.radius && !(std::abs(of_sweep / *asked.radius - 1) <= kLengthAllowed / chain.reach()))
    check.fault(
        fmt::format("lengths and sweep make a radius of {:.12g}, the constraint file asks for {:.12g}",
                    of_sweep, *asked.radius));
  return asked.radius ? asked.radius : of_sweep;
}

/// Exterior angles, radians.
std::vector<double> bends_of(In<Vec2> points, bool closed) {
  const std::size_t n = points.size();
  std::vector<double> bends;
  for (std::size_t k = closed ? 0 : 1; k < (closed ? n : n - 1); ++k) {
    const Vec2 before = points[k] - points[(k + n - 1) % n], after = points[(k + 1) % n] - points[k];
    bends.push_back(argument(multiply(after, conjugate(before))));
  }
  return bends;
}

void check_bends(EntryCheck& check, const MeasuredChain& chain) {
  constexpr double kSlack = 1e-4;  // radians
  if (chain.kept.size() < 3) return;
  double total = 0;
  const std::vector<double> bends = bends_of(chain.image_of_kept(3), chain.closed);
  for (const double b : bends) total += b;
  const double sign = total >= 0 ? 1 : -1;
  if (std::ranges::any_of(bends, [&](double b) { return sign * b < -kSlack || sign * b > kPi - kSlack; }))
    check.fault("its image bends both ways");
  if (chain.closed && std::abs(std::abs(total) - 2 * kPi) > kSlack)
    check.fault(fmt::format("its image goes {:.3f} times around", total / (2 * kPi)));
}

/// Without a sweep in the file an arc has that of its best-fit circle in space.
void check_sweep(EntryCheck& check, const MeasuredChain& chain) {
  if (chain.closed || !check.asked().of_file || check.asked().sweep_degrees) return;
  const std::vector<Vec2>& shape = check.entry().shape;
  const std::vector<Vec2> seen = fit::project(chain.space).image;
  const auto solid = fit::circle_through(seen), laid = fit::circle_through(shape);
  if (!solid || !laid) return;
  const double wanted = fit::sweep_about(solid->centre, seen), found = fit::sweep_about(laid->centre, shape);
  const double misfit = std::ranges::max(distances(*solid, seen)) / solid->radius;
  // Other fits of scattered points differ by some 8 times the misfit over the sweep.
  if (!(std::abs(found - wanted) <= 1e-6 + 20 * misfit / wanted))
    check.fault(fmt::format("its template sweeps {:.6f} degrees, its best-fit circle in space {:.6f}",
                            found / kRadians, wanted / kRadians));
}

// ---- curves ----

/// The template is the chain, seen across its best-fit plane.
void check_projection(EntryCheck& check, const MeasuredChain& chain) {
  constexpr double kNearlyStraight = 1e-3;  // DESIGN 3.2: then the plane is that of the surface
  constexpr double kClearCosine = 0.3;  // of the plane to the surface: from here on its front is not in doubt
  constexpr double kEpsilon = 0x1p-52;
  const ConstraintOutcome& entry = check.entry();
  const fit::Projection seen = fit::project(chain.space);
  const auto [x, y, z] = seen.moment;
  double height = 0, width = 0;
  for (std::size_t k = 0; k < seen.image.size(); ++k) {
    height = std::max(height, std::abs(seen.height[k]));
    width = std::max(width, std::hypot(seen.image[k].y, seen.height[k]));
  }
  const double uncertainty =
      std::min(1.0, y > z ? 64 * kEpsilon * x / (y - z) : 1.0);  // of the plane, radians
  const bool straight = y < 1.1 * kNearlyStraight * kNearlyStraight * x;
  const double allowed = kLengthAllowed * chain.length + uncertainty * height + (straight ? 2 * width : 0);
  const auto off = [&](bool from_behind) {
    std::vector<Vec2> view = seen.image;
    if (from_behind) {
      for (Vec2& p : view) p = conjugate(p);
    }
    const fit::Pose pose = fit::best_pose(view, entry.shape, 1.0);
    double far = 0;
    for (std::size_t k = 0; k < view.size(); ++k)
      far = std::max(far, norm(pose.place(view[k]) - entry.shape[k]));
    return far;
  };
  const double cosine = dot(seen.normal, surface_normal(*check.evidence().map, chain));
  const bool front_known = !chain.closed && !straight && std::abs(cosine) > kClearCosine;
  const double found = front_known ? off((cosine < 0) != entry.mirrored) : std::min(off(false), off(true));
  if (!(found <= allowed))
    check.fault(fmt::format("its template lies {:.3g} off the curve as seen across its plane", found));
}

}  // namespace

std::optional<double> check_line(EntryCheck& check) {
  const auto chain = check.chain();
  if (!chain) return std::nullopt;
  const fit::Line axis = fit::line_through(chain->image_of_kept(2));
  const double straightness = check.largest(distances(axis, chain->image), chain->kept, chain->length, 2);
  check_order(check, *chain, axis);
  if (check.asked().free_lengths) {
    check.check_orientation(axis.direction);
    return straightness;
  }
  if (!check.has_template(chain->vertex.size())) return straightness;
  check.check_template_lengths(*chain);
  const double off = check.posed(check.entry().shape, chain->image, chain->kept, chain->length);
  if (chain->kept_length == 0) return worst_of(std::array{straightness, off});
  const double factor = check.asked().scale.value_or(chain->factor());
  check.check_scale(chain->factor(), chain->reach());
  return worst_of(std::array{straightness, off, chain->edge_error(factor)});
}

std::optional<double> check_circle(EntryCheck& check) {
  const auto chain = check.chain();
  if (!chain) return std::nullopt;
  const auto circle = fit::circle_through(chain->image_of_kept(3), known_radius(check, *chain));
  if (!circle) {
    check.fault("its image determines no circle");
    return std::nullopt;
  }
  const double roundness = check.largest(distances(*circle, chain->image), chain->kept, circle->radius, 3);
  check_bends(check, *chain);
  check.check_mirror(*chain);
  if (!check.has_template(chain->vertex.size())) return roundness;
  check.check_turn(*chain);
  check.check_template_lengths(*chain);
  check_sweep(check, *chain);
  const double off = check.posed(check.entry().shape, chain->image, chain->kept, chain->length);
  if (chain->kept_length == 0) return worst_of(std::array{roundness, off});
  check.check_scale(chain->factor(), chain->reach());
  return worst_of(std::array{roundness, off, chain->edge_error(chain->factor())});
}

std::optional<double> check_curve(EntryCheck& check) {
  const auto chain = check.chain();
  if (!chain || !check.has_template(chain->vertex.size())) return std::nullopt;
  using Shape = Prescription::Shape;
  check.check_turn(*chain);
  check.check_mirror(*chain);
  check.check_template_lengths(*chain, check.asked().shape != Shape::Geodesic);
  if (check.asked().shape == Shape::Plane) check_projection(check, *chain);
  return check.posed(check.entry().shape, chain->image, chain->kept, chain->length);
}

}  // namespace planish
