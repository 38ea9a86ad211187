#include "app/interrupt.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "io/file.hpp"

namespace planish {
namespace {

std::atomic<bool> stop{false};

}  // namespace

void watch_interrupts() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals,
                  nullptr);  // inherited by every later thread: the watcher alone receives them
  std::thread([signals] {
    int received = 0;
    sigwait(&signals, &received);
    stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    abandon_writes();
    _exit(130);
  }).detach();
}

bool stop_requested() { return stop; }

}  // namespace planish
