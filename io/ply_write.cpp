#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <deque>
#include <set>

#include "io/mesh_files.hpp"
#include "io/ply_element.hpp"
#include "io/uv_set.hpp"

namespace planish {
namespace {

/// A statement's keyword and the rest: "g left door" -> {"g", "left door"}.
std::pair<std::string_view, std::string_view> split_statement(std::string_view text) {
  const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
  const std::size_t rest = std::min(text.find_first_not_of(" \t", end), text.size());
  return {text.substr(0, end), text.substr(rest)};
}

/// The group or material of each triangle as a number into a list of names; kNone before the first.
struct Naming {
  std::vector<std::string> names;
  std::vector<Index> number;  ///< [T], empty where no statement names anything
};

Naming naming_of(const Mesh& mesh, std::string_view keyword) {
  Naming naming;
  Index from = 0, current = kNone;
  const auto fill_to = [&](Index triangle) {
    for (; from < triangle; ++from) naming.number[from] = current;
  };
  for (const Statement& statement : mesh.statements) {
    const auto [word, name] = split_statement(statement.text);
    if (word != keyword) continue;
    naming.number.resize(mesh.num_triangles());
    fill_to(statement.triangle);
    const auto found = std::ranges::find(naming.names, name);
    current = static_cast<Index>(found - naming.names.begin());
    if (found == naming.names.end()) naming.names.emplace_back(name);
  }
  if (!naming.names.empty()) fill_to(mesh.num_triangles());
  return naming;
}

/// An edge of a chain.
struct EdgeRow {
  Index vertex1, vertex2;
  Index feature;
};

std::vector<EdgeRow> edges_of(const std::vector<Feature>& features) {
  std::vector<EdgeRow> edges;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::vector<Index>& chain = features[i].vertex;
    const auto add = [&](Index a, Index b) { edges.push_back({a, b, static_cast<Index>(i)}); };
    for (std::size_t k = 1; k < chain.size(); ++k) add(chain[k - 1], chain[k]);
    if (features[i].closed) add(chain.back(), chain.front());
  }
  return edges;
}

/// Is it a name of a feature that an earlier run wrote: "feature NUMBER NAME"?
bool names_a_feature(const std::string& comment) {
  constexpr std::string_view kWord = "feature ";
  return comment.starts_with(kWord) && comment.size() > kWord.size() &&
         std::isdigit(static_cast<unsigned char>(comment[kWord.size()])) != 0;
}

/// A name that stays on its line.
std::string on_one_line(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return name;
}

class PlyWriter {
 public:
  PlyWriter(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings)
      : exec_(exec),
        output_(output),
        mesh_(*output.mesh),
        warnings_(warnings),
        vertices_("vertex", mesh_.num_vertices()),
        faces_("face", mesh_.num_triangles()),
        edge_rows_(output.features == nullptr ? std::vector<EdgeRow>{} : edges_of(*output.features)),
        edges_("edge", static_cast<Index>(edge_rows_.size())) {}

