#include "io/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planish {
namespace {

/// Optimal string alignment distance; only the first kLongest characters count.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t kLongest = 64;
  a = a.substr(0, kLongest);
  b = b.substr(0, kLongest);
  std::array<std::array<std::size_t, kLongest + 1>, 3> rows{};
  auto *before = &rows[0], *above = &rows[1], *row = &rows[2];
  for (std::size_t j = 0; j <= b.size(); ++j) (*above)[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    (*row)[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = (*above)[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      (*row)[j] = std::min({(*above)[j] + 1, (*row)[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        (*row)[j] = std::min((*row)[j], (*before)[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return (*above)[b.size()];
}

bool has_control(std::string_view text) {
  return std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
}

}  // namespace

std::string_view nearest_word(std::string_view word, In<std::string_view> known) {
  return *std::ranges::min_element(known, {}, [&](std::string_view k) { return edit_distance(word, k); });
}

std::string listed_words(In<std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += in_quotes(words[i]);
  }
  return text;
}

void JsonReader::fault(Error error) {
  if (!fault_) fault_ = std::move(error);
}

void JsonReader::fault(const JsonValue& at, std::string what, ErrorCode code) {
  if (fault_) return;
  fault_ = Error{.code = code, .what = std::move(what), .place = {.file = file_, .pointer = at.pointer()}};
}

void JsonReader::unknown(const JsonValue& at, const std::string& kind, std::string_view found,
                         In<std::string_view> known) {
  if (fault_) return;
  constexpr std::size_t kListed = 12;
  std::string what = "unknown " + kind + " " + in_quotes(found);
  if (known.empty()) return fault(at, what + ", there are none");
  what += ", the nearest known one is " + in_quotes(nearest_word(found, known));
  if (known.size() > 1 && known.size() <= kListed) what += " (of " + listed_words(known) + ")";
  fault(at, std::move(what));
}

bool JsonReader::expect(const JsonValue& value, JsonKind kind, const std::string& wanted) {
  if (fault_) return false;
  if (value.kind() == kind) return true;
  fault(value, "expected " + wanted + ", found " + value.described());
  return false;
}

void JsonReader::allow_only(const JsonValue& object, In<std::string_view> known) {
  object.for_each_member([&](const std::string& key, const JsonValue& value) {
    if (std::ranges::find(known, key) == known.end()) unknown(value, "key", key, known);
  });
}

std::optional<JsonValue> JsonReader::required(const JsonValue& object, std::string_view key) {
  const auto found = object.member(key);
  if (!found) fault(object, in_quotes(key) + " is missing");
  return found;
}

bool JsonReader::boolean(const JsonValue& value) {
  return expect(value, JsonKind::Boolean, "true or false") && value.boolean();
}

double JsonReader::number(const JsonValue& value) {
  return expect(value, JsonKind::Number, "a number") ? value.number() : 0;
}

double JsonReader::positive(const JsonValue& value) {
  if (!expect(value, JsonKind::Number, "a positive number")) return 0;
  if (!(value.number() > 0)) fault(value, "expected a positive number, found " + shortest(value.number()));
  return value.number();
}

Index JsonReader::index(const JsonValue& value) {
  if (!expect(value, JsonKind::Number, "an index")) return 0;
  const double number = value.number();
  if (number >= 0 && number <= std::numeric_limits<Index>::max() && number == std::floor(number))
    return static_cast<Index>(number);
  fault(value, "expected an index (a whole number from 0 to 2147483647), found " + shortest(number));
  return 0;
}

std::vector<Index> JsonReader::indices(const JsonValue& value, const std::string& wanted) {
  std::vector<Index> list;
  if (!expect(value, JsonKind::Array, wanted)) return list;
  if (value.size() == 0) fault(value, "expected " + wanted + ", found an empty array");
  list.reserve(static_cast<std::size_t>(value.size()));
  value.for_each_element([&](const JsonValue& element) { list.push_back(index(element)); });
  return list;
}

std::array<Index, 2> JsonReader::edge(const JsonValue& value) {
  const std::string wanted = "an edge (two vertices)";
  if (!expect(value, JsonKind::Array, wanted)) return {};
  if (value.size() != 2) fault(value, "expected " + wanted + ", found " + value.described());
  if (fault_) return {};
  const std::vector<Index> ends = indices(value, wanted);
  if (ends[0] == ends[1]) fault(value, "an edge needs two different vertices");
  return {ends[0], ends[1]};
}

void JsonReader::coordinates(const JsonValue& value, Out<double> coordinate) {
  const std::string wanted = "a point of " + std::to_string(coordinate.size()) + " numbers";
  if (!expect(value, JsonKind::Array, wanted)) return;
  if (value.size() != static_cast<Index>(coordinate.size()))
    return fault(value, "expected " + wanted + ", found " + value.described());
  std::size_t i = 0;
  value.for_each_element([&](const JsonValue& element) { coordinate[i++] = number(element); });
}

Vec2 JsonReader::point2(const JsonValue& value) {
  double p[2] = {0, 0};
  coordinates(value, p);
  return {p[0], p[1]};
}

Vec3 JsonReader::point3(const JsonValue& value) {
  double p[3] = {0, 0, 0};
  coordinates(value, p);
  return {p[0], p[1], p[2]};
}

std::string JsonReader::line_of_text(const JsonValue& value, const std::string& wanted) {
  if (!expect(value, JsonKind::String, wanted)) return "";
  check_name(value, value.string());
  return value.string();
}

void JsonReader::check_name(const JsonValue& at, const std::string& name) {
  if (name.empty()) fault(at, "expected a name, found an empty one");
  if (has_control(name)) fault(at, "the text " + in_quotes(name) + " contains a control character");
}

std::size_t JsonReader::word_number(const JsonValue& value, In<std::string_view> known) {
  if (!expect(value, JsonKind::String, listed_words(known))) return 0;
  const auto found = std::ranges::find(known, value.string());
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  unknown(value, "word", value.string(), known);
  return 0;
}

}  // namespace planish
