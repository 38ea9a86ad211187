// Which bodies a vertex belongs to, and at which place.
#pragma once

#include <algorithm>

#include "engine/constraints/compile.hpp"

namespace planish {

class VertexBodies {
 public:
  struct At {
    Index vertex, body, place;
  };

  explicit VertexBodies(const std::vector<Body>& bodies) {
    for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) {
      for (Index i = 0; i < static_cast<Index>(bodies[b].vertex.size()); ++i)
        at_.push_back({bodies[b].vertex[i], b, i});
    }
    std::sort(at_.begin(), at_.end(), [](const At& x, const At& y) {
      return x.vertex != y.vertex ? x.vertex < y.vertex : x.body < y.body;
    });
  }

  /// By vertex, then by body.
  const std::vector<At>& all() const { return at_; }

  In<At> of(Index vertex) const {
    const auto [first, last] = std::equal_range(at_.begin(), at_.end(), At{vertex, 0, 0},
                                                [](const At& x, const At& y) { return x.vertex < y.vertex; });
    return {first, last};
  }

  /// kNone where the body does not have the vertex.
  Index place(Index body, Index vertex) const {
    for (const At& at : of(vertex)) {
      if (at.body == body) return at.place;
    }
    return kNone;
  }

 private:
  std::vector<At> at_;
};

}  // namespace planish
