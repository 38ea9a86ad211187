#include "engine/solve/border.hpp"

#include <algorithm>
#include <limits>
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

/// Rows of Y that have entries in many columns, real and imaginary parts below one another, dense.
constexpr std::size_t kDenseRow = 48;
constexpr Eigen::Index kDenseRows = 512;  // gathered before they are multiplied
constexpr Index kColumnBlock = 128;

class Products {
 public:
  Products(const Exec& exec, Eigen::MatrixXd& schur)
      : exec_(exec), schur_(schur), dense_(kDenseRows, schur.cols()) {}

  void add(In<RowEntry> row) {
    if (row.size() >= kDenseRow) return add_dense(row);
    for (std::size_t i = 0; i < row.size(); ++i) {
      for (std::size_t j = i; j < row.size(); ++j)
        schur_(row[j].column, row[i].column) -= dot(row[i].value, row[j].value);
    }
  }

  void flush() {
    const auto rows = dense_.topRows(filled_);
    exec_.for_blocks(static_cast<Index>(schur_.cols()), kColumnBlock, [&](Index, Range r) {
      const Eigen::Index below = schur_.cols() - r.begin;
      schur_.block(r.begin, r.begin, below, r.end - r.begin).noalias() -=
          rows.rightCols(below).transpose() * rows.middleCols(r.begin, r.end - r.begin);
    });
    filled_ = 0;
  }

 private:
  void add_dense(In<RowEntry> row) {
    if (filled_ + 2 > kDenseRows) flush();
    dense_.middleRows(filled_, 2).setZero();
    for (const RowEntry& e : row) {
      dense_(filled_, e.column) = e.value.x;
      dense_(filled_ + 1, e.column) = e.value.y;
    }
    filled_ += 2;
  }

  const Exec& exec_;
  Eigen::MatrixXd& schur_;
  Eigen::MatrixXd dense_;
  Eigen::Index filled_ = 0;
};

/// Lower triangle of Re(Y^H Y), row by row of Y: columns that have no row in common cost nothing.
void subtract_products(const Exec& exec, const std::vector<SparseColumn>& half, Eigen::MatrixXd& schur) {
  std::vector<RowEntry> entries;
  for (std::size_t k = 0; k < half.size(); ++k) {
    for (std::size_t i = 0; i < half[k].row.size(); ++i)
      entries.push_back({half[k].row[i], static_cast<Index>(k), half[k].value[i]});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const RowEntry& a, const RowEntry& b) { return a.row < b.row; });
  Products products(exec, schur);
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].row == entries[begin].row) ++end;
    products.add(In<RowEntry>(entries).subspan(begin, end - begin));
  }
  products.flush();
}

/// Whether every pivot is more than what rounding leaves of a column that depends on those before it: its sign is chance.
bool is_definite(const Eigen::LLT<Eigen::MatrixXd>& factor, const Eigen::MatrixXd& schur) {
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * static_cast<double>(schur.cols());
  for (Eigen::Index k = 0; k < schur.cols(); ++k) {
    const double root = factor.matrixLLT()(k, k);
    if (!(root * root > rounding * schur(k, k))) return false;
  }
  return true;
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
  subtract_products(exec, parts->half, schur);
  parts->schur.compute(schur);
  if (parts->schur.info() != Eigen::Success || !is_definite(parts->schur, schur))
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

void BorderedPhase::solve(const Exec& exec, In<Vec2> rhs, Out<Vec2> x) const {
  const std::size_t m = parts_->half.size(), n = rhs.size() - m;
  std::vector<double> border(m);
  for (std::size_t k = 0; k < m; ++k) border[k] = rhs[n + k].x;
  solve(exec, rhs.first(n), border, x.first(n), border);
  for (std::size_t k = 0; k < m; ++k) x[n + k] = {border[k], 0};
}

}  // namespace planish
