// Prices, dry runs and the paper's variant of constrained flattening, through the program.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/app/constraint_support.hpp"

using namespace planish::tests;

namespace {

/// A sampled panel and the constraints that fit it.
struct Panel {
  explicit Panel(const std::string& kind) {
    const Ran made =
        run("sample " + kind + " --triangles 4000 --noise 0.0003 -o " + mesh + " --features " + constraints);
    REQUIRE(made.code == 0);
  }
  Ran flatten(const std::string& options) const {
    return run("flatten " + mesh + " -c " + constraints + " " + options);
  }

  Scratch scratch;
  std::string mesh = scratch.file("panel.ply"), constraints = scratch.file("c.json");
};

json report_of(const Panel& panel, const std::string& options) {
  const Scratch scratch;
  const Ran ran = panel.flatten(options + " --report " + scratch.file("r.json"));
  REQUIRE_MESSAGE(ran.code == 0, ran.err);
  return json::parse(content_of(scratch.file("r.json")));
}

double energy(const json& report) { return report.at("energy").at("arap"); }

double worst_residual(const json& report) {
  double worst = 0;
  for (const json& c : report.at("constraints")) worst = std::max(worst, c.at("residual").get<double>());
  return worst;
}

}  // namespace

TEST_CASE("constraint modes: prices are the energies of runs that leave constraints out") {
  const Panel panel("hood");
  const json report = report_of(panel, "--price"), &price = report.at("price");
  CHECK(price.at("energy") == report.at("energy").at("arap"));
  CHECK(price.at("unconstrained").get<double>() < price.at("energy").get<double>());
  CHECK(price.at("without_refit").get<double>() >= price.at("energy").get<double>() * (1 - 1e-9));

  const json all = json::parse(content_of(panel.constraints));
  REQUIRE(price.at("constraints").size() == all.at("constraints").size());
  for (std::size_t k = 0; k < all.at("constraints").size(); ++k) {
    json others = all;
    others["constraints"].erase(k);
    write(panel.scratch.file("others.json"), others.dump());
    Panel without("hood");
    without.constraints = panel.scratch.file("others.json");
    const double expected = energy(report_of(without, ""));
    const json& item = price.at("constraints")[k];
    CHECK(item.at("energy_without").get<double>() == doctest::Approx(expected).epsilon(1e-9));
    CHECK(item.at("cost").get<double>() == doctest::Approx(energy(report) - expected).epsilon(1e-6));
  }
}

TEST_CASE("constraint modes: without constraints there are no prices") {
  const Panel panel("fender");
  const Ran ran = run("flatten " + panel.mesh + " --price");
  CHECK(ran.code == 2);
  CHECK_MESSAGE(has(ran.err, "--constraints"), ran.err);
}

TEST_CASE("constraint modes: a dry run counts what is free, finds contradictions and writes nothing") {
  const Panel panel("hood");
  const Ran planned = panel.flatten("--dry-run");
  CHECK(planned.code == 0);
  CHECK_MESSAGE(has(planned.out, "no contradiction found"), planned.out);
  // Two creases and two crossing lines: four shapes; the crossing ones are one assembly and one cluster.
  CHECK_MESSAGE(has(planned.out, "4 features of prescribed shape in 3 assemblies"), planned.out);
  CHECK(panel.scratch.count() == 2);

  json twice = json::parse(content_of(panel.constraints));
  const std::string feature = twice.at("constraints")[0].at("feature");
  twice["constraints"].push_back({{"type", "circle"}, {"feature", feature}, {"sweep_degrees", 90}});
  write(panel.constraints, twice.dump());
  const Ran refused = panel.flatten("--dry-run");
  CHECK(refused.code == 5);
  CHECK_MESSAGE(has(refused.err, "cannot all hold"), refused.err);

  const Ran with_output = panel.flatten("--dry-run -o " + panel.scratch.file("o.ply"));
  CHECK(with_output.code == 2);
  CHECK_FALSE(std::filesystem::exists(panel.scratch.file("o.ply")));
}

TEST_CASE(
    "constraint modes: the paper's variant meets constraints, keeps directions and costs a little more") {
  const Panel panel("hood");
  const json ours = report_of(panel, ""), papers = report_of(panel, "--paper");
  CHECK(worst_residual(papers) < 1e-9);
  CHECK(papers.at("flipped_triangles") == 0);
  CHECK(papers.at("iterations") == 0);  // no triangle flips, so one global step is all
  CHECK(energy(papers) == doctest::Approx(ours.at("history")[0].at("energy").get<double>()).epsilon(1e-9));
  CHECK(energy(papers) > energy(ours));
}

TEST_CASE("constraint modes: weights turn flipped triangles back in the paper's variant") {
  // A line far longer than its panel flips triangles at its ends.
  const Panel panel("hood");
  json stretched = json::parse(content_of(panel.constraints));
  json& line = stretched["constraints"][2];
  REQUIRE(line.at("type") == "line");
  line["lengths"] = "scale";
  line["scale"] = 1.6;
  write(panel.constraints, stretched.dump());
  const Scratch scratch;
  REQUIRE(panel.flatten("--flips keep --report " + scratch.file("flips.json")).code == 6);
  const Ran weighed = panel.flatten("--paper --report " + scratch.file("r.json"));
  const json report = json::parse(content_of(scratch.file("r.json")));
  CHECK(report.at("iterations").get<int>() > 0);
  CHECK(weighed.code == 0);
  CHECK(report.at("flipped_triangles") == 0);
  CHECK(worst_residual(report) < 1e-9);
}
