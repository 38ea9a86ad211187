#include "engine/prepare/soup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace planish {

Soup make_soup(const Mesh& mesh) {
  Soup soup{mesh.position, std::vector<Index>(mesh.position.size()), mesh.corner_vertex,
            std::vector<Index>(mesh.corner_vertex.size()), std::vector<Index>(mesh.num_triangles())};
  std::iota(soup.vertex_origin.begin(), soup.vertex_origin.end(), 0);
  std::iota(soup.corner_origin.begin(), soup.corner_origin.end(), 0);
  std::iota(soup.triangle_origin.begin(), soup.triangle_origin.end(), 0);
  return soup;
}

void keep_triangles(Soup& soup, const std::vector<char>& keep) {
  Index kept = 0;
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    if (!keep[t]) continue;
    for (Index i = 0; i < 3; ++i) {
      soup.corner_vertex[3 * kept + i] = soup.corner_vertex[3 * t + i];
      soup.corner_origin[3 * kept + i] = soup.corner_origin[3 * t + i];
    }
    soup.triangle_origin[kept++] = soup.triangle_origin[t];
  }
  soup.corner_vertex.resize(3 * static_cast<std::size_t>(kept));
  soup.corner_origin.resize(3 * static_cast<std::size_t>(kept));
  soup.triangle_origin.resize(kept);
}

void MendingLog::add(std::string_view what, Index id) {
  auto mending =
      std::find_if(mendings_.begin(), mendings_.end(), [&](const Mending& m) { return m.what == what; });
  if (mending == mendings_.end()) mending = mendings_.insert(mending, {std::string(what), 0, {}});
  ++mending->count;
  if (mending->ids.size() < kMaxListedIds) mending->ids.push_back(id);
}

std::vector<Mending> MendingLog::finish() && { return std::move(mendings_); }

std::vector<EdgeSide> sorted_sides(In<Index> vertex_of_corner) {
  std::vector<EdgeSide> sides;
  sides.reserve(vertex_of_corner.size());
  for (Index c = 0; c < static_cast<Index>(vertex_of_corner.size()); c += 3) {
    const Index* v = &vertex_of_corner[c];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (Index i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(v[i], v[(i + 1) % 3]);
      sides.push_back({low, high, c + i});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

Unions::Unions(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

Index Unions::root(Index i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void Unions::unite(Index i, Index j) {
  const Index a = root(i), b = root(j);
  parent_[std::max(a, b)] = std::min(a, b);
}

namespace {

bool finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

Precision::Precision(const Soup& soup) {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (Index v : soup.corner_vertex) {
    const Vec3 p = soup.position[v];
    if (!finite(p)) continue;
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  const Vec3 size = upper - lower, centre = lower + 0.5 * size;
  const double extent = std::max({size.x, size.y, size.z}), unit = extent > 0 ? extent : 1;
  const double magnitude =
      std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}) / unit + 0.5;
  const bool usable = std::isfinite(unit) && std::isfinite(1 / unit);
  scale_ = usable ? 1 / unit : std::numeric_limits<double>::quiet_NaN();
  least_altitude_ = 4 * std::numeric_limits<double>::epsilon() * magnitude;
}

bool Precision::is_flat(Vec3 a, Vec3 b, Vec3 c) const {
  if (!finite(a) || !finite(b) || !finite(c)) return false;
  const Vec3 ab = scale_ * (b - a), ac = scale_ * (c - a);
  const double longest = std::max({norm(ab), norm(ac), distance(b, c)});
  return norm(cross(ab, ac)) <= least_altitude_ * longest;
}

std::vector<char> triangles_to_mend(const Soup& soup, const Precision& precision) {
  Unions component(soup.num_triangles());
  const std::vector<EdgeSide> sides = sorted_sides(soup.corner_vertex);
  std::vector<Index> unfit;
  for_each_edge(sides, [&](In<EdgeSide> edge) {
    for (const EdgeSide& side : edge) component.unite(edge[0].corner / 3, side.corner / 3);
    const bool opposed =
        edge.size() == 2 && soup.corner_vertex[edge[0].corner] != soup.corner_vertex[edge[1].corner];
    if (edge.size() > 1 && !opposed) unfit.push_back(edge[0].corner / 3);
  });
  std::vector<char> wanted(soup.num_triangles(), 0);  // by component
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    const Index* v = soup.corners(t);
    if (precision.is_flat(soup.position[v[0]], soup.position[v[1]], soup.position[v[2]]))
      wanted[component.root(t)] = 1;
  }
  for (Index t : unfit) wanted[component.root(t)] = 0;
  std::vector<char> mend(soup.num_triangles());
  for (Index t = 0; t < soup.num_triangles(); ++t) mend[t] = wanted[component.root(t)];
  return mend;
}

void drop_repeated(Soup& soup, MendingLog& log) {
  std::vector<char> keep(soup.num_triangles(), 1);
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    const Index* v = soup.corners(t);
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) continue;
    keep[t] = 0;
    log.add("dropped triangles that name a vertex twice", soup.triangle_origin[t]);
  }
  keep_triangles(soup, keep);
}

namespace {

/// Of the kept triangles, drops doubled ones that hang on an edge of two others and are free at their other
/// edges.
void drop_flaps(const Soup& soup, std::vector<char>& keep, const std::vector<char>& doubled,
                MendingLog& log) {
  if (std::find(doubled.begin(), doubled.end(), 1) == doubled.end()) return;
  std::vector<Index> free_edges(soup.num_triangles(), 0), crowded_edges(soup.num_triangles(), 0);
  for_each_edge(sorted_sides(soup.corner_vertex), [&](In<EdgeSide> edge) {
    const auto kept =
        std::count_if(edge.begin(), edge.end(), [&](const EdgeSide& s) { return keep[s.corner / 3]; });
    for (const EdgeSide& side : edge) (kept == 1 ? free_edges : crowded_edges)[side.corner / 3] += kept != 2;
  });
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    if (!keep[t] || !doubled[t] || free_edges[t] != 2 || crowded_edges[t] != 1) continue;
    keep[t] = 0;
    log.add("dropped flaps without thickness", soup.triangle_origin[t]);
  }
}

}  // namespace

void drop_copies(Soup& soup, MendingLog& log) {
  struct Named {
    std::array<Index, 3> vertices;
    Index triangle;
    auto operator<=>(const Named&) const = default;
  };
  std::vector<Named> named(soup.num_triangles());
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    const Index* v = soup.corners(t);
    named[t] = {{v[0], v[1], v[2]}, t};
    std::sort(named[t].vertices.begin(), named[t].vertices.end());
  }
  std::sort(named.begin(), named.end());
  std::vector<char> keep(soup.num_triangles(), 1), doubled(soup.num_triangles(), 0);
  for (std::size_t i = 1; i < named.size(); ++i) {
    if (named[i].vertices != named[i - 1].vertices) continue;
    keep[named[i].triangle] = 0;
    doubled[named[i - 1].triangle] = keep[named[i - 1].triangle];
  }
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    if (!keep[t]) log.add("dropped copies of triangles", soup.triangle_origin[t]);
  }
  drop_flaps(soup, keep, doubled, log);
  keep_triangles(soup, keep);
}

