#include "io/json_document.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/cursor.hpp"

namespace planish {

/// Receives the events of nlohmann's parser.
class JsonBuilder {
 public:
  using Json = nlohmann::json;

  JsonBuilder(std::string_view text, const std::string& file, JsonDocument& document)
      : text_(text), file_(file), node_(document.node_), string_(document.text_) {}

  std::optional<Error>& fault() { return fault_; }

  bool null() { return add({}); }
  bool boolean(bool value) { return add({.kind = JsonKind::Boolean, .number = value ? 1.0 : 0.0}); }
  bool number_integer(Json::number_integer_t value) { return add_number(static_cast<double>(value)); }
  bool number_unsigned(Json::number_unsigned_t value) { return add_number(static_cast<double>(value)); }
  bool number_float(Json::number_float_t value, const std::string&) { return add_number(value); }
  bool string(std::string& value) { return add({.kind = JsonKind::String, .text = keep(value)}); }
  bool binary(Json::binary_t&) { return false; }  // never in text

  bool start_object(std::size_t) { return open(JsonKind::Object); }
  bool start_array(std::size_t) { return open(JsonKind::Array); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    open_.back().key = size();
    return push({.kind = JsonKind::Key, .text = keep(name)});
  }

  bool end_object() {
    const Index object = open_.back().node;
    if (const Index twice = repeated_key(object); twice != kNone) {
      open_.back().key = twice;
      const std::string& name = string_[node_[twice].text];
      fault_ = Error{.code = ErrorCode::BadSyntax,
                     .what = "the name " + in_quotes(name) + " stands twice in one object",
                     .place = {.file = file_, .pointer = pointer_of_key()}};
      return false;
    }
    return close();
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& exception) {
    const std::size_t at = std::min(position > 0 ? position - 1 : 0, text_.size());
    Place place = place_in(text_, text_.data() + at, file_);
    place.pointer = pointer_of_next();
    fault_ = Error{.code = ErrorCode::BadSyntax,
                   .what = "not valid JSON: " + reason(exception.what(), at),
                   .place = std::move(place)};
    return false;
  }

 private:
  struct Open {
    Index node = 0;
    Index key = kNone;  ///< of an object: its latest key
  };

  Index size() const { return static_cast<Index>(node_.size()); }

  Index keep(std::string& value) {
    string_.push_back(std::move(value));
    return static_cast<Index>(string_.size()) - 1;
  }

  bool push(JsonNode node) {
    node.end = size() + 1;
    node_.push_back(node);
    return true;
  }
  bool add(const JsonNode& node) {
    if (!open_.empty()) ++node_[open_.back().node].count;
    return push(node);
  }
  bool add_number(double value) { return add({.kind = JsonKind::Number, .number = value}); }
  bool open(JsonKind kind) {
    const Index container = size();
    add({.kind = kind});
    open_.push_back({.node = container});
    return true;
  }
  bool close() {
    node_[open_.back().node].end = size();
    open_.pop_back();
    return true;
  }

  /// The second of two equal keys of the object that ends here, or kNone.
  Index repeated_key(Index object) {
    keys_.clear();
    for (Index n = object + 1; n < size(); n = node_[n + 1].end) keys_.push_back(n);
    const auto name = [&](Index n) -> const std::string& { return string_[node_[n].text]; };
    std::ranges::stable_sort(keys_, {}, name);
    const auto found = std::ranges::adjacent_find(keys_, {}, name);
    return found == keys_.end() ? kNone : found[1];
  }

  std::string step_of_key(const Open& open) const { return pointer_step(string_[node_[open.key].text]); }

  /// Pointer of the open containers but the last.
  std::string pointer_of_outer() const {
    std::string pointer;
    for (std::size_t k = 0; k + 1 < open_.size(); ++k) {
      const JsonNode& container = node_[open_[k].node];
      pointer += container.kind == JsonKind::Object ? step_of_key(open_[k])
                                                    : "/" + std::to_string(container.count - 1);
    }
    return pointer;
  }
  std::string pointer_of_key() const { return pointer_of_outer() + step_of_key(open_.back()); }

