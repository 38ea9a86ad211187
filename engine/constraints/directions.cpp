#include "engine/constraints/directions.hpp"

namespace planish {
namespace {

class Directions {
 public:
  Directions(const RestSurface& rest, const Compiled& compiled, const VertexBodies& vertex_bodies,
             const Agreement& agreement)
      : rest_(rest), bodies_(compiled.bodies), vertex_bodies_(vertex_bodies), agreement_(agreement) {}

  std::vector<double> operator()() {
    std::vector<std::vector<Index>> joints_of(bodies_.size());
    for (Index k = 0; k < static_cast<Index>(agreement_.joints.size()); ++k) {
      const Joint& joint = agreement_.joints[k];
      if (joint.b == kNone) continue;
      joints_of[joint.a].push_back(k);
      joints_of[joint.b].push_back(k);
    }
    std::vector<double> direction(bodies_.size(), 0);
    std::vector<std::uint8_t> known(bodies_.size(), 0);
    for (Index root = 0; root < static_cast<Index>(bodies_.size()); ++root) {
      if (known[root]) continue;
      known[root] = 1;
      std::vector<Index> queue = {root};
      for (std::size_t head = 0; head < queue.size(); ++head) {
        const Index from = queue[head];
        for (const Index k : joints_of[from]) {
          const Joint& joint = agreement_.joints[k];
          const Index to = joint.a == from ? joint.b : joint.a;
          if (known[to]) continue;
          known[to] = 1;
          queue.push_back(to);
          const double step = from_b_to_a(joint);
          direction[to] = direction[from] + (joint.a == to ? step : -step);
        }
      }
    }
    return direction;
  }

 private:
  double from_b_to_a(const Joint& joint) const {
    if (joint.kind == Joint::Kind::Fit) return argument(joint.c0);
    const Index v = bodies_[joint.a].vertex[joint.place_a];
    return argument(multiply(at_vertex(joint.a, v), conjugate(at_vertex(joint.b, v))));
  }

  /// Unit sum over a body's edges at v: their directions on the surface against those in the template.
  Vec2 at_vertex(Index b, Index v) const {
    const Body& body = bodies_[b];
    const Index here = vertex_bodies_.place(b, v);
    Vec2 sum{};
    visit_spokes(v, [&](Index neighbour, double angle) {
      const Index there = vertex_bodies_.place(b, neighbour);
      if (there == kNone || !joined(body, here, there)) return;
      sum += multiply(unit(angle), unit(-argument(body.shape[there] - body.shape[here])));
    });
    return dot(sum, sum) > 0 ? sum : Vec2{1, 0};
  }

  static bool joined(const Body& body, Index i, Index j) {
    if (body.kind == Body::Kind::Region) return true;
    const auto n = static_cast<Index>(body.vertex.size());
    const Index apart = std::abs(i - j);
    return apart == 1 || (body.closed && apart == n - 1);
  }

  /// Every edge at v with its polar angle on the surface, counter-clockwise.
  template <class Visit>
  void visit_spokes(Index v, Visit visit) const {
    const Topology& topology = *rest_.topology;
    const In<Index> star = slice(In<Index>(topology.star_corner), topology.stars().group(v));
    double total = 0;
    for (const Index c : star) total += corner_angles(rest_.frame[c / 3])[c % 3];
    const double scale = topology.is_boundary(v) ? 1 : 2 * kPi / total;
    double angle = 0;
    for (const Index c : star) {
      visit(rest_.mesh->corner_vertex[next_corner(c)], scale * angle);
      angle += corner_angles(rest_.frame[c / 3])[c % 3];
    }
    if (topology.is_boundary(v))
      visit(rest_.mesh->corner_vertex[previous_corner(star.back())], scale * angle);
  }

  const RestSurface& rest_;
  const std::vector<Body>& bodies_;
  const VertexBodies& vertex_bodies_;
  const Agreement& agreement_;
};

}  // namespace

std::vector<double> surface_directions(const RestSurface& rest, const Compiled& compiled,
                                       const VertexBodies& vertex_bodies, const Agreement& agreement) {
  return Directions(rest, compiled, vertex_bodies, agreement)();
}

}  // namespace planish
