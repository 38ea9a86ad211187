#include "io/mesh_files.hpp"
#include "io/ply_header.hpp"
#include "io/rows_mesh.hpp"

namespace planish {

Result<Mesh> read_ply(const Exec& exec, std::string_view bytes, const std::string& file) {
  auto header = parse_ply_header(bytes, file);
  if (!header) return fail(std::move(header.error()));
  const RowSource source{
      .file = file, .bytes = bytes, .body = header->size, .text = header->text, .swapped = header->swapped};
  BinaryRows converted;
  if (source.text) {
    auto rows = binary_rows(exec, header->elements, source);
    if (!rows) return fail(std::move(rows.error()));
    converted = std::move(*rows);
  }
  const auto rows = lay_out_rows(exec, header->elements, source, converted);
  if (!rows) return fail(rows.error());
  auto mesh = mesh_of_rows(exec, source, *rows);
  if (mesh) mesh->comments = std::move(header->comments);
  return mesh;
}

}  // namespace planish