namespace {

/// Triangles of one sheet, reached from the first across edges with two sides.
struct Sheet {
  std::vector<Index> triangles;
  Index opposed = 0;  ///< how many run against the first
  bool orientable = true;
};

/// opposed [T] out: whether a triangle runs against the first of its sheet; -1 where no sheet has reached it
/// yet.
Sheet walk_sheet(const Soup& soup, In<Index> twin, Index first, Out<signed char> opposed) {
  Sheet sheet;
  sheet.triangles = {first};
  opposed[first] = 0;
  for (std::size_t i = 0; i < sheet.triangles.size(); ++i) {
    const Index t = sheet.triangles[i];
    sheet.opposed += opposed[t];
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      if (twin[c] == kNone) continue;
      const Index next = twin[c] / 3;
      const bool against =
          soup.corner_vertex[c] == soup.corner_vertex[twin[c]];  // both sides start at one vertex
      const auto wanted = static_cast<signed char>(opposed[t] ^ static_cast<signed char>(against));
      if (opposed[next] < 0) {
        opposed[next] = wanted;
        sheet.triangles.push_back(next);
      } else if (opposed[next] != wanted) {
        sheet.orientable = false;
      }
    }
  }
  return sheet;
}

}  // namespace

void turn_triangles(Soup& soup, MendingLog& log) {
  std::vector<Index> twin(soup.corner_vertex.size(), kNone);
  for_each_edge(sorted_sides(soup.corner_vertex), [&](In<EdgeSide> sides) {
    if (sides.size() != 2) return;
    twin[sides[0].corner] = sides[1].corner;
    twin[sides[1].corner] = sides[0].corner;
  });
  std::vector<signed char> opposed(soup.num_triangles(), -1);
  std::vector<char> turn(soup.num_triangles(), 0);
  for (Index first = 0; first < soup.num_triangles(); ++first) {
    if (opposed[first] >= 0) continue;
    const Sheet sheet = walk_sheet(soup, twin, first, opposed);
    if (!sheet.orientable) continue;
    const bool turn_opposed =
        2 * static_cast<Offset>(sheet.opposed) <= static_cast<Offset>(sheet.triangles.size());
    for (Index t : sheet.triangles) turn[t] = (opposed[t] == 1) == turn_opposed;
  }
  for (Index t = 0; t < soup.num_triangles(); ++t) {
    if (!turn[t]) continue;
    std::swap(soup.corner_vertex[3 * t + 1], soup.corner_vertex[3 * t + 2]);
    std::swap(soup.corner_origin[3 * t + 1], soup.corner_origin[3 * t + 2]);
    log.add("turned triangles", soup.triangle_origin[t]);
  }
}

void split_vertices(Soup& soup, MendingLog& log) {
  const auto num_corners = static_cast<Index>(soup.corner_vertex.size());
  Unions fans(num_corners);  // corners of one vertex that hang together across edges
  for_each_edge(sorted_sides(soup.corner_vertex), [&](In<EdgeSide> sides) {
    const Index first = sides[0].corner;
    for (const EdgeSide& side : sides.subspan(1)) {
      const bool same_start = soup.corner_vertex[side.corner] == soup.corner_vertex[first];
      fans.unite(first, same_start ? side.corner : next_corner(side.corner));
      fans.unite(next_corner(first), same_start ? next_corner(side.corner) : side.corner);
    }
  });
  std::vector<Index> fan_vertex(num_corners, kNone);  // by the fan's first corner
  std::vector<char> taken(soup.position.size(), 0), split(soup.position.size(), 0);
  for (Index c = 0; c < num_corners; ++c) {
    const Index fan = fans.root(c), v = soup.corner_vertex[c];
    if (fan_vertex[fan] == kNone) {
      fan_vertex[fan] = v;
      if (taken[v]) {
        fan_vertex[fan] = static_cast<Index>(soup.position.size());
        soup.position.push_back(Vec3(soup.position[v]));
        soup.vertex_origin.push_back(Index(soup.vertex_origin[v]));
        if (!split[v]) log.add("split vertices", soup.vertex_origin[v]);
        split[v] = 1;
      }
      taken[v] = 1;
    }
    soup.corner_vertex[c] = fan_vertex[fan];
  }
}

}  // namespace planish
