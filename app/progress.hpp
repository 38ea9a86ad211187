// One line on stderr that says where the work is.
#pragma once

#include <chrono>

#include "engine/model/monitor.hpp"

namespace planish {

enum class ProgressStyle { None, OneLine, Lines };

/// One line that is rewritten on a terminal, lines where asked for, nothing else.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressStyle style) : style_(style) {}
  ~ProgressLine() { finish(); }
  void show(const Progress& progress);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  ProgressStyle style_;
  Clock::time_point begin_ = Clock::now(), last_{};
  bool open_ = false;
};

}  // namespace planish
