#include "io/constraints_json.hpp"

#include <filesystem>
#include <new>

#include "io/constraints_json_rules.hpp"
#include "io/file.hpp"

namespace planish {
namespace {

constexpr std::array<std::string_view, 7> kKeys = {"$schema",  "version",     "agreement", "outer",
                                                   "features", "constraints", "seams"};

void check_version(JsonReader& reader, const JsonValue& root) {
  const auto version = reader.required(root, "version");
  if (version && reader.number(*version) != 1)
    reader.fault(*version, "this program reads version 1, found " + version->described());
}

double read_agreement(JsonReader& reader, const JsonValue& value) {
  const double agreement = reader.number(value);
  if (!(agreement >= 0)) reader.fault(value, "expected a number from 0 on, found " + shortest(agreement));
  return agreement;
}

std::vector<std::string> read_seams(JsonReader& reader, const JsonValue& value, const FeatureNames& names) {
  std::vector<std::string> seams;
  if (!reader.expect(value, JsonKind::Array, "an array of features")) return seams;
  value.for_each_element(
      [&](const JsonValue& name) { seams.push_back(names.resolve(reader, name, FeatureShape::Curve)); });
  return seams;
}

/// Features first, wherever they stand: the rest speaks of them.
ConstraintSet read_set(const Exec& exec, JsonReader& reader, const JsonValue& root,
                       const std::string& folder) {
  ConstraintSet set;
  if (!reader.expect(root, JsonKind::Object, "an object")) return set;
  check_version(reader, root);
  reader.allow_only(root, kKeys);
  if (const auto schema = root.member("$schema")) reader.expect(*schema, JsonKind::String, "a string");
  if (reader.failed()) return set;
  if (const auto features = root.member("features"))
    set.features = read_features(exec, reader, *features, folder);
  if (reader.failed()) return set;
  const FeatureNames names(set.features);
  if (const auto agreement = root.member("agreement")) set.agreement = read_agreement(reader, *agreement);
  if (const auto outer = root.member("outer")) set.outer = names.resolve(reader, *outer, FeatureShape::Curve);
  if (const auto constraints = root.member("constraints"))
    set.constraints = read_rules(reader, *constraints, names);
  if (const auto seams = root.member("seams")) set.seams = read_seams(reader, *seams, names);
  return set;
}

}  // namespace

Result<ConstraintSet> read_constraints(const Exec& exec, const std::string& path) {
  const auto bytes = FileBytes::open(path, exec);
  if (!bytes) return fail(bytes.error());
  return parse_constraints(exec, bytes->view(), path, std::filesystem::path(path).parent_path().string());
}

Result<ConstraintSet> parse_constraints(const Exec& exec, std::string_view text, const std::string& file,
                                        const std::string& folder) try {
  const auto document = JsonDocument::parse(text, file);
  if (!document) return fail(document.error());
  JsonReader reader(file);
  ConstraintSet set = read_set(exec, reader, document->root(), folder);
  if (reader.failed()) return fail(reader.take_fault());
  return set;
} catch (const std::bad_alloc&) {
  return fail(Error{
      .code = ErrorCode::OutOfMemory, .what = "no memory for the constraints", .place = {.file = file}});
}

}  // namespace planish
