#include "engine/constraints/orientation.hpp"

#include <algorithm>
#include <map>

#include "engine/constraints/directions.hpp"
#include "engine/constraints/disjoint_sets.hpp"
#include "engine/constraints/near_closure.hpp"
#include "engine/features/one_ring.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

class Orienting {
 public:
  Orienting(const Exec& exec, const RestSurface& rest, const ConstraintView& view, Compiled compiled,
            const StartInput& input, Init init)
      : exec_(exec), rest_(rest), view_(view), compiled_(std::move(compiled)), input_(input), init_(init) {
    compiled_.pins.clear();
  }

  Result<Orientation> operator()() {
    return agree_on_shapes()
        .and_then([&] { return lay_out(separate_clusters(bodies().size()), surface_angle_); })
        .and_then([&] { return check_folds(); })
        .and_then([&] { return rotate(); })
        .and_then([&] { return relate(); })
        .map([&] { return std::move(result_); });
  }

 private:
  const std::vector<Body>& bodies() const { return compiled_.bodies; }

  Result<void> agree_on_shapes() {
    auto agreed = agree(compiled_, view_, *rest_.mesh);
    if (!agreed) return fail(agreed.error());
    agreement_ = std::move(*agreed);
    assemblies_ = find_assemblies(compiled_, agreement_);
    vertex_bodies_.emplace(bodies());
    owners_ = find_owners(compiled_, agreement_);
    surface_angle_ = surface_directions(rest_, compiled_, *vertex_bodies_, agreement_);
    mark_fixed();
    return {};
  }

  // ---- the layout ----

