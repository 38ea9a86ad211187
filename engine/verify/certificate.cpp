#include "engine/verify/certificate.hpp"

#include <algorithm>

#include "kernels/exact/orient2.hpp"
#include "kernels/local/distortion.hpp"
#include "kernels/local/jacobians.hpp"

namespace planish {
namespace {

struct Weighted {
  double value, weight;
};

/// The least value up to which the weights of [begin, end) add up to at least `weight`, of those there are; values before it are
/// no greater afterwards, and `weight` and `begin` are what is left.   Cost: linear, as a rule.
double select_weighted(std::vector<Weighted>::iterator& begin, std::vector<Weighted>::iterator end,
                       double& weight) {
  const auto less = [](const Weighted& a, const Weighted& b) { return a.value < b.value; };
  while (end - begin > 1) {
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, less);
    double below = 0;
    for (auto at = begin; at != middle; ++at) below += at->weight;
    if (below >= weight) {
      end = middle;
    } else {
      weight -= below;
      begin = middle;
    }
  }
  return begin->value;
}

Spread spread_of(std::vector<Weighted> values) {
  std::vector<double> weight(values.size()), moment(values.size());
  Spread spread{.min = values.front().value, .max = values.front().value};
  for (std::size_t i = 0; i < values.size(); ++i) {
    weight[i] = values[i].weight;
    moment[i] = values[i].weight * values[i].value;
    spread.min = std::min(spread.min, values[i].value);
    spread.max = std::max(spread.max, values[i].value);
  }
  const double total = pairwise_sum(weight);
  spread.mean = pairwise_sum(moment) / total;
  auto begin = values.begin();
  double before = 0;  // the share whose weight has been passed
  double left = 0;
  for (const auto& [share, target] :
       {std::pair{0.01, &spread.p1}, {0.50, &spread.p50}, {0.99, &spread.p99}}) {
    left += (share - before) * total;
    before = share;
    *target = select_weighted(begin, values.end(), left);
  }
  return spread;
}

void measure_energies(const Exec& exec, In<RestFrame> frame, In<SingularValues> sigma,
                      Certificate& certificate) {
  const auto num_triangles = static_cast<Index>(frame.size());
  const auto total = [&](auto&& density) {
    return exec.sum_blocks(num_triangles, kBlock, [&](Range r) {
      double sum = 0;
      for (Index t = r.begin; t < r.end; ++t) sum += area(frame[t]) * density(sigma[t]);
      return sum;
    });
  };
  const double rest_area = total([](SingularValues) { return 1.0; });
  certificate.arap = total([](SingularValues s) { return arap(s); }) / rest_area;
  certificate.symmetric_dirichlet =
      total([](SingularValues s) { return symmetric_dirichlet(s); }) / rest_area;
}

void measure_stretch(const Exec& exec, In<RestFrame> frame, In<SingularValues> sigma,
                     Certificate& certificate) {
  const auto spread = [&](auto&& quantity) {
    std::vector<Weighted> values(frame.size());
    for (std::size_t t = 0; t < frame.size(); ++t) values[t] = {quantity(sigma[t]), area(frame[t])};
    return spread_of(std::move(values));
  };
  exec.for_tasks(4, [&](Index task) {
    if (task == 0) certificate.sigma_max = spread([](SingularValues s) { return s.sigma_max; });
    if (task == 1) certificate.sigma_min = spread([](SingularValues s) { return s.sigma_min; });
    if (task == 2)
      certificate.area_ratio = spread([](SingularValues s) { return s.sigma_max * s.sigma_min; });
    if (task == 3)
      certificate.angle_distortion = spread([](SingularValues s) { return s.sigma_max / s.sigma_min; });
  });
}

/// Signed angle of corner c in the map.
double image_angle(Index c, In<Index> corner_vertex, In<Vec2> uv) {
  const Vec2 apex = uv[corner_vertex[c]];
  const Vec2 a = uv[corner_vertex[next_corner(c)]] - apex, b = uv[corner_vertex[previous_corner(c)]] - apex;
  return std::atan2(cross(a, b), dot(a, b));
}

}  // namespace

Certificate certify(const Exec& exec, const Surface& surface, const Topology& topology, In<RestFrame> frame,
                    In<Vec2> uv) {
  const Index num_triangles = surface.num_triangles();
  const In<Index> corner = surface.corner_vertex;
  std::vector<Mat2> jacobian(num_triangles);
  std::vector<SingularValues> sigma(num_triangles);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    jacobians(r, frame, uv, corner, jacobian);
    singular_values(r, jacobian, sigma);
  });
  Certificate certificate;
  certificate.flipped = select(exec, num_triangles, [&](Index t) {
    return orient2(uv[corner[3 * t]], uv[corner[3 * t + 1]], uv[corner[3 * t + 2]]) <= 0;
  });
  // A fan winds 2 pi k around its centre: more than 2 pi means at least 4 pi, and 3 pi tells them apart.
  certificate.overwound = select(exec, surface.num_vertices(), [&](Index v) {
    if (topology.is_boundary(v)) return false;
    double angle = 0;
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
      angle += image_angle(c, corner, uv);
    }
    return angle > 3 * kPi;
  });
  certificate.flipped_triangles = static_cast<Offset>(certificate.flipped.size());
  certificate.overwound_vertices = static_cast<Offset>(certificate.overwound.size());
  measure_energies(exec, frame, sigma, certificate);
  if (certificate.flipped_triangles > 0) certificate.symmetric_dirichlet = kInfinity;
  measure_stretch(exec, frame, sigma, certificate);
  return certificate;
}

}  // namespace planish
