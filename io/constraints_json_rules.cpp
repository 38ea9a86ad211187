#include "io/constraints_json_rules.hpp"

#include <algorithm>
#include <unordered_set>

namespace planish {
namespace {

using Rule = decltype(Constraint::rule);
template <class T>
using Word = std::pair<std::string_view, T>;

/// Reads one constraint.
class RuleReader {
 public:
  RuleReader(JsonReader& reader, const FeatureNames& names) : reader_(reader), names_(names) {}

  Constraint read(const JsonValue& constraint);

 private:
  struct Type {
    std::string_view word;
    Rule (RuleReader::*read)(const JsonValue& constraint);
    std::vector<std::string_view> known;  ///< keys beside type and name
  };
  static const std::vector<Type>& types();
  const Type* type_of(const JsonValue& constraint);

  Rule line(const JsonValue& constraint);
  Rule circle(const JsonValue& constraint);
  Rule angle(const JsonValue& constraint);
  Rule parallel(const JsonValue& constraint) { return relation(constraint, 0); }
  Rule perpendicular(const JsonValue& constraint) { return relation(constraint, 90); }
  Rule direction(const JsonValue& constraint);
  Rule curve(const JsonValue& constraint);
  Rule region(const JsonValue& constraint);
  Rule pin(const JsonValue& constraint);

  AngleConstraint relation(const JsonValue& constraint, double degrees);
  void relation_features(const JsonValue& features, AngleConstraint& rule);
  void relation_edges(const JsonValue& edges, AngleConstraint& rule);
  std::string feature(const JsonValue& constraint, FeatureShape shape = FeatureShape::Curve);
  Scale scale(const JsonValue& constraint, std::optional<double> factor);
  double degrees(const JsonValue& constraint, bool oriented);
  bool flag(const JsonValue& constraint, std::string_view key);
  std::optional<bool> mirror(const JsonValue& constraint);
  std::optional<Measure> measure(const JsonValue& constraint);
  /// Faults where a key stands beside one that leaves it without meaning.
  void exclude(const JsonValue& constraint, std::string_view key, std::string_view other);
  void add_to_name(const std::array<Index, 2>& edge);

