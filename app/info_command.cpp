#include <fmt/core.h>

#include "app/commands.hpp"
#include "app/common.hpp"
#include "engine/prepare/validate.hpp"
#include "io/report_json.hpp"

namespace planish {
namespace {

void print_diagnosis(const Diagnosis& d, const std::string& path) {
  constexpr double kDegrees = 180 / kPi;
  fmt::print("{}\n  {} vertices ({} unreferenced, {} at the position of an earlier one), {} triangles\n",
             path, d.vertices, d.unreferenced_vertices, d.duplicate_positions, d.triangles);
  fmt::print("  {} components, {} boundary loops, Euler characteristic {}", d.components, d.boundary_loops,
             d.euler);
  if (d.genus != kNone) fmt::print(", genus {}", d.genus);
  fmt::print("\n  box {:g} x {:g} x {:g}, area {:g}, angles {:.4g} to {:.4g} degrees\n",
             d.upper.x - d.lower.x, d.upper.y - d.lower.y, d.upper.z - d.lower.z, d.area,
             kDegrees * d.min_angle, kDegrees * d.max_angle);
  if (d.usable()) {
    fmt::print("  can be flattened\n");
    return;
  }
  Diagnosis one;
  for (const Defect& defect : d.defects) {
    one.defects.assign(1, defect);
    fmt::print("  cannot be flattened: {}\n", describe(refusal(one)));
  }
}

}  // namespace

Result<int> run_info(const CommonArgs& common, const InfoArgs& args) {
  const Exec exec(common.threads);
  const auto input = read_input(exec, args.mesh, args.repair);
  if (!input) return fail(input.error());
  const auto diagnosis = diagnose(exec, input->mesh.surface());
  if (!diagnosis) return fail(in_file(diagnosis.error(), args.mesh));
  if (args.json) {
    fmt::print("{}\n", diagnosis_json(*diagnosis, args.mesh, input->mendings, input->mesh.warnings));
  } else {
    say_mendings(input->mendings);
    print_diagnosis(*diagnosis, args.mesh);
    say_warnings(common, input->mesh.warnings);
  }
  return 0;
}

}  // namespace planish
