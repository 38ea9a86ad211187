#include "engine/solve/newton_map.hpp"

#include <algorithm>
#include <numeric>

#include "engine/solve/determinant_multiples.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

constexpr double kSufficientDecrease = 1e-4;
constexpr int kMostHalvings = 30;
// Of a sum, relative; and of the lengths of edges, which is more where the energy is next to none.
constexpr double kEnergyRounding = 1e-14, kLengthRounding = 2e-16;
// The share of the projection in the Hessian, from step to step.
constexpr double kLessProjection = 0.25;
constexpr double kMoreProjection = 3;
constexpr double kLeastProjection = 1e-3;  // less is none
/// Vertices that contacts couple without an elimination order of their own, over the root of their number.
constexpr double kFewCoupled = 0.7;
/// Steps that a kept factor is bent by; 5, 10 and 20 take the same time (perf/README.md).
constexpr int kPairs = 10;
// Of the diagonal, where rounding makes a projected Hessian of very unlike triangles indefinite.
constexpr double kFirstLift = 1e-12, kMostLift = 1e-4;

/// Moves of features at the DOF map's base.
void set_moves(const DofMap& dof, ReducedUnknowns& unknowns) {
  const Index first = 2 * unknowns.num_pairs();
  const NodeMap& nodes = dof.nodes();
  const Index num_carriers = dof.num_nodes() - dof.num_vertices();
  std::vector<std::vector<ReducedUnknowns::Move>> moves(unknowns.feature_vertex.size());
  dof.visit_carried([&](Index v, Index node) {
    if (node == kNone) return;
    const Index carrier = first + 2 * (node - static_cast<Index>(nodes.node.size()));
    moves[unknowns.feature_place[v]] = {{carrier, {1, 0}}, {carrier + 1, {0, 1}}};
  });
  for (const DofMap::Motion& m : dof.motions())
    moves[unknowns.feature_place[m.vertex]].push_back({first + 2 * num_carriers + m.column, m.value});
  unknowns.line = dof.line_edges();
  for (DofMap::LineEdge& edge : unknowns.line) {
    for (auto& [unknown, rate] : edge.rate) unknown += first + 2 * num_carriers;
  }
  unknowns.move.clear();
  unknowns.move_begin.assign(1, 0);
  for (const auto& of_vertex : moves) {
    unknowns.move.insert(unknowns.move.end(), of_vertex.begin(), of_vertex.end());
    unknowns.move_begin.push_back(static_cast<Index>(unknowns.move.size()));
  }
}

}  // namespace

ReducedUnknowns whole_unknowns(const DofMap& dof, In<Index> order, In<Index> vertex_component,
                               In<std::uint8_t> turns_freely, In<Vec2> x) {
  ReducedUnknowns unknowns;
  const NodeMap& nodes = dof.nodes();
  unknowns.pair.assign(nodes.node.size(), kNone);
  for (const Index v : order) {
    if (nodes.node[v] != v) continue;
    unknowns.pair[v] = unknowns.num_pairs();
    unknowns.vertex.push_back(v);
  }
  unknowns.size = 2 * unknowns.num_pairs() + 2 * (dof.num_nodes() - dof.num_vertices()) + dof.num_border();
  if (dof.poses() != nullptr) {
    unknowns.feature_place.assign(nodes.node.size(), kNone);
    dof.visit_carried([&](Index v, Index) {
      unknowns.feature_place[v] = static_cast<Index>(unknowns.feature_vertex.size());
      unknowns.feature_vertex.push_back(v);
    });
    set_moves(dof, unknowns);
  }
  // What is held lies at 0, or at the one pin of its component.
  std::vector<Vec2> centre(turns_freely.size());
  for (const auto& [v, z] : nodes.place) centre[vertex_component[v]] = z;
  std::vector<Index> farthest(turns_freely.size(), kNone);
  const auto distance = [&](Index v) { return norm(x[v] - centre[vertex_component[v]]); };
  for (const Index v : unknowns.vertex) {
    Index& far = farthest[vertex_component[v]];
    if (far == kNone || distance(v) > distance(far)) far = v;
  }
  for (std::size_t k = 0; k < turns_freely.size(); ++k) {
    if (!turns_freely[k] || farthest[k] == kNone) continue;
    const Vec2 arm = x[farthest[k]] - centre[k];  // a rotation moves its end by (-arm.y, arm.x)
    unknowns.held.push_back(2 * unknowns.pair[farthest[k]] + (std::abs(arm.y) >= std::abs(arm.x) ? 0 : 1));
  }
  return unknowns;
}

