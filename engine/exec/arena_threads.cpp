// Exec on plain threads, started for every loop. For the thread sanitizer, which follows what they hand to one another; in the
// distribution's TBB, which is not instrumented, it sees none of that and takes everything for a race.
#include <atomic>
#include <exception>
#include <thread>

#include "engine/exec/parallel.hpp"

namespace planish {

struct Exec::Arena {
  explicit Arena(int wanted)
      : threads(wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        idle(threads - 1) {}

  /// Takes up to so many idle threads; loops inside loops get what is left.
  int claim(int wanted) {
    int free = idle;
    while (!idle.compare_exchange_weak(free, free - std::min(free, wanted))) {
    }
    return std::min(free, wanted);
  }

  /// Calls work() on the calling thread and on so many others; the first exception goes to the caller.
  void run_on(int others, const std::function<void()>& work) {
    std::exception_ptr failure;
    std::atomic<bool> failed = false;
    const auto guarded = [&] {
      try {
        work();
      } catch (...) {
        if (!failed.exchange(true)) failure = std::current_exception();
      }
    };
    std::vector<std::thread> helpers;
    for (int k = 0; k < others; ++k) helpers.emplace_back(guarded);
    guarded();
    for (std::thread& helper : helpers) helper.join();
    idle += others;
    if (failure) std::rethrow_exception(failure);
  }

  const int threads;
  std::atomic<int> idle;
};

Exec::Exec(int threads) : arena_(std::make_unique<Arena>(threads)) {}
Exec::~Exec() = default;

int Exec::threads() const { return arena_->threads; }

void Exec::run(Index count, const std::function<void(Index)>& body) const {
  if (count <= 0) return;
  std::atomic<Index> next = 0;
  arena_->run_on(arena_->claim(count - 1), [&] {
    for (Index i = next++; i < count; i = next++) body(i);
  });
}

void Exec::both(const std::function<void()>& a, const std::function<void()>& b) const {
  std::atomic<int> next = 0;
  arena_->run_on(arena_->claim(1), [&] {
    for (int i = next++; i < 2; i = next++) (i == 0 ? a : b)();
  });
}

}  // namespace planish
