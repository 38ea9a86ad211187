#include "io/line_chunks.hpp"

namespace planish {

std::vector<std::string_view> line_chunks(std::string_view text, Dialect dialect, std::size_t chunk_bytes) {
  std::vector<std::string_view> chunks;
  // A chunk ends at a true line end even where a comment's last backslash joins nothing.
  const Dialect cutting{.comments = false, .continued_lines = dialect.continued_lines};
  while (!text.empty()) {
    std::size_t size = text.size();
    if (size > chunk_bytes) {
      std::size_t from = chunk_bytes;
      while (from > 0 && (text[from - 1] == '\\' || text[from - 1] == '\r'))
        --from;  // not inside a joined line end
      Cursor cursor(text.substr(from), cutting);
      cursor.next_line();
      size = static_cast<std::size_t>(cursor.position() - text.data());
    }
    chunks.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return chunks;
}

std::vector<Offset> rows_before(const Exec& exec, const std::vector<std::string_view>& chunks,
                                Dialect dialect) {
  std::vector<Offset> before(chunks.size() + 1, 0);
  exec.for_tasks(static_cast<Index>(chunks.size()), [&](Index k) {
    for (Cursor cursor(chunks[k], dialect); !cursor.at_end(); cursor.next_line()) {
      if (!cursor.at_line_end()) ++before[k + 1];
    }
  });
  for (std::size_t k = 0; k < chunks.size(); ++k) before[k + 1] += before[k];
  return before;
}

}  // namespace planish
