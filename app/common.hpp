// What the commands share: reading with repair, names of outputs, words on the terminal.
#pragma once

#include <chrono>
#include <initializer_list>
#include <string>
#include <vector>

#include "app/args.hpp"
#include "app/progress.hpp"
#include "engine/exec/parallel.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/repair.hpp"
#include "io/report_json.hpp"

namespace planish {

/// An output file: its path ("": none wanted) and the formats it may have (none: any name).
struct OutputFile {
  std::string path;
  std::initializer_list<const char*> formats;
};

/// Refuses output names and places before any work is done.
Result<void> check_outputs(std::initializer_list<OutputFile> files);

/// Makes a folder for outputs where there is none.   Fails: CannotWrite.
Result<void> make_folder(const std::string& path);

/// A mesh as read, mended where asked for, with what has to be said about it.
struct Input {
  Mesh mesh;
  Mesh original;  ///< before it was mended; empty where nothing was
  std::vector<Mending> mendings;
  std::vector<Index> triangle_origin;  ///< of the mended triangles in the original; empty where nothing was
};

/// Errors name the file.
Result<Input> read_input(const Exec& exec, const std::string& path, bool mend);

/// With the file named, where the engine could not know it.
Error in_file(Error error, const std::string& path);

/// What readers left out may be the parameterization that is missed.
Error no_parameterization(const Mesh& mesh);

void say_mendings(const std::vector<Mending>& mendings);
void say_warnings(const CommonArgs& common, const std::vector<std::string>& warnings);

ProgressStyle progress_style(const CommonArgs& common);

/// Shows progress and passes on the user's wish to stop.
Monitor monitor_of(ProgressLine& progress);

Offset peak_memory_bytes();

/// Largest resident size up to the end of each step, as steps follow one another.
class PeakByStep {
 public:
  void enter(Phase phase);
  /// With the present step, which goes on.
  std::vector<StepPeak> peaks() const;

 private:
  std::vector<StepPeak> past_;
  Phase present_ = Phase::Read;
};

/// "dir/part.obj" -> "part.obj".
std::string file_name(const std::string& path);

/// Seconds of steps, in the order they were taken.
class Stopwatch {
 public:
  /// Runs a step and notes its time.
  template <class Step>
  auto operator()(Phase phase, Step step) {
    const auto begin = Clock::now();
    auto result = step();
    times_.push_back({name(phase), std::chrono::duration<double>(Clock::now() - begin).count()});
    return result;
  }
  const std::vector<StepTime>& times() const { return times_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StepTime> times_;
};

}  // namespace planish
