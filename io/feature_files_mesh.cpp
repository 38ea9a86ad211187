// Polylines out of mesh formats: vertices, and segments between them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/cursor.hpp"
#include "io/feature_files.hpp"
#include "io/obj_chunk.hpp"
#include "io/ply_header.hpp"
#include "io/polyline_chain.hpp"
#include "io/rows.hpp"

namespace planish {
namespace {

constexpr Offset kMostElements = std::numeric_limits<Index>::max() / 2;

/// The polyline of the segments; place_of(segment) is where a segment stands in its file.
template <class PlaceOf>
Result<PolylineSource> joined(In<Vec3> point, In<std::array<Index, 2>> segment, PlaceOf&& place_of) {
  ChainOfSegments chain = join_segments(point, segment);
  if (!chain.fault) return std::move(chain.polyline);
  return fail(Error{.code = ErrorCode::BadSyntax,
                    .what = "expected one polyline without branches, found: " + chain.fault->what,
                    .place = place_of(chain.fault->segment),
                    .element = ElementKind::Vertex,
                    .ids = std::move(chain.fault->points),
                    .count = chain.fault->count});
}

bool is_finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// The statements v and l of an OBJ file.
class ObjLines {
 public:
  ObjLines(std::string_view text, const std::string& file)
      : text_(text), file_(file), cursor_(text, kObjDialect) {}

  Result<PolylineSource> run() {
    for (; !cursor_.at_end() && !fault_; cursor_.next_line()) {
      if (cursor_.at_line_end()) continue;
      const std::string_view keyword = cursor_.token();
      if (keyword == "v") {
        parse_vertex();
      } else if (keyword == "l") {
        parse_line();
      }
    }
    if (!fault_) check_indices();
    if (!fault_ && segment_.empty())
      fault(ErrorCode::BadSyntax, "expected a polyline ('l'), found the end of the file", cursor_.position());
    if (fault_) return fail(std::move(*fault_));
    return joined(point_, segment_, [&](std::size_t s) { return place_in(text_, where_[s], file_); });
  }

 private:
  void fault(ErrorCode code, std::string what, const char* position) {
    if (!fault_)
      fault_ = Error{.code = code, .what = std::move(what), .place = place_in(text_, position, file_)};
  }

  void parse_vertex() {
    double value[3] = {0, 0, 0};
    for (double& x : value) {
      cursor_.at_line_end();
      const char* begin = cursor_.position();
      if (!cursor_.read_double(x) || !cursor_.at_separator()) {
        return fault(ErrorCode::BadSyntax, "expected a number of a vertex, found " + quoted(text_, begin),
                     begin);
      }
    }
    point_.push_back({value[0], value[1], value[2]});
  }

  void parse_line() {
    const char* begin = cursor_.position();
    Index before = kNone;
    std::size_t count = 0;
    for (; !cursor_.at_line_end() && !fault_; ++count) {
      const char* at = cursor_.position();
      const Index vertex = parse_index(at);
      if (count > 0) {
        segment_.push_back({before, vertex});
        where_.push_back(at);
      }
      before = vertex;
    }
    if (count < 2)
      fault(ErrorCode::BadSyntax, "a line needs two vertices, found " + std::to_string(count), begin);
    if (static_cast<Offset>(segment_.size()) > kMostElements)
      fault(ErrorCode::TooLarge, "more than 2^30 segments", begin);
  }

  /// v or v/vt, from 1 or, negative, from the latest vertex back. Later vertices may be named.
  Index parse_index(const char* begin) {
    Offset vertex = 0, uv = 0;
    bool good = cursor_.read_integer(vertex);
    if (good && !cursor_.at_separator() && *cursor_.position() == '/') {
      cursor_.move_to(cursor_.position() + 1);
      cursor_.read_integer(uv);
    }
    good = good && cursor_.at_separator();
    if (!good)
      fault(ErrorCode::BadSyntax, "expected a vertex of a line (v or v/vt), found " + quoted(text_, begin),
            begin);
    const Offset index = vertex < 0 ? static_cast<Offset>(point_.size()) + vertex : vertex - 1;
    if (good && (index < 0 || index > kMostElements)) {
      fault(ErrorCode::IndexOutOfRange,
            "line names vertex " + std::to_string(vertex) + ", " + std::to_string(point_.size()) +
                " are defined before it",
            begin);
    }
    return static_cast<Index>(std::clamp<Offset>(index, 0, kMostElements));
  }

  void check_indices() {
    const auto num_points = static_cast<Index>(point_.size());
    for (std::size_t s = 0; s < segment_.size() && !fault_; ++s) {
      for (const Index v : segment_[s]) {
        if (v >= num_points) {
          fault(ErrorCode::IndexOutOfRange,
                "line names vertex " + std::to_string(v + 1) + ", only " + std::to_string(num_points) +
                    " are defined",
                where_[s]);
        } else if (!is_finite(point_[v])) {
          fault(
              ErrorCode::BadSyntax,
              "vertex " + std::to_string(v + 1) + " of the line has a coordinate that is not a finite number",
              where_[s]);
        }
      }
    }
  }

