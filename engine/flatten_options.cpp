#include "engine/flatten_options.hpp"

#include <array>
#include <string_view>

namespace planish {
namespace {

/// Options that are ARAP's, and whether the deformation of an ARAP map has a use for them too.
struct OptionOfArap {
  const char* name;
  bool of_deform;
  bool (*changed)(const FlattenOptions&);
};
const FlattenOptions kDefault;
constexpr std::array kOptions = {
    OptionOfArap{"init", true, [](const FlattenOptions& o) { return o.init != kDefault.init; }},
    OptionOfArap{"energy", true, [](const FlattenOptions& o) { return o.energy != kDefault.energy; }},
    OptionOfArap{"flips", true, [](const FlattenOptions& o) { return o.flips != kDefault.flips; }},
    OptionOfArap{"overlaps", false, [](const FlattenOptions& o) { return o.overlaps != kDefault.overlaps; }},
    OptionOfArap{"tolerance", true,
                 [](const FlattenOptions& o) { return o.tolerance != kDefault.tolerance; }},
    OptionOfArap{"max-iterations", true,
                 [](const FlattenOptions& o) { return o.max_iterations != kDefault.max_iterations; }},
    OptionOfArap{"paper", false, [](const FlattenOptions& o) { return o.paper; }},
    OptionOfArap{"keep-directions", false, [](const FlattenOptions& o) { return o.keep_directions; }},
    OptionOfArap{"price", false, [](const FlattenOptions&) { return false; }},
};

}  // namespace

bool uses_option(Method method, const char* option) {
  if (method == Method::Arap) return true;
  for (const OptionOfArap& o : kOptions) {
    if (std::string_view(o.name) == option) return method == Method::Deform && o.of_deform;
  }
  return true;
}

Result<void> check_options(const FlattenOptions& options) {
  if (!(options.tolerance > 0)) return fail(ErrorCode::BadUsage, "tolerance must be above 0");
  if (options.max_iterations < 0) return fail(ErrorCode::BadUsage, "max_iterations must not be negative");
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  if (options.memory_limit < 0) return fail(ErrorCode::BadUsage, "memory_limit must not be negative");
  if (options.memory_limit > 0 && options.method == Method::Deform)
    return fail(ErrorCode::BadUsage, "the method deform has no limit of memory: leave it out");
  for (const OptionOfArap& o : kOptions) {
    if (o.changed(options) && !uses_option(options.method, o.name))
      return fail(ErrorCode::BadUsage, std::string("the option ") + o.name +
                                           " has no meaning for the method " + name(options.method) +
                                           ": leave it out");
  }
  if (options.energy == Energy::SymmetricDirichlet && (options.paper || options.flips != Flips::Untangle))
    return fail(
        ErrorCode::BadUsage,
        "symmetric-dirichlet is infinite where triangles are flipped: it needs flips to be untangled");
  if (options.paper && (options.flips == Flips::Keep || options.flips == Flips::Stiffening))
    return fail(ErrorCode::BadUsage, "the paper's variant has its own procedure against flips, weights");
  if (options.overlaps == Overlapping::Remove && (options.paper || options.flips != Flips::Untangle))
    return fail(ErrorCode::BadUsage,
                "overlaps are removed from maps without flips: that needs flips to be untangled");
  return {};
}

}  // namespace planish
