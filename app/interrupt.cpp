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

void wait_for_signal() {
  while (sem_wait(&received) != 0) {  // a debugger or a stop and go on interrupts it too
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
