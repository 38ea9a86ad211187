#include "io/feature_files.hpp"

#include <cmath>
#include <new>

#include "io/cursor.hpp"
#include "io/file.hpp"

namespace planish {
namespace {

constexpr Dialect kCsvDialect{.comments = true, .continued_lines = false};

/// One point a line.
class CsvParser {
 public:
  CsvParser(std::string_view text, const std::string& file)
      : text_(text), file_(file), cursor_(text, kCsvDialect) {}

  Result<PolylineSource> run() {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text_.starts_with(kByteOrderMark)) cursor_.move_to(text_.data() + kByteOrderMark.size());
    skip_header();
    for (; !cursor_.at_end() && !fault_; cursor_.next_line()) {
      if (!cursor_.at_line_end()) parse_point();
    }
    if (!fault_ && polyline_.point.empty()) fault("expected a point, found the end of the file");
    if (!fault_) close();
    if (fault_) return fail(std::move(*fault_));
    return std::move(polyline_);
  }

 private:
  void fault(std::string what) { fault(std::move(what), cursor_.position()); }
  void fault(std::string what, const char* position) {
    fault_ = Error{
        .code = ErrorCode::BadSyntax, .what = std::move(what), .place = place_in(text_, position, file_)};
  }

  /// The first line with content, where it does not begin with a number.
  void skip_header() {
    while (!cursor_.at_end() && cursor_.at_line_end()) cursor_.next_line();
    const char* begin = cursor_.position();
    double ignored = 0;
    const bool number = cursor_.read_double(ignored) && at_field_end();
    cursor_.move_to(begin);
    if (!number) cursor_.next_line();
  }

  bool at_field_end() const {
    return cursor_.at_separator() || *cursor_.position() == ',' || *cursor_.position() == ';' ||
           *cursor_.position() == '#';
  }

  /// Blanks around no more than one comma or semicolon.
  void skip_separator() {
    if (cursor_.at_line_end()) return;
    const char* at = cursor_.position();
    if (*at != ',' && *at != ';') return;
    cursor_.move_to(at + 1);
    cursor_.at_line_end();
  }

  void parse_point() {
    const char* line = cursor_.position();
    double value[3] = {0, 0, 0};
    for (int i = 0; i < 3; ++i) {
      if (i > 0) skip_separator();
      const char* begin = cursor_.position();
      if (!cursor_.read_double(value[i]) || !at_field_end()) {
        return fault("expected three numbers of a point, number " + std::to_string(i + 1) + " is " +
                         quoted(text_, begin),
                     begin);
      }
      if (!std::isfinite(value[i])) return fault("a coordinate is not a finite number", begin);
    }
    if (!cursor_.at_line_end()) {
      return fault(
          "expected the end of the line after three numbers (with a decimal point, not a comma), found " +
          quoted(text_, cursor_.position()));
    }
    polyline_.point.push_back({value[0], value[1], value[2]});
    last_line_ = line;
  }

  void close() {
    std::vector<Vec3>& point = polyline_.point;
    polyline_.closed = point.size() > 1 && point.front() == point.back();
    if (!polyline_.closed) return;
    point.pop_back();
    if (point.size() < 3)
      fault("a closed polyline needs three points, this one ends where it began", last_line_);
  }

  std::string_view text_;
  const std::string& file_;
  Cursor cursor_;
  PolylineSource polyline_;
  const char* last_line_ = nullptr;
  std::optional<Error> fault_;
};

using Parser = Result<PolylineSource> (*)(const Exec&, std::string_view, const std::string&);

Parser parser_of(const std::string& path) {
  const std::string extension = format_of(path);
  if (extension == "ply") return parse_polyline_ply;
  if (extension == "obj") {
    return [](const Exec&, std::string_view text, const std::string& file) {
      return parse_polyline_obj(text, file);
    };
  }
  if (extension == "csv" || extension == "txt" || extension == "xyz") {
    return [](const Exec&, std::string_view text, const std::string& file) {
      return parse_polyline_csv(text, file);
    };
  }
  return nullptr;
}

}  // namespace

Result<PolylineSource> parse_polyline_csv(std::string_view text, const std::string& file) {
  return CsvParser(text, file).run();
}

Result<PolylineSource> read_feature_file(const Exec& exec, const std::string& path) try {
  const Parser parse = parser_of(path);
  if (parse == nullptr) {
    return fail(Error{.code = ErrorCode::BadSyntax,
                      .what = "polylines are read from .obj, .ply, .csv, .txt and .xyz files",
                      .place = {.file = path}});
  }
  const auto bytes = FileBytes::open(path, exec);
  if (!bytes) return fail(bytes.error());
  return parse(exec, bytes->view(), path);
} catch (const std::bad_alloc&) {
  return fail(
      Error{.code = ErrorCode::OutOfMemory, .what = "no memory for the polyline", .place = {.file = path}});
}

}  // namespace planish
