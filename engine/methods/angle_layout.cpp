#include "engine/methods/angle_layout.hpp"

#include "engine/solve/global_phase.hpp"
#include "engine/solve/laplacian.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

/// Of half-edge 3 t of each triangle.
struct Frames {
  std::vector<double> direction;  // radians
  std::vector<double> log_length;
};

class Layout {
 public:
  Layout(const Exec& exec, In<Index> corner_vertex, const Topology& topology, In<double> angle)
      : exec_(exec), corner_vertex_(corner_vertex), topology_(topology), angle_(angle) {}

  Result<std::vector<Vec2>> operator()(In<Index> order, In<double> area) {
    carry_frames();
    measure_edges();
    return fit(order).map([&](std::vector<Vec2> uv) {
      scale(area, uv);
      return uv;
    });
  }

 private:
  Index num_triangles() const { return static_cast<Index>(angle_.size() / 3); }
  Index num_vertices() const { return static_cast<Index>(topology_.star_begin.size()) - 1; }

  /// Direction of half-edge c against that of the first of its triangle.
  double turn(Index c) const {
    const Index first = c - c % 3;
    double sum = 0;
    for (Index k = first; k < c; ++k) sum += kPi - angle_[next_corner(k)];
    return sum;
  }
  double log_length(Index c) const {
    return frames_.log_length[c / 3] + std::log(std::sin(angle_[previous_corner(c)])) -
           std::log(std::sin(angle_[previous_corner(c - c % 3)]));
  }
  double direction(Index c) const { return frames_.direction[c / 3] + turn(c); }

  void set_frame(Index c, double direction, double log_length) {
    const Index t = c / 3;
    frames_.direction[t] = reduce_angle(direction - turn(c));
    frames_.log_length[t] = log_length - std::log(std::sin(angle_[previous_corner(c)])) +
                            std::log(std::sin(angle_[previous_corner(3 * t)]));
  }

  void carry_frames() {
    frames_.direction.assign(num_triangles(), 0);
    frames_.log_length.assign(num_triangles(), 0);
    std::vector<std::uint8_t> reached(num_triangles(), 0);
    std::vector<Index> queue;
    queue.reserve(num_triangles());
    for (Index root = 0; root < num_triangles(); ++root) {
      if (reached[root]) continue;
      reached[root] = 1;
      std::size_t head = queue.size();
      queue.push_back(root);
      for (; head < queue.size(); ++head) {
        for (Index c = 3 * queue[head]; c < 3 * queue[head] + 3; ++c) {
          const Index twin = topology_.corner_twin[c];
          if (twin == kNone || reached[twin / 3]) continue;
          set_frame(twin, direction(c) + kPi, log_length(c));
          reached[twin / 3] = 1;
          queue.push_back(twin / 3);
        }
      }
    }
  }

  void measure_edges() {
    vector_.resize(angle_.size());
    const auto measured = [&](Index c) { return std::exp(log_length(c)) * unit(direction(c)); };
    exec_.for_blocks(static_cast<Index>(angle_.size()), kBlock, [&](Index, Range r) {
      for (Index c = r.begin; c < r.end; ++c) {
        const Index twin = topology_.corner_twin[c];
        if (twin == kNone) {
          vector_[c] = measured(c);
        } else if (c < twin) {
          vector_[c] = 0.5 * (measured(c) - measured(twin));
        }
      }
    });
    exec_.for_blocks(static_cast<Index>(angle_.size()), kBlock, [&](Index, Range r) {
      for (Index c = r.begin; c < r.end; ++c) {
        if (const Index twin = topology_.corner_twin[c]; twin != kNone && twin < c)
          vector_[c] = -vector_[twin];
      }
    });
  }

  double weight(Index c) const { return 1 / dot(vector_[c], vector_[c]); }

