#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <optional>

#include "engine/exec/parallel.hpp"

namespace planish {

struct Exec::Arena {
  explicit Arena(int threads) {
    if (threads <= 0) return;
    // Asking for more threads than the process allows (a determinism test, say) lifts the limit for our
    // lifetime.
    const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    if (static_cast<std::size_t>(threads) > allowed) {
      limit.emplace(tbb::global_control::max_allowed_parallelism, threads);
    }
    own.emplace(threads);
  }
  std::optional<tbb::global_control> limit;
  mutable std::optional<tbb::task_arena> own;
};

Exec::Exec(int threads) : arena_(std::make_unique<Arena>(threads)) {}
Exec::~Exec() = default;

int Exec::threads() const {
  return arena_->own ? arena_->own->max_concurrency() : tbb::this_task_arena::max_concurrency();
}

void Exec::run(Index count, const std::function<void(Index)>& body) const {
  if (count <= 0) return;
  if (count == 1) return body(0);
  const auto loop = [&] {
    tbb::parallel_for(tbb::blocked_range<Index>(0, count, 1), [&](const tbb::blocked_range<Index>& r) {
      for (Index i = r.begin(); i != r.end(); ++i) body(i);
    });
  };
  if (arena_->own) {
    arena_->own->execute(loop);
  } else {
    loop();
  }
}

void Exec::both(const std::function<void()>& a, const std::function<void()>& b) const {
  const auto pair = [&] { tbb::parallel_invoke(a, b); };
  if (arena_->own) {
    arena_->own->execute(pair);
  } else {
    pair();
  }
}

}  // namespace planish
