#include "io/carry_over.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "io/rows.hpp"

namespace planish {
namespace {

using Weights = std::array<double, 3>;  // of a triangle's corners in order

/// Sum of the values with a weight; the others may be anything, NaN too. Of two terms the sum is the same
/// from either side of an edge, to the last bit.
template <class ValueOf>
double interpolate(const Weights& weight, ValueOf&& value_of) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    if (weight[i] != 0) sum += weight[i] * value_of(i);
  }
  return sum;
}

Weights weights_at(const SurfacePoint& point) {
  return {point.barycentric.x, point.barycentric.y, point.barycentric.z};
}

/// Weights of a vertex of the embedded mesh in a triangle of the input that contains it. Its origin may be
/// given in a neighbour: then it lies on what both share, and only corners of both have a weight.
Weights weights_in(In<Index> corner_vertex, const Embedding& embedding, Index num_input_vertices,
                   Index triangle, Index vertex) {
  Weights weight{};
  const In<Index> corners = corner_vertex.subspan(std::size_t{3} * triangle, 3);
  const auto give = [&](Index v, double share) {
    const auto found = std::ranges::find(corners, v);
    if (found != corners.end()) weight[found - corners.begin()] = share;
  };
  if (vertex < num_input_vertices) {
    give(vertex, 1);
    return weight;
  }
  const SurfacePoint& point = embedding.vertex_origin[vertex - num_input_vertices];
  if (point.triangle == triangle) return weights_at(point);
  const Weights at_origin = weights_at(point);
  for (int i = 0; i < 3; ++i) give(corner_vertex[std::size_t{3} * point.triangle + i], at_origin[i]);
  return weight;
}

/// The nearest number that the type has.
template <class T>
T rounded(double x) {
  if constexpr (std::floating_point<T>) {
    return static_cast<T>(x);
  } else {
    constexpr double kLowest = std::numeric_limits<T>::lowest(), kHighest = std::numeric_limits<T>::max();
    return static_cast<T>(std::clamp(std::round(x), kLowest, kHighest));
  }
}

Attribute carry_vertex_attribute(const Exec& exec, const Mesh& input, const Embedding& embedding,
                                 const Attribute& attribute) {
  Attribute carried = attribute;
  const Index first = input.num_vertices();
  const std::size_t size = byte_size(attribute.scalar);
  carried.values.resize(size * embedding.position.size());
  const auto value = [&](Index v) {
    return reinterpret_cast<const char*>(attribute.values.data()) + size * v;
  };
  exec.for_blocks(static_cast<Index>(embedding.vertex_origin.size()), kBlock, [&](Index, Range r) {
    visit_scalar(attribute.scalar, [&]<class T>(T) {
      for (Index i = r.begin; i < r.end; ++i) {
        const SurfacePoint& point = embedding.vertex_origin[i];
        const Index* const corner = &input.corner_vertex[std::size_t{3} * point.triangle];
        const T x = rounded<T>(interpolate(
            weights_at(point), [&](int k) { return static_cast<double>(load<T>(value(corner[k]), false)); }));
        std::memcpy(carried.values.data() + size * (static_cast<std::size_t>(first) + i), &x, sizeof(T));
      }
    });
  });
  return carried;
}

Attribute carry_triangle_attribute(const Exec& exec, const Embedding& embedding, const Attribute& attribute) {
  Attribute carried{.name = attribute.name, .scalar = attribute.scalar, .values = {}};
  const std::size_t size = byte_size(attribute.scalar);
  carried.values.resize(size * embedding.triangle_origin.size());
  exec.for_blocks(static_cast<Index>(embedding.triangle_origin.size()), kBlock, [&](Index, Range r) {
    visit_scalar(attribute.scalar, [&]<class T>(T) {
      for (Index t = r.begin; t < r.end; ++t) {
        std::memcpy(carried.values.data() + sizeof(T) * t,
                    attribute.values.data() + sizeof(T) * embedding.triangle_origin[t], sizeof(T));
      }
    });
  });
  return carried;
}

UvSet carry_uv_set(const Exec& exec, const Mesh& input, const Embedding& embedding, const UvSet& set) {
  UvSet carried{.name = set.name, .corner_uv = {}, .per_vertex = set.per_vertex};
  carried.corner_uv.resize(embedding.corner_vertex.size());
  exec.for_blocks(static_cast<Index>(embedding.corner_vertex.size()), kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      const Index origin = embedding.triangle_origin[c / 3];
      const Weights weight = weights_in(input.corner_vertex, embedding, input.num_vertices(), origin,
                                        embedding.corner_vertex[c]);
      const Vec2* const uv = &set.corner_uv[std::size_t{3} * origin];
      carried.corner_uv[c] = {interpolate(weight, [&](int k) { return uv[k].x; }),
                              interpolate(weight, [&](int k) { return uv[k].y; })};
    }
  });
  return carried;
}

