#include "tests/support/multipliers.hpp"

#include <map>
#include <Eigen/Dense>

namespace planish::multipliers {
namespace {

/// Unknowns: u and v of every vertex, then free scales.
class Assembler {
 public:
  explicit Assembler(const Problem& problem) : problem_(problem) {
    size_ = 2 * static_cast<Eigen::Index>(problem.position.size());
    for (const DirectedShape& shape : problem.shapes) scale_column_.push_back(column_of(shape));
  }

  Solution solve() {
    write_energy();
    for (std::size_t k = 0; k < problem_.shapes.size(); ++k) write(problem_.shapes[k], scale_column_[k]);
    for (const auto& [v, z] : problem_.pins) hold(v, z);
    if (problem_.pins.empty()) hold(0, {});
    return minimise();
  }

 private:
  struct Row {
    std::vector<std::pair<Eigen::Index, double>> entry;
    double value = 0;
  };

  Eigen::Index column_of(const DirectedShape& shape) {
    if (shape.scale || shape.free_lengths) return -1;
    if (shape.scale_group == kNone) return size_++;
    const auto [known, added] = group_column_.try_emplace(shape.scale_group, size_);
    if (added) ++size_;
    return known->second;
  }

  void write_energy() {
    hessian_ = Eigen::MatrixXd::Zero(size_, size_);
    gradient_ = Eigen::VectorXd::Zero(size_);
    for (std::size_t t = 0; t < problem_.rotation.size(); ++t) {
      const Index* v = &problem_.corner_vertex[3 * t];
      const Vec3 p[3] = {problem_.position[v[0]], problem_.position[v[1]], problem_.position[v[2]]};
      const Vec3 along = (1 / norm(p[1] - p[0])) * (p[1] - p[0]);
      const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
      const Vec3 across = cross((1 / norm(normal)) * normal, along);
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;  // the edge i -> j is opposite corner k
        const Vec3 a = p[i] - p[k], b = p[j] - p[k], edge = p[j] - p[i];
        const double cotangent = dot(a, b) / norm(cross(a, b));
        add_edge(v[i], v[j], cotangent,
                 multiply(problem_.rotation[t], {dot(edge, along), dot(edge, across)}));
      }
    }
  }

  void add_edge(Index from, Index to, double weight, Vec2 wanted) {
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Index a = 2 * from + axis, b = 2 * to + axis;
      const double d = axis == 0 ? wanted.x : wanted.y;
      hessian_(a, a) += weight, hessian_(b, b) += weight;
      hessian_(a, b) -= weight, hessian_(b, a) -= weight;
      gradient_[b] += weight * d, gradient_[a] -= weight * d;
    }
  }

  void write(const DirectedShape& shape, Eigen::Index scale_column) {
    const Index w = shape.vertex[0];
    for (std::size_t i = 1; i < shape.vertex.size(); ++i) {
      const Index v = shape.vertex[i];
      const Vec2 d = shape.direction, along = multiply(d, shape.shape[i] - shape.shape[0]);
      if (shape.free_lengths) {
        rows_.push_back({{{2 * v, -d.y}, {2 * v + 1, d.x}, {2 * w, d.y}, {2 * w + 1, -d.x}}, 0});
        continue;
      }
      for (int axis = 0; axis < 2; ++axis) {
        const double part = axis == 0 ? along.x : along.y;
        Row row{{{2 * v + axis, 1}, {2 * w + axis, -1}}, 0};
        if (scale_column < 0) {
          row.value = *shape.scale * part;
        } else {
          row.entry.emplace_back(scale_column, -part);
        }
        rows_.push_back(std::move(row));
      }
    }
  }

  void hold(Index v, Vec2 z) {
    rows_.push_back({{{2 * v, 1}}, z.x});
    rows_.push_back({{{2 * v + 1, 1}}, z.y});
  }

  Solution minimise() {
    const auto m = static_cast<Eigen::Index>(rows_.size());
    Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(size_, m);
    Eigen::VectorXd value(m);
    for (Eigen::Index k = 0; k < m; ++k) {
      for (const auto& [column, x] : rows_[k].entry) transposed(column, k) += x;
      value[k] = rows_[k].value;
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(1e-9);
    qr.compute(transposed);
    const Eigen::Index rank = qr.rank();
    Eigen::MatrixXd kept(size_, rank);
    Eigen::VectorXd kept_value(rank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      kept.col(k) = transposed.col(qr.colsPermutation().indices()[k]);
      kept_value[k] = value[qr.colsPermutation().indices()[k]];
    }
    const Eigen::Index n = size_ + rank;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    matrix.topLeftCorner(size_, size_) = hessian_;
    matrix.topRightCorner(size_, rank) = kept;
    matrix.bottomLeftCorner(rank, size_) = kept.transpose();
    Eigen::VectorXd right(n);
    right << gradient_, kept_value;
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(matrix);
    Eigen::VectorXd x = lu.solve(right);
    x += lu.solve(right - matrix * x);
    Solution solution{
        .z = {},
        .equations = static_cast<int>(m),
        .redundant = static_cast<int>(m - rank),
        .contradiction = (transposed.transpose() * x.head(size_) - value).cwiseAbs().maxCoeff()};
    for (Eigen::Index v = 0; v < static_cast<Eigen::Index>(problem_.position.size()); ++v)
      solution.z.push_back({x[2 * v], x[2 * v + 1]});
    return solution;
  }

  const Problem& problem_;
  Eigen::Index size_ = 0;
  std::vector<Eigen::Index> scale_column_;
  std::map<Index, Eigen::Index> group_column_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
  std::vector<Row> rows_;
};

}  // namespace

Solution solve(const Problem& problem) { return Assembler(problem).solve(); }

}  // namespace planish::multipliers