  void mark_fixed() {
    const Surface surface = rest_.surface();
    layout_.assembly.assign(surface.position.size(), kNone);
    layout_.point.resize(surface.position.size());
    layout_.fixed_edge.assign(surface.corner_vertex.size(), 0);
    layout_.fixed_triangle.assign(surface.num_triangles(), 0);
    const auto fix = [&](Index c) {
      if (c == kNone) return;
      layout_.fixed_edge[c] = 1;
      if (const Index twin = rest_.topology->corner_twin[c]; twin != kNone) layout_.fixed_edge[twin] = 1;
    };
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const Body& body = bodies()[b];
      for (const Index t : body.triangle) {
        layout_.fixed_triangle[t] = 1;
        for (Index c = 3 * t; c < 3 * t + 3; ++c) fix(c);
      }
      if (!body.has_edges()) continue;
      for (const Index v : body.vertex) layout_.assembly[v] = assemblies_.of[b];
      for (std::size_t i = 0; i < body.num_edges(); ++i) {
        const Index u = body.vertex[i], v = body.vertex[(i + 1) % body.vertex.size()];
        fix(half_edge(surface, *rest_.topology, u, v));
        fix(half_edge(surface, *rest_.topology, v, u));
      }
    }
    for (Index t = 0; t < surface.num_triangles(); ++t) {
      int edges = 0;
      for (Index c = 3 * t; c < 3 * t + 3; ++c) edges += layout_.fixed_edge[c];
      if (edges > 1) layout_.fixed_triangle[t] = 1;
    }
  }

  Result<void> lay_out(const Clusters& clusters, In<double> angle) {
    const auto parted = part_nearly_closed(
        compiled_, view_.set->agreement,
        [&] { return std::make_unique<Poses>(compiled_, agreement_, assemblies_, clusters, angle); },
        agreement_, owners_);
    result_.parted.insert(result_.parted.end(), parted.begin(), parted.end());
    auto poses = closed_poses(compiled_, view_, *rest_.mesh, agreement_, assemblies_, clusters, angle);
    if (!poses) return fail(poses.error());
    poses_ = std::move(*poses);
    for (const Owner& owner : owners_) layout_.point[owner.vertex] = poses_->point(owner.body, owner.place);
    return {};
  }

  Result<void> check_folds() const {
    return planish::check_folds(rest_, view_, compiled_, agreement_, owners_, layout_.point);
  }

  // ---- rotations ----

  Result<void> rotate() {
    if (init_ == Init::Harmonic || init_ == Init::Identity) return read_rotations();
    auto problem = RotationProblem::make(exec_, rest_, input_, layout_, init_);
    if (!problem) return fail(problem.error());
    problem_.emplace(std::move(*problem));
    return solve();
  }

  Result<void> solve() {
    std::vector<Index> at;
    auto rotations = problem_->solve(layout_, at);
    if (!rotations) return fail(named(rotations.error(), at));
    rotations_ = std::move(*rotations);
    return {};
  }

  Error named(const Error& error, const std::vector<Index>& at) const {
    if (error.code != ErrorCode::ConstraintsConflict) return error;
    std::vector<Index> constraints;
    for (const Index v : at) {
      for (const auto& here : vertex_bodies_->of(v)) constraints.push_back(bodies()[here.body].constraint);
    }
    for (const Relation& r : compiled_.relations) {
      const auto is_here = [&](Index b) {
        return b != kNone &&
               std::find(constraints.begin(), constraints.end(), bodies()[b].constraint) != constraints.end();
      };
      if (is_here(r.a) && is_here(r.b)) constraints.push_back(r.constraint);
    }
    return conflict(*view_.set, constraints, error.what);
  }

  Result<void> read_rotations() {
    rotations_.theta.resize(rest_.frame.size());
    Result<std::vector<Vec2>> rotation = std::vector<Vec2>();
    if (init_ == Init::Harmonic) {
      rotation = harmonic_rotations(exec_, input_, rest_.outer_loop);
    } else {
      auto start = first_rotations(exec_, input_, init_);
      if (!start) return fail(start.error());
      rotation = std::move(start->rotation);
    }
    if (!rotation) return fail(rotation.error());
    for (std::size_t t = 0; t < rotation->size(); ++t) rotations_.theta[t] = argument((*rotation)[t]);
    return {};
  }

  /// By how much each assembly is turned against its layout, and a triangle from which that is read.
  struct Turned {
    std::vector<double> by;
    std::vector<Index> triangle, component;
  };
  Turned measure() const {
    const Index n = assemblies_.size();
    std::vector<Vec2> sum(n);
    Turned turned{std::vector<double>(n), std::vector<Index>(n, kNone), std::vector<Index>(n, 0)};
    const In<Index> vertex = rest_.mesh->corner_vertex;
    for (Index c = 0; c < static_cast<Index>(vertex.size()); ++c) {
      if (!layout_.fixed_edge[c]) continue;
      const Index assembly = layout_.assembly[vertex[c]];
      if (assembly == kNone) continue;
      const double length = norm(edge_vectors(rest_.frame[c / 3])[c % 3]);
      sum[assembly] += length * unit(rotations_.theta[c / 3] - laid_out_rotation(layout_, rest_, c));
      if (turned.triangle[assembly] == kNone) turned.triangle[assembly] = c / 3;
    }
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const Index assembly = assemblies_.of[b];
      if (!bodies()[b].has_edges() && turned.triangle[assembly] == kNone)
        sum[assembly] += multiply(chain_vector(bodies()[b]), unit(-poses_->angle(static_cast<Index>(b))));
      const Index corner = rest_.topology->star_corner[rest_.topology->star_begin[bodies()[b].vertex[0]]];
      turned.component[assembly] = rest_.topology->triangle_component[corner / 3];
    }
    for (Index a = 0; a < n; ++a) turned.by[a] = dot(sum[a], sum[a]) > 0 ? argument(sum[a]) : 0;
    return turned;
  }

  /// From the first to the last vertex of a chord's feature, as the rotations lay its edges.
  Vec2 chain_vector(const Body& body) const {
    Vec2 sum{};
    const std::vector<Index>& chain = view_.features[body.feature].vertex;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      for (const bool forwards : {true, false}) {
        const Index u = chain[forwards ? i : i + 1], v = chain[forwards ? i + 1 : i];
        const Index c = half_edge(rest_.surface(), *rest_.topology, u, v);
        if (c == kNone) continue;
        const Vec2 edge = multiply(unit(rotations_.theta[c / 3]), edge_vectors(rest_.frame[c / 3])[c % 3]);
        sum += forwards ? edge : -edge;
      }
    }
    return sum;
  }

  // ---- relations ----

  Result<void> relate() {
    Turned turned = measure();
    Measured measured{.angle = {}, .frame = {}, .num_frames = rest_.topology->num_components};
    for (Index b = 0; b < static_cast<Index>(bodies().size()); ++b) {
      const Index assembly = assemblies_.of[b];
      // A chord has no edges whose angles to others of its assembly the surface tells.
      const Vec2 along = bodies()[b].has_edges() ? Vec2{} : chain_vector(bodies()[b]);
      measured.angle.push_back(dot(along, along) > 0 ? argument(along)
                                                     : poses_->angle(b) + turned.by[assembly]);
      measured.frame.push_back(turned.component[assembly]);
    }
    auto oriented = choose_branches(compiled_, view_, measured);
    if (!oriented) return fail(oriented.error());
    for (std::size_t b = 0; b < bodies().size(); ++b)
      measured.angle[b] += oriented->frame_turn[measured.frame[b]];
    result_.clusters = std::move(oriented->clusters);
    result_.chosen = std::move(oriented->chosen);
    if (!compiled_.relations.empty()) {
      if (auto met = meet_relations(measured); !met) return met;
      turned = measure();
    }
    mark_directed(*oriented);
    for (Index b = 0; b < static_cast<Index>(bodies().size()); ++b)
      result_.angle.push_back(poses_->angle(b) + turned.by[assemblies_.of[b]]);
    result_.theta = std::move(rotations_.theta);
    result_.residual = rotations_.residual;
    return {};
  }

  void mark_directed(const Oriented& oriented) {
    std::vector<Index> members(oriented.directed_set.size(), 0);
    for (const Index set : oriented.frame_set) ++members[set];
    for (const Index set : oriented.frame_set)
      result_.directed.push_back(oriented.directed_set[set] || members[set] > 1);
  }

  /// Laid out anew with common orientations; rows along paths then turn assemblies against one another.
  Result<void> meet_relations(const Measured& measured) {
    if (auto laid_out = lay_out(result_.clusters, measured.angle); !laid_out) return laid_out;
    if (auto folds = check_folds(); !folds) return folds;
    const DisjointSets tied = tied_assemblies();
    if (problem_) {
      if (auto solved = solve(); !solved) return solved;
      const std::vector<PathRow> rows = path_rows(measure(), tied);
      if (!rows.empty()) {
        auto adjusted = problem_->adjust(layout_, rotations_, rows);
        if (!adjusted) return fail(adjusted.error());
        rotations_ = std::move(*adjusted);
        if (auto checked = check_rows(rows); !checked) return checked;
      }
    }
    align_frames(measure(), tied);
    return {};
  }

  /// Assemblies whose directions clusters tie; the last index stands for the u axis.
  DisjointSets tied_assemblies() const {
    const Index axis = assemblies_.size();
    DisjointSets tied(axis + 1);
    std::vector<Index> first_of_cluster(result_.clusters.size(), kNone);
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const Index cluster = result_.clusters.of[b];
      Index& first = first_of_cluster[cluster];
      if (result_.clusters.directed[cluster]) tied.unite(axis, assemblies_.of[b]);
      if (first == kNone) first = assemblies_.of[b];
      tied.unite(first, assemblies_.of[b]);
    }
    return tied;
  }

  /// In the common layout all tied assemblies have one turn: in every component a row for each of them but the first.
  std::vector<PathRow> path_rows(const Turned& turned, DisjointSets tied) const {
    std::map<std::pair<Index, Index>, Index> leader;
    std::vector<PathRow> rows;
    for (Index a = 0; a < assemblies_.size(); ++a) {
      if (turned.triangle[a] == kNone) continue;
      const auto [entry, added] = leader.try_emplace({tied.root(a), turned.component[a]}, a);
      if (added) continue;
      const Index other = entry->second;
      rows.push_back({.end = {{turned.triangle[a], 1}, {turned.triangle[other], -1}},
                      .change = reduce_angle(turned.by[other] - turned.by[a])});
    }
    return rows;
  }

  /// Turns whole components so that what is tied across them, or to the u axis, has one turn. A component follows the
  /// first set of assemblies that asks for it.
  void align_frames(const Turned& turned, DisjointSets tied) {
    const Index axis = assemblies_.size();
    std::vector<double> by(rest_.topology->num_components, 0);
    std::vector<std::uint8_t> aligned(by.size(), 0);
    std::map<Index, double> wanted = {{tied.root(axis), 0.0}};  // per tied set
    const auto align = [&](bool to_axis) {
      for (Index a = 0; a < assemblies_.size(); ++a) {
        const Index set = tied.root(a), component = turned.component[a];
        if ((set == tied.root(axis)) != to_axis || aligned[component]) continue;
        aligned[component] = 1;
        by[component] = wanted.try_emplace(set, turned.by[a]).first->second - turned.by[a];
      }
    };
    align(true);
    align(false);
    for (std::size_t t = 0; t < rotations_.theta.size(); ++t)
      rotations_.theta[t] += by[rest_.topology->triangle_component[t]];
  }

  Result<void> check_rows(const std::vector<PathRow>& rows) {
    const Turned turned = measure();
    for (const PathRow& row : rows) {
      double off = 0;
      for (const PathRow::End& end : row.end) {
        const auto a =
            std::find(turned.triangle.begin(), turned.triangle.end(), end.triangle) - turned.triangle.begin();
        off += end.sign * turned.by[a];
      }
      rotations_.residual = std::max(rotations_.residual, std::abs(reduce_angle(off)));
    }
    if (rotations_.residual <= 1e-9) return {};
    return fail(ErrorCode::ResidualTooLarge, "rotations miss rows of angle constraints by " +
                                                 std::to_string(rotations_.residual) +
                                                 " radians, 1e-9 is allowed");
  }

  const Exec& exec_;
  const RestSurface& rest_;
  const ConstraintView& view_;
  Compiled compiled_;
  const StartInput& input_;
  Init init_;
  Agreement agreement_;
  Assemblies assemblies_;
  std::optional<VertexBodies> vertex_bodies_;
  std::vector<Owner> owners_;
  std::vector<double> surface_angle_;
  Layout layout_;
  std::unique_ptr<Poses> poses_;
  std::optional<RotationProblem> problem_;
  Rotations rotations_;
  Orientation result_;
};

}  // namespace

Result<Orientation> orient(const Exec& exec, const RestSurface& rest, const ConstraintView& view,
                           Compiled compiled, const StartInput& input, Init init) {
  return Orienting(exec, rest, view, std::move(compiled), input, init)();
}

}  // namespace planish
