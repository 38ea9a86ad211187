// Ctrl-C: a wish to stop that the solver sees between iterations, and an end within a second where it cannot.
#pragma once

namespace planish {

/// Call once, before any thread is started: SIGINT and SIGTERM then set stop_requested(); when the program
/// has not ended 0.7 s later, unfinished output is removed and the process exits with 130.
void watch_interrupts();

bool stop_requested();

}  // namespace planish
