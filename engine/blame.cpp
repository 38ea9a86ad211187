#include "engine/blame.hpp"

#include <algorithm>
#include <chrono>

namespace planish {
namespace {

bool has_flips(const Certificate& c) { return c.flipped_triangles > 0 || c.overwound_vertices > 0; }

/// Features with a vertex that is at fault, or a triangle.
std::vector<std::string> features_at(const Surface& surface, const std::vector<Feature>& features,
                                     const Certificate& certificate) {
  std::vector<std::uint8_t> at_fault(surface.num_vertices(), 0), faulty(surface.num_triangles(), 0);
  for (const Index v : certificate.overwound) at_fault[v] = 1;
  const auto mark = [&](Index t) {
    faulty[t] = 1;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) at_fault[surface.corner_vertex[c]] = 1;
  };
  for (const Index t : certificate.flipped) mark(t);
  if (!has_flips(certificate)) {
    for (const auto& [first, second] : certificate.overlapping) mark(first), mark(second);
  }
  std::vector<std::string> names;
  for (const Feature& feature : features) {
    const bool touched =
        std::any_of(feature.vertex.begin(), feature.vertex.end(), [&](Index v) { return at_fault[v]; }) ||
        std::any_of(feature.triangle.begin(), feature.triangle.end(), [&](Index t) { return faulty[t]; });
    if (touched) names.push_back(feature.name);
  }
  return names;
}

}  // namespace

Result<Blame> find_blame(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                         const FlattenOptions& options, double seconds, const Monitor& monitor) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto time_is_up = [&] {
    return std::chrono::duration<double>(Clock::now() - begin).count() > seconds;
  };
  const bool about_flips = has_flips(flattening.certificate);
  FlattenOptions tried = options;
  if (about_flips) tried.overlaps = Overlapping::Report;
  Blame blame;
  if (constraints.features != nullptr)
    blame.features = features_at(surface, *constraints.features, flattening.certificate);
  const std::size_t count = constraints.set == nullptr ? 0 : constraints.set->constraints.size();
  bool stopped = false;  // by the caller, not by the time
  const Monitor until_then = [&](const Progress& progress) {
    stopped |= monitor && monitor(progress) == Verdict::Stop;
    return stopped || time_is_up() ? Verdict::Stop : Verdict::Continue;
  };
  for (std::size_t k = 0; k < count && !time_is_up(); ++k) {
    ConstraintSet others = *constraints.set;
    others.constraints.erase(others.constraints.begin() + static_cast<std::ptrdiff_t>(k));
    Constraints without = constraints;
    without.set = &others;
    const auto flat = flatten(surface, without, tried, until_then);
    if (stopped) return fail(ErrorCode::Cancelled, "stopped by the caller");
    if (!flat && flat.error().code == ErrorCode::Cancelled) break;
    ++blame.tried;
    if (flat && !has_flips(flat->certificate) && (about_flips || flat->certificate.overlapping_pairs == 0))
      blame.constraints.push_back(constraints.set->constraints[k].name);
  }
  return blame;
}

}  // namespace planish
