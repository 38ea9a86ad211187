#include "app/method_args.hpp"

#include <CLI/CLI.hpp>

#include "engine/flatten_options.hpp"

namespace planish {

const std::vector<Method>& all_methods() {
  static const std::vector<Method> kAll = {Method::Arap, Method::Lscm,   Method::Dncp,  Method::Spectral,
                                           Method::Abf,  Method::Yamabe, Method::Deform};
  return kAll;
}

std::string method_names() {
  std::string names;
  for (const Method method : all_methods()) {
    if (!names.empty()) names += method == all_methods().back() ? " or " : ", ";
    names += name(method);
  }
  return names;
}

Result<Method> method_of(const std::string& word) {
  for (const Method method : all_methods()) {
    if (word == name(method)) return method;
  }
  return fail(ErrorCode::BadUsage, "there is no method \"" + word + "\": " + method_names());
}

Result<Contender> contender_of(const std::string& word) {
  const Contender without{Method::Arap, false};
  if (word == name(without)) return without;
  return method_of(word).map([](Method method) { return Contender{method, true}; });
}

void add_method(CLI::App& app, Method& method) {
  std::map<std::string, Method> methods;
  for (const Method m : all_methods()) methods.emplace(name(m), m);
  app.add_option("--method", method, method_names() + " [arap]")
      ->transform(CLI::CheckedTransformer(methods).description(""));
}

Result<void> check_method_options(const CLI::App& app, Method method) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& word : option->get_lnames()) {
      if (option->count() == 0 || uses_option(method, word.c_str())) continue;
      return fail(ErrorCode::BadUsage,
                  "--" + word + " has no meaning with --method " + name(method) + ": leave it out");
    }
  }
  return {};
}

}  // namespace planish
