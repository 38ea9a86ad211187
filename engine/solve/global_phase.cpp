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

namespace {

/// The factor in 16 bits an entry.
class Strips {
 public:
  Strips() = default;
  explicit Strips(const CholeskyAnalysis& a) : begin_(a.num_supernodes() + std::size_t{1}) {
    for (Index s = 0; s < a.num_supernodes(); ++s)
      begin_[s + 1] = begin_[s] + strips_size(a.columns(s), a.rows(s));
    entry_ = LargeArray<std::int16_t>(begin_.back());
    for (std::vector<float>* numbers : {&scale_, &diagonal_, &inverse_})
      numbers->resize(a.size() + kStripColumns);
  }

  bool empty() const { return begin_.empty(); }

  /// Numbers that make() works with.
  static Index scratch_size(const CholeskyAnalysis& a) {
    Index most = 0;
    for (Index s = 0; s < a.num_supernodes(); ++s) most = std::max(most, a.rows(s));
    return most + kStripRows;
  }

  void make(const CholeskyAnalysis& a, Range supernodes, const double* value, Out<double> scratch) {
    for (Index s = supernodes.begin; s < supernodes.end; ++s) {
      const StripColumns<float> column{scale_.data(), diagonal_.data(), inverse_.data()};
      make_strips({a.columns(s), a.rows(s), value + a.value_begin[s]}, entry_.data() + begin_[s],
                  column.from(a.super[s]), scratch.data());
    }
  }

  StripFactor view() const {
    return {begin_,
            entry_.data(),
            {scale_.data(), diagonal_.data(), inverse_.data()},
            &strip_solves(best_instruction_set())};
  }

 private:
  std::vector<Offset> begin_;
  LargeArray<std::int16_t> entry_;
  std::vector<float> scale_, diagonal_, inverse_;
};

}  // namespace

struct GlobalPhase::Factor {
  CholeskyAnalysis analysis;
  LargeArray<double> value;
  Strips strips;
  SupernodeTree tree;

  SupernodalFactor view() const {
    return {.super = analysis.super,
            .row_begin = analysis.row_begin,
            .row = analysis.row,
            .value_begin = analysis.value_begin,
            .value = value.data(),
            .strips = strips.view(),
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
  f.strips = {};
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

void GlobalPhase::round(const Exec& exec) {
  Factor& f = *factor_;
  if (is_rounded()) return;
  const CholeskyAnalysis& a = f.analysis;
  Strips strips(a);
  constexpr Offset kPart = 1 << 20;  // values
  std::vector<Index> begin = {0};
  for (Index s = 1; s <= a.num_supernodes(); ++s) {
    if (s == a.num_supernodes() || a.value_begin[s + 1] - a.value_begin[begin.back()] > kPart)
      begin.push_back(s);
  }
  const auto num_parts = static_cast<Index>(begin.size()) - 1;
  std::vector<std::vector<double>> scratch(num_parts, std::vector<double>(strips.scratch_size(a)));
  // Nothing is allocated from here on, where the old values go.
  exec.for_tasks(num_parts, [&](Index part) {
    const Range supernodes{begin[part], begin[part + 1]};
    strips.make(a, supernodes, f.value.data(), scratch[part]);
    // Both precisions are never there at once.
    f.value.discard(a.value_begin[supernodes.begin], a.value_begin[supernodes.end]);
  });
  f.value = {};
  f.strips = std::move(strips);
}

bool GlobalPhase::is_rounded() const { return !factor_->strips.empty(); }

void GlobalPhase::solve(const Exec& exec, In<Vec2> rhs, Out<Vec2> x) const {
  if (!rhs.empty()) factor_->tree.solve(exec, factor_->view(), rhs, x);
}

void GlobalPhase::forward(const Exec& exec, In<Vec2> rhs, Out<Vec2> half) const {
  factor_->tree.forward(exec, factor_->view(), rhs, half);
}

void GlobalPhase::backward(const Exec& exec, In<Vec2> half, Out<Vec2> x) const {
  factor_->tree.backward(exec, factor_->view(), half, x);
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
    std::vector<SparseColumn> permuted;
    for (Index k = r.begin; k < r.end; ++k) {
      if (k > r.begin && is_i_times(rhs[k], rhs[k - 1])) continue;
      permuted.push_back(rhs[k]);
      for (Index& row : permuted.back().row) row = place[row];
    }
    std::vector<SparseColumn> solved = factor_->tree.forward(f, permuted);
    std::size_t next = 0;
    for (Index k = r.begin; k < r.end; ++k) {
      if (k > r.begin && is_i_times(rhs[k], rhs[k - 1])) {
        result[k] = result[k - 1];
        for (Vec2& z : result[k].value) z = times_i(z);
      } else {
        result[k] = std::move(solved[next++]);
      }
    }
  });
  return result;
}

Offset GlobalPhase::factor_nonzeros() const { return factor_->analysis.factor_nonzeros(); }

}  // namespace planish