/// Repeats the statements of an OBJ file for triangles in another order. All statements are written once, in
/// their order, before the first triangle after them; where the order goes back, those that differ from the
/// ones in force are repeated.
class StatementWriter {
 public:
  explicit StatementWriter(const std::vector<Statement>& statements)
      : statements_(statements), keyword_of_(statements.size()) {
    for (std::size_t i = 0; i < statements.size(); ++i) keyword_of_[i] = number_of(word(statements[i].text));
    in_force_.assign(keywords_.size(), kNone);
    last_.assign(keywords_.size() * (statements.size() + 1), kNone);
    for (std::size_t i = 0; i < statements.size(); ++i) {
      std::copy_n(last_.begin() + i * keywords_.size(), keywords_.size(),
                  last_.begin() + (i + 1) * keywords_.size());
      last_[(i + 1) * keywords_.size() + keyword_of_[i]] = static_cast<Index>(i);
    }
  }

  /// From triangle on, the first `count` statements of the input are in force.
  void go_to(Index triangle, Index count) {
    for (; frontier_ < count; ++frontier_) {
      carried_.push_back({triangle, statements_[frontier_].text});
      in_force_[keyword_of_[frontier_]] = frontier_;
    }
    for (std::size_t k = 0; k < keywords_.size(); ++k) {
      const Index wanted = last_[count * keywords_.size() + k];
      if (keywords_[k] == "mtllib" || wanted == in_force_[k]) continue;  // libraries stay loaded
      if (wanted == kNone || in_force_[k] == kNone ||
          statements_[wanted].text != statements_[in_force_[k]].text) {
        carried_.push_back({triangle, wanted == kNone ? none_of(keywords_[k]) : statements_[wanted].text});
      }
      in_force_[k] = wanted;
    }
  }

  /// The statements after the last triangle go after the last one.
  std::vector<Statement> finish(Index num_triangles) {
    for (; frontier_ < static_cast<Index>(statements_.size()); ++frontier_) {
      carried_.push_back({num_triangles, statements_[frontier_].text});
    }
    return std::move(carried_);
  }

 private:
  static std::string_view word(std::string_view text) { return text.substr(0, text.find_first_of(" \t")); }
  /// What undoes all statements of a keyword.
  static std::string none_of(std::string_view keyword) {
    return keyword == "s" ? "s off" : std::string(keyword);
  }
  std::size_t number_of(std::string_view keyword) {
    const auto found = std::ranges::find(keywords_, keyword);
    const auto number = static_cast<std::size_t>(found - keywords_.begin());
    if (found == keywords_.end()) keywords_.push_back(keyword);
    return number;
  }

  const std::vector<Statement>& statements_;
  std::vector<std::string_view> keywords_;  // a handful
  std::vector<std::size_t> keyword_of_;
  std::vector<Index> last_;      // [statements + 1][keywords] last statement of each among the first i
  std::vector<Index> in_force_;  // [keywords] statement or kNone
  Index frontier_ = 0;           // statements written so far
  std::vector<Statement> carried_;
};

std::vector<Statement> carry_statements(const Mesh& input, const Embedding& embedding) {
  if (input.statements.empty()) return {};
  std::vector<Index> num_before(input.num_triangles());  // [T] statements in force or superseded
  Index count = 0;
  const auto num_statements = static_cast<Index>(input.statements.size());
  for (Index t = 0; t < input.num_triangles(); ++t) {
    while (count < num_statements && input.statements[count].triangle <= t) ++count;
    num_before[t] = count;
  }
  StatementWriter writer(input.statements);
  const auto num_triangles = static_cast<Index>(embedding.triangle_origin.size());
  for (Index t = 0; t < num_triangles; ++t) {
    const Index wanted = num_before[embedding.triangle_origin[t]];
    if (t == 0 || wanted != num_before[embedding.triangle_origin[t - 1]]) writer.go_to(t, wanted);
  }
  return writer.finish(num_triangles);
}

}  // namespace

Mesh carry_over(const Exec& exec, const Mesh& input, const Embedding& embedding) {
  Mesh mesh;
  mesh.position = embedding.position;
  mesh.corner_vertex = embedding.corner_vertex;
  mesh.comments = input.comments;
  mesh.warnings = input.warnings;
  mesh.statements = carry_statements(input, embedding);
  for (const UvSet& set : input.uv_sets) mesh.uv_sets.push_back(carry_uv_set(exec, input, embedding, set));
  for (const Attribute& attribute : input.vertex_attributes) {
    mesh.vertex_attributes.push_back(carry_vertex_attribute(exec, input, embedding, attribute));
  }
  for (const Attribute& attribute : input.triangle_attributes) {
    mesh.triangle_attributes.push_back(carry_triangle_attribute(exec, embedding, attribute));
  }
  return mesh;
}

}  // namespace planish
