#include "engine/verify.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "app/commands.hpp"
#include "app/common.hpp"
#include "io/constraints_json.hpp"
#include "io/mesh_files.hpp"
#include "io/report_json.hpp"
#include "io/report_read.hpp"

namespace planish {
namespace {

constexpr std::size_t kShown = 5;  // ids a line

/// The three files, as far as they were given.
struct Files {
  Mesh mesh;
  std::optional<Claims> claims;
  std::optional<ConstraintSet> set;
};

Result<Files> read_files(const Exec& exec, const VerifyArgs& args) {
  if (!args.constraints.empty() && args.report.empty())
    return fail(ErrorCode::BadUsage,
                "--constraints needs --report, which has the features as they lie in the mesh");
  auto mesh = read_mesh(exec, args.mesh);
  if (!mesh) return fail(in_file(mesh.error(), args.mesh));
  if (mesh->num_triangles() > 0 && mesh->uv_sets.empty())
    return fail(in_file(no_parameterization(*mesh), args.mesh));
  Files files;
  files.mesh = std::move(*mesh);
  if (!args.report.empty()) {
    auto claims = read_report(exec, args.report, {files.mesh.num_vertices(), files.mesh.num_triangles()});
    if (!claims) return fail(in_file(claims.error(), args.report));
    files.claims = std::move(*claims);
  }
  if (!args.constraints.empty()) {
    auto set = read_constraints(exec, args.constraints);
    if (!set) return fail(in_file(set.error(), args.constraints));
    files.set = std::move(*set);
  }
  return files;
}

/// Of faults, their first few ids: " (triangles 3, 8, ...)".
std::string listed(const char* what, In<Index> ids) {
  if (ids.empty()) return "";
  std::string text;
  for (const Index id : ids.first(std::min(ids.size(), kShown)))
    text += (text.empty() ? "" : ", ") + std::to_string(id);
  return fmt::format(" ({} {}{})", what, text, ids.size() > kShown ? ", ..." : "");
}

std::string listed_pairs(const std::vector<std::array<Index, 2>>& pairs) {
  if (pairs.empty()) return "";
  std::string text;
  for (std::size_t k = 0; k < std::min(pairs.size(), kShown); ++k)
    text += fmt::format("{}{}-{}", k == 0 ? "" : ", ", pairs[k][0], pairs[k][1]);
  return fmt::format(" (triangles {}{})", text, pairs.size() > kShown ? ", ..." : "");
}

void print_map(const Verification& v, const VerificationContext& context) {
  const Certificate& c = v.certificate;
  fmt::print("{}: {} triangles in {}, uv from {}", context.mesh, v.triangles,
             v.charts == 1 ? "one chart" : fmt::format("{} charts", v.charts), context.uv_set);
  if (!context.other_sets.empty()) fmt::print(", the first of {} sets", context.other_sets.size() + 1);
  fmt::print(
      "\narap {:.6e}, symmetric dirichlet {:.6f}, stretch {:.4f} to {:.4f}, angle distortion up to {:.4f}\n",
      c.arap, c.symmetric_dirichlet, c.sigma_min.min, c.sigma_max.max, c.angle_distortion.max);
  fmt::print("flipped triangles {}{}\n", c.flipped_triangles, listed("triangles", c.flipped));
  fmt::print("overwound vertices {}{}\n", c.overwound_vertices, listed("vertices", c.overwound));
  fmt::print("overlapping pairs {}, {:.3g} of the area{}\n", c.overlapping_pairs, c.overlap_area_fraction,
             listed_pairs(v.overlapping));
}

void print_finding(const ConstraintFinding& finding) {
  const std::string side = finding.side == 0 ? "" : fmt::format(", side {}", finding.side);
  fmt::print("constraint \"{}\" ({}{}): ", finding.name, finding.type, side);
  if (finding.residual) {
    fmt::print("residual {:.2e}{}", *finding.residual, finding.degrees ? " degrees" : "");
  } else {
    fmt::print("not measured{}", finding.unmeasured.empty() ? "" : ", " + finding.unmeasured);
  }
  fmt::print("{}\n", finding.faults.empty() ? "" : ", wrong:");
  for (const std::string& fault : finding.faults) fmt::print("  {}\n", fault);
}

/// What keeps it from holding, counted.
std::string conclusion(const Verification& v) {
  if (v.holds()) return "all holds";
  const Certificate& c = v.certificate;
  const auto wrong =
      std::ranges::count_if(v.constraints, [](const auto& finding) { return !finding.faults.empty(); });
  const std::pair<Offset, const char*> counts[] = {
      {c.flipped_triangles, "flipped triangles"},
      {c.overwound_vertices, "overwound vertices"},
      {c.overlapping_pairs, "overlapping pairs"},
      {wrong, "constraints that are wrong"},
      {static_cast<Offset>(v.faults.size()), "other faults of the report"}};
  std::string text;
  for (const auto& [count, what] : counts) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  }
  return "does not hold: " + text;
}

/// quiet: what is wrong only.
void print_text(const Verification& v, const VerificationContext& context, bool quiet) {
  if (!quiet) print_map(v, context);
  for (const ConstraintFinding& finding : v.constraints) {
    if (!quiet || !finding.faults.empty()) print_finding(finding);
  }
  for (const std::string& fault : v.faults) fmt::print("wrong: {}\n", fault);
  if (!quiet || !v.holds()) fmt::print("{}\n", conclusion(v));
}

VerificationContext context_of(const VerifyArgs& args, const Mesh& mesh) {
  VerificationContext context{.mesh = args.mesh,
                              .report = args.report,
                              .constraints = args.constraints,
                              .uv_set = mesh.uv_sets.front().name,
                              .warnings = mesh.warnings};
  for (std::size_t k = 1; k < mesh.uv_sets.size(); ++k) context.other_sets.push_back(mesh.uv_sets[k].name);
  return context;
}

}  // namespace

Result<int> run_verify(const CommonArgs& common, const VerifyArgs& args) {
  const Exec exec(common.threads);
  const auto files = read_files(exec, args);
  if (!files) return fail(files.error());
  const In<Vec2> corner_uv = files->mesh.uv_sets.empty() ? In<Vec2>() : files->mesh.uv_sets.front().corner_uv;
  const auto found = verify(
      files->mesh.surface(), corner_uv,
      {.claims = files->claims ? &*files->claims : nullptr, .set = files->set ? &*files->set : nullptr},
      {.threads = exec.threads()});
  if (!found)
    return fail(in_file(found.error(),
                        found.error().code == ErrorCode::ConstraintInvalid ? args.constraints : args.mesh));
  const VerificationContext context = context_of(args, files->mesh);
  if (args.json) {
    fmt::print("{}", verification_json(*found, context));
  } else {
    print_text(*found, context, common.quiet);
  }
  return found->holds() ? 0 : 6;
}

}  // namespace planish
