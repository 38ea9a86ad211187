#include "io/rows_mesh.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "io/polygons.hpp"
#include "io/uv_set.hpp"

namespace planish {
namespace {

struct UvSpelling {
  const char* set;
  const char* u;
  const char* v;
};
/// In order of preference; the face list "texcoord" comes last.
constexpr UvSpelling kUvSpellings[] = {
    {"st", "s", "t"}, {"uv", "u", "v"}, {"texture_uv", "texture_u", "texture_v"}};

int find_property(const Element& element, std::string_view name, bool list) {
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const Property& property = element.properties[p];
    if (property.name == name && property.list_count.has_value() == list) return static_cast<int>(p);
  }
  return -1;
}

/// One corner list that is wrong; the one of the lowest row is reported.
struct FaceFault {
  Offset row = -1;
  ErrorCode code = ErrorCode::BadSyntax;
  std::string what;
  const char* at = nullptr;
};

class MeshOfRows {
 public:
  MeshOfRows(const Exec& exec, const RowSource& source, const std::vector<ElementRows>& elements)
      : exec_(exec), source_(source) {
    for (const ElementRows& rows : elements) {
      const std::string& name = rows.element().name;
      if (name == "vertex") {
        vertices_ = &rows;
      } else if (name == "face") {
        faces_ = &rows;
      } else if (rows.count() > 0) {
        mesh_.warnings.push_back("element '" + name + "' (" + std::to_string(rows.count()) +
                                 " rows) is left out");
      }
    }
  }

  Result<Mesh> run() {
    if (auto error = read_vertices()) return fail(std::move(*error));
    if (faces_ != nullptr && faces_->count() > 0) {
      if (auto error = read_faces()) return fail(std::move(*error));
    }
    keep_vertex_uv();
    if (!polygon_begin_.empty()) keep_texcoord();
    keep_vertex_attributes();
    if (!polygon_begin_.empty()) keep_triangle_attributes();
    return std::move(mesh_);
  }

 private:
  Error error(ErrorCode code, std::string what) const {
    return {.code = code, .what = std::move(what), .place = {.file = source_.file}};
  }

  std::optional<Error> read_vertices() {
    if (vertices_ == nullptr) return error(ErrorCode::BadSyntax, "the header has no element 'vertex'");
    if (vertices_->count() >= std::numeric_limits<Index>::max()) {
      return error(ErrorCode::TooLarge,
                   std::to_string(vertices_->count()) + " vertices are more than 2^31 - 2");
    }
    mesh_.position.resize(vertices_->count());
    constexpr std::array<double Vec3::*, 3> kCoordinates = {&Vec3::x, &Vec3::y, &Vec3::z};
    constexpr std::array kNames = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      const int p = find_property(vertices_->element(), kNames[i], false);
      if (p < 0) {
        return error(ErrorCode::BadSyntax,
                     std::string("element 'vertex' has no property '") + kNames[i] + "'");
      }
      vertex_done_.push_back(p);
      read_column(*vertices_, p, [&](Index v, double value) { mesh_.position[v].*kCoordinates[i] = value; });
    }
    return std::nullopt;
  }

  /// Calls keep(row, value) with every value of a scalar property, as a double.
  template <class Keep>
  void read_column(const ElementRows& rows, int p, Keep&& keep) const {
    visit_scalar(rows.element().properties[p].scalar, [&]<class T>(T) {
      exec_.for_blocks(static_cast<Index>(rows.count()), kBlock, [&](Index, Range r) {
        for (Index row = r.begin; row < r.end; ++row) {
          keep(row, static_cast<double>(load<T>(rows.value(row, p), rows.swapped())));
        }
      });
    });
  }

  std::optional<Error> read_faces() {
    for (const char* name : {"vertex_indices", "vertex_index"}) {
      corners_ = find_property(faces_->element(), name, true);
      if (corners_ >= 0) break;
    }
    if (corners_ < 0) return error(ErrorCode::BadSyntax, "element 'face' has no list 'vertex_indices'");
    if (is_floating(corner_property().scalar)) {
      return error(ErrorCode::BadSyntax, "the list '" + corner_property().name + "' is not of integers");
    }
    if (auto fault = find_polygons()) return fault;
    if (auto fault = read_corners()) return fault;
    const Offsets polygons{polygon_begin_};
    if (polygon_begin_.back() == 3 * polygons.size()) {
      mesh_.corner_vertex = std::move(polygon_vertex_);
      return std::nullopt;
    }
    if (Offset{3} * num_triangles(polygons) >= std::numeric_limits<Index>::max()) return too_many_faces();
    triangle_corner_ = triangulate(exec_, polygons, polygon_vertex_, mesh_.position);
    mesh_.corner_vertex.resize(triangle_corner_.size());
    for (std::size_t c = 0; c < triangle_corner_.size(); ++c) {
      mesh_.corner_vertex[c] = polygon_vertex_[triangle_corner_[c]];
    }
    return std::nullopt;
  }

