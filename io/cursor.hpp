// Tokenizer over text in memory: nothing is copied, and lines are counted only when an error needs its place.
#pragma once

#include <string>
#include <string_view>

#include "engine/model/error.hpp"

namespace planish {

/// What a format allows between its numbers.
struct Dialect {
  bool comments = false;         ///< '#' ends a line's content
  bool continued_lines = false;  ///< a backslash at a line's end joins the next line
};

/// A position in text. Blanks are space, tab and carriage return; they never include the line's end.
class Cursor {
 public:
  Cursor(std::string_view text, Dialect dialect)
      : at_(text.data()), end_(text.data() + text.size()), dialect_(dialect) {}

  const char* position() const { return at_; }
  bool at_end() const { return at_ == end_; }
  void move_to(const char* position) { at_ = position; }

  /// Skips blanks and joined line ends; true when the line has nothing more to say.
  bool at_line_end();

  /// Moves to the start of the next line, over joined ones (not out of a comment: comments are never joined).
  void next_line();

  /// Skips blanks and line ends.
  void skip_space();

  /// Next run of characters other than blanks on this line; empty at its end.
  std::string_view token();

  /// Rest of the line without the blanks at its end, from the current position on; moves to the next line.
  /// Joined lines are returned as they stand in the file.
  std::string_view rest_of_line();

  /// Reads a number and moves past it; "nan" and "inf" are numbers. False: no number here, nothing moved.
  bool read_double(double& value);
  bool read_float(float& value);
  /// Saturates far outside the range of 32-bit numbers.
  bool read_integer(Offset& value);

  /// A token ends here: blank, line end or end of text.
  bool at_separator() const;

 private:
  /// Length of a joined line end here ("\\\n" or "\\\r\n"), 0 if there is none.
  int joined_line_end() const;

  const char* at_;
  const char* end_;
  Dialect dialect_;
};

/// Line and column of a position in text.
Place place_in(std::string_view text, const char* position, const std::string& file);

/// The token at a position as an error quotes it: in quotes, shortened, "the end of the line" where there is
/// none.
std::string quoted(std::string_view text, const char* position);

}  // namespace planish
