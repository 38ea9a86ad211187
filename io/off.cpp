#include <algorithm>

#include "io/mesh_files.hpp"
#include "io/rows_mesh.hpp"

namespace planish {
namespace {

constexpr Dialect kOffDialect{.comments = true, .continued_lines = false};

struct OffHeader {
  bool colours = false, normals = false;
  Offset vertices = 0, faces = 0;
  std::size_t size = 0;  ///< bytes up to the first row
};

class OffHeaderParser {
 public:
  OffHeaderParser(std::string_view bytes, const std::string& file)
      : bytes_(bytes), file_(file), cursor_(bytes, kOffDialect) {}

  Result<OffHeader> run() {
    OffHeader header;
    if (!find_content()) return unexpected("the word OFF");
    const char* begin = cursor_.position();
    std::string_view word = cursor_.token();
    const auto skip = [&](std::string_view prefix) {
      const bool found = word.starts_with(prefix);
      if (found) word.remove_prefix(prefix.size());
      return found;
    };
    header.colours = skip("C");
    header.normals = skip("N");
    if (word != "OFF") {
      cursor_.move_to(begin);
      return unexpected("the word OFF, COFF, NOFF or CNOFF");
    }
    for (Offset* count : {&header.vertices, &header.faces}) {
      if (!find_content() || !cursor_.read_integer(*count) || !cursor_.at_separator() || *count < 0) {
        return unexpected(count == &header.vertices ? "the number of vertices" : "the number of faces");
      }
    }
    Offset edges = 0;  // often 0 or missing; never used
    if (!cursor_.at_line_end() && (!cursor_.read_integer(edges) || !cursor_.at_separator())) {
      return unexpected("the number of edges");
    }
    if (!cursor_.at_line_end()) return unexpected("the end of the line");
    cursor_.next_line();
    header.size = static_cast<std::size_t>(cursor_.position() - bytes_.data());
    return header;
  }

  /// Numbers of the first row after the header.
  static int count_numbers(std::string_view body) {
    Cursor cursor(body, kOffDialect);
    while (!cursor.at_end() && cursor.at_line_end()) cursor.next_line();
    int count = 0;
    while (!cursor.token().empty()) ++count;
    return count;
  }

 private:
  /// Moves over line ends and comments.
  bool find_content() {
    while (cursor_.at_line_end()) {
      if (cursor_.at_end()) return false;
      cursor_.next_line();
    }
    return true;
  }

  Failure unexpected(const std::string& wanted) const {
    return fail(Error{.code = cursor_.at_end() ? ErrorCode::Truncated : ErrorCode::BadSyntax,
                      .what = "expected " + wanted + ", found " + quoted(bytes_, cursor_.position()),
                      .place = place_in(bytes_, cursor_.position(), file_)});
  }

  std::string_view bytes_;
  const std::string& file_;
  Cursor cursor_;
};

std::vector<Element> elements_of(const OffHeader& header, int first_row_numbers) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (header.normals) names.insert(names.end(), {"nx", "ny", "nz"});
  if (header.colours) {
    const bool alpha = first_row_numbers >= static_cast<int>(names.size()) + 4;
    names.insert(names.end(), {"red", "green", "blue"});
    if (alpha) names.push_back("alpha");
  }
  Element vertex{.name = "vertex", .count = header.vertices, .properties = {}};
  for (std::string& name : names) {
    vertex.properties.push_back({.name = std::move(name), .scalar = Scalar::Float64, .list_count = {}});
  }
  Element face{.name = "face", .count = header.faces, .properties = {}};
  face.properties.push_back({.name = "vertex_indices", .scalar = Scalar::Int32, .list_count = Scalar::Int32});
  return {std::move(vertex), std::move(face)};
}

bool is_colour(const Attribute& attribute) {
  return attribute.name == "red" || attribute.name == "green" || attribute.name == "blue" ||
         attribute.name == "alpha";
}

/// Colours written as 0 to 255 become bytes, as other formats have them; fractions stay.
void narrow_colours(Mesh& mesh) {
  const auto value = [](const Attribute& attribute, std::size_t v) {
    return load<double>(reinterpret_cast<const char*>(attribute.values.data()) + v * sizeof(double), false);
  };
  for (const Attribute& attribute : mesh.vertex_attributes) {
    for (std::size_t v = 0; is_colour(attribute) && v < mesh.position.size(); ++v) {
      const double number = value(attribute, v);
      if (!(number >= 0 && number <= 255) || number != std::floor(number)) return;
    }
  }
  for (Attribute& attribute : mesh.vertex_attributes) {
    if (!is_colour(attribute)) continue;
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
      attribute.values[v] = static_cast<std::byte>(static_cast<unsigned char>(value(attribute, v)));
    }
    attribute.values.resize(mesh.position.size());
    attribute.scalar = Scalar::UInt8;
  }
}

}  // namespace

Result<Mesh> read_off(const Exec& exec, std::string_view bytes, const std::string& file) {
  const auto header = OffHeaderParser(bytes, file).run();
  if (!header) return fail(header.error());
  const RowSource source{.file = file,
                         .bytes = bytes,
                         .body = header->size,
                         .text = true,
                         .dialect = kOffDialect,
                         .more_on_a_row = true};  // colours of faces
  const auto elements = elements_of(*header, OffHeaderParser::count_numbers(source.body_bytes()));
  const auto converted = binary_rows(exec, elements, source);
  if (!converted) return fail(converted.error());
  const auto rows = lay_out_rows(exec, elements, source, *converted);
  if (!rows) return fail(rows.error());
  auto mesh = mesh_of_rows(exec, source, *rows);
  if (!mesh) return mesh;
  if (header->colours) narrow_colours(*mesh);
  if (converted->rows_with_more[0] > 0) {
    mesh->warnings.push_back("numbers after the coordinates of " +
                             std::to_string(converted->rows_with_more[0]) + " vertices are left out");
  }
  return mesh;
}

}  // namespace planish
