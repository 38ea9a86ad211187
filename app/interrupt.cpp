#include "app/interrupt.hpp"

#include <semaphore.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "io/file.hpp"

namespace planish {
namespace {

std::atomic<bool> stop{false};
sem_t received;

/// Runs on whichever thread the system chose, also one that a library started before main.
void note(int) { sem_post(&received); }

void take_signals() {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// METIS takes SIGTERM for itself while it works, and leaves by a jump, out of the middle of malloc if need be, which then
/// never lets go of its lock. So the signals are taken back every few milliseconds.
void wait_for_signal() {
  constexpr long kMilliseconds = 5;
  while (true) {
    timespec until{};
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += kMilliseconds * 1'000'000;
    if (until.tv_nsec >= 1'000'000'000) ++until.tv_sec, until.tv_nsec -= 1'000'000'000;
    if (sem_timedwait(&received, &until) == 0) return;
    take_signals();
  }
}

}  // namespace

void watch_interrupts() {
  sem_init(&received, 0, 0);
  take_signals();
  std::thread([] {
    wait_for_signal();
    stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    abandon_writes();
    _exit(130);
  }).detach();
}

bool stop_requested() { return stop; }

}  // namespace planish
