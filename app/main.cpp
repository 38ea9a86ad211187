// planish: args -> calls -> exit code.
#include <fmt/core.h>

#include <exception>
#include <string_view>

#include "app/args.hpp"
#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "io/report_json.hpp"

namespace planish {
namespace {

Result<int> run(const Args& args) {
  if (const auto* text = std::get_if<TextArgs>(&args.command)) {
    fmt::print("{}", text->text);
    return 0;
  }
  watch_interrupts();
  if (const auto* flatten = std::get_if<FlattenArgs>(&args.command))
    return run_flatten(args.common, *flatten);
  if (const auto* info = std::get_if<InfoArgs>(&args.command)) return run_info(args.common, *info);
  return run_sample(args.common, std::get<SampleArgs>(args.command));
}

int program(int argc, char** argv) {
  bool json_errors = false;  // also for errors of the command line itself
  for (int i = 1; i < argc; ++i) json_errors |= std::string_view(argv[i]) == "--json-errors";
  const auto code = parse_args(argc, argv).and_then(run);
  if (code) return *code;
  if (json_errors) {
    fmt::print(stderr, "{}\n", error_json(code.error()));
  } else {
    fmt::print(stderr, "planish: {}\n", describe(code.error()));
  }
  return exit_code(code.error().code);
}

}  // namespace
}  // namespace planish

int main(int argc, char** argv) {
  try {
    return planish::program(argc, argv);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "planish: not enough memory [{}]\n", planish::name(planish::ErrorCode::OutOfMemory));
    return planish::exit_code(planish::ErrorCode::OutOfMemory);
  } catch (const std::exception& defect) {
    fmt::print(stderr, "planish: {}; {} [internal-defect]\n", defect.what(),
               planish::remedy(planish::ErrorCode::InternalDefect));
    return 1;
  }
}
