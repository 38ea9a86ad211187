// Flips removed by the program: the options, the report, and what is said where some remain.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"

using namespace planish::tests;
using nlohmann::json;

namespace {

/// A plate with a long finger, far from any plane: its ARAP minimum turns triangles over.
std::string finger_obj() {
  constexpr int kSpokes = 24;
  std::vector<std::array<double, 2>> ring = {{0.1, 1.5}};  // radius and height, from the tip
  for (int k = 0; k <= 12; ++k) ring.push_back({0.2, 1.4 * (12 - k) / 12});
  for (int k = 1; k <= 8; ++k) ring.push_back({0.2 + 0.1 * k, 0});
  const auto kRings = static_cast<int>(ring.size());
  std::string text = "v 0 0 1.5\n", faces;
  for (const auto& [radius, height] : ring) {
    for (int k = 0; k < kSpokes; ++k) {
      const double turn = 2 * 3.14159265358979 * k / kSpokes;
      text += "v " + std::to_string(radius * std::cos(turn)) + " " + std::to_string(radius * std::sin(turn)) +
              " " + std::to_string(height) + "\n";
    }
  }
  const auto at = [&](int r, int k) {
    return std::to_string(r == 0 ? 1 : 2 + (r - 1) * kSpokes + k % kSpokes);
  };
  for (int k = 0; k < kSpokes; ++k) faces += "f 1 " + at(1, k) + " " + at(1, k + 1) + "\n";
  for (int r = 1; r < kRings; ++r) {
    for (int k = 0; k < kSpokes; ++k) {
      faces += "f " + at(r, k) + " " + at(r + 1, k) + " " + at(r + 1, k + 1) + "\n";
      faces += "f " + at(r, k) + " " + at(r + 1, k + 1) + " " + at(r, k + 1) + "\n";
    }
  }
  return text + faces;
}

struct Finger {
  Scratch scratch;
  Finger() { write(scratch.file("finger.obj"), finger_obj()); }
  Ran flatten(const std::string& options) const {
    return run("flatten " + scratch.file("finger.obj") + " -o " + scratch.file("o.ply") + " --report " +
               scratch.file("r.json") + " " + options);
  }
  json report() const { return json::parse(content_of(scratch.file("r.json"))); }
};

}  // namespace

TEST_CASE("flips: a finger has some where they are kept, and none by default") {
  const Finger finger;
  const Ran kept = finger.flatten("--flips keep");
  REQUIRE(kept.code == 6);
  CHECK(kept.err.find("triangles are flipped (") != std::string::npos);
  const json with_flips = finger.report();
  CHECK(with_flips.at("flipped_triangles").get<int>() > 0);
  CHECK(with_flips.at("flips") == json({{"method", "keep"}}));
  const Ran ran = finger.flatten("");
  CHECK(ran.code == 0);
  const json report = finger.report();
  CHECK(report.at("flipped_triangles") == 0);
  CHECK(report.at("overwound_vertices") == 0);
  CHECK(report.at("converged") == true);
  const json& flips = report.at("flips");
  CHECK(flips.at("method") == "untangle");
  CHECK(flips.at("flipped_before") == 0);  // its first map has none: no step is kept that would flip one
  CHECK(flips.at("newton_steps").get<int>() > 0);
  CHECK(flips.at("newton_steps").get<int>() <
        6);  // patches leave the whole little to do: 7 where they end at 1e-4
  CHECK(flips.at("barrier").at("delta") == 0.2);
  CHECK(flips.at("energy").get<double>() >= report.at("energy").at("arap").get<double>());
  CHECK(run("verify " + finger.scratch.file("o.ply")).code == 0);
}

TEST_CASE("flips: energies never rise on the way down to the minimum") {
  const Finger finger;
  for (const char* energy : {"arap", "symmetric-dirichlet"}) {
    REQUIRE(finger.flatten(std::string("--energy ") + energy).code == 0);
    const json report = finger.report();
    double before = 0;
    int polished = 0;
    for (const json& step : report.at("history")) {
      if (step.at("phase") != "polish") continue;
      const double now = step.at("energy").get<double>();
      if (polished++ > 0) CHECK(now <= before * (1 + 1e-12));
      before = now;
    }
    CHECK(polished > 1);
    CHECK(report.at("gradient").get<double>() <= 1e-6);
  }
}

