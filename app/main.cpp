// planish: args -> calls -> exit code.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <new>
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
  if (const auto* compare = std::get_if<CompareArgs>(&args.command))
    return run_compare(args.common, *compare);
  if (const auto* deform = std::get_if<DeformArgs>(&args.command)) return run_deform(args.common, *deform);
  if (const auto* embed = std::get_if<EmbedArgs>(&args.command)) return run_embed(args.common, *embed);
  if (const auto* verify = std::get_if<VerifyArgs>(&args.command)) return run_verify(args.common, *verify);
  if (const auto* info = std::get_if<InfoArgs>(&args.command)) return run_info(args.common, *info);
  return run_sample(args.common, std::get<SampleArgs>(args.command));
}

/// The one place where exceptions, of other libraries or of a defect, become errors.
Result<int> run_guarded(int argc, char** argv) {
  try {
    auto code = parse_args(argc, argv).and_then(run);
    if (code && (std::fflush(stdout) != 0 || std::ferror(stdout))) {
      return fail(ErrorCode::CannotWrite, "standard output cannot be written");
    }
    return code;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "not enough memory");
  } catch (const std::exception& defect) {
    return fail(ErrorCode::InternalDefect, defect.what());
  }
}

int program(int argc, char** argv) {
  bool json_errors = false;  // also for errors of the command line itself
  for (int i = 1; i < argc; ++i) json_errors |= std::string_view(argv[i]) == "--json-errors";
  const auto code = run_guarded(argc, argv);
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

int main(int argc, char** argv) { return planish::program(argc, argv); }
