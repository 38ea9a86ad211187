#include "engine/verify/benchmark.hpp"

#include <algorithm>

#include "kernels/exact/orient2.hpp"
#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {
namespace {

class Figures {
 public:
  Figures(const Exec& exec, In<Index> corner_vertex, const Topology& topology, In<RestFrame> frame,
          In<Vec2> uv)
      : exec_(exec),
        corner_vertex_(corner_vertex),
        topology_(topology),
        frame_(frame),
        uv_(uv),
        rest_area_(rest_areas(exec, frame)),
        image_area_(frame.size()),
        sigma_(frame.size()),
        angle_(corner_vertex.size()) {
    exec_.for_blocks(size(), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) measure(t);
    });
  }

  BenchmarkFigures operator()(const Overlaps& overlaps) const {
    const double rest = total(rest_area_), image = total(image_area_);
    const double scale = std::sqrt(rest / image);
    const auto area = [&](Index t) { return rest_area_[t] / rest; };
    const auto image_area = [&](Index t) { return image_area_[t] / image; };
    BenchmarkFigures f;
    f.max_area_distortion = largest([&](Index t) {
      return image_area(t) / area(t) + (image_area(t) > 0 ? area(t) / image_area(t) : kInfinity) - 2;
    });
    f.average_area_error = sum([&](Index t) { return std::abs(image_area(t) - area(t)); });
    f.max_singular_value = scale * largest([&](Index t) { return sigma_[t].sigma_max; });
    const double least = -largest([&](Index t) { return -std::abs(sigma_[t].sigma_min); });
    f.min_singular_value = scale * least;
    const double flipped = sum([&](Index t) { return orientation(t) < 0 ? 1.0 : 0.0; }) / size();
    f.proportion_flipped_triangles = std::min(flipped, 1 - flipped);
    f.max_angle_distortion = largest([&](Index t) {
      const double a = sigma_[t].sigma_max, b = std::abs(sigma_[t].sigma_min);
      return b > 0 ? a / b + b / a - 2 : kInfinity;
    });
    f.average_angle_error = sum([&](Index t) { return area(t) * angle_error(t); });
    f.resolution = least > 0 ? extent() / least : kInfinity;
    f.bijectivity_violation_area = (overlaps.covered_rest_area + covered_in_stars()) / rest;
    return f;
  }

 private:
  Index size() const { return static_cast<Index>(frame_.size()); }

  void measure(Index t) {
    const std::array<Vec2, 3> z{uv_[corner_vertex_[3 * t]], uv_[corner_vertex_[3 * t + 1]],
                                uv_[corner_vertex_[3 * t + 2]]};
    sigma_[t] = singular_values(jacobian(frame_[t], z[0], z[1], z[2]));
    image_area_[t] = 0.5 * std::abs(cross(z[1] - z[0], z[2] - z[0]));
    for (Index i = 0; i < 3; ++i) {
      const Vec2 a = z[(i + 1) % 3] - z[i], b = z[(i + 2) % 3] - z[i];
      angle_[3 * t + i] = std::atan2(std::abs(cross(a, b)), dot(a, b));
    }
  }

  int orientation(Index t) const {
    return orient2(uv_[corner_vertex_[3 * t]], uv_[corner_vertex_[3 * t + 1]],
                   uv_[corner_vertex_[3 * t + 2]]);
  }

  double angle_error(Index t) const {
    const std::array<double, 3> rest = corner_angles(frame_[t]);
    double error = 0;
    for (Index i = 0; i < 3; ++i) error += std::abs(angle_[3 * t + i] - rest[i]);
    return error;
  }

  double total(In<double> values) const {
    return sum([&](Index t) { return values[t]; });
  }
  template <class Value>
  double sum(Value value) const {
    return exec_.sum_blocks(size(), kBlock, [&](Range r) {
      double part = 0;
      for (Index t = r.begin; t < r.end; ++t) part += value(t);
      return part;
    });
  }
  template <class Value>
  double largest(Value value) const {
    std::vector<double> part(Exec::num_blocks(size(), kBlock), -kInfinity);
    exec_.for_blocks(size(), kBlock, [&](Index block, Range r) {
      for (Index t = r.begin; t < r.end; ++t) part[block] = std::max(part[block], value(t));
    });
    return *std::max_element(part.begin(), part.end());
  }

  /// Longer side of the map's box; vertices that no triangle uses are not in it.
  double extent() const {
    Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
    for (const Index v : corner_vertex_) {
      lower = {std::min(lower.x, uv_[v].x), std::min(lower.y, uv_[v].y)};
      upper = {std::max(upper.x, uv_[v].x), std::max(upper.y, uv_[v].y)};
    }
    return std::max(upper.x - lower.x, upper.y - lower.y);
  }

  In<Index> star(Index v) const {
    return slice(In<Index>(topology_.star_corner), topology_.stars().group(v));
  }

  /// Triangles around a vertex lie side by side when none is turned over and they wind around it once at most.
  bool may_overlap(Index v) const {
    double around = 0;
    for (const Index c : star(v)) {
      if (orientation(c / 3) <= 0) return true;
      around += angle_[c];
    }
    constexpr double kRounding = 1e-9;
    return topology_.is_boundary(v) ? around > 2 * kPi - kRounding : around > 3 * kPi;
  }

  double covered_in_stars() const {
    const auto num_vertices = static_cast<Index>(topology_.star_begin.size()) - 1;
    std::vector<std::pair<Index, Index>> pairs;
    for (const Index v : select(exec_, num_vertices, [&](Index v) { return may_overlap(v); })) {
      for (const Index c : star(v)) {
        for (const Index d : star(v)) {
          if (c / 3 < d / 3) pairs.emplace_back(c / 3, d / 3);
        }
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    double covered = 0;
    for (const auto& [s, t] : pairs) {
      const double common = common_image_area(corner_vertex_, uv_, s, t);
      if (common > 0) covered += common * (rest_area_[s] / image_area_[s] + rest_area_[t] / image_area_[t]);
    }
    return covered;
  }

  const Exec& exec_;
  In<Index> corner_vertex_;
  const Topology& topology_;
  In<RestFrame> frame_;
  In<Vec2> uv_;
  std::vector<double> rest_area_, image_area_;  // [T]
  std::vector<SingularValues> sigma_;
  std::vector<double> angle_;  // [3 T] of the image, without sign
};

}  // namespace

std::vector<double> rest_areas(const Exec& exec, In<RestFrame> frame) {
  std::vector<double> result(frame.size());
  exec.for_blocks(static_cast<Index>(frame.size()), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) result[t] = area(frame[t]);
  });
  return result;
}

BenchmarkFigures benchmark_figures(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                   In<RestFrame> frame, In<Vec2> uv, const Overlaps& overlaps) {
  return Figures(exec, corner_vertex, topology, frame, uv)(overlaps);
}

}  // namespace planish
