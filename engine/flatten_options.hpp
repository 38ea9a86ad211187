// Which options of flatten go together.
#pragma once

#include "engine/model/error.hpp"
#include "engine/model/options.hpp"

namespace planish {

/// Fails: BadUsage, naming the option: values out of range; combinations without meaning; options of ARAP with a method that
/// has no use for them.
Result<void> check_options(const FlattenOptions& options);

/// Whether a method has a use for an option, called by its long name on the command line ("flips").
bool uses_option(Method method, const char* option);

}  // namespace planish
