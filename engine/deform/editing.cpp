#include "engine/deform/editing.hpp"

#include <algorithm>
#include <cmath>

#include "engine/deform/aligned_map.hpp"
#include "engine/flatten_steps.hpp"

namespace planish {
namespace {

Placement inverse(const Placement& isometry) {
  return {-multiply(conjugate(isometry.c), isometry.p), conjugate(isometry.c)};
}

}  // namespace

void Editing::add_time(Phase phase, double seconds) {
  for (StepTime& time : solved_.timings) {
    if (time.step != name(phase)) continue;
    time.seconds += seconds;
    return;
  }
  solved_.timings.push_back({name(phase), seconds});
}

Result<void> Editing::begin(const Surface& surface, In<Vec2> uv, const Monitor& monitor) {
  solved_.threads = exec_.threads();
  auto checked = timed(Phase::Check, monitor, [&]() -> Result<void> {
    auto piece = make_workpiece(exec_, surface);
    if (!piece) return fail(piece.error());
    piece_ = std::move(*piece);
    auto map = take_map(piece_, uv);
    if (!map) return fail(map.error());
    given_ = std::move(*map);
    if (options_.reference == Reference::Surface) return {};
    auto geometry = geometry_of_map(exec_, piece_, given_.uv);
    if (!geometry) return fail(geometry.error());
    reference_.emplace(std::move(*geometry));
    return {};
  });
  if (!checked) return checked;
  piece_.outer_loop = outer_loops(topology());
  uv_ = aligned_ = given_.uv;
  motion_.resize(topology().num_components);
  find_held();
  return timed(Phase::Order, monitor, [&]() -> Result<void> {
    auto order = fill_reducing_order(exec_, piece_.whole_laplacian(exec_));
    if (!order) return fail(order.error());
    piece_.order = std::move(*order);
    return {};
  });
}

Result<void> Editing::constrain(const Constraints& constraints, const Monitor& monitor) {
  return timed(Phase::Compile, monitor, [&] { return compile(constraints, monitor); }).and_then([&] {
    return timed(Phase::Start, monitor, [&] { return place(); });
  });
}

Result<void> Editing::compile(const Constraints& constraints, const Monitor& monitor) {
  system_.reset();
  placed_.reset();
  laid_.clear();
  responses_.forget();
  set_ = constraints.set == nullptr ? ConstraintSet{} : *constraints.set;
  features_ = features_in_order(mesh(), constraints.features);
  vertex_origin_.assign(constraints.vertex_origin.begin(), constraints.vertex_origin.end());
  piece_.find_loops();
  auto outer = choose_outer(piece_, features_, set_.outer);
  if (!outer) return fail(outer.error());
  piece_.outer_loop = std::move(*outer);
  if (set_.constraints.empty()) return {};
  view_ = {&set_, features_, vertex_origin_};
  auto system = compiled_system(monitor);
  if (!system) return fail(system.error());
  system_ = std::move(*system);
  return {};
}

Result<std::unique_ptr<ConstraintSystem>> Editing::compiled_system(const Monitor& monitor) const {
  return ConstraintSystem::make(
      piece_.rest(), view_,
      [&](const Surface& region) { return map_region(region, options_.threads, monitor); }, piece_.component);
}

Result<void> Editing::move_pin(Index vertex, Vec2 uv) {
  if (!system_) return fail(ErrorCode::BadUsage, "there are no constraints, so no pin to move");
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
    return fail(ErrorCode::BadUsage,
                "vertex " + std::to_string(vertex) + " cannot be moved to what is no place");
  auto moved = system_->move_pin(vertex, (1 / mesh().unit) * uv);
  if (!moved) return fail(moved.error());
  for (Constraint& constraint : set_.constraints) {
    auto* pins = std::get_if<PinConstraint>(&constraint.rule);
    for (std::size_t i = 0; pins != nullptr && i < pins->vertex.size(); ++i) {
      if (pins->vertex[i] == vertex) pins->uv[i] = uv;
    }
  }
  if (!*moved && keeps_placed()) return {};
  return timed(Phase::Start, {}, [&] { return place(); });
}

/// Nothing but a pin moves, as long as components stay where all their pins together lay them.
bool Editing::keeps_placed() const {
  if (release_ != Release::None || last_.poses != FeaturePoses::Held) return false;
  return onto_pins(system_->pins(), piece_.component, topology().num_components, given_.uv) == laid_;
}

/// Components move as pins and directions ask, then each constrained element goes where it lies nearest.
Result<void> Editing::place() {
  release_ = Release::None;
  anew_.reset();
  laid_.clear();
  std::vector<Placement> laid, motion(topology().num_components);
  std::vector<Vec2> map = given_.uv;
  if (system_) {
    laid = onto_pins(system_->pins(), piece_.component, topology().num_components, map);
    auto aligned = align_map(piece_, *system_, map);
    if (!aligned) return fail(aligned.error());
    motion = std::move(*aligned);
    auto placed = place_features(*system_, map);
    if (!placed) return fail(placed.error());
    placed_.emplace(std::move(*placed));
    if (auto scales = system_->check_scales(*placed_->poses); !scales) return scales;
  }
  align(std::move(motion));
  aligned_ = std::move(map);
  find_held();
  laid_ = std::move(laid);
  return {};
}

/// The map as it is now goes along with its components.
void Editing::align(std::vector<Placement> motion) {
  std::vector<Placement> change;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const bool same = motion[k] == motion_[k];
    change.push_back(same ? Placement{} : then(inverse(motion_[k]), motion[k]));
    if (!same) responses_.forget();
  }
  move_components(change, piece_.component, uv_);
  motion_ = std::move(motion);
}

