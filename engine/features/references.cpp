#include "engine/features/references.hpp"

#include "engine/features/feature_error.hpp"
#include "engine/features/one_ring.hpp"

namespace planish {
namespace {

class References {
 public:
  References(const Surface& surface, const Topology& topology, const ConstraintSet& set)
      : surface_(surface), topology_(topology), set_(set) {}

  Result<void> operator()() {
    for (; at_ < set_.constraints.size() && !error_; ++at_) {
      const auto& rule = set_.constraints[at_].rule;
      if (const auto* pin = std::get_if<PinConstraint>(&rule)) {
        for (std::size_t i = 0; i < pin->vertex.size(); ++i) vertex(pin->vertex[i], "vertices", i);
      } else if (const auto* angle = std::get_if<AngleConstraint>(&rule)) {
        for (std::size_t i = 0; i < angle->edges.size(); ++i)
          edge(angle->edges[i], "/edges/" + std::to_string(i));
      } else if (const auto* direction = std::get_if<DirectionConstraint>(&rule)) {
        if (direction->edge) edge(*direction->edge, "/edge");
      }
    }
    return error_ ? fail(*error_) : Result<void>();
  }

 private:
  void note(const std::string& what, const std::string& place, ElementKind element, std::vector<Index> ids) {
    if (error_) return;
    error_ = Error{.code = ErrorCode::ConstraintInvalid,
                   .what = "constraint \"" + set_.constraints[at_].name + "\": " + what,
                   .place = {},
                   .element = element,
                   .ids = std::move(ids),
                   .count = 1,
                   .also = {}};
    error_->place.pointer = "/constraints/" + std::to_string(at_) + place;
  }

  bool used(Index v) const { return topology_.star_begin[v] < topology_.star_begin[v + 1]; }

  bool vertex(Index v, const std::string& place) {
    if (v < 0 || v >= surface_.num_vertices()) {
      note("names a vertex that does not exist, the mesh has " + std::to_string(surface_.num_vertices()) +
               ", counted from 0",
           place, ElementKind::Vertex, {v});
    } else if (!used(v)) {
      note("names a vertex that no triangle uses", place, ElementKind::Vertex, {v});
    }
    return !error_;
  }

  void vertex(Index v, const char* key, std::size_t i) {
    vertex(v, std::string("/") + key + "/" + std::to_string(i));
  }

  void edge(const std::array<Index, 2>& ends, const std::string& place) {
    if (!vertex(ends[0], place + "/0") || !vertex(ends[1], place + "/1")) return;
    if (share_edge(surface_, topology_, ends[0], ends[1])) return;
    note("names two vertices that share no edge", place, ElementKind::Edge, {ends[0], ends[1]});
  }

  const Surface& surface_;
  const Topology& topology_;
  const ConstraintSet& set_;
  std::size_t at_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<void> check_references(const Surface& surface, const Topology& topology, const ConstraintSet& set) {
  return References(surface, topology, set)();
}

}  // namespace planish