  JsonReader& reader_;
  const FeatureNames& names_;
  std::string default_name_;
};

const std::vector<RuleReader::Type>& RuleReader::types() {
  using R = RuleReader;
  static const std::vector<Type> kTypes = {
      {"line", &R::line, {"feature", "lengths", "scale", "scale_group"}},
      {"circle", &R::circle, {"feature", "scale", "scale_group", "radius", "sweep_degrees", "mirror"}},
      {"angle", &R::angle, {"features", "edges", "degrees", "oriented", "measure"}},
      {"parallel", &R::parallel, {"features", "edges", "oriented", "measure"}},
      {"perpendicular", &R::perpendicular, {"features", "edges", "oriented", "measure"}},
      {"direction", &R::direction, {"feature", "edge", "degrees", "oriented", "measure"}},
      {"curve", &R::curve, {"feature", "scale", "scale_group", "shape", "mirror"}},
      {"region", &R::region, {"feature", "scale", "scale_group"}},
      {"pin", &R::pin, {"vertices", "uv"}},
  };
  return kTypes;
}

const RuleReader::Type* RuleReader::type_of(const JsonValue& constraint) {
  const auto type = reader_.required(constraint, "type");
  std::vector<std::string_view> words;
  for (const Type& t : types()) words.push_back(t.word);
  if (!type || !reader_.expect(*type, JsonKind::String, listed_words(words))) return nullptr;
  const auto found = std::ranges::find(types(), type->string(), &Type::word);
  if (found != types().end()) return &*found;
  reader_.unknown(*type, "type", type->string(), words);
  return nullptr;
}

Constraint RuleReader::read(const JsonValue& constraint) {
  if (!reader_.expect(constraint, JsonKind::Object, "an object")) return {};
  const Type* type = type_of(constraint);
  if (type == nullptr) return {};
  std::vector<std::string_view> known = {"type", "name"};
  known.insert(known.end(), type->known.begin(), type->known.end());
  reader_.allow_only(constraint, known);
  default_name_ = type->word;
  Rule rule = (this->*type->read)(constraint);
  const auto name = constraint.member("name");
  return {.name = name ? reader_.line_of_text(*name, "a name") : default_name_,
          .type = std::string(type->word),
          .rule = std::move(rule)};
}

Rule RuleReader::line(const JsonValue& constraint) {
  using Lengths = LineConstraint::Lengths;
  constexpr std::array kWords = {Word<Lengths>{"keep", Lengths::Keep}, Word<Lengths>{"scale", Lengths::Scale},
                                 Word<Lengths>{"free", Lengths::Free}};
  LineConstraint rule{.feature = feature(constraint), .scale = {}};
  if (const auto lengths = constraint.member("lengths")) rule.lengths = reader_.word(*lengths, kWords);
  if (rule.lengths == Lengths::Scale) {
    rule.scale = scale(constraint, std::nullopt);
    return rule;
  }
  for (const std::string_view key : {"scale", "scale_group"}) {
    if (const auto found = constraint.member(key))
      reader_.fault(*found, in_quotes(key) + " of a line needs 'lengths': 'scale'");
  }
  return rule;
}

Rule RuleReader::circle(const JsonValue& constraint) {
  CircleConstraint rule;
  rule.feature = feature(constraint);
  rule.scale = scale(constraint, std::nullopt);
  if (const auto radius = constraint.member("radius")) {
    rule.radius = reader_.positive(*radius);
    exclude(constraint, "scale", "radius");
    exclude(constraint, "scale_group", "radius");
  }
  if (const auto sweep = constraint.member("sweep_degrees")) {
    rule.sweep_degrees = reader_.number(*sweep);
    if (!(*rule.sweep_degrees > 0 && *rule.sweep_degrees < 360))
      reader_.fault(*sweep,
                    "expected a sweep between 0 and 360 degrees, found " + shortest(*rule.sweep_degrees));
  }
  rule.mirror = mirror(constraint);
  return rule;
}

Rule RuleReader::angle(const JsonValue& constraint) {
  return relation(constraint, degrees(constraint, flag(constraint, "oriented")));
}

AngleConstraint RuleReader::relation(const JsonValue& constraint, double degrees) {
  AngleConstraint rule;
  rule.degrees = degrees;
  rule.oriented = flag(constraint, "oriented");
  rule.measure = measure(constraint);
  const auto features = constraint.member("features"), edges = constraint.member("edges");
  if (!features && !edges) reader_.fault(constraint, "the constraint needs 'features' or 'edges'");
  if (features) relation_features(*features, rule);
  if (edges) {
    exclude(constraint, "features", "edges");
    exclude(constraint, "measure", "edges");
    relation_edges(*edges, rule);
  }
  return rule;
}

void RuleReader::relation_features(const JsonValue& features, AngleConstraint& rule) {
  if (!reader_.expect(features, JsonKind::Array, "two features")) return;
  if (features.size() != 2) reader_.fault(features, "expected two features, found " + features.described());
  features.for_each_element([&](const JsonValue& name) {
    rule.features.push_back(names_.resolve(reader_, name, FeatureShape::Curve));
    default_name_ += " " + rule.features.back();
  });
  if (!reader_.failed() && rule.features[0] == rule.features[1])
    reader_.fault(features,
                  "expected two different features, found " + in_quotes(rule.features[0]) + " twice");
}

void RuleReader::relation_edges(const JsonValue& edges, AngleConstraint& rule) {
  if (!reader_.expect(edges, JsonKind::Array, "two edges")) return;
  if (edges.size() != 2) reader_.fault(edges, "expected two edges, found " + edges.described());
  edges.for_each_element([&](const JsonValue& edge) {
    rule.edges.push_back(reader_.edge(edge));
    add_to_name(rule.edges.back());
  });
}

Rule RuleReader::direction(const JsonValue& constraint) {
  DirectionConstraint rule;
  rule.oriented = flag(constraint, "oriented");
  rule.degrees = degrees(constraint, rule.oriented);
  rule.measure = measure(constraint);
  if (const auto edge = constraint.member("edge")) {
    exclude(constraint, "feature", "edge");
    exclude(constraint, "measure", "edge");
    rule.edge = reader_.edge(*edge);
    add_to_name(*rule.edge);
  } else if (constraint.member("feature")) {
    rule.feature = feature(constraint);
  } else {
    reader_.fault(constraint, "the constraint needs 'feature' or 'edge'");
  }
  return rule;
}

Rule RuleReader::curve(const JsonValue& constraint) {
  using Shape = CurveConstraint::Shape;
  constexpr std::array kWords = {Word<Shape>{"plane", Shape::Plane},
                                 Word<Shape>{"geodesic", Shape::Geodesic}};
  CurveConstraint rule{.feature = feature(constraint), .scale = scale(constraint, 1), .mirror = {}};
  if (const auto shape = constraint.member("shape")) rule.shape = reader_.word(*shape, kWords);
  rule.mirror = mirror(constraint);
  return rule;
}

Rule RuleReader::region(const JsonValue& constraint) {
  return RegionConstraint{.feature = feature(constraint, FeatureShape::Region),
                          .scale = scale(constraint, 1)};
}

Rule RuleReader::pin(const JsonValue& constraint) {
  constexpr std::size_t kNamed = 3;
  PinConstraint rule;
  const auto vertices = reader_.required(constraint, "vertices"), uv = reader_.required(constraint, "uv");
  if (!vertices || !uv) return rule;
  rule.vertex = reader_.indices(*vertices, "an array of vertices");
  if (!reader_.expect(*uv, JsonKind::Array, "an array of points of the plane")) return rule;
  uv->for_each_element([&](const JsonValue& point) { rule.uv.push_back(reader_.point2(point)); });
  if (rule.uv.size() != rule.vertex.size()) {
    reader_.fault(*uv, "expected a point for each of the " + std::to_string(rule.vertex.size()) +
                           " vertices, found " + std::to_string(rule.uv.size()));
  }
  std::vector<Index> sorted = rule.vertex;
  std::ranges::sort(sorted);
  if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
    reader_.fault(*vertices, "vertex " + std::to_string(*twice) + " stands twice");
  for (std::size_t i = 0; i < std::min(kNamed, rule.vertex.size()); ++i)
    default_name_ += " " + std::to_string(rule.vertex[i]);
  if (rule.vertex.size() > kNamed)
    default_name_ += " and " + std::to_string(rule.vertex.size() - kNamed) + " more";
  return rule;
}

std::string RuleReader::feature(const JsonValue& constraint, FeatureShape shape) {
  const auto value = reader_.required(constraint, "feature");
  if (!value) return "";
  std::string name = names_.resolve(reader_, *value, shape);
  default_name_ += " " + name;
  return name;
}

/// `factor` is the default; a group shares a free factor.
Scale RuleReader::scale(const JsonValue& constraint, std::optional<double> factor) {
  Scale scale{.factor = factor, .group = {}};
  const auto group = constraint.member("scale_group");
  if (group) scale = {.factor = std::nullopt, .group = reader_.line_of_text(*group, "the name of a group")};
  const auto value = constraint.member("scale");
  if (!value) return scale;
  if (value->kind() == JsonKind::String) {
    if (value->string() != "free")
      reader_.fault(*value, "expected a positive number or 'free', found " + value->described());
    scale.factor = std::nullopt;
    return scale;
  }
  scale.factor = reader_.positive(*value);
  if (group)
    reader_.fault(*group, "a group shares a free scale, 'scale' is given as " + shortest(*scale.factor));
  return scale;
}

double RuleReader::degrees(const JsonValue& constraint, bool oriented) {
  const auto value = reader_.required(constraint, "degrees");
  if (!value) return 0;
  const double angle = reader_.number(*value);
  if (oriented && !(angle >= 0 && angle < 360))
    reader_.fault(*value, "expected degrees from 0 to below 360, found " + shortest(angle));
  if (!oriented && !(angle >= 0 && angle <= 180))
    reader_.fault(*value, "expected degrees from 0 to 180 (below 360 where 'oriented' is true), found " +
                              shortest(angle));
  return angle;
}

bool RuleReader::flag(const JsonValue& constraint, std::string_view key) {
  const auto value = constraint.member(key);
  return value && reader_.boolean(*value);
}

std::optional<bool> RuleReader::mirror(const JsonValue& constraint) {
  const auto value = constraint.member("mirror");
  return value ? std::optional(reader_.boolean(*value)) : std::nullopt;
}

std::optional<Measure> RuleReader::measure(const JsonValue& constraint) {
  constexpr std::array kWords = {Word<Measure>{"line", Measure::Line},
                                 Word<Measure>{"chord", Measure::Chord}};
  const auto value = constraint.member("measure");
  return value ? std::optional(reader_.word(*value, kWords)) : std::nullopt;
}

void RuleReader::exclude(const JsonValue& constraint, std::string_view key, std::string_view other) {
  if (const auto found = constraint.member(key))
    reader_.fault(*found, in_quotes(key) + " has no meaning beside " + in_quotes(other));
}

void RuleReader::add_to_name(const std::array<Index, 2>& edge) {
  default_name_ += " " + std::to_string(edge[0]) + "-" + std::to_string(edge[1]);
}

}  // namespace

std::vector<Constraint> read_rules(JsonReader& reader, const JsonValue& constraints,
                                   const FeatureNames& names) {
  std::vector<Constraint> rules;
  if (!reader.expect(constraints, JsonKind::Array, "an array of constraints")) return rules;
  rules.reserve(static_cast<std::size_t>(constraints.size()));
  RuleReader rule_reader(reader, names);
  std::unordered_set<std::string> taken;
  constraints.for_each_element([&](const JsonValue& constraint) {
    if (reader.failed()) return;
    rules.push_back(rule_reader.read(constraint));
    if (!reader.failed() && !taken.insert(rules.back().name).second) {
      reader.fault(constraint, "two constraints are called " + in_quotes(rules.back().name) +
                                   "; give one of them another 'name'");
    }
  });
  return rules;
}

}  // namespace planish
