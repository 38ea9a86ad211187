#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <deque>
#include <set>

#include "io/mesh_files.hpp"
#include "io/uv_set.hpp"

namespace planish {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are copied as they lie in memory");

/// Bytes that go into every row: `size` of them, from begin + row * stride.
struct Column {
  const char* begin;
  std::size_t stride, size;
};

/// The rows of one element and their description.
class ElementWriter {
 public:
  ElementWriter(const char* name, Index count) : name_(name), count_(count) {}

  bool has(const std::string& property) const { return names_.contains(property); }

  /// A scalar property: its value in row i is at begin + i * stride + offset. Without rows, begin may be
  /// null.
  void add(const std::string& property, Scalar scalar, const void* begin, std::size_t stride,
           std::size_t offset = 0) {
    constexpr std::array kTypes = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
    names_.insert(property);
    header_ += std::string("property ") + kTypes[static_cast<int>(scalar)] + " " + property + "\n";
    const auto* first = static_cast<const char*>(begin);
    columns_.push_back({count_ > 0 ? first + offset : first, stride, byte_size(scalar)});
  }

  /// The corners of triangles.
  void add_triangles(const std::vector<Index>& corner_vertex) {
    static constexpr char kThree = 3;
    names_.insert("vertex_indices");
    header_ += "property list uchar int vertex_indices\n";
    columns_.push_back({&kThree, 0, 1});
    columns_.push_back(
        {reinterpret_cast<const char*>(corner_vertex.data()), 3 * sizeof(Index), 3 * sizeof(Index)});
  }

  std::string header() const {
    return std::string("element ") + name_ + " " + std::to_string(count_) + "\n" + header_;
  }
  std::size_t row_size() const {
    std::size_t size = 0;
    for (const Column& column : columns_) size += column.size;
    return size;
  }
  std::size_t size() const { return row_size() * static_cast<std::size_t>(count_); }

  void write(const Exec& exec, char* out) const {
    const std::size_t row_bytes = row_size();
    exec.for_blocks(count_, kBlock, [&](Index, Range r) {
      std::size_t offset = 0;
      for (const Column& column : columns_) {
        write_column(r, column, out + offset, row_bytes);
        offset += column.size;
      }
    });
  }

 private:
  template <std::size_t kSize>
  static void copy_rows(Range r, const Column& column, char* out, std::size_t row_bytes) {
    for (Index row = r.begin; row < r.end; ++row) {
      std::memcpy(out + row_bytes * static_cast<std::size_t>(row),
                  column.begin + column.stride * static_cast<std::size_t>(row), kSize);
    }
  }

  static void write_column(Range r, const Column& column, char* out, std::size_t row_bytes) {
    switch (column.size) {
      case 1: return copy_rows<1>(r, column, out, row_bytes);
      case 2: return copy_rows<2>(r, column, out, row_bytes);
      case 4: return copy_rows<4>(r, column, out, row_bytes);
      case 8: return copy_rows<8>(r, column, out, row_bytes);
      default: return copy_rows<3 * sizeof(Index)>(r, column, out, row_bytes);
    }
  }

  const char* name_;
  Index count_;
  std::string header_;
  std::vector<Column> columns_;
  std::set<std::string> names_;
};

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

class PlyWriter {
 public:
  PlyWriter(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings)
      : exec_(exec),
        output_(output),
        mesh_(*output.mesh),
        warnings_(warnings),
        vertices_("vertex", mesh_.num_vertices()),
        faces_("face", mesh_.num_triangles()) {}

  std::string run() {
    vertices_.add("x", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, x));
    vertices_.add("y", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, y));
    vertices_.add("z", Scalar::Float64, mesh_.position.data(), sizeof(Vec3), offsetof(Vec3, z));
    faces_.add_triangles(mesh_.corner_vertex);
    if (!output_.uv.empty()) add_vertex_uv("s", "t", output_.uv);
    add_earlier_uv();
    add_names();
    // Provenance is new; an attribute of the same name comes from an earlier run and gives way.
    const std::set<std::string> vertex_provenance = {"origin_triangle", "b0", "b1", "b2"};
    add_attributes(vertices_, mesh_.vertex_attributes,
                   output_.vertex_origin_triangle.empty() ? std::set<std::string>{} : vertex_provenance);
    add_attributes(
        faces_, mesh_.triangle_attributes,
        output_.triangle_origin.empty() ? std::set<std::string>{} : std::set<std::string>{"origin"});
    add_provenance();
    return text();
  }

 private:
  void add_vertex_uv(const std::string& u, const std::string& v, In<Vec2> uv) {
    vertices_.add(u, Scalar::Float64, uv.data(), sizeof(Vec2), offsetof(Vec2, x));
    vertices_.add(v, Scalar::Float64, uv.data(), sizeof(Vec2), offsetof(Vec2, y));
  }

  /// The parameterizations of the input, which output_.uv supersedes: under names that are still free.
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

  void add_attributes(ElementWriter& element, const std::vector<Attribute>& attributes,
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

  std::string text() const {
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    for (const auto* comments : {&mesh_.comments, &comments_}) {
      for (const std::string& comment : *comments) text += "comment " + comment + "\n";
    }
    text += vertices_.header() + faces_.header() + "end_header\n";
    const std::size_t begin = text.size();
    text.resize(begin + vertices_.size() + faces_.size());
    vertices_.write(exec_, text.data() + begin);
    faces_.write(exec_, text.data() + begin + vertices_.size());
    return text;
  }

  const Exec& exec_;
  const MeshOutput& output_;
  const Mesh& mesh_;
  std::vector<std::string>& warnings_;
  ElementWriter vertices_, faces_;
  std::vector<std::string> comments_;
  std::deque<std::vector<Vec2>> vertex_uv_;  // columns point into these
  std::deque<Naming> namings_;
};

}  // namespace

std::string format_ply(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings) {
  return PlyWriter(exec, output, warnings).run();
}

}  // namespace planish
