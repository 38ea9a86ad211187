#include "app/flat_result.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>

#include "app/provenance.hpp"
#include "engine/compare.hpp"
#include "engine/features/parted.hpp"
#include "io/mesh_files.hpp"

namespace planish {
namespace {

std::string first_few(const std::vector<Index>& ids) {
  constexpr std::size_t kFew = 5;
  const std::size_t shown = std::min(kFew, ids.size());
  return ids.empty() ? std::string()
                     : fmt::format(" ({}{})", fmt::join(ids.begin(), ids.begin() + shown, ", "),
                                   ids.size() > shown ? ", ..." : "");
}

}  // namespace

void number_before_cut(const Cut& cut, const std::vector<Feature>& parted, Flattening& flattening) {
  for (Index& v : flattening.certificate.overwound) v = cut.vertex_origin[v];
  for (ConstraintOutcome& outcome : flattening.constraints.outcome) {
    for (Index& v : outcome.yielded) v = cut.vertex_origin[v];
    if (outcome.type != "region") continue;
    const auto region = std::find_if(parted.begin(), parted.end(), [&](const Feature& feature) {
      return feature.name == outcome.features.front();
    });
    outcome.shape = shape_before_cut(cut, region->triangle, outcome.shape);
  }
}

Result<void> write_flattened(const Exec& exec, const std::string& path, const FeaturedMesh& featured,
                             const Cut* cut, In<Vec2> uv, std::vector<std::string>& warnings) {
  const Embedding* embedding = featured.embedding ? &*featured.embedding : nullptr;
  const Provenance provenance = provenance_of(featured.input, embedding);
  MeshOutput output{.mesh = &featured.mesh,
                    .triangle_origin = provenance.triangle_origin,
                    .vertex_origin_triangle = provenance.vertex_origin_triangle,
                    .vertex_barycentric = provenance.vertex_barycentric,
                    .features = embedding ? &embedding->features : nullptr};
  std::vector<Vec2> corner_uv;
  if (cut != nullptr) {
    for (const Index v : cut->corner_vertex) corner_uv.push_back(uv[v]);
    output.corner_uv = corner_uv;
  } else {
    output.uv = uv;
  }
  return write_mesh(exec, path, output, warnings);
}

std::vector<PlacedFeature> placed_features(const std::vector<Feature>& features,
                                           const ConstraintFacts& constraints) {
  std::vector<PlacedFeature> placed;
  for (const Feature& feature : features) {
    using Ideal = PlacedFeature::Ideal;
    Ideal ideal = Ideal::None;
    bool used = false;
    for (const ConstraintOutcome& c : constraints.outcome) {
      if (std::find(c.features.begin(), c.features.end(), feature.name) == c.features.end()) continue;
      used = true;
      if (c.type == "line") ideal = Ideal::Line;
      if (c.type == "circle") ideal = Ideal::Circle;
    }
    if (used) {
      placed.push_back(
          {feature.name, feature.vertex, feature.closed, feature.triangle, ideal, feature.length});
    }
  }
  return placed;
}

std::vector<PlacedFeature> all_placed(const std::vector<Feature>& features) {
  std::vector<PlacedFeature> placed;
  for (const Feature& f : features)
    placed.push_back({f.name, f.vertex, f.closed, f.triangle, PlacedFeature::Ideal::None, f.length});
  return placed;
}

void say_constraints(const ConstraintFacts& constraints) {
  const std::vector<ConstraintOutcome>& outcome = constraints.outcome;
  if (outcome.empty()) return;
  const auto worst = std::max_element(outcome.begin(), outcome.end(), [](const auto& a, const auto& b) {
    return share_of_allowed(a) < share_of_allowed(b);
  });
  const auto met =
      std::count_if(outcome.begin(), outcome.end(), [](const auto& c) { return share_of_allowed(c) <= 1; });
  fmt::print("{} of {} constraints met, the worst is \"{}\" with residual {:.2e}{}\n", met, outcome.size(),
             worst->name, worst->residual, worst->degrees ? " degrees" : "");
}

bool say_unmet(const std::string& mesh, const ConstraintFacts& constraints) {
  bool any = false;
  for (const ConstraintOutcome& c : constraints.outcome) {
    if (share_of_allowed(c) <= 1) continue;
    any = true;
    fmt::print(stderr, "planish: {}: constraint \"{}\" is not met, its residual is {:.2e}{}\n", mesh, c.name,
               c.residual, c.degrees ? " degrees" : "");
  }
  return any;
}

bool say_disorder(const std::string& mesh, const ConstraintFacts& constraints) {
  bool any = false;
  for (const ConstraintOutcome& c : constraints.outcome) {
    if (c.keeps_order) continue;
    any = true;
    fmt::print(stderr, "planish: {}: the vertices of \"{}\" lost their order along the line\n", mesh, c.name);
  }
  return any;
}

void say_flips(const std::string& mesh, const Certificate& c) {
  fmt::print(stderr, "planish: {}: {} triangles are flipped{} and {} vertices overwound{} in the map\n", mesh,
             c.flipped_triangles, first_few(c.flipped), c.overwound_vertices, first_few(c.overwound));
}

bool say_unwanted_overlaps(const std::string& mesh, const Flattening& flattening) {
  const Certificate& c = flattening.certificate;
  if (flattening.overlaps.method != Overlapping::Remove || c.overlapping_pairs == 0) return false;
  const bool has_flips = c.flipped_triangles > 0 || c.overwound_vertices > 0;
  const auto [first, second] = c.overlapping.front();
  fmt::print(
      stderr,
      "planish: {}: {} pairs of triangles lie on one another in the map ({}-{}{}), {:.2g} of its area; {}\n",
      mesh, c.overlapping_pairs, first, second, c.overlapping_pairs > 1 ? ", ..." : "",
      c.overlap_area_fraction,
      has_flips ? "they are removed from maps without flips only"
      : flattening.overlaps.start == OverlapRemoval::Start::None
          ? "no map without any was found to begin at: loosen constraints, or cut the mesh into parts"
          : "components that pins hold lie on one another: move their pins");
  return true;
}

}  // namespace planish
