// A comparison of methods as JSON (docs/compare.schema.json) and as a table for people.
#pragma once

#include <string>
#include <vector>

#include "engine/model/comparison.hpp"

namespace planish {

/// Beside the rows, what the program knows.
struct ComparisonContext {
  std::string mesh, constraints;  ///< paths as given; constraints may be ""
  std::string command;
};

/// Numbers read back bit for bit; those of methods without a map, and infinite ones, are null.
std::string comparison_json(const std::vector<ComparedMethod>& rows, const ComparisonContext& context);

/// GitHub's Markdown: a table, and below it why methods have no map and which kept shapes but not sizes.
std::string comparison_table(const std::vector<ComparedMethod>& rows, const ComparisonContext& context);

/// What stands above the model on the sheet.
std::vector<std::string> model_caption(Index triangles);

/// What stands above a map on the sheet.
std::vector<std::string> comparison_caption(const ComparedMethod& row);

}  // namespace planish
