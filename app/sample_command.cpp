#include <fmt/core.h>

#include "app/commands.hpp"
#include "app/common.hpp"
#include "io/file.hpp"
#include "io/mesh_files.hpp"
#include "io/sample_features_json.hpp"

namespace planish {

Result<int> run_sample(const CommonArgs& common, const SampleArgs& args) {
  if (auto possible = check_outputs({{args.output, {"ply", "obj"}}, {args.features, {}}}); !possible) {
    return fail(possible.error());
  }
  const Exec exec(common.threads);
  const auto sample = make_sample(exec, args.options);
  if (!sample) return fail(sample.error());
  std::vector<std::string> warnings;
  if (auto done = write_mesh(exec, args.output, {.mesh = &sample->mesh}, warnings); !done)
    return fail(done.error());
  if (!args.features.empty()) {
    if (auto done = write_file(args.features, sample_constraints_json(*sample)); !done)
      return fail(done.error());
  }
  if (!common.quiet) {
    fmt::print("{}: {} vertices, {} triangles\n", args.output, sample->mesh.num_vertices(),
               sample->mesh.num_triangles());
  }
  return 0;
}

}  // namespace planish
