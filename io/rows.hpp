// Files made of elements with typed properties (PLY, and OFF seen as such): what their rows are, where they
// lie, and how to read a column of them. Rows given as text are turned into binary ones first, so that there
// is one decoder.
#pragma once

#include <bit>
#include <concepts>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "io/cursor.hpp"

namespace planish {

struct Property {
  std::string name;
  Scalar scalar = Scalar::Float32;
  std::optional<Scalar> list_count;  ///< type of a list's length; none: a plain scalar
};

struct Element {
  std::string name;
  Offset count = 0;
  std::vector<Property> properties;
};

/// Where rows come from, to say where they are wrong.
struct RowSource {
  const std::string& file;
  std::string_view bytes;      ///< the whole file
  std::size_t body = 0;        ///< where the rows begin
  bool text = false;           ///< one row a line
  bool swapped = false;        ///< binary, in the other byte order
  Dialect dialect = {};        ///< of text
  bool more_on_a_row = false;  ///< text: numbers after the last property are passed over
  std::string_view body_bytes() const { return bytes.substr(body); }
};

/// Binary rows of text ones, native byte order.
struct BinaryRows {
  std::string bytes;
  std::vector<Offset> rows_with_more;  ///< per element, rows with numbers after the last property
};

/// Fails: Truncated, BadSyntax with line and column.
Result<BinaryRows> binary_rows(const Exec& exec, const std::vector<Element>& elements,
                               const RowSource& source);

/// The rows of one element.
class ElementRows {
 public:
  const Element& element() const { return *element_; }
  Offset count() const { return element_->count; }
  Offset num_before() const { return num_before_; }
  bool swapped() const { return swapped_; }

  /// First byte of a property's value; of a list, of its length.
  const char* value(Offset row, int property) const {
    if (row_begin_.empty()) return begin_ + row * stride_ + property_offset_[property];
    return walk(row_begin_[row], property);
  }
  /// Length of a list that is the same in all rows; none where it varies.
  std::optional<Offset> common_length(int property) const;
  /// Bytes from row to row where that is always the same, else 0.
  Offset stride() const { return row_begin_.empty() ? stride_ : 0; }

 private:
  friend class RowLayout;
  const char* walk(const char* row, int property) const;

  const Element* element_ = nullptr;
  const char* begin_ = nullptr;
  Offset num_before_ = 0;  ///< rows of the elements before
  Offset stride_ = 0;
  std::vector<Offset> property_offset_;
  std::vector<const char*> row_begin_;
  bool swapped_ = false;
};

/// Finds every element's rows and checks that they are all there and nothing follows.
/// Fails: Truncated, BadSyntax (negative or unusable list lengths), with the byte.
/// Cost: one pass over the lengths of lists, in parallel where all rows have the same.
Result<std::vector<ElementRows>> lay_out_rows(const Exec& exec, const std::vector<Element>& elements,
                                              const RowSource& source, const BinaryRows& converted);

/// Place of a row: its line in text, else the byte of `at`.
Place place_of_row(const RowSource& source, const ElementRows& rows, Offset row, const char* at);

/// Calls f with a value of the C++ type of a scalar, e.g. f(float{}).
template <class F>
decltype(auto) visit_scalar(Scalar scalar, F&& f) {
  switch (scalar) {
    case Scalar::Int8: return f(std::int8_t{});
    case Scalar::UInt8: return f(std::uint8_t{});
    case Scalar::Int16: return f(std::int16_t{});
    case Scalar::UInt16: return f(std::uint16_t{});
    case Scalar::Int32: return f(std::int32_t{});
    case Scalar::UInt32: return f(std::uint32_t{});
    case Scalar::Float32: return f(float{});
    case Scalar::Float64: break;
  }
  return f(double{});
}

inline bool is_floating(Scalar scalar) { return scalar == Scalar::Float32 || scalar == Scalar::Float64; }

/// The value at an address of any alignment.
template <class T>
T load(const char* at, bool swapped) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, at, sizeof(T));
  if (swapped) {
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  }
  return std::bit_cast<T>(bytes);
}

/// A list's length, or any integer. Unsigned 32-bit values stay positive.
inline Offset load_integer(const char* at, Scalar scalar, bool swapped) {
  return visit_scalar(scalar, [&]<class T>(T) { return static_cast<Offset>(load<T>(at, swapped)); });
}

}  // namespace planish
