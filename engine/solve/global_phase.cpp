#include "engine/solve/global_phase.hpp"

#include <algorithm>
#include <new>

#include "engine/exec/large_array.hpp"
#include "engine/solve/cholesky_analysis.hpp"
#include "engine/solve/multifrontal.hpp"
#include "engine/solve/supernode_tree.hpp"

namespace planish {

Result<Offset> factor_nonzeros(const SymmetricMatrix& matrix, In<Index> order) {
  return count_factor(matrix, order);
}

struct GlobalPhase::Factor {
  CholeskyAnalysis analysis;
  LargeArray<double> value;
  LargeArray<float> rounded;
  SupernodeTree tree;

  SupernodalFactor view() const {
    return {.super = analysis.super,
            .row_begin = analysis.row_begin,
            .row = analysis.row,
            .value_begin = analysis.value_begin,
            .value = value.data(),
            .rounded = rounded.data(),
            .solves = &panel_solves(best_instruction_set()),
            .permutation = analysis.permutation};
  }
};

GlobalPhase::GlobalPhase(std::unique_ptr<Factor> factor) : factor_(std::move(factor)) {}
GlobalPhase::GlobalPhase(GlobalPhase&&) noexcept = default;
GlobalPhase& GlobalPhase::operator=(GlobalPhase&&) noexcept = default;
GlobalPhase::~GlobalPhase() = default;

namespace {

Failure no_memory() {
  return fail(ErrorCode::OutOfMemory, "not enough memory for the values of the sparse factor");
}

}  // namespace

Result<GlobalPhase> GlobalPhase::analyse(const Exec& exec, const SymmetricMatrix& matrix, In<Index> order) {
  auto analysis = analyse_cholesky(exec, matrix, order);
  if (!analysis) return fail(analysis.error());
  try {
    auto parts = std::make_unique<Factor>();
    parts->analysis = std::move(*analysis);
    parts->tree = SupernodeTree(parts->view());
    return GlobalPhase(std::move(parts));
  } catch (const std::bad_alloc&) {
    return no_memory();
  }
}

Result<GlobalPhase> GlobalPhase::factor(const Exec& exec, const SymmetricMatrix& matrix, In<Index> order) {
  auto result = analyse(exec, matrix, order);
  if (!result) return result;
  if (auto factored = result->refactor(exec, matrix); !factored) return fail(factored.error());
  return result;
}

Result<void> GlobalPhase::refactor(const Exec& exec, const SymmetricMatrix& matrix) try {
  Factor& f = *factor_;
  f.rounded = {};
  if (f.value.size() == 0) f.value = LargeArray<double>(f.analysis.factor_nonzeros());
  const Index bad =
      factor_fronts(exec, f.analysis, dense_kernels(best_instruction_set()), matrix.value, f.value.data());
  if (bad == kNone) return {};
  return fail(Error{.code = ErrorCode::FactorizationFailed,
                    .what = "the matrix is not positive definite",
                    .place = {},
                    .element = ElementKind::Vertex,
                    .ids = {f.analysis.permutation[bad]},
                    .count = 1});
} catch (const std::bad_alloc&) {
  return no_memory();
}

void GlobalPhase::round_to_single(const Exec& exec) {
  Factor& f = *factor_;
  if (is_rounded()) return;
  f.rounded = LargeArray<float>(f.value.size());
  constexpr Index kPart = 1 << 20;
  exec.for_tasks(static_cast<Index>((f.value.size() + kPart - 1) / kPart), [&](Index part) {
    const Offset begin = static_cast<Offset>(part) * kPart, end = std::min(begin + kPart, f.value.size());
    std::copy(f.value.data() + begin, f.value.data() + end, f.rounded.data() + begin);
    f.value.discard(begin, end);  // both precisions are never there at once
  });
  f.value = {};
}

bool GlobalPhase::is_rounded() const { return factor_->rounded.data() != nullptr; }

void GlobalPhase::solve(const Exec& exec, In<Vec2> rhs, Out<Vec2> x) const {
  if (!rhs.empty()) factor_->tree.solve(exec, factor_->view(), rhs, x);
}

void GlobalPhase::forward(const Exec& exec, In<Vec2> rhs, Out<Vec2> half) const {
  const SupernodalFactor f = factor_->view();
  exec.for_blocks(static_cast<Index>(half.size()), kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) half[k] = rhs[f.permutation[k]];
  });
  factor_->tree.forward(exec, f, half);
}

void GlobalPhase::backward(const Exec& exec, Out<Vec2> half, Out<Vec2> x) const {
  const SupernodalFactor f = factor_->view();
  factor_->tree.backward(exec, f, half);
  exec.for_blocks(static_cast<Index>(half.size()), kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) x[f.permutation[k]] = half[k];
  });
}

namespace {

Vec2 times_i(Vec2 z) { return {-z.y, z.x}; }

/// Free complex unknowns give pairs of columns, the second i times the first.
bool is_i_times(const SparseColumn& second, const SparseColumn& first) {
  if (second.row != first.row) return false;
  for (std::size_t i = 0; i < first.value.size(); ++i) {
    if (second.value[i] != times_i(first.value[i])) return false;
  }
  return true;
}

}  // namespace

std::vector<SparseColumn> GlobalPhase::forward(const Exec& exec, const std::vector<SparseColumn>& rhs) const {
  constexpr Index kMostTasks = 16;  // each has a workspace of the size of the whole
  const SupernodalFactor f = factor_->view();
  std::vector<Index> place(f.permutation.size());
  for (std::size_t k = 0; k < place.size(); ++k) place[f.permutation[k]] = static_cast<Index>(k);
  std::vector<SparseColumn> result(rhs.size());
  const auto num_columns = static_cast<Index>(rhs.size());
  const Index columns_a_task = (num_columns + kMostTasks - 1) / kMostTasks;
  exec.for_blocks(num_columns, std::max(1, columns_a_task), [&](Index, Range r) {
    std::vector<Vec2> workspace(place.size());
    for (Index k = r.begin; k < r.end; ++k) {
      if (k > r.begin && is_i_times(rhs[k], rhs[k - 1])) {
        result[k] = result[k - 1];
        for (Vec2& z : result[k].value) z = times_i(z);
        continue;
      }
      SparseColumn permuted = rhs[k];
      for (Index& row : permuted.row) row = place[row];
      result[k] = factor_->tree.forward(f, permuted, workspace);
    }
  });
  return result;
}

Offset GlobalPhase::factor_nonzeros() const { return factor_->analysis.factor_nonzeros(); }

}  // namespace planish
