#include "io/ply_header.hpp"

#include <array>
#include <optional>

namespace planish {
namespace {

struct TypeName {
  std::string_view name;
  Scalar scalar;
};
constexpr std::array kTypeNames = {TypeName{"char", Scalar::Int8},      TypeName{"int8", Scalar::Int8},
                                   TypeName{"uchar", Scalar::UInt8},    TypeName{"uint8", Scalar::UInt8},
                                   TypeName{"short", Scalar::Int16},    TypeName{"int16", Scalar::Int16},
                                   TypeName{"ushort", Scalar::UInt16},  TypeName{"uint16", Scalar::UInt16},
                                   TypeName{"int", Scalar::Int32},      TypeName{"int32", Scalar::Int32},
                                   TypeName{"uint", Scalar::UInt32},    TypeName{"uint32", Scalar::UInt32},
                                   TypeName{"float", Scalar::Float32},  TypeName{"float32", Scalar::Float32},
                                   TypeName{"double", Scalar::Float64}, TypeName{"float64", Scalar::Float64}};

std::optional<Scalar> type_named(std::string_view name) {
  for (const TypeName& type : kTypeNames) {
    if (type.name == name) return type.scalar;
  }
  return std::nullopt;
}

class PlyHeaderParser {
 public:
  PlyHeaderParser(std::string_view bytes, const std::string& file)
      : bytes_(bytes), file_(file), cursor_(bytes, {}) {}

  Result<PlyHeader> run() {
    if (!bytes_.starts_with("ply\n") && !bytes_.starts_with("ply\r\n")) {
      fault("expected the line 'ply', found " + quoted(bytes_, bytes_.data()));
      return fail(std::move(*fault_));
    }
    cursor_.next_line();
    while (!ended_ && !fault_) parse_line();
    if (!fault_ && !has_format_) fault("the header has no line 'format'");
    if (!fault_) check_rows();
    if (fault_) return fail(std::move(*fault_));
    header_.size = static_cast<std::size_t>(cursor_.position() - bytes_.data());
    return std::move(header_);
  }

 private:
  void fault(std::string what, ErrorCode code = ErrorCode::BadSyntax) {
    fault_ =
        Error{.code = code, .what = std::move(what), .place = place_in(bytes_, cursor_.position(), file_)};
  }
  void unexpected(const std::string& wanted) {
    cursor_.at_line_end();
    const bool cut_off = cursor_.at_end();
    fault("expected " + wanted + ", found " + quoted(bytes_, cursor_.position()),
          cut_off ? ErrorCode::Truncated : ErrorCode::BadSyntax);
  }

  void parse_line() {
    if (cursor_.at_line_end()) return cursor_.at_end() ? unexpected("'end_header'") : cursor_.next_line();
    const char* begin = cursor_.position();
    const std::string_view keyword = cursor_.token();
    if (keyword == "comment" || keyword == "obj_info") return keep_comment();
    if (keyword == "format") {
      parse_format();
    } else if (keyword == "element") {
      parse_element();
    } else if (keyword == "property") {
      parse_property();
    } else if (keyword == "end_header") {
      ended_ = true;
    } else {
      cursor_.move_to(begin);
      return unexpected("a line of a PLY header");
    }
    if (fault_) return;
    if (!cursor_.at_line_end()) return unexpected("the end of the line");
    if (cursor_.at_end()) return unexpected("a line end");
    cursor_.next_line();
  }

  void keep_comment() {
    std::string_view text = cursor_.rest_of_line();
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    header_.comments.emplace_back(text);
  }

  void parse_format() {
    cursor_.at_line_end();
    const char* begin = cursor_.position();
    const std::string_view format = cursor_.token();
    has_format_ = true;
    header_.text = format == "ascii";
    header_.swapped =
        format == (std::endian::native == std::endian::little ? "binary_big_endian" : "binary_little_endian");
    if (!header_.text && format != "binary_big_endian" && format != "binary_little_endian") {
      cursor_.move_to(begin);
      return unexpected("ascii, binary_little_endian or binary_big_endian");
    }
    if (cursor_.at_line_end() || cursor_.token() != "1.0") unexpected("version 1.0");
  }

  void parse_element() {
    Element element{.name = std::string(cursor_.token()), .count = 0, .properties = {}};
    if (element.name.empty()) return unexpected("the element's name");
    for (const Element& other : header_.elements) {
      if (other.name == element.name) return fault("element '" + element.name + "' is announced twice");
    }
    if (cursor_.at_line_end() || !cursor_.read_integer(element.count) || !cursor_.at_separator() ||
        element.count < 0) {
      return unexpected("the number of rows of element '" + element.name + "'");
    }
    header_.elements.push_back(std::move(element));
  }

  std::optional<Scalar> parse_type(bool integer) {
    cursor_.at_line_end();
    const char* begin = cursor_.position();
    const auto type = type_named(cursor_.token());
    if (type && !(integer && is_floating(*type))) return type;
    cursor_.move_to(begin);
    unexpected(integer ? "an integer type" : "a type");
    return std::nullopt;
  }

  void parse_property() {
    if (header_.elements.empty()) return fault("a property before the first element");
    Property property;
    cursor_.at_line_end();
    const char* begin = cursor_.position();
    if (cursor_.token() == "list") {
      property.list_count = parse_type(true);
    } else {
      cursor_.move_to(begin);
    }
    if (fault_) return;
    const auto type = parse_type(false);
    if (!type) return;
    property.scalar = *type;
    property.name = cursor_.token();
    if (property.name.empty()) return unexpected("the property's name");
    Element& element = header_.elements.back();
    for (const Property& other : element.properties) {
      if (other.name == property.name) {
        return fault("element '" + element.name + "' has two properties '" + property.name + "'");
      }
    }
    element.properties.push_back(std::move(property));
  }

  void check_rows() {
    for (const Element& element : header_.elements) {
      if (element.count > 0 && element.properties.empty())
        fault("element '" + element.name + "' has no properties");
    }
  }

  std::string_view bytes_;
  const std::string& file_;
  Cursor cursor_;
  PlyHeader header_;
  bool has_format_ = false, ended_ = false;
  std::optional<Error> fault_;
};

}  // namespace

Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& file) {
  return PlyHeaderParser(bytes, file).run();
}

}  // namespace planish
