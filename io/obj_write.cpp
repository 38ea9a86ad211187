#include <algorithm>
#include <array>
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

void append_uv(const Exec& exec, In<Vec2> uv, std::string& text) {
  append_lines(exec, static_cast<Index>(uv.size()), text, [&](LineBuffer& buffer, Index v) {
    buffer.begin_line(3 * kNumberBytes);
    buffer.put("vt ");
    buffer.put_number(uv[v].x);
    buffer.put(' ');
    buffer.put_number(uv[v].y);
    buffer.put('\n');
  });
}

void append_face(LineBuffer& buffer, const Index* corner, bool with_uv) {
  buffer.begin_line(7 * kNumberBytes);
  buffer.put('f');
  for (int i = 0; i < 3; ++i) {
    buffer.put(' ');
    buffer.put_number(Offset{corner[i]} + 1);
    if (!with_uv) continue;
    buffer.put('/');
    buffer.put_number(Offset{corner[i]} + 1);
  }
  buffer.put('\n');
}

/// Faces, each after the statements that come before it.
void append_faces(const Exec& exec, const Mesh& mesh, bool with_uv, std::string& text) {
  const auto& statements = mesh.statements;
  append_lines(exec, mesh.num_triangles(), text, [&](LineBuffer& buffer, Index t) {
    auto next = std::ranges::lower_bound(statements, t, {}, &Statement::triangle);
    for (; next != statements.end() && next->triangle == t; ++next) {
      buffer.begin_line(next->text.size() + 1);
      buffer.put(next->text);
      buffer.put('\n');
    }
    append_face(buffer, &mesh.corner_vertex[std::size_t{3} * t], with_uv);
  });
  auto last = std::ranges::lower_bound(statements, mesh.num_triangles(), {}, &Statement::triangle);
  for (; last != statements.end(); ++last) text += last->text + "\n";
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
  append_uv(exec, output.uv, text);
  append_faces(exec, mesh, !output.uv.empty(), text);
  return text;
}

}  // namespace planish
