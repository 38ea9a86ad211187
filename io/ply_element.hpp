// The rows of a binary PLY element and their description, gathered from columns wherever they lie.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

class PlyElement {
 public:
  /// `name` outlives the element.
  PlyElement(const char* name, Index count) : name_(name), count_(count) {}

  bool has(const std::string& property) const { return names_.contains(property); }

  /// A scalar property: its value in row i is at begin + i * stride + offset. Without rows, begin may be
  /// null.
  void add(const std::string& property, Scalar scalar, const void* begin, std::size_t stride,
           std::size_t offset = 0);
  /// The list vertex_indices: three corners a triangle.
  void add_triangles(const std::vector<Index>& corner_vertex);
  /// The list texcoord: u and v of three corners a triangle.
  void add_texcoord(In<Vec2> corner_uv);

  std::string header() const;
  /// Bytes of all rows.
  std::size_t size() const { return row_size() * static_cast<std::size_t>(count_); }
  /// out [size()]
  void write(const Exec& exec, char* out) const;

 private:
  /// Bytes that go into every row: `size` of them, from begin + row * stride.
  struct Column {
    const char* begin;
    std::size_t stride, size;
  };
  std::size_t row_size() const;
  template <std::size_t kSize>
  static void copy_rows(Range r, const Column& column, char* out, std::size_t row_bytes);
  static void write_column(Range r, const Column& column, char* out, std::size_t row_bytes);

  const char* name_;
  Index count_;
  std::string header_;
  std::vector<Column> columns_;
  std::set<std::string> names_;
};

}  // namespace planish
