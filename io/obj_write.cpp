#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include "io/mesh_files.hpp"
#include "io/rows.hpp"

namespace planish {
namespace {

constexpr Index kLinesAtOnce = 8192;

/// Text grown line by line; room for one line is made before it is written.
class LineBuffer {
 public:
  void begin_line(std::size_t most_bytes) {
    if (text_.size() - size_ < most_bytes) text_.resize(2 * text_.size() + most_bytes);
  }
  void put(char c) { text_[size_++] = c; }
  void put(std::string_view text) {
    text.copy(text_.data() + size_, text.size());
    size_ += text.size();
  }
  /// Shortest text that reads back as the same bits.
  template <class T>
  void put_number(T value) {
    size_ = static_cast<std::size_t>(
        std::to_chars(text_.data() + size_, text_.data() + text_.size(), value).ptr - text_.data());
  }
  std::string_view view() const { return {text_.data(), size_}; }

 private:
  std::string text_;
  std::size_t size_ = 0;
};

constexpr std::size_t kNumberBytes = 32;  // longest double, float or index, and a blank

/// Appends the lines of blocks, formatted in parallel: `line(buffer, i)` writes those of element i.
template <class Line>
void append_lines(const Exec& exec, Index n, std::string& text, Line&& line) {
  std::vector<LineBuffer> block(Exec::num_blocks(n, kLinesAtOnce));
  exec.for_blocks(n, kLinesAtOnce, [&](Index k, Range r) {
    for (Index i = r.begin; i < r.end; ++i) line(block[k], i);
  });
  std::size_t size = text.size();
  for (const LineBuffer& buffer : block) size += buffer.view().size();
  text.reserve(size);
  for (const LineBuffer& buffer : block) text += buffer.view();
}

using Colours = std::array<const Attribute*, 3>;

bool complete(const Colours& colours) { return std::ranges::count(colours, nullptr) == 0; }

const Attribute* find_attribute(const Mesh& mesh, std::string_view name) {
  for (const Attribute& attribute : mesh.vertex_attributes) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

/// OBJ colours are fractions; bytes count in 255ths.
void put_colour(LineBuffer& buffer, const Attribute& attribute, Index v) {
  const std::byte* at = attribute.values.data() + static_cast<std::size_t>(v) * byte_size(attribute.scalar);
  visit_scalar(attribute.scalar, [&]<class T>(T) {
    const T value = load<T>(reinterpret_cast<const char*>(at), false);
    if constexpr (std::same_as<T, std::uint8_t>) {
      buffer.put_number(value / 255.0);
    } else {
      buffer.put_number(value);
    }
  });
}

void append_vertices(const Exec& exec, const Mesh& mesh, const Colours& colours, std::string& text) {
  const bool coloured = complete(colours);
  append_lines(exec, mesh.num_vertices(), text, [&](LineBuffer& buffer, Index v) {
    buffer.begin_line(7 * kNumberBytes);
    buffer.put('v');
    const Vec3& p = mesh.position[v];
    for (const double coordinate : {p.x, p.y, p.z}) {
      buffer.put(' ');
      buffer.put_number(coordinate);
    }
    for (int i = 0; coloured && i < 3; ++i) {
      buffer.put(' ');
      put_colour(buffer, *colours[i], v);
    }
    buffer.put('\n');
  });
}

void put_uv(LineBuffer& buffer, Vec2 uv) {
  buffer.begin_line(3 * kNumberBytes);
  buffer.put("vt ");
  buffer.put_number(uv.x);
  buffer.put(' ');
  buffer.put_number(uv.y);
  buffer.put('\n');
}

void append_uv(const Exec& exec, In<Vec2> uv, std::string& text) {
  append_lines(exec, static_cast<Index>(uv.size()), text,
               [&](LineBuffer& buffer, Index v) { put_uv(buffer, uv[v]); });
}

/// The `vt` lines of a mesh with uv at its corners, and which of them each corner names.
struct CornerUv {
  std::vector<Index> star_begin, star_corner;  ///< corners of each vertex, those of one uv side by side
  std::vector<Index> line_begin;               ///< [V + 1] lines of each vertex
  std::vector<Index> line;                     ///< [3 T]
};

std::array<std::uint64_t, 2> bits(Vec2 z) {
  return {std::bit_cast<std::uint64_t>(z.x), std::bit_cast<std::uint64_t>(z.y)};
}

/// Calls body(corner, k) for the corners of a vertex in their order; k counts the different uv before.
template <class Body>
Index for_corners(const CornerUv& lines, In<Vec2> corner_uv, Index v, Body&& body) {
  Index k = 0;
  for (Index i = lines.star_begin[v]; i < lines.star_begin[v + 1]; ++i) {
    const Index c = lines.star_corner[i];
    const bool first = i == lines.star_begin[v];
    if (!first && bits(corner_uv[c]) != bits(corner_uv[lines.star_corner[i - 1]])) ++k;
    body(c, k);
  }
  return lines.star_begin[v] == lines.star_begin[v + 1] ? 0 : k + 1;
}

CornerUv share_uv(const Exec& exec, const Mesh& mesh, In<Vec2> corner_uv) {
  CornerUv lines;
  const In<Index> corner_vertex = mesh.corner_vertex;
  const auto num_corners = static_cast<Index>(corner_vertex.size());
  std::vector<Index> count(mesh.num_vertices(), 0);
  for (const Index v : corner_vertex) ++count[v];
  lines.star_begin = exclusive_scan(count);
  lines.star_corner.resize(num_corners);
  std::vector<Index> place(lines.star_begin.begin(), lines.star_begin.end() - 1);
  for (Index c = 0; c < num_corners; ++c) lines.star_corner[place[corner_vertex[c]]++] = c;
  exec.for_blocks(mesh.num_vertices(), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const auto star = Out<Index>(lines.star_corner).subspan(lines.star_begin[v], count[v]);
      std::ranges::sort(star, {}, [&](Index c) { return std::pair(bits(corner_uv[c]), c); });
      count[v] = for_corners(lines, corner_uv, v, [](Index, Index) {});
    }
  });
  lines.line_begin = exclusive_scan(count);
  lines.line.resize(num_corners);
  exec.for_blocks(mesh.num_vertices(), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      for_corners(lines, corner_uv, v, [&](Index c, Index k) { lines.line[c] = lines.line_begin[v] + k; });
    }
  });
  return lines;
}

