#include "app/featured.hpp"

#include "engine/embed.hpp"
#include "io/carry_over.hpp"
#include "io/constraints_json.hpp"

namespace planish {

Result<FeaturedMesh> read_featured(const Exec& exec, const std::string& mesh, const std::string& constraints,
                                   bool mend, const Monitor& monitor, Stopwatch& stopwatch) {
  FeaturedMesh result;
  auto read = stopwatch(Phase::Read, [&]() -> Result<void> {
    if (monitor({.phase = Phase::Read}) == Verdict::Stop)
      return fail(ErrorCode::Cancelled, "stopped by the user");
    if (!constraints.empty()) {
      auto set = read_constraints(exec, constraints);
      if (!set) return fail(in_file(set.error(), constraints));
      result.set = std::move(*set);
    }
    auto input = read_input(exec, mesh, mend);
    if (!input) return fail(input.error());
    result.input = std::move(*input);
    return {};
  });
  if (!read) return fail(read.error());
  if (result.set.features.empty() && result.set.constraints.empty()) {
    result.mesh = result.input.mesh;
    return result;
  }
  auto embedding = stopwatch(Phase::Embed, [&] {
    return embed(result.input.mesh.surface(), result.set, {.threads = exec.threads()}, monitor);
  });
  if (!embedding) {
    const bool of_feature = !embedding.error().place.pointer.empty();
    return fail(in_file(embedding.error(), of_feature ? constraints : mesh));
  }
  result.embedding = std::move(*embedding);
  result.mesh = carry_over(exec, result.input.mesh, *result.embedding);
  return result;
}

}  // namespace planish
