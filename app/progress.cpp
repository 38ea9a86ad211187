#include "app/progress.hpp"

#include <fmt/core.h>

#include <cstdio>

namespace planish {

void ProgressLine::show(const Progress& progress) {
  if (style_ == ProgressStyle::None) return;
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const bool one_line = style_ == ProgressStyle::OneLine;
  const char *begin = one_line ? "\r\033[K" : "", *end = one_line ? "" : "\n";
  if (progress.energy == 0 && progress.iteration == 0) {
    fmt::print(stderr, "{}{} ({:.1f} s){}", begin, name(progress.phase), seconds, end);
  } else {
    if (one_line && now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    fmt::print(stderr, "{}{} iteration {}, energy {:.6e}, gradient {:.1e} ({:.1f} s){}", begin,
               name(progress.phase), progress.iteration, progress.energy, progress.gradient, seconds, end);
  }
  open_ = one_line;
  std::fflush(stderr);
}

void ProgressLine::finish() {
  if (open_) fmt::print(stderr, "\r\033[K");
  open_ = false;
}

}  // namespace planish
