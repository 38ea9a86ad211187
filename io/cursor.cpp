#include "io/cursor.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cstring>

namespace planish {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return static_cast<unsigned>(c - '0') < 10; }

template <class T>
bool read_number(const char*& at, const char* end, T& value) {
  const char* begin = at;
  if (begin != end && *begin == '+') {  // fast_float takes no leading plus
    ++begin;
    if (begin != end && (*begin == '-' || *begin == '+')) return false;
  }
  const auto [past, error] = fast_float::from_chars(begin, end, value);
  if (error == std::errc::invalid_argument) return false;
  at = past;
  return true;
}

}  // namespace

int Cursor::joined_line_end() const {
  if (at_ == end_ || *at_ != '\\' || !dialect_.continued_lines) return 0;
  if (end_ - at_ >= 2 && at_[1] == '\n') return 2;
  if (end_ - at_ >= 3 && at_[1] == '\r' && at_[2] == '\n') return 3;
  return 0;
}

bool Cursor::at_line_end() {
  while (at_ != end_) {
    if (is_blank(*at_)) {
      ++at_;
    } else if (*at_ == '\n' || (*at_ == '#' && dialect_.comments)) {
      return true;
    } else if (const int length = joined_line_end()) {
      at_ += length;
    } else {
      return false;
    }
  }
  return true;
}

void Cursor::next_line() {
  const bool in_comment = at_ != end_ && *at_ == '#' && dialect_.comments;
  while (at_ != end_) {
    const auto* newline =
        static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
    if (newline == nullptr) {
      at_ = end_;
      return;
    }
    const char* last = newline;
    if (last != at_ && last[-1] == '\r') --last;
    const bool joined = dialect_.continued_lines && !in_comment && last != at_ && last[-1] == '\\';
    at_ = newline + 1;
    if (!joined) return;
  }
}

void Cursor::skip_space() {
  while (at_ != end_ && (is_blank(*at_) || *at_ == '\n')) ++at_;
}

std::string_view Cursor::token() {
  if (at_line_end()) return {};
  const char* begin = at_;
  while (!at_separator()) ++at_;
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

std::string_view Cursor::rest_of_line() {
  const char* begin = at_;
  next_line();
  const char* last = at_;
  while (last != begin && (is_blank(last[-1]) || last[-1] == '\n')) --last;
  return {begin, static_cast<std::size_t>(last - begin)};
}

bool Cursor::read_double(double& value) { return read_number(at_, end_, value); }
bool Cursor::read_float(float& value) { return read_number(at_, end_, value); }

bool Cursor::read_integer(Offset& value) {
  constexpr Offset kSaturated = 1'000'000'000'000;
  const char* at = at_;
  const bool negative = at != end_ && *at == '-';
  if (at != end_ && (*at == '-' || *at == '+')) ++at;
  if (at == end_ || !is_digit(*at)) return false;
  Offset magnitude = 0;
  for (; at != end_ && is_digit(*at); ++at) magnitude = std::min(magnitude * 10 + (*at - '0'), kSaturated);
  value = negative ? -magnitude : magnitude;
  at_ = at;
  return true;
}

bool Cursor::at_separator() const {
  return at_ == end_ || is_blank(*at_) || *at_ == '\n' || joined_line_end() > 0;
}

Place place_in(std::string_view text, const char* position, const std::string& file) {
  const std::string_view before = text.substr(0, static_cast<std::size_t>(position - text.data()));
  const std::size_t newline = before.rfind('\n');
  const std::size_t line_begin = newline == std::string_view::npos ? 0 : newline + 1;
  return {.file = file,
          .line = 1 + std::count(before.begin(), before.end(), '\n'),
          .column = static_cast<Offset>(before.size() - line_begin) + 1};
}

std::string quoted(std::string_view text, const char* position) {
  constexpr std::size_t kLongest = 24;
  Cursor cursor(text.substr(static_cast<std::size_t>(position - text.data())), {});
  const std::string_view token = cursor.token();
  if (token.empty()) return cursor.at_end() ? "the end of the file" : "the end of the line";
  std::string shown;
  for (const char c : token.substr(0, kLongest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return "'" + shown + (token.size() > kLongest ? "...'" : "'");
}

}  // namespace planish