  /// Pointer of the value that would come next; of the object where a key would.
  std::string pointer_of_next() const {
    if (open_.empty()) return "";
    const JsonNode& innermost = node_[open_.back().node];
    if (innermost.kind == JsonKind::Array) return pointer_of_outer() + "/" + std::to_string(innermost.count);
    return node_.back().kind == JsonKind::Key ? pointer_of_key() : pointer_of_outer();
  }

  /// The parser's reason without its own spelling of the place.
  std::string reason(std::string_view message, std::size_t at) const {
    if (const auto id = message.find("] "); id != message.npos) message.remove_prefix(id + 2);
    if (message.starts_with("parse error at ")) {
      if (const auto colon = message.find(": "); colon != message.npos) message.remove_prefix(colon + 2);
    }
    return std::string(message) + (names_no_number(at) ? "; JSON has neither NaN nor infinity" : "");
  }

  bool names_no_number(std::size_t at) const {
    const auto is_letter = [&](std::size_t i) {
      return (text_[i] >= 'a' && text_[i] <= 'z') || (text_[i] >= 'A' && text_[i] <= 'Z');
    };
    if (at >= text_.size() || !is_letter(at)) return false;
    while (at > 0 && is_letter(at - 1)) --at;
    std::string word(text_.substr(at, 3));
    std::ranges::transform(word, word.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return word == "nan" || word == "inf";
  }

  std::string_view text_;
  const std::string& file_;
  std::vector<JsonNode>& node_;
  std::vector<std::string>& string_;
  std::vector<Open> open_;
  std::vector<Index> keys_;
  std::optional<Error> fault_;
};

Result<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& file) {
  if (text.size() >= static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    return fail(Error{
        .code = ErrorCode::TooLarge, .what = "a constraint file of 2 GiB or more", .place = {.file = file}});
  }
  JsonDocument document;
  JsonBuilder builder(text, file, document);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  if (builder.fault()) return fail(std::move(*builder.fault()));
  return document;
}

std::optional<JsonValue> JsonValue::member(std::string_view key) const {
  for (Index n = node_ + 1; n < node().end; n = node_at(n + 1).end) {
    if (text_of(n) == key) return JsonValue(*document_, n + 1);
  }
  return std::nullopt;
}

std::string JsonValue::pointer() const {
  std::string pointer;
  for (Index container = 0; container != node_;) {
    Index n = container + 1, element = 0;
    while (node_at(n).kind == JsonKind::Key ? node_at(n + 1).end <= node_ : node_at(n).end <= node_) {
      n = node_at(n).kind == JsonKind::Key ? node_at(n + 1).end : node_at(n).end;
      ++element;
    }
    const bool is_member = node_at(n).kind == JsonKind::Key;
    pointer += is_member ? pointer_step(text_of(n)) : "/" + std::to_string(element);
    container = is_member ? n + 1 : n;
  }
  return pointer;
}

std::string JsonValue::described() const {
  switch (kind()) {
    case JsonKind::Null: return "null";
    case JsonKind::Boolean: return boolean() ? "true" : "false";
    case JsonKind::Number: return "the number " + shortest(number());
    case JsonKind::String: return "the string " + in_quotes(string());
    case JsonKind::Array: return "an array of " + std::to_string(size());
    case JsonKind::Object:
    case JsonKind::Key: break;
  }
  return "an object";
}

std::string pointer_step(std::string_view name) {
  std::string step = "/";
  for (const char c : name) {
    if (c == '~') {
      step += "~0";
    } else if (c == '/') {
      step += "~1";
    } else {
      step += c;
    }
  }
  return step;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string shown = "'";
  // Bytes above 127 belong to UTF-8, which a JSON text always is.
  for (const char c : text.substr(0, kLongest))
    shown += static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? '?' : c;
  if (text.size() > kLongest) {
    while (static_cast<unsigned char>(shown.back()) >= 0x80) shown.pop_back();  // no half characters
    shown += "...";
  }
  return shown + "'";
}

std::string shortest(double number) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, number);
  return {digits, end};
}

}  // namespace planish
