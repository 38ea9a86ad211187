#include "io/obj_chunk.hpp"

#include <algorithm>
#include <limits>

#include "io/polygons.hpp"

namespace planish {
namespace {

class ObjParser {
 public:
  explicit ObjParser(std::string_view text) : text_(text), cursor_(text, kObjDialect) {
    // A vertex or face line has seldom fewer than 20 bytes; what is not used is never touched.
    chunk_.position.reserve(text.size() / 20);
    chunk_.corner_vertex.value.reserve(text.size() / 8);
  }

  ObjChunk run() {
    while (!cursor_.at_end() && !chunk_.fault) {
      if (!cursor_.at_line_end()) parse_line();
      if (!chunk_.fault) cursor_.next_line();
    }
    return std::move(chunk_);
  }

 private:
  void parse_line() {
    const char* begin = cursor_.position();
    const std::string_view keyword = cursor_.token();
    if (keyword == "v") {
      parse_vertex();
    } else if (keyword == "f") {
      parse_face();
    } else if (keyword == "vt") {
      parse_uv();
    } else if (keyword == "vn") {
      ++chunk_.normals;
    } else if (keyword == "g" || keyword == "o" || keyword == "s" || keyword == "usemtl" ||
               keyword == "mtllib") {
      cursor_.move_to(begin);
      keep_statement();
    }
  }

  void fault(std::string what) { fault(std::move(what), cursor_.position()); }
  void fault(std::string what, const char* position) {
    chunk_.fault = ObjFault{.what = std::move(what), .position = position};
  }

  /// Reads up to `most` numbers to the line's end; the number of them, or -1 after a fault.
  int parse_numbers(double* value, int least, int most, const char* what) {
    int count = 0;
    for (; !cursor_.at_line_end(); ++count) {
      const char* begin = cursor_.position();
      if (count == most) {
        fault(std::string("more numbers than ") + what + " has", begin);
        return -1;
      }
      if (!cursor_.read_double(value[count]) || !cursor_.at_separator()) {
        fault("expected a number of " + std::string(what) + ", found " + quoted(text_, begin), begin);
        return -1;
      }
    }
    if (count >= least) return count;
    fault(std::string(what) + " needs " + std::to_string(least) + " numbers, found " + std::to_string(count));
    return -1;
  }

  /// x y z, then nothing, a weight (not used), a colour, or a colour with its opacity (not used).
  void parse_vertex() {
    double value[7];
    const int count = parse_numbers(value, 3, 7, "a vertex");
    if (count < 0) return;
    if (count == 5) return fault("a vertex has 3, 4, 6 or 7 numbers, found 5");
    chunk_.position.push_back({value[0], value[1], value[2]});
    if (count >= 6) chunk_.colour.push_back({value[3], value[4], value[5]});
  }

  void parse_uv() {
    double value[3] = {0, 0, 0};
    if (parse_numbers(value, 1, 3, "a texture coordinate") > 0) chunk_.uv.push_back({value[0], value[1]});
  }

  void parse_face() {
    const char* begin = cursor_.position();
    const std::size_t first = chunk_.corner_vertex.value.size();
    while (!cursor_.at_line_end()) {
      if (!parse_corner()) return;
    }
    const std::size_t end = chunk_.corner_vertex.value.size();
    if (const Offset n = static_cast<Offset>(end - first); n != 3) {
      if (std::string why = unusable_face(n); !why.empty()) return fault(std::move(why), begin);
    }
    chunk_.face_end.push_back(static_cast<Index>(end));
  }

  /// v, v/vt, v//vn or v/vt/vn; fields after the first may be empty.
  bool parse_corner() {
    const char* begin = cursor_.position();
    Offset vertex = 0, uv = 0, normal = 0;
    bool good = cursor_.read_integer(vertex);
    bool has_uv = false;
    if (good && skip_slash()) {
      has_uv = cursor_.read_integer(uv);
      if (skip_slash()) cursor_.read_integer(normal);
    }
    if (!good || !cursor_.at_separator()) {
      fault("expected a face corner (v, v/vt, v//vn or v/vt/vn), found " + quoted(text_, begin), begin);
      return false;
    }
    append(chunk_.corner_vertex, vertex, chunk_.position.size());
    if (has_uv) append_uv(uv);
    return true;
  }

  bool skip_slash() {
    const char* at = cursor_.position();
    if (cursor_.at_end() || *at != '/') return false;
    cursor_.move_to(at + 1);
    return true;
  }

  static void append(ObjIndices& indices, Offset named, std::size_t num_defined) {
    constexpr Offset kLowest = ObjIndices::kNeverInRange, kHighest = std::numeric_limits<Index>::max();
    if (named < 0) {
      indices.relative.push_back(static_cast<Index>(indices.value.size()));
      named += static_cast<Offset>(num_defined);
    } else {
      named = named == 0 ? kLowest : named - 1;
    }
    indices.value.push_back(static_cast<Index>(std::clamp(named, kLowest, kHighest)));
  }

  /// corner_uv stays empty in files without uv; corners passed over get kNone.
  void append_uv(Offset named) {
    if (chunk_.corner_uv.value.empty()) chunk_.corner_uv.value.reserve(chunk_.corner_vertex.value.capacity());
    chunk_.corner_uv.value.resize(chunk_.corner_vertex.value.size() - 1, kNone);
    append(chunk_.corner_uv, named, chunk_.uv.size());
    ++chunk_.corners_with_uv;
  }

  void keep_statement() {
    const char* begin = cursor_.position();
    const std::string_view text = cursor_.rest_of_line();
    chunk_.statements.push_back({.text = text,
                                 .corners_before = static_cast<Index>(chunk_.corner_vertex.value.size()),
                                 .faces_before = static_cast<Index>(chunk_.face_end.size())});
    cursor_.move_to(begin);  // run() moves on
  }

  std::string_view text_;
  Cursor cursor_;
  ObjChunk chunk_;
};

}  // namespace

ObjChunk parse_obj_chunk(std::string_view text) { return ObjParser(text).run(); }

const char* find_obj_index(std::string_view text, Index corner, bool of_uv) {
  for (Cursor cursor(text, kObjDialect); !cursor.at_end(); cursor.next_line()) {
    if (cursor.token() != "f") continue;
    while (!cursor.at_line_end()) {
      const std::string_view token = cursor.token();
      if (corner-- > 0) continue;
      return of_uv ? token.data() + token.find('/') + 1 : token.data();
    }
  }
  return text.data();
}

}  // namespace planish
