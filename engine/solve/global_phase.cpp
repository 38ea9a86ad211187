#include "engine/solve/global_phase.hpp"

#include <cholmod.h>
#include <dlfcn.h>

#include <algorithm>
#include <mutex>
#include <string>

#include "engine/solve/supernode_tree.hpp"

/// Never called: its address tells which library the matrix products come from. Weak, so that a BLAS with other
/// names links too.
extern "C" void dgemm_() __attribute__((weak));

namespace planish {
namespace {

/// Holds a threaded OpenBLAS to one thread while any factorization runs: its threads would change the order
/// of sums, and the bits with them. The setting is the process's own, so it is counted by all factorizations
/// that run at a time. Other BLAS libraries have no such call and need none.
class OneBlasThread {
 public:
  OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (holders_++ > 0 || !threads().get || !threads().set) return;
    before_ = threads().get();
    threads().set(1);
  }
  ~OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (--holders_ == 0 && threads().get && threads().set) threads().set(before_);
  }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  struct Threads {
    void (*set)(int) = nullptr;
    int (*get)() = nullptr;
  };
  static const Threads& threads() {
    static const Threads found = find();
    return found;
  }
  /// Looked up in the library of the matrix products: where a plugin brought it, the process does not see it.
  static Threads find() {
    Dl_info blas{};
    void* const library = dladdr(reinterpret_cast<void*>(&dgemm_), &blas) != 0
                              ? dlopen(blas.dli_fname, RTLD_LAZY | RTLD_NOLOAD)
                              : nullptr;
    void* const scope = library ? library : RTLD_DEFAULT;
    const Threads found{reinterpret_cast<void (*)(int)>(dlsym(scope, "openblas_set_num_threads")),
                        reinterpret_cast<int (*)()>(dlsym(scope, "openblas_get_num_threads"))};
    if (library) dlclose(library);  // it stays loaded: it was before
    return found;
  }
  static inline std::mutex mutex_;
  static inline int holders_ = 0;
  static inline int before_ = 1;
};

/// CHOLMOD's workspace; never prints.
struct Common {
  Common() {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_super = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
  }
  ~Common() { cholmod_finish(&common); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  cholmod_common common{};
};

/// The matrix as CHOLMOD sees it; our arrays, not copied.
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

/// With the rows beyond the given ones last.
std::vector<Index> whole_order(In<Index> order, Index size) {
  std::vector<Index> whole(order.begin(), order.end());
  for (auto row = static_cast<Index>(order.size()); row < size; ++row) whole.push_back(row);
  return whole;
}

Failure out_of_memory(const char* step) {
  return fail(ErrorCode::OutOfMemory,
              std::string("not enough memory for the ") + step + " of the sparse factor");
}

}  // namespace

Result<std::vector<Index>> fill_reducing_order(const SymmetricMatrix& matrix) {
  // METIS draws from the process's own random numbers, seeded anew by every call: one call at a time.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  Common cholmod;
  cholmod_sparse sparse = view(matrix);
  std::vector<Index> order(matrix.size());
  if (matrix.size() > 0 && !cholmod_metis(&sparse, nullptr, 0, 1, order.data(), &cholmod.common)) {
    // METIS takes SIGTERM for itself while it works, and gives up; its input is valid by construction.
    const bool stopped = cholmod.common.status == CHOLMOD_INVALID;
    return stopped ? fail(ErrorCode::Cancelled, "stopped by a signal") : out_of_memory("ordering");
  }
  return order;
}

Result<Offset> factor_nonzeros(const SymmetricMatrix& matrix, In<Index> order) {
  Common cholmod;
  std::vector<Index> whole = whole_order(order, matrix.size());
  cholmod_sparse sparse = view(matrix);
  cholmod_factor* factor = cholmod_analyze_p(&sparse, whole.data(), nullptr, 0, &cholmod.common);
  if (!factor) return out_of_memory("analysis");
  const auto nonzeros = static_cast<Offset>(factor->xsize);
  cholmod_free_factor(&factor, &cholmod.common);
  return nonzeros;
}

struct GlobalPhase::Factor {
  Common cholmod;
  cholmod_factor* factor = nullptr;
  SupernodeTree tree;
  std::vector<float> rounded;

  Factor() = default;
  ~Factor() { cholmod_free_factor(&factor, &cholmod.common); }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  SupernodalFactor view() const {
    const auto ints = [](void* p, std::size_t n) { return In<Index>(static_cast<const Index*>(p), n); };
    return {.super = ints(factor->super, factor->nsuper + 1),
            .row_begin = ints(factor->pi, factor->nsuper + 1),
            .row = ints(factor->s, factor->ssize),
            .value_begin = ints(factor->px, factor->nsuper + 1),
            .value = static_cast<const double*>(factor->x),
            .rounded = rounded.empty() ? nullptr : rounded.data(),
            .permutation = ints(factor->Perm, factor->n)};
  }
};

GlobalPhase::GlobalPhase(std::unique_ptr<Factor> factor) : factor_(std::move(factor)) {}
GlobalPhase::GlobalPhase(GlobalPhase&&) noexcept = default;
GlobalPhase& GlobalPhase::operator=(GlobalPhase&&) noexcept = default;
GlobalPhase::~GlobalPhase() = default;

Result<GlobalPhase> GlobalPhase::factor(const SymmetricMatrix& matrix, In<Index> order) {
  auto analysed = std::make_unique<Factor>();
  cholmod_sparse sparse = planish::view(matrix);
  std::vector<Index> whole = whole_order(order, matrix.size());
  analysed->factor = cholmod_analyze_p(&sparse, whole.data(), nullptr, 0, &analysed->cholmod.common);
  if (!analysed->factor) return out_of_memory("analysis");
  analysed->tree = SupernodeTree(analysed->view());
  GlobalPhase result(std::move(analysed));
  if (auto factored = result.refactor(matrix); !factored) return fail(factored.error());
  return result;
}

Result<void> GlobalPhase::refactor(const SymmetricMatrix& matrix) {
  cholmod_common& common = factor_->cholmod.common;
  cholmod_sparse sparse = planish::view(matrix);
  factor_->rounded = {};
  const OneBlasThread one_thread;
  cholmod_factorize(&sparse, factor_->factor, &common);
  if (common.status == CHOLMOD_OUT_OF_MEMORY) return out_of_memory("values");
  if (common.status == CHOLMOD_OK) return {};
  const Index pivot = static_cast<const Index*>(factor_->factor->Perm)[factor_->factor->minor];
  return fail(Error{.code = ErrorCode::FactorizationFailed,
                    .what = "the matrix is not positive definite",
                    .place = {},
                    .element = ElementKind::Vertex,
                    .ids = {pivot},
                    .count = 1});
}

void GlobalPhase::round_to_single(const Exec& exec) {
  const auto* value = static_cast<const double*>(factor_->factor->x);
  factor_->rounded.resize(factor_->factor->xsize);
  constexpr Index kPart = 1 << 20;
  const auto num_parts = static_cast<Index>((factor_->rounded.size() + kPart - 1) / kPart);
  exec.for_tasks(num_parts, [&](Index part) {
    const std::size_t begin = static_cast<std::size_t>(part) * kPart;
    const std::size_t end = std::min(begin + kPart, factor_->rounded.size());
    for (std::size_t k = begin; k < end; ++k) factor_->rounded[k] = static_cast<float>(value[k]);
  });
}

bool GlobalPhase::is_rounded() const { return !factor_->rounded.empty(); }

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

Offset GlobalPhase::factor_nonzeros() const { return static_cast<Offset>(factor_->factor->xsize); }

}  // namespace planish
