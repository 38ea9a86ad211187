// The option --method, and which other options have a meaning beside it.
#pragma once

#include <string>
#include <vector>

#include "engine/model/comparison.hpp"
#include "engine/model/error.hpp"
#include "engine/model/options.hpp"

namespace CLI {
class App;
}

namespace planish {

/// All methods, in the order they are listed.
const std::vector<Method>& all_methods();

/// "arap, lscm, ... or deform".
std::string method_names();

/// The method of a name.   Fails: BadUsage, listing the names.
Result<Method> method_of(const std::string& word);

/// A method of compare: as above, or "unconstrained".
Result<Contender> contender_of(const std::string& word);

void add_method(CLI::App& app, Method& method);

/// Fails: BadUsage where an option was given that the method has no use for.   Pre: parsed.
Result<void> check_method_options(const CLI::App& app, Method method);

}  // namespace planish
