#include "engine/methods/angle_factor.hpp"

#include <optional>
#include <Eigen/SparseCholesky>

#include "engine/solve/global_phase.hpp"

namespace planish {

struct AngleFactor::Parts {
  const Exec& exec;
  std::vector<Index> order;
  bool is_indefinite = false;
  std::optional<GlobalPhase> global;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> indefinite;

  Parts(const Exec& on, std::vector<Index> rows) : exec(on), order(std::move(rows)) {}

  Result<void> factor_definite(const SymmetricMatrix& a) {
    if (global) return global->refactor(exec, a);
    auto made = GlobalPhase::factor(exec, a, order);
    if (!made) return fail(made.error());
    global.emplace(std::move(*made));
    return {};
  }

  Result<void> factor_indefinite(const SymmetricMatrix& a) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < a.size(); ++j) {
      for (Index k = a.column_begin[j]; k < a.column_begin[j + 1]; ++k)
        entries.emplace_back(a.row[k], j, a.value[k]);
    }
    Eigen::SparseMatrix<double> lower(a.size(), a.size());
    lower.setFromTriplets(entries.begin(), entries.end());
    indefinite.compute(lower);
    return indefinite.info() == Eigen::Success
               ? Result<void>()
               : fail(ErrorCode::FactorizationFailed, "a pivot of the angles' system is 0");
  }
};

AngleFactor::AngleFactor(const Exec& exec, std::vector<Index> order)
    : parts_(std::make_unique<Parts>(exec, std::move(order))) {}
AngleFactor::~AngleFactor() = default;

Result<void> AngleFactor::factor(const SymmetricMatrix& a, bool indefinite) {
  parts_->is_indefinite = indefinite;
  return indefinite ? parts_->factor_indefinite(a) : parts_->factor_definite(a);
}

void AngleFactor::solve(std::vector<Vec2>& x) const {
  if (!parts_->is_indefinite) return parts_->global->solve(parts_->exec, x, x);
  const auto size = static_cast<Index>(x.size());
  Eigen::MatrixX2d columns(size, 2);
  for (Index j = 0; j < size; ++j) columns.row(j) << x[j].x, x[j].y;
  columns = parts_->indefinite.solve(columns).eval();
  for (Index j = 0; j < size; ++j) x[j] = {columns(j, 0), columns(j, 1)};
}

}  // namespace planish
