#include "engine/edit.hpp"

#include <new>

#include "engine/deform/editing.hpp"

namespace planish {
namespace {

template <class Work>
auto with_memory(Work work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "not enough memory to deform the map");
  }
}

Result<void> check(const SolveOptions& options) {
  if (options.steps < 1) return fail(ErrorCode::BadUsage, "steps must be at least 1");
  if (!(options.tolerance > 0)) return fail(ErrorCode::BadUsage, "tolerance must be above 0");
  if (options.max_iterations < 0) return fail(ErrorCode::BadUsage, "max_iterations must not be negative");
  if (options.flips != Flips::Untangle && options.flips != Flips::Keep)
    return fail(ErrorCode::BadUsage, "flips of a deformed map are untangled or kept");
  if (options.energy == Energy::SymmetricDirichlet && options.flips != Flips::Untangle)
    return fail(
        ErrorCode::BadUsage,
        "symmetric-dirichlet is infinite where triangles are flipped: it needs flips to be untangled");
  if (options.overlaps == Overlapping::Remove && options.flips != Flips::Untangle)
    return fail(ErrorCode::BadUsage,
                "overlaps are removed from maps without flips: that needs flips to be untangled");
  return {};
}

}  // namespace

class MapEditor::State {
 public:
  explicit State(const EditOptions& options) : editing(options) {}
  Editing editing;
};

MapEditor::MapEditor(std::unique_ptr<State> state) : state_(std::move(state)) {}
MapEditor::MapEditor(MapEditor&&) noexcept = default;
MapEditor& MapEditor::operator=(MapEditor&&) noexcept = default;
MapEditor::~MapEditor() = default;

Result<MapEditor> MapEditor::begin(const Surface& surface, In<Vec2> uv, const EditOptions& options,
                                   const Monitor& monitor) {
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  return with_memory([&]() -> Result<MapEditor> {
    auto state = std::make_unique<State>(options);
    if (auto begun = state->editing.begin(surface, uv, monitor); !begun) return fail(begun.error());
    return MapEditor(std::move(state));
  });
}

Result<void> MapEditor::constrain(const Constraints& constraints, const Monitor& monitor) {
  return with_memory([&] { return state_->editing.constrain(constraints, monitor); });
}

Result<void> MapEditor::move_pin(Index vertex, Vec2 uv) {
  return with_memory([&] { return state_->editing.move_pin(vertex, uv); });
}

Result<void> MapEditor::solve(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  if (auto checked = check(options); !checked) return checked;
  return with_memory([&] { return state_->editing.solve(options, monitor, sink); });
}

std::vector<Vec2> MapEditor::uv() const { return state_->editing.in_input_order(state_->editing.uv()); }

std::vector<Vec2> MapEditor::given_uv() const {
  return state_->editing.in_input_order(state_->editing.aligned());
}

Deformation MapEditor::measure() const { return state_->editing.measure(); }

}  // namespace planish