TEST_CASE("flips: symmetric Dirichlet has the lower minimum of its own energy, ARAP of its own") {
  const Finger finger;
  REQUIRE(finger.flatten("").code == 0);
  const json arap = finger.report().at("energy");
  REQUIRE(finger.flatten("--energy symmetric-dirichlet").code == 0);
  const json report = finger.report(), dirichlet = report.at("energy");
  CHECK(dirichlet.at("symmetric_dirichlet").get<double>() < arap.at("symmetric_dirichlet").get<double>());
  CHECK(dirichlet.at("arap").get<double>() > arap.at("arap").get<double>());
  CHECK(report.at("flips").at("energy").get<double>() ==
        doctest::Approx(dirichlet.at("symmetric_dirichlet").get<double>()).epsilon(1e-9));
  CHECK(!report.at("flips").contains("barrier"));
}

TEST_CASE("flips: any number of threads gives the same file") {
  const Finger finger;
  std::string first;
  for (const char* threads : {"1", "2", "7"}) {
    REQUIRE(finger.flatten(std::string("--threads ") + threads).code == 0);
    const std::string file = content_of(finger.scratch.file("o.ply"));
    if (first.empty()) first = file;
    CHECK(file == first);
  }
}

TEST_CASE("flips: the published procedures run, and say what they were") {
  const Finger finger;
  for (const char* method : {"weights", "stiffening"}) {
    const Ran ran = finger.flatten(std::string("--flips ") + method + " --max-iterations 30");
    const json report = finger.report();
    CHECK(ran.code == (report.at("flipped_triangles") == 0 ? 0 : 6));
    CHECK(report.at("flips") == json({{"method", method}}));
  }
}

TEST_CASE("flips: methods and energies that do not exist, or do not go together, are refused") {
  const Finger finger;
  CHECK(finger.flatten("--flips iron").code == 2);
  CHECK(finger.flatten("--energy arp").code == 2);
  for (const char* contradiction : {"--energy symmetric-dirichlet --flips keep",
                                    "--energy symmetric-dirichlet --paper", "--paper --flips stiffening"}) {
    CHECK(finger.flatten(contradiction).code == 2);
    CHECK(!std::filesystem::exists(finger.scratch.file("o.ply")));
  }
}

TEST_CASE("flips: where constraints leave no map without them, those are named that make the difference") {
  // A flat grid whose rim is pinned where it lies, and one inner vertex outside of it.
  constexpr int kSide = 7;
  const Scratch scratch;
  std::string mesh;
  json rim = json::array(), places = json::array();
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      mesh += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
      if (x > 0 && y > 0 && x + 1 < kSide && y + 1 < kSide) continue;
      rim.push_back(y * kSide + x);
      places.push_back({x, y});
    }
  }
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const int a = y * kSide + x + 1, b = a + kSide;
      mesh += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) + "\n";
      mesh += "f " + std::to_string(a) + " " + std::to_string(b + 1) + " " + std::to_string(b) + "\n";
    }
  }
  write(scratch.file("grid.obj"), mesh);
  const json set = {{"version", 1},
                    {"constraints",
                     {{{"name", "rim"}, {"type", "pin"}, {"vertices", rim}, {"uv", places}},
                      {{"name", "stray"}, {"type", "pin"}, {"vertices", {24}}, {"uv", {{9, 9}}}},
                      {{"name", "calm"}, {"type", "pin"}, {"vertices", {25}}, {"uv", {{4, 3}}}}}}};
  write(scratch.file("c.json"), set.dump());
  const Ran ran = run("flatten " + scratch.file("grid.obj") + " -c " + scratch.file("c.json") + " -o " +
                      scratch.file("o.ply") + " --report " + scratch.file("r.json"));
  CHECK(ran.code == 6);
  CHECK(ran.err.find("triangles are flipped (") != std::string::npos);
  CHECK_MESSAGE(
      ran.err.find("there are none without \"rim\", or without \"stray\"; loosen it") != std::string::npos,
      ran.err);
  CHECK(ran.err.find("use a larger --tolerance") == std::string::npos);  // that would not help
  const json report = json::parse(content_of(scratch.file("r.json")));
  CHECK(report.at("flipped_triangles").get<int>() > 0);
  for (const json& c : report.at("constraints")) CHECK(c.at("residual").get<double>() < 1e-9);
}