  const Property& corner_property() const { return faces_->element().properties[corners_]; }
  Offset list_length(Offset row, int p) const {
    return load_integer(faces_->value(row, p), *faces_->element().properties[p].list_count,
                        faces_->swapped());
  }

  Error too_many_faces() const {
    return error(ErrorCode::TooLarge, "the faces have more corners than 32-bit indices can count");
  }

  /// polygon_begin_ from the lengths of the corner lists.
  std::optional<Error> find_polygons() {
    const Offset count = faces_->count();
    const std::optional<Offset> common = faces_->common_length(corners_);
    Offset corners = 0;
    if (count >= std::numeric_limits<Index>::max()) return too_many_faces();
    polygon_begin_.resize(count + 1);
    for (Offset row = 0; row < count; ++row) {
      const Offset length = common ? *common : list_length(row, corners_);
      if (length != 3) {
        if (std::string why = unusable_face(length); !why.empty()) {
          return face_error({row, ErrorCode::BadSyntax, std::move(why), faces_->value(row, corners_)});
        }
      }
      corners += length;
      if (corners >= std::numeric_limits<Index>::max()) return too_many_faces();
      polygon_begin_[row + 1] = static_cast<Index>(corners);
    }
    return std::nullopt;
  }

  Error face_error(FaceFault fault) const {
    return {.code = fault.code,
            .what = std::move(fault.what),
            .place = place_of_row(source_, *faces_, fault.row, fault.at)};
  }

  std::optional<Error> read_corners() {
    polygon_vertex_.resize(polygon_begin_.back());
    const auto count = static_cast<Index>(faces_->count());
    std::vector<FaceFault> fault(Exec::num_blocks(count, kBlock));
    visit_scalar(corner_property().scalar, [&]<class T>(T) {
      exec_.for_blocks(count, kBlock, [&](Index k, Range r) { fault[k] = read_corner_block<T>(r); });
    });
    for (FaceFault& f : fault) {
      if (f.row >= 0) return face_error(std::move(f));
    }
    return std::nullopt;
  }

  template <class T>
  FaceFault read_corner_block(Range r) {
    const Offset num_vertices = mesh_.num_vertices();
    const std::size_t count_size = byte_size(*corner_property().list_count);
    for (Index row = r.begin; row < r.end; ++row) {
      const char* at = faces_->value(row, corners_) + count_size;
      for (Index c = polygon_begin_[row]; c < polygon_begin_[row + 1]; ++c, at += sizeof(T)) {
        const auto vertex = static_cast<Offset>(load<T>(at, faces_->swapped()));
        if (vertex < 0 || vertex >= num_vertices) {
          return {row, ErrorCode::IndexOutOfRange,
                  "face " + std::to_string(row) + " names vertex " + std::to_string(vertex) +
                      ", the last is " + std::to_string(num_vertices - 1),
                  at};
        }
        polygon_vertex_[c] = static_cast<Index>(vertex);
      }
    }
    return {};
  }

  void keep_vertex_uv() {
    const Element& element = vertices_->element();
    for (const UvSpelling& spelling : kUvSpellings) {
      const int u = find_property(element, spelling.u, false), v = find_property(element, spelling.v, false);
      if (u < 0 || v < 0) continue;
      vertex_done_.insert(vertex_done_.end(), {u, v});
      std::vector<Vec2> uv(vertices_->count());
      read_column(*vertices_, u, [&](Index row, double value) { uv[row].x = value; });
      read_column(*vertices_, v, [&](Index row, double value) { uv[row].y = value; });
      mesh_.uv_sets.push_back({.name = spelling.set,
                               .corner_uv = uv_of_corners(exec_, mesh_.corner_vertex, uv),
                               .per_vertex = true});
    }
  }