  std::string_view text_;
  const std::string& file_;
  Cursor cursor_;
  std::vector<Vec3> point_;
  std::vector<std::array<Index, 2>> segment_;
  std::vector<const char*> where_;  ///< [S] the second vertex of each segment
  std::optional<Error> fault_;
};

/// Numbers of scalar properties of an element; kNone for one that it does not have.
template <std::size_t n>
std::array<int, n> find_properties(const Element& element, const std::array<const char*, n>& names,
                                   bool integer) {
  std::array<int, n> found;
  found.fill(kNone);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      if (property.name == names[i] && !property.list_count && !(integer && is_floating(property.scalar)))
        found[i] = static_cast<int>(p);
    }
  }
  return found;
}

/// The elements vertex and edge of a PLY file.
class PlyEdges {
 public:
  PlyEdges(const Exec& exec, const RowSource& source, const std::vector<ElementRows>& elements)
      : exec_(exec), source_(source) {
    for (const ElementRows& rows : elements) {
      if (rows.element().name == "vertex") vertices_ = &rows;
      if (rows.element().name == "edge") edges_ = &rows;
    }
  }

  Result<PolylineSource> run() {
    if (vertices_ == nullptr || vertices_->count() == 0) return bad_header("no element 'vertex' with rows");
    if (edges_ == nullptr || edges_->count() == 0) return bad_header("no element 'edge' with rows");
    if (vertices_->count() > kMostElements || edges_->count() > kMostElements)
      return fail(
          Error{.code = ErrorCode::TooLarge, .what = "more than 2^30 rows", .place = {.file = source_.file}});
    const auto xyz = find_properties(vertices_->element(), std::array{"x", "y", "z"}, false);
    const auto ends = find_properties(edges_->element(), std::array{"vertex1", "vertex2"}, true);
    if (std::ranges::count(xyz, kNone) > 0) return bad_header("element 'vertex' without x, y and z");
    if (std::ranges::count(ends, kNone) > 0)
      return bad_header("element 'edge' without integers vertex1 and vertex2");
    read_points(xyz);
    if (auto fault = read_segments(ends)) return fail(std::move(*fault));
    return joined(point_, segment_, [&](std::size_t s) { return place_of_edge(static_cast<Offset>(s)); });
  }

 private:
  Failure bad_header(const std::string& found) const {
    return fail(Error{.code = ErrorCode::BadSyntax,
                      .what = "expected vertices (x, y, z) and edges (vertex1, vertex2), found " + found,
                      .place = {.file = source_.file, .line = 1}});
  }

  Place place_of_edge(Offset row) const { return place_of_row(source_, *edges_, row, edges_->value(row, 0)); }

  void read_points(const std::array<int, 3>& xyz) {
    point_.resize(static_cast<std::size_t>(vertices_->count()));
    const auto read = [&](Index row, int property) {
      const Scalar scalar = vertices_->element().properties[property].scalar;
      return visit_scalar(scalar, [&]<class T>(T) {
        return static_cast<double>(load<T>(vertices_->value(row, property), vertices_->swapped()));
      });
    };
    exec_.for_blocks(static_cast<Index>(point_.size()), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) point_[v] = {read(v, xyz[0]), read(v, xyz[1]), read(v, xyz[2])};
    });
  }

  std::optional<Error> read_segments(const std::array<int, 2>& ends) {
    const auto num_edges = edges_->count();
    segment_.reserve(static_cast<std::size_t>(num_edges));
    for (Offset row = 0; row < num_edges; ++row) {
      std::array<Index, 2> segment{};
      for (std::size_t i = 0; i < 2; ++i) {
        const Scalar scalar = edges_->element().properties[ends[i]].scalar;
        const Offset vertex = load_integer(edges_->value(row, ends[i]), scalar, edges_->swapped());
        if (vertex < 0 || vertex >= vertices_->count()) {
          return Error{.code = ErrorCode::IndexOutOfRange,
                       .what = "edge names vertex " + std::to_string(vertex) + ", only " +
                               std::to_string(vertices_->count()) + " are defined",
                       .place = place_of_edge(row)};
        }
        segment[i] = static_cast<Index>(vertex);
        if (!is_finite(point_[segment[i]])) {
          return Error{.code = ErrorCode::BadSyntax,
                       .what = "vertex " + std::to_string(vertex) +
                               " of the edge has a coordinate that is not a finite number",
                       .place = place_of_edge(row)};
        }
      }
      segment_.push_back(segment);
    }
    return std::nullopt;
  }

  const Exec& exec_;
  const RowSource& source_;
  const ElementRows* vertices_ = nullptr;
  const ElementRows* edges_ = nullptr;
  std::vector<Vec3> point_;
  std::vector<std::array<Index, 2>> segment_;
};

}  // namespace

Result<PolylineSource> parse_polyline_obj(std::string_view text, const std::string& file) {
  return ObjLines(text, file).run();
}

Result<PolylineSource> parse_polyline_ply(const Exec& exec, std::string_view bytes, const std::string& file) {
  const auto header = parse_ply_header(bytes, file);
  if (!header) return fail(header.error());
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
  return PlyEdges(exec, source, *rows).run();
}

}  // namespace planish