/// Directions of the factor where steps began and now, and the steps that differences of them are known for.
struct NewtonMap::Learnt {
  explicit Learnt(const Exec& exec) : pairs(exec, kPairs, pool) {}
  VectorPool pool;
  QuasiNewton pairs;
  std::vector<Vec2> descent, descent_before;
};

NewtonMap::NewtonMap(NewtonMap&&) noexcept = default;
NewtonMap::~NewtonMap() = default;

NewtonMap::NewtonMap(const Exec& exec, const ArapEnergy& mesh, ReducedUnknowns unknowns, DofMap* dof,
                     std::vector<Vec2> x)
    : exec_(exec),
      mesh_(mesh),
      unknowns_(std::move(unknowns)),
      dof_(dof),
      measure_(exec, mesh),
      order_(unknowns_.size),
      x_(std::move(x)),
      force_(x_.size()),
      direction_(x_.size()),
      x_trial_(x_.size()),
      force_trial_(x_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
}

void NewtonMap::lower(const MapDensity& density) {
  // Where boundaries meet all that happens is near them: there multiples took five times the steps.
  if (density.kind != MapDensity::Kind::Arap || barrier_ != nullptr) {
    multiple_.clear();
  } else if (multiple_.empty()) {
    multiple_ = determinant_multiples(mesh_);
  }
  density_ = density;
  energy_ = evaluate_at(x_, force_);
}

void NewtonMap::move_to(std::vector<Vec2> x) {
  x_ = std::move(x);
  energy_ = evaluate_at(x_, force_);
}

double NewtonMap::evaluate_at(std::vector<Vec2>& x, std::vector<Vec2>& force) {
  return fold(evaluate_vertices(x, force), force);
}

double NewtonMap::evaluate_vertices(std::vector<Vec2>& x, std::vector<Vec2>& force) {
  double energy = measure_.evaluate(density_, vertices(x), vertices(force));
  if (barrier_) energy += barrier_->add_forces(vertices(x), vertices(force));
  return energy + add_pull(vertices(x), vertices(force));
}

/// Forces at vertices become those in the unknowns, and edges of lines join in.
double NewtonMap::fold(double energy_of_vertices, std::vector<Vec2>& force) {
  if (!dof_) return energy_of_vertices;
  dof_->fold(force);
  return energy_of_vertices + add_line_edges(force);
}

double NewtonMap::add_pull(In<Vec2> uv, Out<Vec2> force) const {
  double energy = 0;
  for (const auto& [v, place] : places_) {
    const Vec2 arm = uv[v] - place;
    energy += stiffness_ * dot(arm, arm);
    force[v] += stiffness_ * arm;
  }
  return energy;
}

double NewtonMap::add_line_edges(std::vector<Vec2>& force) const {
  double energy = 0;
  for (const DofMap::LineEdge& edge : dof_->line_edges()) {
    const EdgeTerms terms = edge_terms(density_, edge.length / edge.rest);
    energy += edge.rest * edge.rest * terms.value;
    for (const auto& [column, rate] : edge.rate)
      force[dof_->num_nodes() + column].x += 0.5 * edge.rest * terms.first * rate;
  }
  return energy;
}

