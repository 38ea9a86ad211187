// The values of a report, by their keys.
#pragma once

#include "io/json_reader.hpp"
#include "io/report_read.hpp"

namespace planish {

/// Faults go to the reader; after one, values are defaults.
struct ReportReader {
  JsonReader& reader;
  MeshSize mesh;

  std::optional<JsonValue> object(const JsonValue& parent, std::string_view key);
  std::optional<JsonValue> array(const JsonValue& parent, std::string_view key);
  /// A number that must be there; null stands for infinity.
  double number(const JsonValue& parent, std::string_view key);
  /// A number that may be null or absent.
  std::optional<double> maybe_number(const JsonValue& parent, std::string_view key);
  Index count(const JsonValue& parent, std::string_view key);
  Spread spread(const JsonValue& parent, std::string_view key);
  /// Ids that the mesh has.
  std::vector<Index> vertices(const JsonValue& parent, std::string_view key);
  std::vector<Index> triangles(const JsonValue& parent, std::string_view key);

  std::vector<Feature> features(const JsonValue& features);
  std::vector<ConstraintOutcome> constraints(const JsonValue& entries);

 private:
  Index id(const JsonValue& value, Index limit, const char* what);
  std::vector<Index> ids(const JsonValue& parent, std::string_view key, Index limit, const char* what);
  std::array<Index, 2> edge(const JsonValue& value);
  Feature feature(const std::string& name, const JsonValue& value);
  ConstraintOutcome entry(const JsonValue& value);
  void read_subject(const JsonValue& value, ConstraintOutcome& outcome);
  void read_shape(const JsonValue& value, ConstraintOutcome& outcome);
};

}  // namespace planish
