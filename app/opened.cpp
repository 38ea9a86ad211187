#include "app/opened.hpp"

#include <fmt/format.h>

#include "engine/features/parted.hpp"

namespace planish {

const std::vector<Feature>& OpenedMesh::embedded_features() const {
  static const std::vector<Feature> kNoFeatures;
  return featured.embedding ? featured.embedding->features : kNoFeatures;
}

Constraints OpenedMesh::constraints() const {
  if (!constrained) return {};
  Constraints result{.set = &featured.set, .features = &flat_features()};
  if (cut) result.vertex_origin = cut->vertex_origin;
  return result;
}

Error OpenedFiles::placed(const Error& error) const {
  return in_file(error, error.place.pointer.empty() ? mesh : constraints);
}

namespace {

Result<OpenedMesh> read_and_cut(const Exec& exec, const OpenedFiles& files, const Monitor& monitor,
                                Stopwatch& stopwatch) {
  auto featured = read_featured(exec, files.mesh, files.constraints, files.repair, monitor, stopwatch);
  if (!featured) return fail(featured.error());
  OpenedMesh result{.featured = std::move(*featured),
                    .cut = std::nullopt,
                    .parted = {},
                    .constrained = !files.constraints.empty()};
  if (result.featured.set.seams.empty() && files.cut == CutMode::None) return result;
  if (monitor({.phase = Phase::Cut}) == Verdict::Stop)
    return fail(ErrorCode::Cancelled, "stopped by the user");
  auto opened = stopwatch(Phase::Cut, [&] {
    return cut(result.mesh().surface(), result.embedded_features(), result.featured.set.seams,
               {.mode = files.cut, .threads = exec.threads()});
  });
  if (!opened) return fail(files.placed(opened.error()));
  result.cut = std::move(*opened);
  if (!result.featured.embedding) return result;
  auto parted = features_on_cut(exec, result.mesh().surface(), *result.cut, result.embedded_features(),
                                result.featured.set);
  if (!parted) return fail(in_file(parted.error(), files.constraints));
  result.parted = std::move(*parted);
  return result;
}

}  // namespace

Result<void> open_mesh(const Exec& exec, const OpenedFiles& files, const Monitor& monitor,
                       Stopwatch& stopwatch, OpenedMesh& opened, std::vector<std::string>& warnings) {
  return read_and_cut(exec, files, monitor, stopwatch).map([&](OpenedMesh mesh) {
    opened = std::move(mesh);
    warnings = opened.mesh().warnings;
  });
}

std::string unwelded_warning(const OpenedMesh& opened, const MeshFacts& facts) {
  if (facts.duplicate_positions == 0 || opened.cut) return "";
  return fmt::format(
      "{} components were flattened each on its own, but {} vertices lie at the position of "
      "another one; if they are one surface, use --repair to merge them",
      facts.components, facts.duplicate_positions);
}

std::string sizes_warning(const Flattening& flattening) {
  const std::vector<std::string>& names = flattening.up_to_scale;
  if (names.empty()) return "";
  return fmt::format("the method {} keeps shapes, not their sizes: those of {} constraints are free (\"{}\")",
                     name(flattening.method), names.size(), fmt::join(names, "\", \""));
}

}  // namespace planish