  std::string run() {
    vertices_.add("x", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, x));
    vertices_.add("y", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, y));
    vertices_.add("z", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, z));
    faces_.add_triangles(mesh_.corner_vertex);
    if (!output_.corner_uv.empty()) {
      faces_.add_texcoord(output_.corner_uv);
    } else if (!output_.uv.empty()) {
      add_vertex_uv("s", "t", output_.uv);
    }
    add_earlier_uv();
    add_names();
    // Provenance is new; an attribute of the same name comes from an earlier run and gives way.
    const std::set<std::string> vertex_provenance = {"origin_triangle", "b0", "b1", "b2"};
    add_attributes(vertices_, mesh_.vertex_attributes,
                   output_.vertex_origin_triangle.empty() ? std::set<std::string>{} : vertex_provenance);
    std::set<std::string> superseded;
    if (!output_.triangle_origin.empty()) superseded.insert("origin");
    if (has_regions()) superseded.insert("region");
    add_attributes(faces_, mesh_.triangle_attributes, superseded);
    add_provenance();
    if (output_.features != nullptr) add_features(*output_.features);
    return text();
  }

 private:
  void add_vertex_uv(const std::string& u, const std::string& v, In<Vec2> uv) {
    vertices_.add(u, Scalar::Float64, uv.data(), sizeof(Vec2), offsetof(Vec2, x));
    vertices_.add(v, Scalar::Float64, uv.data(), sizeof(Vec2), offsetof(Vec2, y));
  }

  /// The parameterizations of the input, which the new one supersedes: under names that are still free.
  void add_earlier_uv() {
    for (const UvSet& set : mesh_.uv_sets) {
      const bool kept = set.per_vertex ? add_earlier_vertex_uv(set) : add_seam_uv(set);
      if (!kept)
        warnings_.push_back("the input's parameterization '" + set.name +
                            "' is not kept: its names are taken");
    }
  }

  /// Is the pair of names reserved for a set of the input that has it as its own spelling?
  bool is_own_spelling(const std::string& spelling, const UvSet& but) const {
    return std::ranges::any_of(mesh_.uv_sets, [&](const UvSet& set) {
      return &set != &but && set.per_vertex && set.name == spelling;
    });
  }

  bool add_earlier_vertex_uv(const UvSet& set) {
    struct Spelling {
      const char* set;
      const char* u;
      const char* v;
    };
    constexpr std::array kSpellings = {
        Spelling{"st", "s", "t"}, Spelling{"texture_uv", "texture_u", "texture_v"}, Spelling{"uv", "u", "v"}};
    const auto try_spelling = [&](const Spelling& spelling) {
      // Readers that know s t would take an earlier set there for the new one at the corners.
      if (!output_.corner_uv.empty() && std::string_view(spelling.set) == "st") return false;
      if (vertices_.has(spelling.u) || vertices_.has(spelling.v)) return false;
      vertex_uv_.push_back(uv_of_vertices(mesh_.corner_vertex, set.corner_uv, mesh_.num_vertices()));
      add_vertex_uv(spelling.u, spelling.v, vertex_uv_.back());
      return true;
    };
    for (const Spelling& spelling : kSpellings) {
      if (set.name == spelling.set && try_spelling(spelling)) return true;
    }
    return std::ranges::any_of(kSpellings, [&](const Spelling& spelling) {
      return !is_own_spelling(spelling.set, set) && try_spelling(spelling);
    });
  }

  /// A uv a corner: six scalars a face, which every reader passes over unharmed.
  bool add_seam_uv(const UvSet& set) {
    constexpr std::array kNames = {"u0", "v0", "u1", "v1", "u2", "v2"};
    if (std::ranges::any_of(kNames, [&](const char* name) { return faces_.has(name); })) return false;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      faces_.add(kNames[i], Scalar::Float64, set.corner_uv.data(), 3 * sizeof(Vec2), i * sizeof(double));
    }
    return true;
  }

  void add_attributes(PlyElement& element, const std::vector<Attribute>& attributes,
                      const std::set<std::string>& superseded) {
    for (const Attribute& attribute : attributes) {
      if (element.has(attribute.name) || superseded.contains(attribute.name)) {
        warnings_.push_back("the input's property '" + attribute.name +
                            "' is replaced by a new one of this name");
        continue;
      }
      element.add(attribute.name, attribute.scalar, attribute.values.data(), byte_size(attribute.scalar));
    }
  }

  /// Groups and materials of an OBJ input as numbers; PLY has no place for its other statements.
  void add_names() {
    const std::pair<const char*, const char*> kKinds[] = {{"g", "group"}, {"usemtl", "material"}};
    for (const auto& [keyword, property] : kKinds) {
      namings_.push_back(naming_of(mesh_, keyword));
      const Naming& naming = namings_.back();
      if (naming.names.empty()) continue;
      faces_.add(property, Scalar::Int32, naming.number.data(), sizeof(Index));
      for (std::size_t i = 0; i < naming.names.size(); ++i) {
        comments_.push_back(std::string("planish ") + property + " " + std::to_string(i) + " " +
                            naming.names[i]);
      }
    }
    std::set<std::string> lost;
    for (const Statement& statement : mesh_.statements) {
      const std::string_view word = split_statement(statement.text).first;
      if (word != "g" && word != "usemtl") lost.emplace(word);
    }
    for (const std::string& word : lost) {
      warnings_.push_back("PLY cannot hold the statements '" + word +
                          "' of the input; write OBJ to keep them");
    }
  }

  void add_provenance() {
    if (!output_.triangle_origin.empty()) {
      faces_.add("origin", Scalar::Int32, output_.triangle_origin.data(), sizeof(Index));
    }
    if (!output_.vertex_origin_triangle.empty()) {
      vertices_.add("origin_triangle", Scalar::Int32, output_.vertex_origin_triangle.data(), sizeof(Index));
    }
    if (!output_.vertex_barycentric.empty()) {
      vertices_.add("b0", Scalar::Float64, output_.vertex_barycentric.data(), sizeof(Vec3),
                    offsetof(Vec3, x));
      vertices_.add("b1", Scalar::Float64, output_.vertex_barycentric.data(), sizeof(Vec3),
                    offsetof(Vec3, y));
      vertices_.add("b2", Scalar::Float64, output_.vertex_barycentric.data(), sizeof(Vec3),
                    offsetof(Vec3, z));
    }
  }

  bool has_regions() const {
    return output_.features != nullptr && std::ranges::any_of(*output_.features, &Feature::is_region);
  }

  void add_features(const std::vector<Feature>& features) {
    for (std::size_t i = 0; i < features.size(); ++i) {
      comments_.push_back("feature " + std::to_string(i) + " " + on_one_line(features[i].name));
    }
    if (has_regions()) add_regions(features);
    if (edge_rows_.empty()) return;
    const EdgeRow* const rows = edge_rows_.data();
    edges_.add("vertex1", Scalar::Int32, rows, sizeof(EdgeRow), offsetof(EdgeRow, vertex1));
    edges_.add("vertex2", Scalar::Int32, rows, sizeof(EdgeRow), offsetof(EdgeRow, vertex2));
    edges_.add("feature", Scalar::Int32, rows, sizeof(EdgeRow), offsetof(EdgeRow, feature));
  }

  /// A triangle has one number: of several regions that share it, the last one's.
  void add_regions(const std::vector<Feature>& features) {
    region_.assign(mesh_.num_triangles(), kNone);
    for (std::size_t i = 0; i < features.size(); ++i) {
      Index taken = 0;
      for (const Index t : features[i].triangle) {
        if (region_[t] != kNone) ++taken;
        region_[t] = static_cast<Index>(i);
      }
      if (taken == 0) continue;
      warnings_.push_back("the property 'region' holds one number a face: " + std::to_string(taken) +
                          " faces of earlier regions are given to '" + features[i].name + "'");
    }
    faces_.add("region", Scalar::Int32, region_.data(), sizeof(Index));
  }

  std::string text() const {
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : mesh_.comments) {
      if (output_.features == nullptr || !names_a_feature(comment)) text += "comment " + comment + "\n";
    }
    for (const std::string& comment : comments_) text += "comment " + comment + "\n";
    std::vector<const PlyElement*> elements = {&vertices_, &faces_};
    if (!edge_rows_.empty()) elements.push_back(&edges_);
    std::size_t size = 0;
    for (const PlyElement* element : elements) {
      text += element->header();
      size += element->size();
    }
    text += "end_header\n";
    std::size_t begin = text.size();
    text.resize(begin + size);
    for (const PlyElement* element : elements) {
      element->write(exec_, text.data() + begin);
      begin += element->size();
    }
    return text;
  }

  const Exec& exec_;
  const MeshOutput& output_;
  const Mesh& mesh_;
  std::vector<std::string>& warnings_;
  PlyElement vertices_, faces_;
  std::vector<EdgeRow> edge_rows_;
  PlyElement edges_;
  std::vector<Index> region_;  // [T] number of a region, kNone outside of all
  std::vector<std::string> comments_;
  std::deque<std::vector<Vec2>> vertex_uv_;  // columns point into these
  std::deque<Naming> namings_;
};

}  // namespace

std::string format_ply(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings) {
  return PlyWriter(exec, output, warnings).run();
}

}  // namespace planish
