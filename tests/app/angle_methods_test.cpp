// --method abf and yamabe through the program: what is written is measured by checks that know nothing of how it was made.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

/// The dome, flattened under constraints; files are in.obj, c.json, o.obj and r.json.
Ran flatten_dome(const Scratch& scratch, const std::string& method, const std::string& constraints) {
  write(scratch.file("in.obj"), dome());
  write(scratch.file("c.json"), file_of(kFeatures, constraints, ""));
  return run("flatten " + scratch.file("in.obj") + " -c " + scratch.file("c.json") + " --method " + method +
             " -o " + scratch.file("o.obj") + " --report " + scratch.file("r.json"));
}

constexpr const char* kFree = R"(, "lengths": "free")";

}  // namespace

TEST_CASE(
    "abf, yamabe: a dome between four straight sides at right angles is a rectangle in the written file") {
  for (const std::string method : {"abf", "yamabe"}) {
    const Scratch scratch;
    const Ran ran = flatten_dome(scratch, method, lines(kSideList, kFree) + ", " + right_angles(kSides));
    REQUIRE_MESSAGE(ran.code == 0, ran.err);
    const Ran own = verified(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
    CHECK_MESSAGE(own.code == 0, (own.out + own.err));
    const Ran other = checked(scratch.file("c.json"), scratch.file("o.obj"), scratch.file("r.json"));
    CHECK_MESSAGE(other.code == 0, other.out);
    const json report = json::parse(content_of(scratch.file("r.json")));
    CHECK(report.at("method") == method);
    for (const json& c : report.at("constraints")) CHECK(c.at("residual").get<double>() < 1e-9);
    const std::string fault = schema_fault("report.schema.json", scratch.file("r.json"));
    CHECK_MESSAGE((fault.empty() || fault == "absent"), fault);
  }
}

TEST_CASE("abf, yamabe: a shape that is more than angles is refused with exit 5, and nothing is written") {
  for (const std::string method : {"abf", "yamabe"}) {
    const Scratch scratch;
    const Ran ran = flatten_dome(scratch, method, R"({"type": "circle", "feature": "ring"})");
    CHECK(ran.code == 5);
    CHECK_MESSAGE(has(ran.err, "method " + method + " cannot express"), ran.err);
    CHECK(scratch.count() == 2);
  }
  const Scratch scratch;
  const Ran inside = flatten_dome(scratch, "yamabe", lines({"row"}, kFree));
  CHECK(inside.code == 5);
  CHECK_MESSAGE(has(inside.err, "outer boundary"), inside.err);
}

TEST_CASE(
    "abf: lines that keep their lengths elsewhere are straight here, and the report says what was let go") {
  const Scratch scratch;
  const Ran ran = flatten_dome(scratch, "abf", lines({"row", "up"}));
  REQUIRE_MESSAGE(ran.code == 0, ran.err);
  const json report = json::parse(content_of(scratch.file("r.json")));
  CHECK(report.at("up_to_scale") == json::array({"line row", "line up"}));
}
