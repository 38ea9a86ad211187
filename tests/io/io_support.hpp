// What the tests of readers and writers share.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "io/mesh_files.hpp"

namespace planish::test {

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "planish-test-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }

 private:
  std::string path_;
};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same_attributes(const std::vector<Attribute>& a, const std::vector<Attribute>& b) {
  return std::ranges::equal(a, b, [](const Attribute& p, const Attribute& q) {
    return p.name == q.name && p.scalar == q.scalar && p.values == q.values;
  });
}

/// Everything equal, numbers bit for bit.
inline bool same_mesh(const Mesh& a, const Mesh& b) {
  const auto same_set = [](const UvSet& p, const UvSet& q) {
    return p.name == q.name && p.per_vertex == q.per_vertex && same_bytes(p.corner_uv, q.corner_uv);
  };
  const auto same_statement = [](const Statement& p, const Statement& q) {
    return p.triangle == q.triangle && p.text == q.text;
  };
  return same_bytes(a.position, b.position) && a.corner_vertex == b.corner_vertex &&
         std::ranges::equal(a.uv_sets, b.uv_sets, same_set) &&
         same_attributes(a.vertex_attributes, b.vertex_attributes) &&
         same_attributes(a.triangle_attributes, b.triangle_attributes) &&
         std::ranges::equal(a.statements, b.statements, same_statement) && a.comments == b.comments &&
         a.warnings == b.warnings;
}

using Reader = Result<Mesh> (*)(const Exec&, std::string_view, const std::string&);

/// Reads text that must be readable.
inline Mesh must_read(Reader read, std::string_view bytes) {
  const Exec exec;
  Result<Mesh> mesh = read(exec, bytes, "part");
  if (!mesh) FAIL(describe(mesh.error()));
  return std::move(*mesh);
}

/// Reads text that must not be readable.
inline Error must_fail(Reader read, std::string_view bytes) {
  const Exec exec;
  const Result<Mesh> mesh = read(exec, bytes, "part");
  REQUIRE(!mesh.has_value());
  return mesh.error();
}

inline bool indices_in_range(const Mesh& mesh) {
  const auto in_range = [&](Index v) { return v >= 0 && v < mesh.num_vertices(); };
  return mesh.corner_vertex.size() % 3 == 0 && std::ranges::all_of(mesh.corner_vertex, in_range);
}

/// Attribute, uv and statement columns have the lengths the mesh promises.
inline bool columns_fit(const Mesh& mesh) {
  const auto fits = [](Index count) {
    return [count](const Attribute& a) {
      return a.values.size() == byte_size(a.scalar) * static_cast<std::size_t>(count);
    };
  };
  return std::ranges::all_of(mesh.vertex_attributes, fits(mesh.num_vertices())) &&
         std::ranges::all_of(mesh.triangle_attributes, fits(mesh.num_triangles())) &&
         std::ranges::all_of(
             mesh.uv_sets,
             [&](const UvSet& set) { return set.corner_uv.size() == mesh.corner_vertex.size(); }) &&
         std::ranges::all_of(mesh.statements, [&](const Statement& s) {
           return s.triangle >= 0 && s.triangle <= mesh.num_triangles();
         });
}

/// The values of a column as doubles; fails the test when the column is missing.
template <class T>
std::vector<T> values(const std::vector<Attribute>& attributes, const std::string& name) {
  for (const Attribute& attribute : attributes) {
    if (attribute.name != name) continue;
    REQUIRE(byte_size(attribute.scalar) == sizeof(T));
    std::vector<T> result(attribute.values.size() / sizeof(T));
    std::memcpy(result.data(), attribute.values.data(), attribute.values.size());
    return result;
  }
  FAIL("no attribute " << name);
  return {};
}

template <class T>
Attribute column(std::string name, Scalar scalar, const std::vector<T>& numbers) {
  Attribute attribute{.name = std::move(name), .scalar = scalar, .values = {}};
  attribute.values.resize(numbers.size() * sizeof(T));
  if (!numbers.empty()) std::memcpy(attribute.values.data(), numbers.data(), attribute.values.size());
  return attribute;
}

/// A number appended as it lies in memory, in either byte order.
template <class T>
void put(std::string& bytes, T value, bool swapped = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (swapped) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// n by n vertices on a wavy square, with awkward coordinates.
inline Mesh grid(Index n) {
  Mesh mesh;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      mesh.position.push_back({i / 3.0, j / 7.0, std::sin(0.1 * i * j) * 1e-7});
    }
  }
  for (Index j = 0; j + 1 < n; ++j) {
    for (Index i = 0; i + 1 < n; ++i) {
      const Index a = j * n + i;
      for (const Index v : {a, a + 1, a + n + 1, a, a + n + 1, a + n}) mesh.corner_vertex.push_back(v);
    }
  }
  return mesh;
}

}  // namespace planish::test
