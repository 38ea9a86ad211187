#include "io/ply_element.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace planish {

static_assert(std::endian::native == std::endian::little, "rows are copied as they lie in memory");

void PlyElement::add(const std::string& property, Scalar scalar, const void* begin, std::size_t stride,
                     std::size_t offset) {
  constexpr std::array kTypes = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
  names_.insert(property);
  header_ += std::string("property ") + kTypes[static_cast<int>(scalar)] + " " + property + "\n";
  const auto* first = static_cast<const char*>(begin);
  columns_.push_back({count_ > 0 ? first + offset : first, stride, byte_size(scalar)});
}

void PlyElement::add_triangles(const std::vector<Index>& corner_vertex) {
  static constexpr char kThree = 3;
  names_.insert("vertex_indices");
  header_ += "property list uchar int vertex_indices\n";
  columns_.push_back({&kThree, 0, 1});
  columns_.push_back(
      {reinterpret_cast<const char*>(corner_vertex.data()), 3 * sizeof(Index), 3 * sizeof(Index)});
}

void PlyElement::add_texcoord(In<Vec2> corner_uv) {
  static constexpr char kSix = 6;
  names_.insert("texcoord");
  header_ += "property list uchar double texcoord\n";
  columns_.push_back({&kSix, 0, 1});
  columns_.push_back({reinterpret_cast<const char*>(corner_uv.data()), 3 * sizeof(Vec2), 3 * sizeof(Vec2)});
}

std::string PlyElement::header() const {
  return std::string("element ") + name_ + " " + std::to_string(count_) + "\n" + header_;
}

std::size_t PlyElement::row_size() const {
  std::size_t size = 0;
  for (const Column& column : columns_) size += column.size;
  return size;
}

void PlyElement::write(const Exec& exec, char* out) const {
  const std::size_t row_bytes = row_size();
  exec.for_blocks(count_, kBlock, [&](Index, Range r) {
    std::size_t offset = 0;
    for (const Column& column : columns_) {
      write_column(r, column, out + offset, row_bytes);
      offset += column.size;
    }
  });
}

template <std::size_t kSize>
void PlyElement::copy_rows(Range r, const Column& column, char* out, std::size_t row_bytes) {
  for (Index row = r.begin; row < r.end; ++row) {
    std::memcpy(out + row_bytes * static_cast<std::size_t>(row),
                column.begin + column.stride * static_cast<std::size_t>(row), kSize);
  }
}

void PlyElement::write_column(Range r, const Column& column, char* out, std::size_t row_bytes) {
  switch (column.size) {
    case 1: return copy_rows<1>(r, column, out, row_bytes);
    case 2: return copy_rows<2>(r, column, out, row_bytes);
    case 4: return copy_rows<4>(r, column, out, row_bytes);
    case 8: return copy_rows<8>(r, column, out, row_bytes);
    case 3 * sizeof(Vec2): return copy_rows<3 * sizeof(Vec2)>(r, column, out, row_bytes);
    default: return copy_rows<3 * sizeof(Index)>(r, column, out, row_bytes);
  }
}

}  // namespace planish
