#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "io/cursor.hpp"
#include "io/mesh_files.hpp"
#include "io/rows.hpp"
#include "io/weld.hpp"

namespace planish {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;

/// The words of STL are written in any case; `word` is in lower case.
bool is_word(std::string_view token, std::string_view word) {
  return std::ranges::equal(token, word,
                            [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

/// Word after word over line ends.
class StlCursor {
 public:
  explicit StlCursor(std::string_view text) : cursor_(text, {}) {}

  std::string_view next() {
    cursor_.skip_space();
    return cursor_.token();
  }
  /// True and past it when the next word is `word`; else nothing moved.
  bool take(std::string_view word) {
    cursor_.skip_space();
    const char* begin = cursor_.position();
    if (is_word(cursor_.token(), word)) return true;
    cursor_.move_to(begin);
    return false;
  }
  bool read_number(double& value) {
    cursor_.skip_space();
    const char* begin = cursor_.position();
    if (cursor_.read_double(value) && cursor_.at_separator()) return true;
    cursor_.move_to(begin);
    return false;
  }
  void next_line() { cursor_.next_line(); }
  const char* position() const { return cursor_.position(); }
  bool at_end() {
    cursor_.skip_space();
    return cursor_.at_end();
  }

 private:
  Cursor cursor_;
};

Failure failure(ErrorCode code, std::string what, Place place) {
  return fail(Error{.code = code, .what = std::move(what), .place = std::move(place)});
}

std::optional<Error> too_many(std::size_t num_triangles, const std::string& file) {
  if (num_triangles < std::numeric_limits<Index>::max() / 3) return std::nullopt;
  return Error{.code = ErrorCode::TooLarge,
               .what = std::to_string(num_triangles) + " triangles are more than 32-bit indices can count",
               .place = {.file = file}};
}

Mesh mesh_of(Welded welded) {
  Mesh mesh;
  mesh.position = std::move(welded.position);
  mesh.corner_vertex = std::move(welded.corner_vertex);
  return mesh;
}

std::size_t announced_triangles(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + 80, std::endian::native == std::endian::big);
}

/// "solid" alone does not tell: binary files may begin so too.
bool is_text(std::string_view bytes) {
  if (bytes.size() >= kHeaderBytes &&
      bytes.size() == kHeaderBytes + kTriangleBytes * announced_triangles(bytes)) {
    return false;
  }
  StlCursor cursor(bytes);
  if (!cursor.take("solid")) return false;
  if (bytes.substr(0, kHeaderBytes).find('\0') != std::string_view::npos) return false;
  cursor.next_line();
  return cursor.at_end() || cursor.take("facet") || cursor.take("endsolid") || bytes.size() < kHeaderBytes;
}

Result<Mesh> read_binary(const Exec& exec, std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderBytes) {
    return failure(ErrorCode::Truncated,
                   "a binary STL file begins with " + std::to_string(kHeaderBytes) + " bytes, the file has " +
                       std::to_string(bytes.size()),
                   {.file = file, .byte = static_cast<Offset>(bytes.size())});
  }
  const std::size_t count = announced_triangles(bytes);
  const std::size_t wanted = kHeaderBytes + kTriangleBytes * count;
  if (bytes.size() < wanted) {
    return failure(ErrorCode::Truncated,
                   std::to_string(count) + " triangles need " + std::to_string(wanted) +
                       " bytes, the file has " + std::to_string(bytes.size()),
                   {.file = file, .byte = static_cast<Offset>(bytes.size())});
  }
  if (auto error = too_many(count, file)) return fail(std::move(*error));
  const char* triangles = bytes.data() + kHeaderBytes;
  const auto position_of = [&](Index corner) {
    const char* at = triangles + kTriangleBytes * static_cast<std::size_t>(corner / 3) + 12 +
                     12 * static_cast<std::size_t>(corner % 3);
    constexpr bool kSwapped = std::endian::native == std::endian::big;
    return Vec3{load<float>(at, kSwapped), load<float>(at + 4, kSwapped), load<float>(at + 8, kSwapped)};
  };
  Mesh mesh = mesh_of(weld(exec, static_cast<Index>(3 * count), position_of));
  if (bytes.size() > wanted) {
    mesh.warnings.push_back(std::to_string(bytes.size() - wanted) +
                            " bytes after the last triangle are left out");
  }
  return mesh;
}

/// Facets of a run of text that begins and ends between facets or solids.
class StlTextParser {
 public:
  StlTextParser(std::string_view text, bool in_solid) : cursor_(text), in_solid_(in_solid) {}

  void run() {
    while (!expected_ && !cursor_.at_end()) {
      if (!in_solid_) {
        begin_solid();
      } else if (cursor_.take("endsolid")) {
        cursor_.next_line();  // the rest is the solid's name
        in_solid_ = false;
      } else {
        parse_facet();
      }
    }
  }

  bool in_solid() const { return in_solid_; }
  const std::vector<Vec3>& corners() const { return corners_; }
  /// What should have stood at position(), or none.
  const std::optional<std::string>& expected() const { return expected_; }
  const char* position() const { return cursor_.position(); }

 private:
  void begin_solid() {
    if (!expect("solid")) return;
    cursor_.next_line();
    in_solid_ = true;
  }

  bool expect(const char* word) {
    if (!cursor_.take(word)) expected_ = std::string("'") + word + "'";
    return !expected_;
  }

  void parse_facet() {
    if (!cursor_.take("facet")) {
      expected_ = "'facet' or 'endsolid'";
      return;
    }
    if (!expect("normal")) return;
    for (int i = 0; i < 3; ++i) cursor_.next();  // not used, and some writers put no number there
    if (!expect("outer") || !expect("loop")) return;
    for (int i = 0; i < 3; ++i) {
      if (!expect("vertex") || !parse_position()) return;
    }
    if (expect("endloop")) expect("endfacet");
  }

  bool parse_position() {
    Vec3 p;
    for (double* coordinate : {&p.x, &p.y, &p.z}) {
      if (cursor_.read_number(*coordinate)) continue;
      expected_ = "a coordinate";
      return false;
    }
    corners_.push_back(p);
    return true;
  }

  StlCursor cursor_;
  bool in_solid_;
  std::vector<Vec3> corners_;
  std::optional<std::string> expected_;
};

/// Cuts text before lines that begin with "facet", about every `chunk_bytes`.
std::vector<std::string_view> facet_chunks(std::string_view text, std::size_t chunk_bytes) {
  std::vector<std::string_view> chunks;
  while (!text.empty()) {
    std::size_t size = text.size();
    if (size > chunk_bytes) {
      Cursor cursor(text, {});
      cursor.move_to(text.data() + chunk_bytes);
      cursor.next_line();
      while (!cursor.at_end()) {
        const char* line = cursor.position();
        if (is_word(cursor.token(), "facet")) {
          size = static_cast<std::size_t>(line - text.data());
          break;
        }
        cursor.next_line();
      }
    }
    chunks.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return chunks;
}

Result<Mesh> read_text(const Exec& exec, std::string_view bytes, const std::string& file) {
  constexpr std::size_t kChunk = std::size_t{1} << 18;
  std::vector<StlTextParser> parser;
  for (const std::string_view chunk : facet_chunks(bytes, kChunk))
    parser.emplace_back(chunk, !parser.empty());
  exec.for_tasks(static_cast<Index>(parser.size()), [&](Index k) { parser[k].run(); });
  std::size_t num_corners = 0;
  std::vector<Index> begin;
  for (std::size_t k = 0; k < parser.size(); ++k) {
    std::optional<std::string> expected = parser[k].expected();
    const bool last = k + 1 == parser.size();
    if (!expected && parser[k].in_solid() == last) expected = last ? "'facet' or 'endsolid'" : "'solid'";
    if (expected) {
      const char* position = parser[k].position();
      const bool cut_off = position == bytes.data() + bytes.size();
      return failure(cut_off ? ErrorCode::Truncated : ErrorCode::BadSyntax,
                     "expected " + *expected + ", found " + quoted(bytes, position),
                     place_in(bytes, position, file));
    }
    if (auto error = too_many(num_corners / 3, file)) return fail(std::move(*error));
    begin.push_back(static_cast<Index>(num_corners));
    num_corners += parser[k].corners().size();
  }
  if (auto error = too_many(num_corners / 3, file)) return fail(std::move(*error));
  std::vector<Vec3> corner(num_corners);
  exec.for_tasks(static_cast<Index>(parser.size()),
                 [&](Index k) { std::ranges::copy(parser[k].corners(), corner.begin() + begin[k]); });
  return mesh_of(weld(exec, static_cast<Index>(num_corners), [&](Index c) { return corner[c]; }));
}

}  // namespace

Result<Mesh> read_stl(const Exec& exec, std::string_view bytes, const std::string& file) {
  return is_text(bytes) ? read_text(exec, bytes, file) : read_binary(exec, bytes, file);
}

}  // namespace planish