void append_corner_uv(const Exec& exec, const CornerUv& lines, In<Vec2> corner_uv, std::string& text) {
  append_lines(exec, static_cast<Index>(lines.line_begin.size()) - 1, text, [&](LineBuffer& buffer, Index v) {
    Index next = 0;
    for_corners(lines, corner_uv, v, [&](Index c, Index k) {
      if (k != next) return;
      put_uv(buffer, corner_uv[c]);
      ++next;
    });
  });
}

/// uv: the `vt` line of each corner, or null.
void append_face(LineBuffer& buffer, const Index* corner, const Index* uv) {
  buffer.begin_line(7 * kNumberBytes);
  buffer.put('f');
  for (int i = 0; i < 3; ++i) {
    buffer.put(' ');
    buffer.put_number(Offset{corner[i]} + 1);
    if (uv == nullptr) continue;
    buffer.put('/');
    buffer.put_number(Offset{uv[i]} + 1);
  }
  buffer.put('\n');
}

/// Faces, each after the statements that come before it.
///   corner_line [3 T] or empty: the `vt` line of each corner
void append_faces(const Exec& exec, const Mesh& mesh, In<Index> corner_line, std::string& text) {
  const auto& statements = mesh.statements;
  append_lines(exec, mesh.num_triangles(), text, [&](LineBuffer& buffer, Index t) {
    auto next = std::ranges::lower_bound(statements, t, {}, &Statement::triangle);
    for (; next != statements.end() && next->triangle == t; ++next) {
      buffer.begin_line(next->text.size() + 1);
      buffer.put(next->text);
      buffer.put('\n');
    }
    const std::size_t c = std::size_t{3} * t;
    append_face(buffer, &mesh.corner_vertex[c], corner_line.empty() ? nullptr : &corner_line[c]);
  });
  auto last = std::ranges::lower_bound(statements, mesh.num_triangles(), {}, &Statement::triangle);
  for (; last != statements.end(); ++last) text += last->text + "\n";
}

/// A name as one word that no reader takes for anything else.
std::string as_word(std::string name) {
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= ' ' || byte == 0x7F || c == '#' || c == '\\') c = '_';
  }
  return name.empty() ? "_" : name;
}

/// The chains, each as a line in a group of its name.
void append_chains(const std::vector<Feature>& features, std::string& text) {
  for (const Feature& feature : features) {
    if (feature.is_region()) continue;
    text += "g " + as_word(feature.name) + "\nl";
    for (const Index v : feature.vertex) text += " " + std::to_string(Offset{v} + 1);
    if (feature.closed) text += " " + std::to_string(Offset{feature.vertex.front()} + 1);
    text += "\n";
  }
}

void warn_of_losses(const MeshOutput& output, const Colours& colours, std::vector<std::string>& warnings) {
  const Mesh& mesh = *output.mesh;
  const bool coloured = complete(colours);
  for (const Attribute& attribute : mesh.vertex_attributes) {
    if (coloured && std::ranges::count(colours, &attribute) > 0) continue;
    warnings.push_back("OBJ cannot hold the vertex property '" + attribute.name + "'; write PLY to keep it");
  }
  for (const Attribute& attribute : mesh.triangle_attributes) {
    warnings.push_back("OBJ cannot hold the face property '" + attribute.name + "'; write PLY to keep it");
  }
  for (const UvSet& set : mesh.uv_sets) {
    warnings.push_back("the input's parameterization '" + set.name +
                       "' is not kept in OBJ; write PLY to keep it");
  }
  if (output.features == nullptr) return;
  for (const Feature& feature : *output.features) {
    if (!feature.is_region()) continue;
    warnings.push_back("OBJ cannot hold the region '" + feature.name + "'; write PLY to keep it");
  }
}

}  // namespace

std::string format_obj(const Exec& exec, const MeshOutput& output, std::vector<std::string>& warnings) {
  const Mesh& mesh = *output.mesh;
  const Colours colours = {find_attribute(mesh, "red"), find_attribute(mesh, "green"),
                           find_attribute(mesh, "blue")};
  warn_of_losses(output, colours, warnings);
  std::string text;
  for (const std::string& comment : mesh.comments) text += "# " + comment + "\n";
  append_vertices(exec, mesh, colours, text);
  if (!output.corner_uv.empty()) {
    const CornerUv lines = share_uv(exec, mesh, output.corner_uv);
    append_corner_uv(exec, lines, output.corner_uv, text);
    append_faces(exec, mesh, lines.line, text);
  } else {
    append_uv(exec, output.uv, text);
    append_faces(exec, mesh, output.uv.empty() ? In<Index>{} : mesh.corner_vertex, text);
  }
  if (output.features != nullptr) append_chains(*output.features, text);
  return text;
}

}  // namespace planish
