#include "engine/solve/border.hpp"

#include <algorithm>
#include <Eigen/Cholesky>

namespace planish {

struct BorderedPhase::Parts {
  const GlobalPhase* inner = nullptr;
  std::vector<SparseColumn> half;  // L^-1 P B, per column
  Eigen::LLT<Eigen::MatrixXd> schur;
};

namespace {

struct RowEntry {
  Index row, column;
  Vec2 value;
};

/// Lower triangle of Re(Y^H Y), row by row of Y: columns that have no row in common cost nothing.
void subtract_products(const std::vector<SparseColumn>& half, Eigen::MatrixXd& schur) {
  std::vector<RowEntry> entries;
  for (std::size_t k = 0; k < half.size(); ++k) {
    for (std::size_t i = 0; i < half[k].row.size(); ++i)
      entries.push_back({half[k].row[i], static_cast<Index>(k), half[k].value[i]});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const RowEntry& a, const RowEntry& b) { return a.row < b.row; });
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].row == entries[begin].row) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = i; j < end; ++j)
        schur(entries[j].column, entries[i].column) -= dot(entries[i].value, entries[j].value);
    }
  }
}

}  // namespace

BorderedPhase::BorderedPhase(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
BorderedPhase::BorderedPhase(BorderedPhase&&) noexcept = default;
BorderedPhase& BorderedPhase::operator=(BorderedPhase&&) noexcept = default;
BorderedPhase::~BorderedPhase() = default;

Index BorderedPhase::size() const { return static_cast<Index>(parts_->half.size()); }

Result<BorderedPhase> BorderedPhase::factor(const Exec& exec, const GlobalPhase& inner,
                                            const std::vector<SparseColumn>& columns, In<double> corner) {
  auto parts = std::make_unique<Parts>();
  parts->inner = &inner;
  parts->half = inner.forward(exec, columns);
  const auto m = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd schur = Eigen::Map<const Eigen::MatrixXd>(corner.data(), m, m);
  subtract_products(parts->half, schur);
  parts->schur.compute(schur);
  if (parts->schur.info() != Eigen::Success)
    return fail(ErrorCode::FactorizationFailed, "the border of the system is not positive definite");
  return BorderedPhase(std::move(parts));
}

void BorderedPhase::solve(const Exec& exec, In<Vec2> rhs, In<double> rhs_border, Out<Vec2> x,
                          Out<double> y) const {
  const Parts& p = *parts_;
  if (p.half.empty()) return p.inner->solve(exec, rhs, x);
  std::vector<Vec2> half(rhs.size());
  p.inner->forward(exec, rhs, half);
  const auto m = static_cast<Eigen::Index>(p.half.size());
  Eigen::VectorXd reduced(m);
  exec.for_tasks(size(), [&](Index k) {
    double product = 0;
    for (std::size_t i = 0; i < p.half[k].row.size(); ++i)
      product += dot(p.half[k].value[i], half[p.half[k].row[i]]);
    reduced[k] = rhs_border[k] - product;
  });
  p.schur.solveInPlace(reduced);
  for (Eigen::Index k = 0; k < m; ++k) {
    y[k] = reduced[k];
    const SparseColumn& column = p.half[k];
    for (std::size_t i = 0; i < column.row.size(); ++i)
      half[column.row[i]] = half[column.row[i]] - reduced[k] * column.value[i];
  }
  p.inner->backward(exec, half, x);
}

}  // namespace planish
