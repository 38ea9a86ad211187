#include "io/rows.hpp"

#include <algorithm>
#include <atomic>

namespace planish {

const char* ElementRows::walk(const char* row, int property) const {
  for (int p = 0; p < property; ++p) {
    const Property& passed = element_->properties[p];
    Offset length = 1;
    if (passed.list_count) {
      length = load_integer(row, *passed.list_count, swapped_);
      row += byte_size(*passed.list_count);
    }
    row += length * static_cast<Offset>(byte_size(passed.scalar));
  }
  return row;
}

std::optional<Offset> ElementRows::common_length(int property) const {
  const Property& list = element_->properties[property];
  if (!row_begin_.empty() || count() == 0 || !list.list_count) return std::nullopt;
  return load_integer(value(0, property), *list.list_count, swapped_);
}

/// Walks over the body, element by element.
class RowLayout {
 public:
  RowLayout(const RowSource& source, std::string_view body)
      : source_(source), at_(body.data()), end_(at_ + body.size()) {}

  Result<ElementRows> next(const Exec& exec, const Element& element) {
    rows_ = ElementRows();
    rows_.element_ = &element;
    rows_.begin_ = at_;
    rows_.num_before_ = num_before_;
    rows_.swapped_ = source_.swapped && !source_.text;
    num_before_ += element.count;
    if (Offset least = least_row_size(); least > 0 && element.count > (end_ - at_) / least) {
      return fail(cut_off((end_ - at_) / least, end_));
    }
    if (element.count > 0 && !try_uniform(exec)) {
      if (auto fault = find_rows()) return fail(std::move(*fault));
    }
    return std::move(rows_);
  }

  /// Bytes that no element accounts for; line ends and zeros that some writers append are none.
  std::string_view left_over() const {
    const char* last = end_;
    while (last != at_ && (last[-1] == '\n' || last[-1] == '\r' || last[-1] == '\0')) --last;
    return {at_, static_cast<std::size_t>(last - at_)};
  }

 private:
  const Element& element() const { return *rows_.element_; }

  Offset least_row_size() const {
    Offset size = 0;
    for (const Property& p : element().properties)
      size += static_cast<Offset>(byte_size(p.list_count.value_or(p.scalar)));
    return size;
  }

  Error fault_at(ErrorCode code, std::string what, const char* at, Offset row) const {
    return {.code = code, .what = std::move(what), .place = place_of_row(source_, rows_, row, at)};
  }

  Error cut_off(Offset row, const char* at) const {
    return fault_at(ErrorCode::Truncated,
                    "row " + std::to_string(row) + " of the " + std::to_string(element().count) +
                        " of element '" + element().name + "' is not complete, the file ends at byte " +
                        std::to_string(source_.bytes.size()),
                    at, row);
  }

  /// Length of a list, or what is wrong with it.
  Result<Offset> list_length(const char* at, const Property& list, Offset row) const {
    const auto count_size = static_cast<Offset>(byte_size(*list.list_count));
    if (end_ - at < count_size) return fail(cut_off(row, at));
    const Offset length = load_integer(at, *list.list_count, rows_.swapped_);
    if (length < 0) {
      return fail(fault_at(ErrorCode::BadSyntax,
                           "the length of list '" + list.name + "' is " + std::to_string(length), at, row));
    }
    const Offset room = (end_ - at - count_size) / static_cast<Offset>(byte_size(list.scalar));
    if (length > room) {
      return fail(fault_at(ErrorCode::Truncated,
                           "list '" + list.name + "' of row " + std::to_string(row) + " of element '" +
                               element().name + "' has " + std::to_string(length) +
                               " values, the file has room for " + std::to_string(room),
                           at, row));
    }
    return length;
  }

  /// Size of the row at an address; the offsets of its properties are appended where they are wanted.
  Result<Offset> row_size(const char* begin, Offset row, std::vector<Offset>* offsets) const {
    const char* at = begin;
    for (const Property& property : element().properties) {
      if (offsets != nullptr) offsets->push_back(at - begin);
      Offset length = 1;
      if (property.list_count) {
        const auto found = list_length(at, property, row);
        if (!found) return fail(found.error());
        length = *found;
        at += byte_size(*property.list_count);
      }
      const Offset bytes = length * static_cast<Offset>(byte_size(property.scalar));
      if (bytes > end_ - at) return fail(cut_off(row, at));
      at += bytes;
    }
    return at - begin;
  }

  /// True when all rows look like the first one.
  bool try_uniform(const Exec& exec) {
    std::vector<Offset> offset;
    const auto size = row_size(at_, 0, &offset);
    if (!size || (*size > 0 && element().count > (end_ - at_) / *size)) return false;
    constexpr Offset kRows = 1 << 16;
    std::atomic<bool> same = true;
    const auto num_blocks = static_cast<Index>((element().count + kRows - 1) / kRows);
    for (std::size_t p = 0; p < offset.size(); ++p) {
      const Property& property = element().properties[p];
      if (!property.list_count) continue;
      const std::size_t bytes = byte_size(*property.list_count);
      const char* first = at_ + offset[p];
      exec.for_tasks(num_blocks, [&](Index k) {
        const Offset end = std::min((k + Offset{1}) * kRows, element().count);
        bool equal = true;
        for (Offset row = k * kRows; row < end; ++row)
          equal &= std::memcmp(first + row * *size, first, bytes) == 0;
        if (!equal) same = false;
      });
      if (!same) return false;
    }
    rows_.stride_ = *size;
    rows_.property_offset_ = std::move(offset);
    at_ += element().count * *size;
    return true;
  }

  /// Row by row, where lists have different lengths.
  std::optional<Error> find_rows() {
    rows_.row_begin_.reserve(element().count);
    for (Offset row = 0; row < element().count; ++row) {
      rows_.row_begin_.push_back(at_);
      const auto size = row_size(at_, row, nullptr);
      if (!size) return size.error();
      at_ += *size;
    }
    return std::nullopt;
  }

  const RowSource& source_;
  const char* at_;
  const char* end_;
  Offset num_before_ = 0;
  ElementRows rows_;
};

Result<std::vector<ElementRows>> lay_out_rows(const Exec& exec, const std::vector<Element>& elements,
                                              const RowSource& source, const BinaryRows& converted) {
  RowLayout layout(source, source.text ? std::string_view(converted.bytes) : source.body_bytes());
  std::vector<ElementRows> all;
  for (const Element& element : elements) {
    auto rows = layout.next(exec, element);
    if (!rows) return fail(std::move(rows.error()));
    all.push_back(std::move(*rows));
  }
  if (const std::string_view rest = layout.left_over(); !rest.empty() && !source.text) {
    return fail(Error{.code = ErrorCode::BadSyntax,
                      .what = std::to_string(rest.size()) + " bytes follow the last row the header announces",
                      .place = {.file = source.file, .byte = rest.data() - source.bytes.data()}});
  }
  return all;
}

}  // namespace planish