/// Least share of the direction at which an edge along a line has no length.
double NewtonMap::first_reversal() const {
  double least = kInfinity;
  if (!dof_) return least;
  for (const DofMap::LineEdge& edge : dof_->line_edges()) {
    double change = 0;
    for (const auto& [column, rate] : edge.rate) change += rate * direction_[dof_->num_nodes() + column].x;
    if (change < 0) least = std::min(least, -edge.length / change);
  }
  return least;
}

/// Tangents at the present place: what the steps since the last base have turned is turned here too; and their curvature.
void NewtonMap::renew_moves() {
  if (!dof_ || !dof_->poses()) return;
  dof_->rebase(x_);
  set_moves(*dof_, unknowns_);
  if (!dof_->expand(x_)) return;
  energy_ = evaluate_vertices(x_, force_);
  unknowns_.curvature = dof_->curvature(vertices(force_));
  const Index border = unknowns_.size - dof_->num_border();  // the first of its unknowns
  for (DofMap::Curvature& c : unknowns_.curvature) c.column += border, c.other += border;
  energy_ = fold(energy_, force_);
}

/// Pairs of the barrier, and zeros for those that are near: the pattern stays while no others come close.
std::vector<HessianElement> NewtonMap::contacts(bool& pattern_is_new) {
  if (!barrier_) return {};
  std::vector<HessianElement> elements = barrier_->hessian(uv(), projection_);
  pattern_is_new = !std::all_of(elements.begin(), elements.end(), [&](const HessianElement& e) {
    return std::binary_search(coupled_.begin(), coupled_.end(), e.vertex);
  });
  if (pattern_is_new) coupled_ = barrier_->near(uv());
  for (const auto& vertex : coupled_) elements.push_back({vertex, {}});
  return elements;
}

/// So many that the elimination order should know of them: a few couple what lies apart in it at the cost of some rows.
bool NewtonMap::couples_many() const {
  std::vector<Index> vertices;
  for (const auto& triple : coupled_) vertices.insert(vertices.end(), triple.begin(), triple.end());
  std::sort(vertices.begin(), vertices.end());
  const auto num = std::unique(vertices.begin(), vertices.end()) - vertices.begin();
  return static_cast<double>(num) > kFewCoupled * std::sqrt(static_cast<double>(unknowns_.num_pairs()));
}

Result<void> NewtonMap::factor(double lift) {
  bool pattern_is_new = false;
  std::vector<HessianElement> further = contacts(pattern_is_new);
  for (const auto& [v, place] : places_) {
    further.push_back({{v, v, v}, {}});
    further.back().block[0][0] = {stiffness_, 0, 0, stiffness_};
  }
  if (pattern_is_new) {
    global_.reset();
    hessian_.forget_pattern();
  }
  SymmetricMatrix& hessian =
      hessian_.at(exec_, mesh_, unknowns_, density_, projection_, uv(), further, multiple_);
  if (lift > 0) {
    for (Index column = 0; column < hessian.size(); ++column)
      hessian.value[hessian.column_begin[column]] *= 1 + lift;
  }
  if (global_) return global_->refactor(exec_, hessian);
  if (pattern_is_new && couples_many()) {
    auto order = order_of_unknowns(exec_, hessian, unknowns_);
    if (!order) return fail(order.error());
    order_ = std::move(*order);
    ++orders_found_;
  }
  auto factored = GlobalPhase::factor(exec_, hessian, order_);
  if (!factored) return fail(factored.error());
  global_.emplace(std::move(*factored));
  return {};
}

Result<void> NewtonMap::prepare() {
  renew_moves();
  if (!keeps_positive()) projection_ = 1;
  double lift = 0;
  while (true) {
    auto factored = factor(lift);
    if (factored) break;
    if (factored.error().code != ErrorCode::FactorizationFailed || lift >= kMostLift) return factored;
    if (projection_ == 1) lift = std::max(kFirstLift, 100 * lift);
    projection_ = std::min(1.0, std::max(kLeastProjection, kMoreProjection * projection_));
  }
  learnt_.reset();
  solve();
  return {};
}

