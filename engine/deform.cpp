#include "engine/deform.hpp"

namespace planish {

Result<Deformation> deform(const Surface& surface, In<Vec2> uv, const Constraints& constraints,
                           const DeformOptions& options, const Monitor& monitor, const StepSink& sink) {
  auto editor = MapEditor::begin(surface, uv, options.edit, monitor);
  if (!editor) return fail(editor.error());
  return editor->constrain(constraints, monitor)
      .and_then([&] { return editor->solve(options.solve, monitor, sink); })
      .map([&] { return editor->measure(); });
}

}  // namespace planish