  /// The face list of two numbers a corner.
  void keep_texcoord() {
    const int p = find_property(faces_->element(), "texcoord", true);
    if (p < 0) return;
    texcoord_ = p;
    for (Offset row = 0; row < faces_->count(); ++row) {
      const Offset corners = polygon_begin_[row + 1] - polygon_begin_[row];
      if (list_length(row, p) == 2 * corners) continue;
      mesh_.warnings.push_back("the list 'texcoord' is left out: face " + std::to_string(row) + " has " +
                               std::to_string(list_length(row, p)) + " values for " +
                               std::to_string(corners) + " corners");
      return;
    }
    std::vector<Vec2> uv = read_texcoord(p);
    if (!triangle_corner_.empty()) {
      std::vector<Vec2> corner_uv(triangle_corner_.size());
      for (std::size_t c = 0; c < triangle_corner_.size(); ++c) corner_uv[c] = uv[triangle_corner_[c]];
      uv = std::move(corner_uv);
    }
    const bool per_vertex = is_per_vertex(exec_, mesh_.corner_vertex, uv, mesh_.num_vertices());
    mesh_.uv_sets.push_back({.name = "texcoord", .corner_uv = std::move(uv), .per_vertex = per_vertex});
  }

  std::vector<Vec2> read_texcoord(int p) const {
    const Property& property = faces_->element().properties[p];
    std::vector<Vec2> uv(polygon_begin_.back());
    visit_scalar(property.scalar, [&]<class T>(T) {
      exec_.for_blocks(static_cast<Index>(faces_->count()), kBlock, [&](Index, Range r) {
        for (Index row = r.begin; row < r.end; ++row) {
          const char* at = faces_->value(row, p) + byte_size(*property.list_count);
          for (Index c = polygon_begin_[row]; c < polygon_begin_[row + 1]; ++c, at += 2 * sizeof(T)) {
            uv[c] = {static_cast<double>(load<T>(at, faces_->swapped())),
                     static_cast<double>(load<T>(at + sizeof(T), faces_->swapped()))};
          }
        }
      });
    });
    return uv;
  }

  /// A scalar property in its own type, `copies(row)` giving the range of elements that take the row's value.
  template <class Copies>
  Attribute attribute(const ElementRows& rows, int p, Index num_values, Copies&& copies) const {
    const Property& property = rows.element().properties[p];
    const std::size_t size = byte_size(property.scalar);
    Attribute result{.name = property.name, .scalar = property.scalar, .values = {}};
    result.values.resize(size * static_cast<std::size_t>(num_values));
    visit_scalar(property.scalar, [&]<class T>(T) {
      exec_.for_blocks(static_cast<Index>(rows.count()), kBlock, [&](Index, Range r) {
        for (Index row = r.begin; row < r.end; ++row) {
          const T value = load<T>(rows.value(row, p), rows.swapped());
          const Range range = copies(row);
          for (Index i = range.begin; i < range.end; ++i) {
            std::memcpy(result.values.data() + static_cast<std::size_t>(i) * size, &value, size);
          }
        }
      });
    });
    return result;
  }

  void warn_of_list(const ElementRows& rows, const Property& list) {
    mesh_.warnings.push_back("list '" + list.name + "' of element '" + rows.element().name + "' is left out");
  }

  void keep_vertex_attributes() {
    const auto& properties = vertices_->element().properties;
    for (int p = 0; p < static_cast<int>(properties.size()); ++p) {
      if (std::ranges::count(vertex_done_, p) > 0) continue;
      if (properties[p].list_count) {
        warn_of_list(*vertices_, properties[p]);
        continue;
      }
      mesh_.vertex_attributes.push_back(attribute(*vertices_, p, mesh_.num_vertices(), [](Index v) {
        return Range{v, v + 1};
      }));
    }
  }

  void keep_triangle_attributes() {
    const auto& properties = faces_->element().properties;
    const Offsets polygons{polygon_begin_};
    for (int p = 0; p < static_cast<int>(properties.size()); ++p) {
      if (p == corners_ || p == texcoord_) continue;
      if (properties[p].list_count) {
        warn_of_list(*faces_, properties[p]);
        continue;
      }
      mesh_.triangle_attributes.push_back(attribute(*faces_, p, mesh_.num_triangles(), [&](Index row) {
        return Range{first_triangle(polygons, row), first_triangle(polygons, row + 1)};
      }));
    }
  }

  const Exec& exec_;
  const RowSource& source_;
  const ElementRows* vertices_ = nullptr;
  const ElementRows* faces_ = nullptr;
  int corners_ = -1, texcoord_ = -1;  ///< properties of faces_
  std::vector<int> vertex_done_;      ///< properties of vertices_ that became positions or uv
  std::vector<Index> polygon_begin_, polygon_vertex_;
  std::vector<Index> triangle_corner_;  ///< empty: all polygons are triangles
  Mesh mesh_;
};

}  // namespace

Result<Mesh> mesh_of_rows(const Exec& exec, const RowSource& source,
                          const std::vector<ElementRows>& elements) {
  return MeshOfRows(exec, source, elements).run();
}

}  // namespace planish
