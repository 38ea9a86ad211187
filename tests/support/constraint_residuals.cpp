#include "tests/support/constraint_residuals.hpp"

#include <algorithm>
#include <map>
#include <Eigen/Dense>

namespace planish {
namespace {

constexpr double kDegrees = 180 / kPi;

Eigen::MatrixX3d centred(In<Vec3> point) {
  Eigen::MatrixX3d m(static_cast<Eigen::Index>(point.size()), 3);
  for (std::size_t i = 0; i < point.size(); ++i)
    m.row(static_cast<Eigen::Index>(i)) << point[i].x, point[i].y, point[i].z;
  return m.rowwise() - m.colwise().mean();
}

/// Orthogonal projection onto the best-fit plane, up to a mirroring.
std::vector<Vec2> projected(In<Vec3> point) {
  const Eigen::MatrixX3d m = centred(point);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeThinV);
  const Eigen::MatrixXd flat = m * svd.matrixV().leftCols(2);
  std::vector<Vec2> result;
  for (Eigen::Index i = 0; i < flat.rows(); ++i) result.push_back({flat(i, 0), flat(i, 1)});
  return result;
}

class Measuring {
 public:
  Measuring(const ConstrainedCase& c, In<Vec2> uv, const std::vector<ConstraintOutcome>& outcome)
      : c_(c), uv_(uv), outcome_(outcome) {}

  std::vector<MeasuredResidual> operator()() {
    for (const Constraint& constraint : c_.set.constraints) {
      at_ = &constraint;
      const double residual = std::visit([&](const auto& rule) { return measure(rule); }, constraint.rule);
      const bool is_angle = std::holds_alternative<AngleConstraint>(constraint.rule) ||
                            std::holds_alternative<DirectionConstraint>(constraint.rule);
      result_.push_back({constraint.name, residual, is_angle});
    }
    return std::move(result_);
  }

 private:
  std::vector<Vec2> images(const std::vector<Index>& vertex) const {
    std::vector<Vec2> z;
    for (const Index v : vertex) z.push_back(uv_[v]);
    return z;
  }
  std::vector<Vec3> points(const std::vector<Index>& vertex) const {
    std::vector<Vec3> p;
    for (const Index v : vertex) p.push_back(c_.mesh.position[v]);
    return p;
  }
  double edge_length(Index u, Index v) const { return norm(c_.mesh.position[v] - c_.mesh.position[u]); }

  std::vector<double> edge_lengths(const Feature& chain) const {
    std::vector<double> length;
    for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < chain.vertex.size(); ++i)
      length.push_back(edge_length(chain.vertex[i], chain.vertex[(i + 1) % chain.vertex.size()]));
    return length;
  }
  double length_of(const Feature& chain) const {
    double sum = 0;
    for (const double l : edge_lengths(chain)) sum += l;
    return sum;
  }

  /// The factor that features of its group have, or what this one has.
  double agreed_scale(const Scale& scale, double measured, double& residual) {
    if (scale.factor) return *scale.factor;
    if (scale.group.empty()) return measured;
    const auto [known, added] = group_.try_emplace(scale.group, measured);
    residual = std::max(residual, std::abs(known->second - measured));
    return known->second;
  }

