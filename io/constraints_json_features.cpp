#include "io/constraints_json_features.hpp"

#include <algorithm>
#include <filesystem>

#include "io/feature_files.hpp"

namespace planish {
namespace {

FeatureShape shape_of(const FeatureSource& source) {
  const bool region =
      std::holds_alternative<EnclosedBySource>(source) || std::holds_alternative<TriangleSource>(source);
  return region ? FeatureShape::Region : FeatureShape::Curve;
}

/// Reads one feature; `feature` is its object, `value` the value of its kind's key.
class FeatureReader {
 public:
  FeatureReader(const Exec& exec, JsonReader& reader, const std::string& folder)
      : exec_(exec), reader_(reader), folder_(folder) {}

  FeatureSource read(const std::string& name, const JsonValue& feature);

 private:
  using Read = FeatureSource (FeatureReader::*)(const JsonValue& value, const JsonValue& feature);
  struct Kind {
    std::string_view key;
    std::vector<std::string_view> known;  ///< all keys, its own first
    Read read;
  };
  static const std::vector<Kind>& kinds();
  const Kind* kind_of(const JsonValue& feature);

  FeatureSource polyline(const JsonValue& value, const JsonValue& feature) {
    PolylineSource source;
    if (!reader_.expect(value, JsonKind::Array, "an array of points")) return source;
    if (value.size() == 0) reader_.fault(value, "expected an array of points, found an empty one");
    source.point.reserve(static_cast<std::size_t>(value.size()));
    value.for_each_element([&](const JsonValue& p) { source.point.push_back(reader_.point3(p)); });
    if (const auto closed = feature.member("closed")) source.closed = reader_.boolean(*closed);
    if (const auto most = feature.member("max_distance")) source.max_distance = reader_.positive(*most);
    return source;
  }

  FeatureSource vertices(const JsonValue& value, const JsonValue& feature) {
    using Word = std::pair<std::string_view, bool>;
    constexpr std::array kJoin = {Word{"edges", false}, Word{"shortest", true}};
    VertexSource source{.vertex = reader_.indices(value, "an array of vertices")};
    if (const auto closed = feature.member("closed")) source.closed = reader_.boolean(*closed);
    if (const auto join = feature.member("join")) source.shortest = reader_.word(*join, kJoin);
    return source;
  }

  FeatureSource loop(const JsonValue& value, const JsonValue&) {
    return LoopSource{.loop = reader_.index(value)};
  }

  FeatureSource boundary_near(const JsonValue& value, const JsonValue&) {
    return BoundaryNearSource{.point = reader_.point3(value)};
  }

  /// The name is resolved when all features are known.
  FeatureSource enclosed_by(const JsonValue& value, const JsonValue& feature) {
    EnclosedBySource source{.feature = reader_.line_of_text(value, "the name of a feature"), .seed = {}};
    if (const auto seed = feature.member("seed")) source.seed = reader_.point3(*seed);
    return source;
  }

  FeatureSource triangles(const JsonValue& value, const JsonValue&) {
    return TriangleSource{.triangle = reader_.indices(value, "an array of triangles")};
  }

  FeatureSource plane_cut(const JsonValue& value, const JsonValue&) {
    constexpr std::array<std::string_view, 3> kKeys = {"point", "normal", "near"};
    PlaneCutSource source;
    if (!reader_.expect(value, JsonKind::Object, "an object with point, normal and near")) return source;
    reader_.allow_only(value, kKeys);
    if (const auto point = reader_.required(value, "point")) source.point = reader_.point3(*point);
    if (const auto near = reader_.required(value, "near")) source.near = reader_.point3(*near);
    if (const auto normal = reader_.required(value, "normal")) {
      source.normal = reader_.point3(*normal);
      if (source.normal == Vec3{}) reader_.fault(*normal, "a plane's normal cannot be zero");
    }
    return source;
  }

  FeatureSource sharp_edges(const JsonValue& value, const JsonValue&) {
    constexpr std::array<std::string_view, 2> kKeys = {"degrees", "near"};
    SharpEdgesSource source;
    if (!reader_.expect(value, JsonKind::Object, "an object with degrees and near")) return source;
    reader_.allow_only(value, kKeys);
    if (const auto near = reader_.required(value, "near")) source.near = reader_.point3(*near);
    if (const auto degrees = reader_.required(value, "degrees")) {
      source.degrees = reader_.number(*degrees);
      if (!(source.degrees > 0 && source.degrees < 180))
        reader_.fault(*degrees,
                      "expected an angle between 0 and 180 degrees, found " + shortest(source.degrees));
    }
    return source;
  }

  FeatureSource file(const JsonValue& value, const JsonValue& feature);
  void file_fault(const JsonValue& path, Error error);

