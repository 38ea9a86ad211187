#include "engine/methods/deformed.hpp"

#include "engine/deform.hpp"

namespace planish {

Result<Flattening> flatten_and_deform(const Surface& surface, const Constraints& constraints,
                                      const FlattenOptions& options, const Monitor& monitor) {
  FlattenOptions without = options;
  without.method = Method::Arap;
  const auto map = flatten(surface, without, monitor);
  if (!map) return fail(map.error());
  const DeformOptions deforming{.edit = {.threads = options.threads},
                                .solve = {.energy = options.energy,
                                          .flips = options.flips,
                                          .tolerance = options.tolerance,
                                          .max_iterations = options.max_iterations}};
  auto deformed = deform(surface, map->uv, constraints, deforming, monitor);
  if (!deformed) return fail(deformed.error());
  Flattening result = std::move(deformed->flattening);
  result.method = Method::Deform;
  result.holonomy_residual = map->holonomy_residual;
  result.timings.insert(result.timings.begin(), map->timings.begin(), map->timings.end());
  return result;
}

}  // namespace planish
