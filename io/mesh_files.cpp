#include "io/mesh_files.hpp"

#include <array>
#include <new>

#include "io/cursor.hpp"
#include "io/file.hpp"

namespace planish {
namespace {

using Reader = Result<Mesh> (*)(const Exec&, std::string_view, const std::string&);

struct Format {
  std::string_view extension;
  Reader read;
};
constexpr std::array kFormats = {Format{"obj", read_obj}, Format{"ply", read_ply}, Format{"stl", read_stl},
                                 Format{"off", read_off}};

/// Format by the first bytes, for names that tell none; empty when they tell none either.
std::string_view format_by_content(std::string_view bytes) {
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n")) return "ply";
  Cursor cursor(bytes, {.comments = true, .continued_lines = false});
  while (!cursor.at_end() && cursor.at_line_end()) cursor.next_line();
  const std::string_view word = cursor.token();
  if (word == "solid") return "stl";
  if (word == "OFF" || word == "COFF" || word == "NOFF" || word == "CNOFF") return "off";
  for (const std::string_view keyword : {"v", "vt", "vn", "f", "g", "o", "s", "mtllib", "usemtl"}) {
    if (word == keyword) return "obj";
  }
  return "";
}

Failure unknown_format(const std::string& path, std::string what) {
  return fail(Error{.code = ErrorCode::UnknownFormat, .what = std::move(what), .place = {.file = path}});
}

Failure out_of_memory(const std::string& path) {
  return fail(
      Error{.code = ErrorCode::OutOfMemory, .what = "no memory for the mesh", .place = {.file = path}});
}

}  // namespace

Result<Mesh> read_mesh(const Exec& exec, const std::string& path) try {
  const auto bytes = FileBytes::open(path, exec);
  if (!bytes) return fail(bytes.error());
  const std::string extension = format_of(path);
  for (const Format& format : kFormats) {
    if (format.extension == extension) return format.read(exec, bytes->view(), path);
  }
  const std::string_view found = format_by_content(bytes->view());
  for (const Format& format : kFormats) {
    if (format.extension == found) return format.read(exec, bytes->view(), path);
  }
  return unknown_format(path, "neither the name nor the first bytes tell a mesh format");
} catch (const std::bad_alloc&) {
  return out_of_memory(path);
}

Result<void> write_mesh(const Exec& exec, const std::string& path, const MeshOutput& output,
                        std::vector<std::string>& warnings) try {
  const std::string extension = format_of(path);
  if (extension == "obj") return write_file(path, format_obj(exec, output, warnings));
  if (extension == "ply") return write_file(path, format_ply(exec, output, warnings));
  return unknown_format(path, "meshes are written as .obj or .ply, not as '" + extension + "'");
} catch (const std::bad_alloc&) {
  return out_of_memory(path);
}

}  // namespace planish
