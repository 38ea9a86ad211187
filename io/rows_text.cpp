#include <limits>

#include "io/line_chunks.hpp"
#include "io/rows.hpp"

namespace planish {
namespace {

struct RowFault {
  std::string what;
  const char* position = nullptr;
};

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// Turns the rows of one chunk of lines.
class RowConverter {
 public:
  RowConverter(const std::vector<Element>& elements, const RowSource& source)
      : elements_(elements), source_(source), rows_with_more_(elements.size(), 0) {}

  /// Rows from number `row` of the body on; stops at the last element's end.
  void run(std::string_view chunk, Offset row) {
    bytes_.reserve(chunk.size());
    std::size_t e = 0;
    for (Cursor cursor(chunk, source_.dialect); !cursor.at_end() && !fault_; cursor.next_line()) {
      if (cursor.at_line_end()) continue;
      while (e < elements_.size() && row >= elements_[e].count) row -= elements_[e++].count;
      if (e == elements_.size()) return;
      convert_row(cursor, e);
      ++row;
    }
  }

  const std::string& bytes() const { return bytes_; }
  const std::vector<Offset>& rows_with_more() const { return rows_with_more_; }
  const std::optional<RowFault>& fault() const { return fault_; }

 private:
  void convert_row(Cursor& cursor, std::size_t e) {
    for (const Property& property : elements_[e].properties) {
      Offset length = 1;
      if (property.list_count) {
        if (!convert_value(cursor, elements_[e], property, *property.list_count)) return;
        const std::size_t at = bytes_.size() - byte_size(*property.list_count);
        length = load_integer(bytes_.data() + at, *property.list_count, false);
        if (length < 0) return set_fault(cursor, "the length of list '" + property.name + "' is negative");
      }
      // A wrong length cannot run away: every value needs characters of this line.
      for (Offset i = 0; i < length; ++i) {
        if (!convert_value(cursor, elements_[e], property, property.scalar)) return;
      }
    }
    if (cursor.at_line_end()) return;
    if (!source_.more_on_a_row) {
      return set_fault(cursor,
                       "a row of element '" + elements_[e].name + "' has more numbers than properties");
    }
    ++rows_with_more_[e];
  }

  bool convert_value(Cursor& cursor, const Element& element, const Property& property, Scalar scalar) {
    const bool ended = cursor.at_line_end();
    const char* begin = cursor.position();
    const bool good = !ended && visit_scalar(scalar, [&]<class T>(T) { return convert_as<T>(cursor); });
    if (good && cursor.at_separator()) return true;
    cursor.move_to(begin);
    set_fault(cursor, "expected " + std::string(is_floating(scalar) ? "a number" : "an integer in range") +
                          " for '" + property.name + "' of element '" + element.name + "', found " +
                          quoted(source_.bytes, begin));
    return false;
  }

  template <class T>
  bool convert_as(Cursor& cursor) {
    if constexpr (std::same_as<T, float>) {
      float value = 0;
      if (!cursor.read_float(value)) return false;
      append(bytes_, value);
    } else if constexpr (std::same_as<T, double>) {
      double value = 0;
      if (!cursor.read_double(value)) return false;
      append(bytes_, value);
    } else {
      Offset value = 0;
      if (!cursor.read_integer(value)) return false;
      if (value < std::numeric_limits<T>::min() || value > std::numeric_limits<T>::max()) return false;
      append(bytes_, static_cast<T>(value));
    }
    return true;
  }

  void set_fault(const Cursor& cursor, std::string what) {
    fault_ = RowFault{.what = std::move(what), .position = cursor.position()};
  }

  const std::vector<Element>& elements_;
  const RowSource& source_;
  std::string bytes_;
  std::vector<Offset> rows_with_more_;
  std::optional<RowFault> fault_;
};

Failure failure_at(const RowSource& source, ErrorCode code, std::string what, const char* position) {
  return fail(
      Error{.code = code, .what = std::move(what), .place = place_in(source.bytes, position, source.file)});
}

/// Position of row number `row` of the body.
const char* find_row(const RowSource& source, Offset row) {
  Cursor cursor(source.body_bytes(), source.dialect);
  for (; !cursor.at_end(); cursor.next_line()) {
    if (!cursor.at_line_end() && row-- == 0) break;
  }
  return cursor.position();
}

Failure missing_rows(const std::vector<Element>& elements, const RowSource& source, Offset row) {
  std::size_t e = 0;
  while (row >= elements[e].count) row -= elements[e++].count;
  return failure_at(source, ErrorCode::Truncated,
                    "the file ends after " + std::to_string(row) + " of " +
                        std::to_string(elements[e].count) + " rows of element '" + elements[e].name + "'",
                    source.bytes.data() + source.bytes.size());
}

}  // namespace

Result<BinaryRows> binary_rows(const Exec& exec, const std::vector<Element>& elements,
                               const RowSource& source) {
  const auto chunks = line_chunks(source.body_bytes(), source.dialect);
  const std::vector<Offset> before = rows_before(exec, chunks, source.dialect);
  std::vector<RowConverter> converter(chunks.size(), RowConverter(elements, source));
  exec.for_tasks(static_cast<Index>(chunks.size()), [&](Index k) { converter[k].run(chunks[k], before[k]); });
  for (const RowConverter& c : converter) {
    if (!c.fault()) continue;
    const bool cut_off = c.fault()->position == source.bytes.data() + source.bytes.size();
    return failure_at(source, cut_off ? ErrorCode::Truncated : ErrorCode::BadSyntax, c.fault()->what,
                      c.fault()->position);
  }
  Offset wanted = 0;
  for (const Element& element : elements) {
    wanted += element.count;
    if (wanted > before.back()) return missing_rows(elements, source, before.back());
  }
  if (wanted < before.back()) {
    return failure_at(source, ErrorCode::BadSyntax, "the header announces no more rows here",
                      find_row(source, wanted));
  }
  BinaryRows rows{.bytes = {}, .rows_with_more = std::vector<Offset>(elements.size(), 0)};
  std::size_t size = 0;
  for (const RowConverter& c : converter) size += c.bytes().size();
  rows.bytes.reserve(size);
  for (const RowConverter& c : converter) {
    rows.bytes += c.bytes();
    for (std::size_t e = 0; e < elements.size(); ++e) rows.rows_with_more[e] += c.rows_with_more()[e];
  }
  return rows;
}

Place place_of_row(const RowSource& source, const ElementRows& rows, Offset row, const char* at) {
  if (source.text) return place_in(source.bytes, find_row(source, rows.num_before() + row), source.file);
  return {.file = source.file, .byte = at - source.bytes.data()};
}

}  // namespace planish
