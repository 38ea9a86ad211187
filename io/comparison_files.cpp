#include "io/comparison_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/benchmark_names.hpp"

namespace planish {
namespace {

using Json = nlohmann::ordered_json;

Json row_json(const ComparedMethod& row) {
  const Certificate& c = row.flattening.certificate;
  const auto number = [&](double x) { return row.has_map() && std::isfinite(x) ? Json(x) : Json(nullptr); };
  const auto count = [&](Offset n) { return row.has_map() ? Json(n) : Json(nullptr); };
  Json benchmark(nullptr);
  if (row.has_map()) {
    for (const auto& [figure, value] : named_figures(c.benchmark)) benchmark[figure] = number(value);
  }
  return {{"method", name(row.contender)},
          {"supported", row.supported},
          {"reason", row.reason},
          {"arap", number(c.arap)},
          {"symmetric_dirichlet", number(c.symmetric_dirichlet)},
          {"conformal", number(row.conformal)},
          {"s1_max", number(c.sigma_max.max)},
          {"s2_min", number(c.sigma_min.min)},
          {"flipped_triangles", count(c.flipped_triangles)},
          {"overwound_vertices", count(c.overwound_vertices)},
          {"overlapping_pairs", count(c.overlapping_pairs)},
          {"worst_residual", row.worst_residual ? number(*row.worst_residual) : Json(nullptr)},
          {"benchmark", benchmark},
          {"up_to_scale", row.flattening.up_to_scale},
          {"seconds", row.seconds}};
}

std::string short_number(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "infinite"; }

/// Bars would end the cell.
std::string in_cell(std::string words) {
  for (std::size_t i = 0; (i = words.find('|', i)) != std::string::npos; i += 2) words.insert(i, "\\");
  std::replace(words.begin(), words.end(), '\n', ' ');
  return words;
}

const char* constraints_word(const ComparedMethod& row) {
  if (!row.contender.constrained) return "none";
  return row.flattening.up_to_scale.empty() ? "yes" : "up to scale";
}

std::string table_row(const ComparedMethod& row) {
  if (!row.has_map())
    return fmt::format("| {} | {} | | | | | | | | | | {:.2f} |\n", name(row.contender),
                       row.supported ? "failed" : "not supported", row.seconds);
  const Certificate& c = row.flattening.certificate;
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2f} |\n",
                     name(row.contender), constraints_word(row), short_number(c.arap),
                     short_number(c.symmetric_dirichlet), short_number(row.conformal),
                     short_number(c.sigma_max.max), short_number(c.sigma_min.min), c.flipped_triangles,
                     c.overwound_vertices, c.overlapping_pairs,
                     row.worst_residual ? fmt::format("{:.1e}", *row.worst_residual) : "", row.seconds);
}

}  // namespace

std::string comparison_json(const std::vector<ComparedMethod>& rows, const ComparisonContext& context) {
  Json json = {{"version", 1},
               {"planish", PLANISH_VERSION},
               {"command", context.command},
               {"mesh", context.mesh},
               {"constraint_file", context.constraints.empty() ? Json(nullptr) : Json(context.constraints)},
               {"rows", Json::array()}};
  for (const ComparedMethod& row : rows) json["rows"].push_back(row_json(row));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string comparison_table(const std::vector<ComparedMethod>& rows, const ComparisonContext& context) {
  std::string text =
      fmt::format("# {}{}{}\n\n", context.mesh, context.constraints.empty() ? "" : ", ", context.constraints);
  text +=
      "| method | constraints | arap | symmetric Dirichlet | conformal | s1 max | s2 min | flipped | "
      "overwound "
      "| overlapping | worst residual | seconds |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const ComparedMethod& row : rows) text += table_row(row);
  for (const ComparedMethod& row : rows) {
    if (!row.has_map()) text += fmt::format("\n{}: {}\n", name(row.contender), in_cell(row.reason));
  }
  return text;
}

std::vector<std::string> model_caption(Index triangles) {
  return {"model", fmt::format("{} triangle{}", triangles, triangles == 1 ? "" : "s"),
          "maps lie as it is seen"};
}

std::vector<std::string> comparison_caption(const ComparedMethod& row) {
  const Certificate& c = row.flattening.certificate;
  return {name(row.contender), fmt::format("arap {:.3g}, conformal {:.3g}", c.arap, row.conformal),
          fmt::format("stretch {:.3g} \u2026 {:.3g}", c.sigma_min.min, c.sigma_max.max),
          fmt::format("flipped {}, overwound {}", c.flipped_triangles, c.overwound_vertices),
          fmt::format("overlapping {}", c.overlapping_pairs)};
}

}  // namespace planish
