// RapidCheck inside doctest: the same cases in every run, the smallest counterexample in the message.
#pragma once

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <sstream>
#include <string>

namespace planish {

/// Runs a property `cases` times from a fixed seed; RC_PARAMS in the environment takes the place of both.
template <class Testable>
void check_property(int cases, Testable property) {
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  if (std::getenv("RC_PARAMS") == nullptr) {
    params.seed = 20240607;
    params.maxSuccess = cases;
  }
  params.maxDiscardRatio = 20;
  const auto result = rc::detail::checkTestable(property, rc::detail::TestMetadata{}, params);
  if (result.template is<rc::detail::SuccessResult>()) {
    std::ostringstream distribution;
    rc::detail::printResultMessage(result, distribution);
    MESSAGE(distribution.str());
    return;
  }
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  FAIL_CHECK(message.str());
}

}  // namespace planish
