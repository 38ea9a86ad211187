#include "io/cursor.hpp"

#include <doctest/doctest.h>

#include "io/line_chunks.hpp"

using namespace planish;

TEST_CASE("cursor: numbers end at blanks, and what is no number moves nothing") {
  Cursor cursor("  1.5e2 -7 +3 +-3 x", {});
  double number = 0;
  Offset integer = 0;
  CHECK_FALSE(cursor.at_line_end());
  CHECK((cursor.read_double(number) && cursor.at_separator() && number == 150));
  CHECK_FALSE(cursor.at_line_end());
  CHECK((cursor.read_integer(integer) && integer == -7));
  CHECK_FALSE(cursor.at_line_end());
  CHECK((cursor.read_double(number) && number == 3));
  CHECK_FALSE(cursor.at_line_end());
  CHECK_FALSE(cursor.read_double(number));
  CHECK(cursor.token() == "+-3");
  CHECK(cursor.token() == "x");
  CHECK(cursor.token().empty());
}

TEST_CASE("cursor: integers saturate instead of overflowing") {
  Cursor cursor("-99999999999999999999999999", {});
  Offset integer = 0;
  REQUIRE(cursor.read_integer(integer));
  CHECK(integer == -1'000'000'000'000);
  CHECK(cursor.at_end());
}

TEST_CASE("cursor: line and column count from 1") {
  const std::string_view text = "ab\n\ncde\n";
  const Place place = place_in(text, text.data() + 6, "f");
  CHECK(place.line == 3);
  CHECK(place.column == 3);
  CHECK(place_in(text, text.data(), "f").line == 1);
  CHECK(place_in(text, text.data() + text.size(), "f").line == 4);
}

TEST_CASE("cursor: quotes are printable and short") {
  const std::string_view text =
      "a\x01"
      "b "
      "0123456789012345678901234567890 \n";
  CHECK(quoted(text, text.data()) == "'a?b'");
  CHECK(quoted(text, text.data() + 4) == "'012345678901234567890123...'");
  CHECK(quoted(text, text.data() + text.size() - 1) == "the end of the line");
  CHECK(quoted(text, text.data() + text.size()) == "the end of the file");
}

TEST_CASE("line chunks: cuts of every size are at true line ends and lose nothing") {
  const std::string text = "v 1 \\\n 2\n\n# c \\\nf 1\\\r\n 2\nlast \\\\\\\n x\n\\";
  for (const Dialect dialect : {Dialect{}, Dialect{.comments = true, .continued_lines = true}}) {
    for (std::size_t size = 1; size < text.size(); ++size) {
      std::string joined;
      for (const std::string_view chunk : line_chunks(text, dialect, size)) {
        joined += chunk;
        REQUIRE(!chunk.empty());
        if (joined.size() == text.size()) continue;
        CHECK(chunk.back() == '\n');
        const bool continued = chunk.ends_with("\\\n") || chunk.ends_with("\\\r\n");
        CHECK_FALSE((continued && dialect.continued_lines));
      }
      CHECK(joined == text);
    }
  }
}

TEST_CASE("line chunks: rows are lines with content") {
  const Dialect dialect{.comments = true, .continued_lines = false};
  const std::vector<std::string_view> chunks = {"a\n\n # b\n", "c # d\n e\n", "f"};
  CHECK(rows_before(Exec(2), chunks, dialect) == std::vector<Offset>{0, 1, 3, 4});
}
