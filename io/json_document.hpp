// A JSON text as one flat array of values, each of which can say where it stands (as a JSON pointer).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/model/error.hpp"

namespace planish {

enum class JsonKind : std::uint8_t { Null, Boolean, Number, String, Array, Object, Key };

/// One value; a container is followed by what it contains, a key by its value.
struct JsonNode {
  JsonKind kind = JsonKind::Null;
  Index end = 0;       ///< the node after all that it contains
  Index count = 0;     ///< elements or members of a container
  Index text = kNone;  ///< of a string or key: its number among the texts
  double number = 0;   ///< of a number, finite; of a boolean 0 or 1
};

class JsonDocument;

/// A value of a document; valid as long as that.
class JsonValue {
 public:
  JsonValue(const JsonDocument& document, Index node) : document_(&document), node_(node) {}

  JsonKind kind() const { return node().kind; }
  double number() const { return node().number; }
  bool boolean() const { return node().number != 0; }
  const std::string& string() const { return text_of(node_); }
  Index size() const { return node().count; }

  /// The value of a member of an object, if it is there.
  std::optional<JsonValue> member(std::string_view key) const;

  /// Calls f(JsonValue) for each element of an array, in order.
  template <class F>
  void for_each_element(F&& f) const {
    for (Index n = node_ + 1; n < node().end; n = node_at(n).end) f(JsonValue(*document_, n));
  }

  /// Calls f(key, JsonValue) for each member of an object, in the order of the text.
  template <class F>
  void for_each_member(F&& f) const {
    for (Index n = node_ + 1; n < node().end; n = node_at(n + 1).end)
      f(text_of(n), JsonValue(*document_, n + 1));
  }

  /// JSON pointer (RFC 6901); "" for the whole document.
  /// Cost: linear in the values before this one.
  std::string pointer() const;

  /// What it is, as an error says it: "the number 3", "an object".
  std::string described() const;

 private:
  const JsonNode& node_at(Index n) const;
  const JsonNode& node() const { return node_at(node_); }
  const std::string& text_of(Index n) const;

  const JsonDocument* document_;
  Index node_;
};

class JsonDocument {
 public:
  /// Fails: BadSyntax with line, column and pointer of the place: not JSON, a number beyond the range of
  /// double, a name that stands twice in one object; TooLarge for 2 GiB and more.
  /// Cost: one pass; 24 bytes a value.
  static Result<JsonDocument> parse(std::string_view text, const std::string& file);

  JsonValue root() const { return {*this, 0}; }

 private:
  friend class JsonValue;
  friend class JsonBuilder;
  std::vector<JsonNode> node_;
  std::vector<std::string> text_;
};

inline const JsonNode& JsonValue::node_at(Index n) const { return document_->node_[n]; }
inline const std::string& JsonValue::text_of(Index n) const { return document_->text_[node_at(n).text]; }

/// One step of a JSON pointer: "/" and the name, with "~" and "/" in it escaped.
std::string pointer_step(std::string_view name);

/// Text in single quotes as an error shows it: shortened, control characters replaced by '?'.
std::string in_quotes(std::string_view text);

/// The shortest decimal that reads back as the same number.
std::string shortest(double number);

}  // namespace planish
