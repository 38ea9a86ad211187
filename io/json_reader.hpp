// Typed values out of a JSON document. The first fault is kept with its pointer; after it values are defaults.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/json_document.hpp"

namespace planish {

class JsonReader {
 public:
  explicit JsonReader(const std::string& file) : file_(file) {}

  bool failed() const { return fault_.has_value(); }
  /// pre: failed().
  Error take_fault() { return std::move(*fault_); }

  void fault(const JsonValue& at, std::string what, ErrorCode code = ErrorCode::BadSyntax);
  void fault(Error error);

  /// False, and a fault, where the value is of another kind; `wanted` says what it should be.
  bool expect(const JsonValue& value, JsonKind kind, const std::string& wanted);

  /// Faults at the first member whose key is not among the known ones.
  void allow_only(const JsonValue& object, In<std::string_view> known);
  /// The value of a member that must be there.
  std::optional<JsonValue> required(const JsonValue& object, std::string_view key);

  bool boolean(const JsonValue& value);
  double number(const JsonValue& value);
  double positive(const JsonValue& value);
  /// A whole number in [0, 2^31).
  Index index(const JsonValue& value);
  /// One or more of them.
  std::vector<Index> indices(const JsonValue& value, const std::string& wanted);
  /// Two indices that differ: an edge.
  std::array<Index, 2> edge(const JsonValue& value);
  Vec2 point2(const JsonValue& value);
  Vec3 point3(const JsonValue& value);
  /// Text that is not empty and fits in a line: no control characters.
  std::string line_of_text(const JsonValue& value, const std::string& wanted);
  /// The same condition on a key.
  void check_name(const JsonValue& at, const std::string& name);

  /// One of a few words, each with its meaning.
  template <class T, std::size_t n>
  T word(const JsonValue& value, const std::array<std::pair<std::string_view, T>, n>& words) {
    std::array<std::string_view, n> known;
    for (std::size_t i = 0; i < n; ++i) known[i] = words[i].first;
    return words[word_number(value, known)].second;
  }

  /// Fault of a word that is not among the known ones, with the nearest of them.
  void unknown(const JsonValue& at, const std::string& kind, std::string_view found,
               In<std::string_view> known);

 private:
  std::size_t word_number(const JsonValue& value, In<std::string_view> known);
  /// The coordinates of a point; faults unless there are as many as asked for.
  void coordinates(const JsonValue& value, Out<double> coordinate);

  const std::string& file_;
  std::optional<Error> fault_;
};

/// The word that the fewest insertions, removals, replacements and swaps of neighbours turn into `word`; of
/// equals the first. Cost: O(|word| * sum of |known|).
/// pre: known is not empty.
std::string_view nearest_word(std::string_view word, In<std::string_view> known);

/// "'a', 'b' or 'c'".
std::string listed_words(In<std::string_view> words);

}  // namespace planish
