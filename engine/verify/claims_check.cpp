#include "engine/verify/claims_check.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace planish {
namespace {

class Comparison {
 public:
  explicit Comparison(double rounding) : rounding_(rounding) {}

  void count(const char* what, Offset stated, Offset found) {
    if (stated != found) add(fmt::format("the report says {} {}, the map has {}", stated, what, found));
  }

  /// slack: absolute, for what rounding of the coordinates makes of a number near 0.
  void number(const std::string& what, double stated, double found, double slack = 0) {
    constexpr double kRelative = 1e-9;
    const bool same =
        stated == found ||  // both infinite, too
        std::abs(stated - found) <= kRelative * std::max(std::abs(stated), std::abs(found)) + slack;
    if (!same) add(fmt::format("the report says {} of {:.12g}, the map has {:.12g}", what, stated, found));
  }

  void spread(const std::string& what, const Spread& stated, const Spread& found) {
    number("a least " + what, stated.min, found.min, rounding_);
    number("a largest " + what, stated.max, found.max, rounding_ * std::abs(found.max));
    number("a mean " + what, stated.mean, found.mean, rounding_);
  }

  /// Each listed one is among the found ones, and as many are listed as a report does.
  void ids(const char* what, const std::vector<Index>& stated, std::vector<Index> found) {
    std::sort(found.begin(), found.end());
    for (const Index id : stated) {
      if (std::binary_search(found.begin(), found.end(), id)) continue;
      return add(fmt::format("the report lists {} {}, which the map does not", what, id));
    }
    if (stated.size() != std::min(found.size(), kMostListed))
      add(fmt::format("the report lists {} ids of {}s, the map has {}", stated.size(), what, found.size()));
  }

  void add(std::string difference) { differences_.push_back(std::move(difference)); }
  std::vector<std::string> take() { return std::move(differences_); }

 private:
  static constexpr std::size_t kMostListed = 64;
  double rounding_;
  std::vector<std::string> differences_;
};

/// Distortions are 0 at isometries, so rounding counts absolutely; those of small triangles by their shapes.
void compare_benchmarks(Comparison& comparison, const BenchmarkFigures& stated, const BenchmarkFigures& found,
                        double rounding) {
  const double worst = rounding * (1 + found.max_angle_distortion) * (1 + found.max_area_distortion);
  comparison.number("a largest area distortion", stated.max_area_distortion, found.max_area_distortion,
                    worst);
  comparison.number("an average area error", stated.average_area_error, found.average_area_error, rounding);
  comparison.number("a benchmark's least singular value", stated.min_singular_value, found.min_singular_value,
                    rounding);
  comparison.number("a benchmark's largest singular value", stated.max_singular_value,
                    found.max_singular_value, rounding * found.max_singular_value);
  comparison.number("a proportion of flipped triangles", stated.proportion_flipped_triangles,
                    found.proportion_flipped_triangles);
  comparison.number("a bijectivity violation area", stated.bijectivity_violation_area,
                    found.bijectivity_violation_area, 1e-12);
  comparison.number("a largest angle distortion", stated.max_angle_distortion, found.max_angle_distortion,
                    worst);
  comparison.number("an average angle error", stated.average_angle_error, found.average_angle_error,
                    rounding);
  comparison.number("a resolution", stated.resolution, found.resolution, worst * found.resolution);
}

void compare_certificates(Comparison& comparison, const Certificate& stated, const Certificate& found,
                          double rounding) {
  comparison.count("flipped triangles", stated.flipped_triangles, found.flipped_triangles);
  comparison.ids("flipped triangle", stated.flipped, found.flipped);
  comparison.count("overwound vertices", stated.overwound_vertices, found.overwound_vertices);
  comparison.ids("overwound vertex", stated.overwound, found.overwound);
  comparison.count("overlapping pairs", stated.overlapping_pairs, found.overlapping_pairs);
  comparison.number("an overlapping area fraction", stated.overlap_area_fraction, found.overlap_area_fraction,
                    1e-12);
  comparison.number("an arap energy", stated.arap, found.arap, rounding * (rounding + std::sqrt(found.arap)));
  comparison.number("a symmetric Dirichlet energy", stated.symmetric_dirichlet, found.symmetric_dirichlet);
  comparison.spread("sigma_max", stated.sigma_max, found.sigma_max);
  comparison.spread("sigma_min", stated.sigma_min, found.sigma_min);
  comparison.spread("area ratio", stated.area_ratio, found.area_ratio);
  comparison.spread("angle distortion", stated.angle_distortion, found.angle_distortion);
  compare_benchmarks(comparison, stated.benchmark, found.benchmark, rounding);
}

void compare_features(Comparison& comparison, const Claims& claims, const WrittenMap& map) {
  for (const Feature& feature : claims.features) {
    double length = 0;
    const std::size_t n = feature.vertex.size();
    for (std::size_t k = feature.closed ? 0 : 1; k < n; ++k)
      length += norm(map.position(feature.vertex[k]) - map.position(feature.vertex[(k + n - 1) % n]));
    if (!feature.is_region())
      comparison.number("a length of feature \"" + feature.name + "\"", feature.length, length);
  }
}

}  // namespace

std::vector<std::string> misreported(const Claims& claims, const Verification& found, const MeshFacts& facts,
                                     const WrittenMap& map, double rounding) {
  Comparison comparison(rounding);
  // Where both sides of a cut lie on one another throughout, the map does not show it.
  if (claims.cut_edges.value_or(0) == found.torn_edges) {
    comparison.count("components", claims.mesh.components, facts.components);
    comparison.count("boundary loops", claims.mesh.boundary_loops, facts.boundary_loops);
    comparison.count("Euler characteristic", claims.mesh.euler, facts.euler);
  } else if (claims.cut_edges.value_or(0) < found.torn_edges) {
    comparison.count("cut edges", claims.cut_edges.value_or(0), found.torn_edges);
  }
  compare_certificates(comparison, claims.certificate, found.certificate, rounding);
  compare_features(comparison, claims, map);
  return comparison.take();
}

}  // namespace planish