  /// rhs - L z, 0 at held vertices.
  void residual(In<std::uint8_t> held, In<Vec2> z, Out<Vec2> result) const {
    exec_.for_blocks(num_vertices(), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) {
        Vec2 sum;
        const auto add = [&](Index u, Vec2 edge, double w) { sum += w * (z[u] - z[v] - edge); };
        for (const Index c : slice(In<Index>(topology_.star_corner), topology_.stars().group(v))) {
          add(corner_vertex_[next_corner(c)], vector_[c], weight(c));
          const Index arriving = previous_corner(c);
          if (topology_.corner_twin[arriving] == kNone)
            add(corner_vertex_[arriving], -vector_[arriving], weight(arriving));
        }
        result[v] = held[v] ? Vec2{} : sum;
      }
    });
  }

  Result<std::vector<Vec2>> fit(In<Index> order) const {
    std::vector<std::uint8_t> held(num_vertices(), 0);
    std::vector<std::uint8_t> has_held(topology_.num_components, 0);
    for (Index v = 0; v < num_vertices(); ++v) {
      std::uint8_t& done = has_held[component_of(v)];
      held[v] = !done;
      done = 1;
    }
    const SymmetricMatrix laplacian =
        vertex_laplacian(exec_, corner_vertex_, topology_, held, [&](Index c) { return weight(c); });
    auto global = GlobalPhase::factor(exec_, laplacian, order);
    if (!global) return fail(global.error());
    std::vector<Vec2> z(num_vertices()), change(num_vertices());
    constexpr int kRefinements = 2;
    for (int k = 0; k <= kRefinements; ++k) {
      residual(held, z, change);
      global->solve(exec_, change, change);
      for (Index v = 0; v < num_vertices(); ++v) z[v] += change[v];
    }
    return z;
  }

  Index component_of(Index v) const {
    return topology_.triangle_component[topology_.star_corner[topology_.star_begin[v]] / 3];
  }

  void scale(In<double> area, std::vector<Vec2>& uv) const {
    std::vector<double> now(area.size(), 0);
    for (Index t = 0; t < num_triangles(); ++t) {
      const Vec2 a = uv[corner_vertex_[3 * t]];
      now[topology_.triangle_component[t]] +=
          0.5 * cross(uv[corner_vertex_[3 * t + 1]] - a, uv[corner_vertex_[3 * t + 2]] - a);
    }
    for (Index v = 0; v < num_vertices(); ++v) {
      const Index k = component_of(v);
      uv[v] = std::sqrt(area[k] / std::abs(now[k])) * uv[v];
    }
  }

  const Exec& exec_;
  In<Index> corner_vertex_;
  const Topology& topology_;
  In<double> angle_;
  Frames frames_;
  std::vector<Vec2> vector_;  // [3 T] of each half-edge, its twin's turned round
};

}  // namespace

AngleDefects angle_defects(const Exec& exec, const Topology& topology, In<double> angle) {
  const auto num_vertices = static_cast<Index>(topology.star_begin.size()) - 1;
  std::vector<AngleDefects> part(Exec::num_blocks(num_vertices, kBlock));
  exec.for_blocks(num_vertices, kBlock, [&](Index block, Range r) {
    AngleDefects& worst = part[block];
    for (Index v = r.begin; v < r.end; ++v) {
      double sum = 0, wheel = 0;
      for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
        sum += angle[c];
        wheel += std::log(std::sin(angle[next_corner(c)])) - std::log(std::sin(angle[previous_corner(c)]));
        const double triangle = angle[c] + angle[next_corner(c)] + angle[previous_corner(c)] - kPi;
        worst.triangle = std::max(worst.triangle, std::abs(triangle));
      }
      if (topology.is_boundary(v)) continue;
      worst.vertex = std::max(worst.vertex, std::abs(sum - 2 * kPi));
      worst.wheel = std::max(worst.wheel, std::abs(wheel));
    }
  });
  AngleDefects worst;
  for (const AngleDefects& p : part) {
    worst.triangle = std::max(worst.triangle, p.triangle);
    worst.vertex = std::max(worst.vertex, p.vertex);
    worst.wheel = std::max(worst.wheel, p.wheel);
  }
  return worst;
}

Result<std::vector<Vec2>> lay_out_angles(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                         In<double> angle, In<Index> order, In<double> area) {
  return Layout(exec, corner_vertex, topology, angle)(order, area);
}

}  // namespace planish
