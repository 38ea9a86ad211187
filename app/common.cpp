#include "app/common.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "app/interrupt.hpp"
#include "io/file.hpp"
#include "io/mesh_files.hpp"

namespace planish {
namespace {

Result<void> check_format(const OutputFile& file) {
  if (file.formats.size() == 0) return {};
  const std::string format = format_of(file.path);
  std::string known;
  for (const char* f : file.formats) {
    if (format == f) return {};
    known += (known.empty() ? "." : " or .") + std::string(f);
  }
  return fail(ErrorCode::BadUsage, file.path + " cannot be written: its name must end in " + known);
}

}  // namespace

Result<void> check_outputs(std::initializer_list<OutputFile> files) {
  for (const OutputFile& file : files) {
    if (file.path.empty()) continue;
    if (auto known = check_format(file); !known) return known;
  }
  for (const OutputFile& file : files) {
    if (file.path.empty()) continue;
    if (auto writable = check_writable(file.path); !writable) return writable;
  }
  return {};
}

Result<void> make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (std::filesystem::is_directory(path)) return {};
  return fail(ErrorCode::CannotWrite, path + " is no folder, and none can be made: " + error.message());
}

Result<Input> read_input(const Exec& exec, const std::string& path, bool mend) {
  auto mesh = read_mesh(exec, path);
  if (!mesh) return fail(in_file(mesh.error(), path));
  Input input;
  if (!mend) {
    input.mesh = std::move(*mesh);
    return input;
  }
  auto repaired = repair(*mesh);
  if (!repaired) return fail(in_file(repaired.error(), path));
  if (!repaired->mendings.empty()) {
    input.triangle_origin = std::move(repaired->triangle_origin);
    input.original = std::move(*mesh);
  }
  input.mendings = std::move(repaired->mendings);
  input.mesh = std::move(repaired->mesh);
  return input;
}

Error in_file(Error error, const std::string& path) {
  if (error.place.file.empty()) error.place.file = path;
  return error;
}

Error no_parameterization(const Mesh& mesh) {
  Error error{.code = ErrorCode::NoParameterization, .what = "the mesh has no uv"};
  for (const std::string& warning : mesh.warnings) error.also += (error.also.empty() ? "" : ", ") + warning;
  return error;
}

void say_mendings(const std::vector<Mending>& mendings) {
  for (const Mending& mending : mendings) fmt::print("repaired: {} {}\n", mending.count, mending.what);
}

void say_warnings(const CommonArgs& common, const std::vector<std::string>& warnings) {
  if (common.quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "planish: warning: {}\n", warning);
}

ProgressStyle progress_style(const CommonArgs& common) {
  if (common.quiet) return ProgressStyle::None;
  if (common.progress) return ProgressStyle::Lines;
  return isatty(STDERR_FILENO) ? ProgressStyle::OneLine : ProgressStyle::None;
}

Monitor monitor_of(ProgressLine& progress) {
  return [&progress](const Progress& state) {
    progress.show(state);
    return stop_requested() ? Verdict::Stop : Verdict::Continue;
  };
}

Offset peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<Offset>(usage.ru_maxrss) * 1024;
}

void PeakByStep::enter(Phase phase) {
  if (phase != present_) past_ = peaks();
  present_ = phase;
}

std::vector<StepPeak> PeakByStep::peaks() const {
  std::vector<StepPeak> all = past_;
  const StepPeak now{name(present_), peak_memory_bytes()};
  const auto known =
      std::find_if(all.begin(), all.end(), [&](const StepPeak& p) { return p.step == now.step; });
  if (known == all.end()) {
    all.push_back(now);
  } else {
    known->bytes = now.bytes;  // a step taken again
  }
  return all;
}

std::string file_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

}  // namespace planish
