#include "io/report_read_parts.hpp"

namespace planish {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes = {
    {{"line", "line"},
     {"circle", "circle"},
     {"curve", "curve"},
     {"region", "region"},
     {"angle", "angle"},
     {"parallel", "parallel"},
     {"perpendicular", "perpendicular"},
     {"direction", "direction"},
     {"pin", "pin"}}};

}  // namespace

// ---- values ----

std::optional<JsonValue> ReportReader::object(const JsonValue& parent, std::string_view key) {
  const auto value = reader.required(parent, key);
  return value && reader.expect(*value, JsonKind::Object, "an object") ? value : std::nullopt;
}

std::optional<JsonValue> ReportReader::array(const JsonValue& parent, std::string_view key) {
  const auto value = reader.required(parent, key);
  return value && reader.expect(*value, JsonKind::Array, "an array") ? value : std::nullopt;
}

double ReportReader::number(const JsonValue& parent, std::string_view key) {
  const auto value = reader.required(parent, key);
  if (!value) return 0;
  return value->kind() == JsonKind::Null ? kInfinity : reader.number(*value);
}

std::optional<double> ReportReader::maybe_number(const JsonValue& parent, std::string_view key) {
  const auto value = parent.member(key);
  if (!value || value->kind() == JsonKind::Null) return std::nullopt;
  return reader.number(*value);
}

Index ReportReader::count(const JsonValue& parent, std::string_view key) {
  const auto value = reader.required(parent, key);
  return value ? reader.index(*value) : 0;
}

Spread ReportReader::spread(const JsonValue& parent, std::string_view key) {
  const auto value = object(parent, key);
  if (!value) return {};
  return {.min = number(*value, "min"),
          .max = number(*value, "max"),
          .mean = number(*value, "mean"),
          .p1 = number(*value, "p1"),
          .p50 = number(*value, "p50"),
          .p99 = number(*value, "p99")};
}

Index ReportReader::id(const JsonValue& value, Index limit, const char* what) {
  const Index found = reader.index(value);
  if (!reader.failed() && found >= limit)
    reader.fault(value,
                 "the report names " + std::string(what) + " " + std::to_string(found) + ", the mesh has " +
                     std::to_string(limit),
                 ErrorCode::IndexOutOfRange);
  return found;
}

std::vector<Index> ReportReader::ids(const JsonValue& parent, std::string_view key, Index limit,
                                     const char* what) {
  std::vector<Index> list;
  if (const auto value = array(parent, key))
    value->for_each_element([&](const JsonValue& element) { list.push_back(id(element, limit, what)); });
  return list;
}

std::vector<Index> ReportReader::vertices(const JsonValue& parent, std::string_view key) {
  return ids(parent, key, mesh.vertices, "vertex");
}

std::vector<Index> ReportReader::triangles(const JsonValue& parent, std::string_view key) {
  return ids(parent, key, mesh.triangles, "triangle");
}

std::array<Index, 2> ReportReader::edge(const JsonValue& value) {
  const std::array<Index, 2> ends = reader.edge(value);
  if (!reader.failed())
    value.for_each_element([&](const JsonValue& end) { id(end, mesh.vertices, "vertex"); });
  return ends;
}

// ---- features ----

Feature ReportReader::feature(const std::string& name, const JsonValue& value) {
  Feature feature;
  feature.name = name;
  if (!reader.expect(value, JsonKind::Object, "a feature (an object)")) return feature;
  if (value.member("triangles")) {
    feature.triangle = triangles(value, "triangles");
    return feature;
  }
  feature.vertex = vertices(value, "vertices");
  if (!reader.failed() && feature.vertex.size() < 2)
    reader.fault(*value.member("vertices"), "expected a chain of two vertices or more");
  if (const auto closed = reader.required(value, "closed")) feature.closed = reader.boolean(*closed);
  feature.length = number(value, "length");
  return feature;
}

std::vector<Feature> ReportReader::features(const JsonValue& features) {
  std::vector<Feature> all;
  if (reader.expect(features, JsonKind::Object, "an object of features"))
    features.for_each_member(
        [&](const std::string& name, const JsonValue& value) { all.push_back(feature(name, value)); });
  return all;
}

// ---- constraints ----

void ReportReader::read_subject(const JsonValue& value, ConstraintOutcome& outcome) {
  const auto name = [&](const JsonValue& text) {
    outcome.features.push_back(reader.line_of_text(text, "the name of a feature"));
  };
  const auto add_edge = [&](const JsonValue& pair) { outcome.edges.push_back(edge(pair)); };
  if (const auto feature = value.member("feature")) name(*feature);
  if (const auto found = value.member("edge")) add_edge(*found);
  if (value.member("features")) {
    if (const auto list = array(value, "features")) list->for_each_element(name);
  }
  if (value.member("edges")) {
    if (const auto list = array(value, "edges")) list->for_each_element(add_edge);
  }
  if (outcome.type == "pin") outcome.pinned = vertices(value, "vertices");
}

void ReportReader::read_shape(const JsonValue& value, ConstraintOutcome& outcome) {
  outcome.scale = maybe_number(value, "scale");
  outcome.orientation = maybe_number(value, "orientation");
  outcome.planarity = maybe_number(value, "planarity");
  outcome.mismatch = maybe_number(value, "mismatch").value_or(0);
  const auto shape = reader.required(value, "template");
  if (shape && shape->kind() != JsonKind::Null &&
      reader.expect(*shape, JsonKind::Array, "an array of points"))
    shape->for_each_element([&](const JsonValue& p) { outcome.shape.push_back(reader.point2(p)); });
  if (const auto mirrored = reader.required(value, "mirrored")) outcome.mirrored = reader.boolean(*mirrored);
  outcome.yielded = vertices(value, "yielded");
  if (const auto keeps = value.member("keeps_order")) outcome.keeps_order = reader.boolean(*keeps);
}

ConstraintOutcome ReportReader::entry(const JsonValue& value) {
  ConstraintOutcome outcome;
  if (!reader.expect(value, JsonKind::Object, "a constraint (an object)")) return outcome;
  if (const auto name = reader.required(value, "name")) outcome.name = reader.line_of_text(*name, "a name");
  if (const auto type = reader.required(value, "type")) outcome.type = reader.word(*type, kTypes);
  if (reader.failed()) return outcome;
  read_subject(value, outcome);
  if (const auto side = value.member("side")) outcome.side = reader.index(*side);
  if (outcome.side < 0 || outcome.side > 2) reader.fault(*value.member("side"), "expected the side 1 or 2");
  outcome.residual = number(value, "residual");
  outcome.residual_abs = number(value, "residual_abs");
  outcome.degrees = maybe_number(value, "degrees");
  const std::string& type = outcome.type;
  if (type == "line" || type == "circle" || type == "curve" || type == "region") read_shape(value, outcome);
  return outcome;
}

std::vector<ConstraintOutcome> ReportReader::constraints(const JsonValue& entries) {
  std::vector<ConstraintOutcome> all;
  if (reader.expect(entries, JsonKind::Array, "an array of constraints"))
    entries.for_each_element([&](const JsonValue& value) { all.push_back(entry(value)); });
  return all;
}

}  // namespace planish