/// Feature vertices, pins, and one vertex of each component without any.
void Editing::find_held() {
  const Index num_vertices = mesh().num_vertices();
  nodes_ = {};
  alone_.clear();
  nodes_.fixed.assign(num_vertices, 0);
  nodes_.num_nodes = num_vertices;
  if (system_) {
    for (const Owner& owner : system_->owners()) nodes_.fixed[owner.vertex] = 1;
    for (const Pin& pin : system_->pins()) nodes_.fixed[pin.vertex] = 1;
  }
  std::vector<std::uint8_t> settled(topology().num_components, 0);
  for (Index v = 0; v < num_vertices; ++v) settled[piece_.component[v]] |= nodes_.fixed[v];
  for (Index v = 0; v < num_vertices; ++v) {
    if (settled[piece_.component[v]]) continue;
    settled[piece_.component[v]] = 1;
    nodes_.fixed[v] = 1;
    alone_.push_back(v);
  }
  nodes_.node.resize(num_vertices);
  for (Index v = 0; v < num_vertices; ++v) nodes_.node[v] = nodes_.fixed[v] ? kNone : v;
}

/// Where the same vertices are held as before, the factor stays.
Result<void> Editing::factor() {
  if (global_ && factored_for_ == nodes_.fixed) return {};
  auto global = GlobalPhase::factor(exec_, laplacian_over(nodes_), piece_.order);
  if (!global) return fail(global.error());
  global_.emplace(std::move(*global));
  factored_for_ = nodes_.fixed;
  ArapEnergy energy = piece_.energy(factored_for_);
  energy.frame = rest().frame;
  energy.cotangent = rest().cotangent;
  energy.area = rest().area;
  local_.emplace(exec_, energy);
  measure_.emplace(exec_, energy);
  responses_.forget();
  return {};
}

SymmetricMatrix Editing::laplacian_over(const NodeMap& nodes) const {
  return quotient_laplacian(exec_, mesh().corner_vertex, topology(), nodes.node, nodes.num_nodes,
                            [&](Index c) { return rest().edge_weight(topology(), c); });
}

}  // namespace planish