void NewtonMap::prepare_again() {
  if (!learnt_) {
    learnt_ = std::make_unique<Learnt>(exec_);
    learnt_->descent = direction_;
  }
  learnt_->descent.swap(learnt_->descent_before);
  solve();
  learnt_->descent = direction_;
  learnt_->pairs.learn({x_trial_, force_trial_, learnt_->descent_before}, {x_, force_, learnt_->descent});
  force_times_direction_ = learnt_->pairs.direction(learnt_->descent, force_times_direction_, direction_);
}

void NewtonMap::solve() {
  std::vector<Vec2> r(unknowns_.size);
  const Index first = 2 * unknowns_.num_pairs();
  const Index num_carriers = dof_ ? dof_->num_nodes() - dof_->num_vertices() : 0;
  const Index carrier = dof_ ? dof_->num_vertices() : 0;  // place of the first
  const auto visit = [&](auto&& two, auto&& one) {
    for (Index k = 0; k < unknowns_.num_pairs(); ++k) two(2 * k, unknowns_.vertex[k]);
    for (Index k = 0; k < num_carriers; ++k) two(first + 2 * k, carrier + k);
    for (Index k = first + 2 * num_carriers; k < unknowns_.size; ++k)
      one(k, carrier + num_carriers + k - first - 2 * num_carriers);
  };
  visit([&](Index k, Index at) { r[k].x = -force_[at].x, r[k + 1].x = -force_[at].y; },
        [&](Index k, Index at) { r[k].x = -force_[at].x; });
  for (const Index h : unknowns_.held) r[h] = {};
  global_->solve(exec_, r, r);
  std::fill(direction_.begin(), direction_.end(), Vec2{});
  visit(
      [&](Index k, Index at) {
        direction_[at] = {r[k].x, r[k + 1].x};
      },
      [&](Index k, Index at) {
        direction_[at] = {r[k].x, 0};
      });
  force_times_direction_ = dot(exec_, force_, direction_);
  gradient_ = std::sqrt(std::max(0.0, -2 * force_times_direction_) / std::max(energy_, 1e-14 * mesh_.area));
}

/// By less than the first flip and the first contact on the linearised path.
void NewtonMap::bound_length() {
  std::vector<Vec2> path = direction_;
  if (dof_) dof_->linearise(path);
  double most = length_ / kShareOfFirstFlip;
  if (keeps_positive()) most = std::min({most, first_reversal(), measure_.first_flip(uv(), vertices(path))});
  if (barrier_) most = std::min(most, barrier_->first_contact(uv(), vertices(path), most));
  length_ = kShareOfFirstFlip * most;
}

bool NewtonMap::advance() {
  const double slope = 2 * force_times_direction_;  // the force is half the gradient
  if (!(slope < 0)) return false;
  const double rounding = kEnergyRounding * energy_ + kLengthRounding * std::sqrt(energy_ * mesh_.area);
  length_ = 1;
  if (keeps_positive() || barrier_) bound_length();
  for (int halving = 0; halving < kMostHalvings; ++halving, length_ *= 0.5) {
    combine(exec_, {{1, x_}, {length_, direction_}}, x_trial_);
    if (dof_ && !dof_->expand(x_trial_)) continue;
    const double trial = evaluate_at(x_trial_, force_trial_);
    if (!(trial <= energy_ + kSufficientDecrease * length_ * slope + rounding)) continue;
    if (keeps_positive() && !measure_.is_injective(vertices(x_trial_))) continue;
    x_.swap(x_trial_);
    force_.swap(force_trial_);
    stride_ = {length_, (energy_ - trial) / (-slope * length_ * (1 - 0.5 * length_))};
    energy_ = trial;
    if (keeps_positive() && !learnt_)
      projection_ = projection_ > kLeastProjection ? kLessProjection * projection_ : 0;
    return true;
  }
  if (dof_ && dof_->expand(x_)) energy_ = evaluate_at(x_, force_);
  return false;
}

}  // namespace planish