  const Exec& exec_;
  JsonReader& reader_;
  const std::string& folder_;
  std::string name_;
};

const std::vector<FeatureReader::Kind>& FeatureReader::kinds() {
  using R = FeatureReader;
  static const std::vector<Kind> kKinds = {
      {"polyline", {"polyline", "closed", "max_distance"}, &R::polyline},
      {"vertices", {"vertices", "closed", "join"}, &R::vertices},
      {"loop", {"loop"}, &R::loop},
      {"boundary_near", {"boundary_near"}, &R::boundary_near},
      {"enclosed_by", {"enclosed_by", "seed"}, &R::enclosed_by},
      {"triangles", {"triangles"}, &R::triangles},
      {"plane_cut", {"plane_cut"}, &R::plane_cut},
      {"sharp_edges", {"sharp_edges"}, &R::sharp_edges},
      {"file", {"file", "closed", "max_distance"}, &R::file},
  };
  return kKinds;
}

/// The one kind whose key the feature has; a fault where there is none, or more than one.
const FeatureReader::Kind* FeatureReader::kind_of(const JsonValue& feature) {
  const Kind* found = nullptr;
  std::vector<std::string_view> all, keys;
  for (const Kind& kind : kinds()) {
    keys.push_back(kind.key);
    for (const std::string_view key : kind.known) {
      if (std::ranges::find(all, key) == all.end()) all.push_back(key);
    }
    if (!feature.member(kind.key)) continue;
    if (found != nullptr) {
      reader_.fault(feature, "the feature has both " + in_quotes(found->key) + " and " + in_quotes(kind.key) +
                                 ", which exclude each other");
    }
    found = &kind;
  }
  if (found == nullptr) {
    reader_.allow_only(feature, all);  // a misspelt kind is said as such
    reader_.fault(feature, "the feature needs one of " + listed_words(keys));
  }
  return found;
}

FeatureSource FeatureReader::read(const std::string& name, const JsonValue& feature) {
  name_ = name;
  if (!reader_.expect(feature, JsonKind::Object, "an object")) return {};
  const Kind* kind = kind_of(feature);
  if (reader_.failed()) return {};
  reader_.allow_only(feature, kind->known);
  return (this->*kind->read)(*feature.member(kind->key), feature);
}

/// The place of a fault is in that file; its name here where nothing in the file is to blame.
void FeatureReader::file_fault(const JsonValue& path, Error error) {
  const std::string of_feature = "feature " + in_quotes(name_) + ": ";
  if (error.place.line == 0 && error.place.byte == kNone)
    return reader_.fault(path, of_feature + error.place.file + ": " + error.what, error.code);
  error.what = of_feature + error.what;
  reader_.fault(std::move(error));
}

FeatureSource FeatureReader::file(const JsonValue& value, const JsonValue& feature) {
  PolylineSource source;
  const std::string given = reader_.line_of_text(value, "the path of a file");
  const auto closed = feature.member("closed");
  const bool close = closed && reader_.boolean(*closed);
  if (const auto most = feature.member("max_distance")) source.max_distance = reader_.positive(*most);
  if (reader_.failed()) return source;
  Result<PolylineSource> read = read_feature_file(exec_, (std::filesystem::path(folder_) / given).string());
  if (!read) {
    file_fault(value, std::move(read.error()));
    return source;
  }
  if (closed && !close && read->closed)
    reader_.fault(*closed,
                  "'closed' is false, but the polyline of " + in_quotes(given) + " ends where it began");
  source.point = std::move(read->point);
  source.closed = read->closed || close;
  return source;
}

}  // namespace

FeatureNames::FeatureNames(const std::vector<FeatureSpec>& features) {
  for (const FeatureSpec& feature : features) {
    name_.push_back(feature.name);
    shape_.emplace(feature.name, shape_of(feature.source));
  }
}

std::string FeatureNames::resolve(JsonReader& reader, const JsonValue& value, FeatureShape shape) const {
  const std::string name = reader.line_of_text(value, "the name of a feature");
  if (reader.failed()) return name;
  const auto found = shape_.find(name);
  if (found == shape_.end()) {
    reader.unknown(value, "feature", name, name_);
  } else if (found->second != shape) {
    reader.fault(value,
                 in_quotes(name) + (shape == FeatureShape::Curve ? " is a region, a curve is needed here"
                                                                 : " is a curve, a region is needed here"),
                 ErrorCode::ConstraintInvalid);
  }
  return name;
}

std::vector<FeatureSpec> read_features(const Exec& exec, JsonReader& reader, const JsonValue& features,
                                       const std::string& folder) {
  std::vector<FeatureSpec> specs;
  if (!reader.expect(features, JsonKind::Object, "an object of features")) return specs;
  specs.reserve(static_cast<std::size_t>(features.size()));
  FeatureReader feature_reader(exec, reader, folder);
  features.for_each_member([&](const std::string& name, const JsonValue& feature) {
    if (reader.failed()) return;
    reader.check_name(feature, name);
    specs.push_back({name, feature_reader.read(name, feature)});
  });
  if (reader.failed()) return specs;
  const FeatureNames names(specs);
  features.for_each_member([&](const std::string&, const JsonValue& feature) {
    if (const auto border = feature.member("enclosed_by"))
      names.resolve(reader, *border, FeatureShape::Curve);
  });
  return specs;
}

}  // namespace planish
