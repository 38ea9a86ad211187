#include "app/interrupt.hpp"

#include <semaphore.h>
#include <signal.h>
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

}  // namespace

void watch_interrupts() {
  sem_init(&received, 0, 0);
  std::thread([] {
    while (sem_wait(&received) != 0) {
    }
    stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    abandon_writes();
    _exit(130);
  }).detach();
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() { return stop; }

}  // namespace planish
