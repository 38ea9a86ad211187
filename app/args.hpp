// The command line: what was asked for, as plain values.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "engine/cut.hpp"
#include "engine/model/comparison.hpp"
#include "engine/model/error.hpp"
#include "engine/model/options.hpp"
#include "engine/sample/panels.hpp"

namespace planish {

/// Options that every command knows.
struct CommonArgs {
  int threads = 0;
  bool progress = false;  ///< progress lines although stderr is not a terminal
  bool quiet = false;
  bool json_errors = false;
  std::string command_line;
};

struct FlattenArgs {
  std::string mesh, constraints, output, report, picture, flat;
  bool repair = false;
  bool price = false, dry_run = false;
  std::uint64_t memory_limit = 0;  ///< bytes, 0: none
  CutMode cut = CutMode::None;
  FlattenOptions options;
};

struct CompareArgs {
  std::string mesh, constraints, folder;
  std::vector<Contender> contenders;
  int width = 2400;               ///< of the sheet, pixels
  double time_limit = kInfinity;  ///< seconds a method
  bool repair = false;
  CutMode cut = CutMode::None;
};

struct DeformArgs {
  std::string mesh, constraints, output, report, picture, frames;
  bool repair = false;
  EditOptions edit;
  SolveOptions solve;
};

struct EmbedArgs {
  std::string mesh, constraints, output, report, picture;
  bool repair = false;
};

struct VerifyArgs {
  std::string mesh, constraints, report;
  bool json = false;
};

struct InfoArgs {
  std::string mesh;
  bool json = false;
  bool repair = false;
};

struct SampleArgs {
  SampleOptions options;
  std::string output, features;
};

/// Text for stdout and nothing else to do: --help, --version.
struct TextArgs {
  std::string text;
};

struct Args {
  CommonArgs common;
  std::variant<TextArgs, FlattenArgs, CompareArgs, DeformArgs, EmbedArgs, VerifyArgs, InfoArgs, SampleArgs>
      command;
};

/// Fails: BadUsage, with the nearest known name where a name is unknown.
Result<Args> parse_args(int argc, const char* const* argv);

}  // namespace planish