  /// Distances between all images against those between template points.
  double congruence(const std::vector<Vec2>& z, const std::vector<Vec2>& t, const Scale& scale, double size) {
    double squares = 0, product = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        squares += dot(t[i] - t[j], t[i] - t[j]);
        product += norm(t[i] - t[j]) * norm(z[i] - z[j]);
      }
    }
    double worst = 0;
    const double s = agreed_scale(scale, product / squares, worst);
    for (std::size_t i = 0; i < z.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        worst = std::max(worst, std::abs(norm(z[i] - z[j]) - s * norm(t[i] - t[j])) / size);
    }
    return worst;
  }

  double off_line(const std::vector<Vec2>& z) const {
    const Vec2 along = z.back() - z.front();
    double worst = 0;
    for (const Vec2 p : z) worst = std::max(worst, std::abs(cross(along, p - z.front())) / norm(along));
    return worst;
  }

  double measure(const LineConstraint& rule) {
    const Feature& chain = c_.feature(rule.feature);
    const std::vector<Vec2> z = images(chain.vertex);
    const double size = length_of(chain);
    if (rule.lengths == LineConstraint::Lengths::Free) return off_line(z) / size;
    std::vector<Vec2> t = {Vec2{}};
    for (const double l : edge_lengths(chain)) t.push_back(t.back() + Vec2{l, 0});
    const Scale scale = rule.lengths == LineConstraint::Lengths::Scale ? rule.scale : Scale{};
    return std::max(off_line(z) / size, congruence(z, t, scale, size));
  }

  double measure(const CircleConstraint& rule) {
    const Feature& chain = c_.feature(rule.feature);
    const std::vector<Vec2> z = images(chain.vertex);
    // The circle through three of the points; the others must be on it.
    const Vec2 a = z.front(), b = z[z.size() / 3] - a,
               d = z[chain.closed ? 2 * z.size() / 3 : z.size() - 1] - a;
    const double e = 2 * cross(b, d);
    const Vec2 centre =
        a + (1 / e) * Vec2{d.y * dot(b, b) - b.y * dot(d, d), b.x * dot(d, d) - d.x * dot(b, b)};
    const double radius = norm(a - centre), size = length_of(chain);
    double worst = 0;
    for (const Vec2 p : z) worst = std::max(worst, std::abs(norm(p - centre) - radius) / radius);
    if (rule.radius) worst = std::max(worst, std::abs(radius / *rule.radius - 1));
    // Edges keep their lengths up to one factor.
    const std::vector<double> length = edge_lengths(chain);
    double sweep = 0, sum = 0;
    for (std::size_t i = 0; i < length.size(); ++i) {
      const Vec2 p = z[i], q = z[(i + 1) % z.size()];
      sum += norm(q - p);
      sweep += std::atan2(cross(p - centre, q - centre), dot(p - centre, q - centre));
    }
    const double s = rule.radius ? sum / size : agreed_scale(rule.scale, sum / size, worst);
    for (std::size_t i = 0; i < length.size(); ++i)
      worst = std::max(worst, std::abs(norm(z[(i + 1) % z.size()] - z[i]) - s * length[i]) / size);
    const double wanted = chain.closed ? 360 : rule.sweep_degrees.value_or(kDegrees * std::abs(sweep));
    return std::max(worst, std::abs(std::abs(sweep) - wanted / kDegrees));
  }

  double measure(const CurveConstraint& rule) {
    const Feature& chain = c_.feature(rule.feature);
    const std::vector<Vec2> z = images(chain.vertex);
    const double size = length_of(chain);
    if (rule.shape == CurveConstraint::Shape::Plane)
      return congruence(z, projected(points(chain.vertex)), rule.scale, size);
    if (chain.closed) return congruence(z, of_outcome().shape, rule.scale, size);
    return std::max(turning(chain, z, rule.mirror.value_or(false)), edges(chain, z, rule.scale));
  }

  double edges(const Feature& chain, const std::vector<Vec2>& z, const Scale& scale) {
    const std::vector<double> length = edge_lengths(chain);
    double sum = 0, worst = 0;
    for (std::size_t i = 0; i < length.size(); ++i) sum += norm(z[i + 1] - z[i]);
    const double size = length_of(chain), s = agreed_scale(scale, sum / size, worst);
    for (std::size_t i = 0; i < length.size(); ++i)
      worst = std::max(worst, std::abs(norm(z[i + 1] - z[i]) - s * length[i]) / size);
    return worst;
  }

  /// Of an open chain, against the mean of both sides of the surface.
  double turning(const Feature& chain, const std::vector<Vec2>& z, bool mirrored) const {
    double worst = 0;
    for (std::size_t i = 1; i + 1 < z.size(); ++i) {
      const Index before = chain.vertex[i - 1], v = chain.vertex[i], after = chain.vertex[i + 1];
      const double left = angle_from(v, after, before), right = angle_from(v, before, after);
      double wanted = 0.5 * (right - left);
      if (left < 0) wanted = right - kPi;
      if (right < 0) wanted = kPi - left;
      if (mirrored) wanted = -wanted;
      const Vec2 a = z[i] - z[i - 1], b = z[i + 1] - z[i];
      worst = std::max(worst, std::abs(std::remainder(std::atan2(cross(a, b), dot(a, b)) - wanted, 2 * kPi)));
    }
    return worst;
  }

  /// Sum of the angles at v counter-clockwise from one neighbour to another; -1 where that leaves the surface.
  double angle_from(Index v, Index from, Index to) const {
    double sum = 0;
    for (Index at = from; at != to || at == from;) {
      bool found = false;
      const In<Index> corner = c_.mesh.corner_vertex;
      for (Index c = 0; c < static_cast<Index>(corner.size()) && !found; ++c) {
        if (corner[c] != v || corner[next_corner(c)] != at) continue;
        found = true;
        const Index next = corner[previous_corner(c)];
        const Vec3 a = c_.mesh.position[at] - c_.mesh.position[v],
                   b = c_.mesh.position[next] - c_.mesh.position[v];
        sum += std::atan2(norm(cross(a, b)), dot(a, b));
        at = next;
      }
      if (!found) return -1;
      if (at == from) break;
    }
    return sum;
  }

  double measure(const RegionConstraint& rule) {
    const Feature& region = c_.feature(rule.feature);
    std::vector<Index> vertex;
    for (const Index t : region.triangle) {
      for (Index k = 3 * t; k < 3 * t + 3; ++k) vertex.push_back(c_.mesh.corner_vertex[k]);
    }
    std::sort(vertex.begin(), vertex.end());
    vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
    double area = 0;
    for (const Index t : region.triangle) {
      const Vec3 p = c_.mesh.position[c_.mesh.corner_vertex[3 * t]];
      area += 0.5 * norm(cross(c_.mesh.position[c_.mesh.corner_vertex[3 * t + 1]] - p,
                               c_.mesh.position[c_.mesh.corner_vertex[3 * t + 2]] - p));
    }
    const ConstraintOutcome& outcome = of_outcome();
    const double worst = congruence(images(vertex), outcome.shape, rule.scale, std::sqrt(area));
    // Where it unrolls the template itself is isometric.
    if (!(outcome.planarity.value_or(1) < 1e-9)) return worst;
    double stretch = 0;
    const double s = rule.scale.factor.value_or(*outcome.scale);
    for (const Index t : region.triangle) {
      for (Index k = 3 * t; k < 3 * t + 3; ++k) {
        const Index u = c_.mesh.corner_vertex[k], v = c_.mesh.corner_vertex[next_corner(k)];
        stretch = std::max(stretch, std::abs(norm(uv_[v] - uv_[u]) - s * edge_length(u, v)));
      }
    }
    return std::max(worst, stretch / std::sqrt(area));
  }

  const ConstraintOutcome& of_outcome() const {
    return *std::find_if(outcome_.begin(), outcome_.end(),
                         [&](const ConstraintOutcome& o) { return o.name == at_->name; });
  }

  Vec2 chord(const std::string& feature) const {
    const Feature& chain = c_.feature(feature);
    return uv_[chain.vertex.back()] - uv_[chain.vertex.front()];
  }
  Vec2 chord(const std::array<Index, 2>& edge) const { return uv_[edge[1]] - uv_[edge[0]]; }

  static double off_angle(Vec2 a, Vec2 b, double degrees, bool oriented) {
    const double angle = kDegrees * std::atan2(cross(a, b), dot(a, b));
    if (oriented) return std::abs(std::remainder(angle - degrees, 360));
    return std::min(std::abs(std::remainder(angle - degrees, 180)),
                    std::abs(std::remainder(angle + degrees, 180)));
  }

  double measure(const AngleConstraint& rule) const {
    if (!rule.edges.empty())
      return off_angle(chord(rule.edges[0]), chord(rule.edges[1]), rule.degrees, rule.oriented);
    return off_angle(chord(rule.features[0]), chord(rule.features[1]), rule.degrees, rule.oriented);
  }
  double measure(const DirectionConstraint& rule) const {
    return off_angle({1, 0}, rule.edge ? chord(*rule.edge) : chord(rule.feature), rule.degrees,
                     rule.oriented);
  }
  double measure(const PinConstraint& rule) const {
    Vec2 lower = uv_[0], upper = uv_[0];
    for (const Vec2 z : uv_) {
      lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
      upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
    }
    double worst = 0;
    for (std::size_t i = 0; i < rule.vertex.size(); ++i)
      worst = std::max(worst, norm(uv_[rule.vertex[i]] - rule.uv[i]));
    return worst / norm(upper - lower);
  }

  const ConstrainedCase& c_;
  In<Vec2> uv_;
  const std::vector<ConstraintOutcome>& outcome_;
  const Constraint* at_ = nullptr;
  std::map<std::string, double> group_;
  std::vector<MeasuredResidual> result_;
};

}  // namespace

std::vector<MeasuredResidual> measure_residuals(const ConstrainedCase& c, In<Vec2> uv,
                                                const std::vector<ConstraintOutcome>& outcome) {
  return Measuring(c, uv, outcome)();
}

double straightness(In<Vec3> point) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred(point));
  return svd.singularValues()[1] / svd.singularValues()[0];
}

}  // namespace planish
