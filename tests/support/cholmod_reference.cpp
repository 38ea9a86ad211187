#include "tests/support/cholmod_reference.hpp"

#include <cholmod.h>

namespace planish {
namespace {

cholmod_sparse view(const SymmetricMatrix& matrix) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = static_cast<std::size_t>(matrix.size());
  sparse.nzmax = matrix.row.size();
  sparse.p = const_cast<Index*>(matrix.column_begin.data());
  sparse.i = const_cast<Index*>(matrix.row.data());
  sparse.x = const_cast<double*>(matrix.value.data());
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

}  // namespace

struct CholmodReference::State {
  cholmod_common common{};
  cholmod_sparse matrix{};
  cholmod_factor* factor = nullptr;
  cholmod_dense *y = nullptr, *e = nullptr, *x = nullptr;
};

CholmodReference::CholmodReference(const SymmetricMatrix& matrix, In<Index> order) : state_(new State) {
  cholmod_common& common = state_->common;
  cholmod_start(&common);
  common.print = 0;
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = order.empty() ? CHOLMOD_METIS : CHOLMOD_GIVEN;
  state_->matrix = view(matrix);
  std::vector<Index> whole(order.begin(), order.end());
  state_->factor =
      cholmod_analyze_p(&state_->matrix, order.empty() ? nullptr : whole.data(), nullptr, 0, &common);
}

CholmodReference::~CholmodReference() {
  cholmod_common& common = state_->common;
  cholmod_free_factor(&state_->factor, &common);
  cholmod_free_dense(&state_->x, &common);
  cholmod_free_dense(&state_->y, &common);
  cholmod_free_dense(&state_->e, &common);
  cholmod_finish(&common);
  delete state_;
}

bool CholmodReference::factor() {
  cholmod_factorize(&state_->matrix, state_->factor, &state_->common);
  return state_->common.status == CHOLMOD_OK;
}

std::vector<Vec2> CholmodReference::solve(In<Vec2> rhs) {
  const std::size_t n = rhs.size();
  std::vector<double> b(2 * n);
  for (std::size_t i = 0; i < n; ++i) b[i] = rhs[i].x, b[n + i] = rhs[i].y;
  cholmod_dense dense{};
  dense.nrow = dense.d = n;
  dense.ncol = 2;
  dense.nzmax = 2 * n;
  dense.x = b.data();
  dense.xtype = CHOLMOD_REAL;
  dense.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, state_->factor, &dense, nullptr, &state_->x, nullptr, &state_->y, &state_->e,
                 &state_->common);
  const auto* solution = static_cast<const double*>(state_->x->x);
  std::vector<Vec2> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = {solution[i], solution[n + i]};
  return x;
}

double CholmodReference::flops() const { return state_->common.fl; }
double CholmodReference::factor_entries() const { return state_->common.lnz; }

std::vector<Index> CholmodReference::order() const {
  const auto* permutation = static_cast<const Index*>(state_->factor->Perm);
  return {permutation, permutation + state_->factor->n};
}

std::vector<Index> CholmodReference::metis(const SymmetricMatrix& matrix) {
  cholmod_common common{};
  cholmod_start(&common);
  cholmod_sparse sparse = view(matrix);
  std::vector<Index> order(matrix.size());
  cholmod_metis(&sparse, nullptr, 0, 1, order.data(), &common);
  cholmod_finish(&common);
  return order;
}

}  // namespace planish
