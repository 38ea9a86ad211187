#include "app/args.hpp"

#include <algorithm>
#include <numeric>
#include <CLI/CLI.hpp>

#include "app/method_args.hpp"

namespace planish {
namespace {

constexpr const char* kDescription =
    "planish flattens triangle meshes into the plane as rigidly as possible.\n"
    "Exit codes: 0 done; 1 a defect of planish; 2 usage; 3 input cannot be read; 4 the mesh cannot be used;\n"
    "5 the constraints or their features cannot be used; 6 solved, but flips remain, overlaps that were to "
    "be "
    "removed remain or the tolerance was not met, or what was to be verified does not hold; 7 cannot write; "
    "130 stopped.";

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  const auto closer = [&](const std::string& a, const std::string& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  };
  const auto best = std::min_element(known.begin(), known.end(), closer);
  if (best == known.end() || edit_distance(word, *best) > std::max<std::size_t>(2, word.size() / 2))
    return "";
  return ", did you mean " + *best + "?";
}

/// Long names of the options an app knows, or of its commands.
std::vector<std::string> known_names(const CLI::App& app, bool options) {
  std::vector<std::string> names;
  if (options) {
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  } else {
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  }
  return names;
}

void add_common(CLI::App& app, CommonArgs& common) {
  app.add_option("--threads", common.threads, "threads to use, 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_flag("--quiet", common.quiet, "no progress, no summary, no warnings");
  app.add_flag("--json-errors", common.json_errors, "errors as JSON objects on stderr");
}

void add_cut(CLI::App& app, CutMode& cut) {
  const std::map<std::string, CutMode> cuts = {{"none", CutMode::None}, {"auto", CutMode::Auto}};
  app.add_option("--cut", cut, "none, or auto: open closed parts and handles along short cuts [none]")
      ->transform(CLI::CheckedTransformer(cuts).description(""));
}

void add_compare(CLI::App& app, CompareArgs& args) {
  app.add_option("mesh", args.mesh, "mesh to flatten: .obj .ply .stl .off, each also with .gz")->required();
  app.add_option("-c,--constraints", args.constraints, "constraint file, JSON: features, constraints, seams");
  app.add_option(
         "-o,--output", args.folder,
         "folder for METHOD.ply, METHOD.png, compare.png, compare.json, compare.md; made where missing")
      ->required();
  app.add_option_function<std::vector<std::string>>(
         "--methods",
         [&args](const std::vector<std::string>& words) {
           for (const std::string& word : words) {
             const auto contender = contender_of(word);
             if (!contender) throw CLI::ValidationError("--methods", contender.error().what);
             if (std::count(args.contenders.begin(), args.contenders.end(), *contender) == 0)
               args.contenders.push_back(*contender);
           }
         },
         "separated by commas, of unconstrained (arap without the constraints), " + method_names() + " [all]")
      ->delimiter(',');
  app.add_option("--time-limit", args.time_limit,
                 "seconds that each method may take, above 0; one that takes longer has no map [any]")
      ->check(CLI::PositiveNumber);
  app.add_option("--width", args.width, "of compare.png, 200 to 8000 pixels")
      ->check(CLI::Range(200, 8000))
      ->capture_default_str();
  app.add_flag("--repair", args.repair,
               "mend orientation, duplicates, degenerate triangles, split vertices first");
  add_cut(app, args.cut);
}

/// All of them where none is named.
Result<void> complete_contenders(CompareArgs& args) {
  const bool constrained = !args.constraints.empty();
  if (args.contenders.empty()) {
    if (constrained) args.contenders.push_back({Method::Arap, false});
    for (const Method method : all_methods()) args.contenders.push_back({method, true});
  }
  if (constrained || std::ranges::all_of(args.contenders, &Contender::constrained)) return {};
  return fail(ErrorCode::BadUsage,
              "without -c no map has constraints: in --methods, ask for arap in place of unconstrained");
}

/// unsaid: what it is where nothing is said.
template <class Value>
void add_overlaps(CLI::App& app, Value& value, const std::string& unsaid) {
  const std::map<std::string, Overlapping> overlaps = {{"report", Overlapping::Report},
                                                       {"remove", Overlapping::Remove}};
  app.add_option("--overlaps", value, "parts of the map on one another: report or remove [" + unsaid + "]")
      ->transform(CLI::CheckedTransformer(overlaps).description(""));
}

void add_flatten(CLI::App& app, FlattenArgs& args) {
  app.add_option("mesh", args.mesh, "mesh to flatten: .obj .ply .stl .off, each also with .gz")->required();
  app.add_option("-c,--constraints", args.constraints, "constraint file, JSON: features, constraints, seams");
  app.add_option("-o,--output", args.output, "mesh with its parameterization: .ply or .obj, also with .gz");
  app.add_option("--report", args.report, "report, JSON");
  app.add_option("--picture", args.picture, "picture of the flat panel: .png or .svg");
  app.add_option("--flat", args.flat, "flat mesh (u, v, 0): .ply or .obj");
  app.add_flag("--repair", args.repair,
               "mend orientation, duplicates, degenerate triangles, split vertices first");
  add_cut(app, args.cut);
  add_method(app, args.options.method);
  const std::map<std::string, Init> inits = {{"uniform", Init::Uniform},
                                             {"cotangent", Init::Cotangent},
                                             {"harmonic", Init::Harmonic},
                                             {"identity", Init::Identity}};
  app.add_option("--init", args.options.init,
                 "first rotations: uniform, cotangent, harmonic or identity [uniform]")
      ->transform(CLI::CheckedTransformer(inits).description(""));
  const std::map<std::string, Energy> energies = {{"arap", Energy::Arap},
                                                  {"symmetric-dirichlet", Energy::SymmetricDirichlet}};
  app.add_option("--energy", args.options.energy, "arap or symmetric-dirichlet [arap]")
      ->transform(CLI::CheckedTransformer(energies).description(""));
  add_overlaps(app, args.options.overlaps, "remove where flips are untangled");
  const std::map<std::string, Flips> flips = {{"untangle", Flips::Untangle},
                                              {"weights", Flips::Weights},
                                              {"stiffening", Flips::Stiffening},
                                              {"keep", Flips::Keep}};
  app.add_option("--flips", args.options.flips,
                 "flipped triangles: untangle, weights, stiffening or keep [untangle]")
      ->transform(CLI::CheckedTransformer(flips).description(""));
  app.add_option("--tolerance", args.options.tolerance, "of the gradient, above 0")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-iterations", args.options.max_iterations,
                 "local/global and Newton steps, 0 or more; removing overlaps may take twice as many again")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  app.add_flag(
      "--paper", args.options.paper,
      "the method as published: directions of features as first found, flipped triangles weighed up");
  app.add_flag("--price", args.price, "say what each constraint costs: one more solve a constraint")
      ->needs("--constraints");
  app.add_flag("--dry-run", args.dry_run,
               "look for contradictions, count unknowns, estimate memory; solve and write nothing");
  app.add_option("--memory-limit", args.memory_limit,
                 "memory to make do with, as 20G (K, M, G, T: powers of 1024); what cannot is refused "
                 "beforehand [none]")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62).description(""));
  app.add_flag("--normalize", args.options.normalize, "scale uv into the unit square (else true scale)");
}

void add_deform(CLI::App& app, DeformArgs& args) {
  app.add_option("mesh", args.mesh, "mesh with its parameterization: .ply .obj, also with .gz")->required();
  app.add_option("-c,--constraints", args.constraints, "constraint file, JSON: features, constraints, seams")
      ->required();
  app.add_option("-o,--output", args.output,
                 "mesh with its deformed parameterization: .ply or .obj, also with .gz");
  app.add_option("--report", args.report, "report, JSON");
  app.add_option("--picture", args.picture,
                 "picture of the map before and after, side by side: .png or .svg");
  app.add_flag("--repair", args.repair,
               "mend orientation, duplicates, degenerate triangles, split vertices first");
  app.add_option("--steps", args.solve.steps, "steps in which the features go to their shapes, 1 or more")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option(
      "--frames", args.frames,
      "folder, made where there is none, for a picture of each step: step_0000.png is the given map");
  const std::map<std::string, FeaturePoses> poses = {{"held", FeaturePoses::Held},
                                                     {"free", FeaturePoses::Free}};
  app.add_option("--poses", args.solve.poses,
                 "features: held where they lie nearest to the given map, or free to move from there [held]")
      ->transform(CLI::CheckedTransformer(poses).description(""));
  const std::map<std::string, Reference> references = {{"surface", Reference::Surface},
                                                       {"parameterization", Reference::Parameterization}};
  app.add_option("--reference", args.edit.reference,
                 "whose shape the triangles keep: surface or parameterization, the given one [surface]")
      ->transform(CLI::CheckedTransformer(references).description(""));
  const std::map<std::string, Energy> energies = {{"arap", Energy::Arap},
                                                  {"symmetric-dirichlet", Energy::SymmetricDirichlet}};
  app.add_option("--energy", args.solve.energy, "arap or symmetric-dirichlet [arap]")
      ->transform(CLI::CheckedTransformer(energies).description(""));
  const std::map<std::string, Flips> flips = {{"untangle", Flips::Untangle}, {"keep", Flips::Keep}};
  app.add_option("--flips", args.solve.flips, "flipped triangles: untangle or keep [untangle]")
      ->transform(CLI::CheckedTransformer(flips).description(""));
  add_overlaps(app, args.solve.overlaps, "report");
  app.add_option("--tolerance", args.solve.tolerance, "of the gradient, above 0")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-iterations", args.solve.max_iterations,
                 "local/global and Newton steps, 0 or more; removing overlaps may take twice as many again")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
}

void add_embed(CLI::App& app, EmbedArgs& args) {
  app.add_option("mesh", args.mesh, "mesh: .obj .ply .stl .off, each also with .gz")->required();
  app.add_option("-c,--constraints", args.constraints, "constraint file, JSON, with the features")
      ->required();
  app.add_option("-o,--output", args.output,
                 "mesh with the features in its edges: .ply or .obj, also with .gz");
  app.add_option("--report", args.report, "report, JSON");
  app.add_option("--picture", args.picture, "picture of the surface with its features: .png or .svg");
  app.add_flag("--repair", args.repair,
               "mend orientation, duplicates, degenerate triangles, split vertices first");
}

void add_verify(CLI::App& app, VerifyArgs& args) {
  app.add_option("mesh", args.mesh, "mesh with its parameterization: .ply .obj, also with .gz")->required();
  app.add_option("-c,--constraints", args.constraints,
                 "constraint file, JSON: what it asks for must be what the report answers");
  app.add_option(
      "--report", args.report,
      "report of flatten that was written with the mesh: residuals are recomputed, its numbers compared");
  app.add_flag("--json", args.json, "the whole result as JSON");
}

void add_info(CLI::App& app, InfoArgs& args) {
  app.add_option("mesh", args.mesh, "mesh: .obj .ply .stl .off, each also with .gz")->required();
  app.add_flag("--json", args.json, "as JSON, with the ids of every defect");
  app.add_flag("--repair", args.repair, "mend first, and say what was done");
}

void add_sample(CLI::App& app, SampleArgs& args) {
  app.add_option("kind", args.options.kind, "what to make")->required()->check(CLI::IsMember(sample_kinds()));
  app.add_option("--triangles", args.options.triangles, "about so many, 32 or more")
      ->check(CLI::Range(32, 700'000'000))
      ->capture_default_str();
  app.add_option("--noise", args.options.noise, "amplitude along the normal, metres, 0 or more")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--seed", args.options.seed, "same seed, same mesh")->capture_default_str();
  app.add_option("-o,--output", args.output, "mesh: .ply or .obj, also with .gz")->required();
  CLI::Option* const features =
      app.add_option("--features", args.features, "constraint file that fits the mesh, JSON");
  app.add_option("--feature-count", args.options.feature_count,
                 "write so many lines and circles spread over the panel, not its own features")
      ->check(CLI::Range(1, static_cast<int>(kMostSpreadFeatures)))
      ->needs(features);
}

/// CLI11 says which words it does not know; we say which known one is nearest.
Failure unknown_words(const CLI::App& app, const CLI::App* command) {
  const auto words = (command ? command : &app)->remaining();
  for (const std::string& word : words) {
    if (!word.starts_with("-")) continue;
    const std::string bare = word.substr(0, word.find('='));
    return fail(ErrorCode::BadUsage,
                "unknown option " + bare + nearest(bare, known_names(command ? *command : app, true)));
  }
  if (command && words.empty()) {
    return fail(ErrorCode::BadUsage, "options go after the command: " + app.remaining().front());
  }
  if (command) return fail(ErrorCode::BadUsage, "unexpected argument " + words.front());
  return fail(ErrorCode::BadUsage,
              "unknown command " + words.front() + nearest(words.front(), known_names(app, false)));
}

}  // namespace

Result<Args> parse_args(int argc, const char* const* argv) {
  CLI::App app(kDescription, "planish");
  app.set_version_flag("--version", "planish " PLANISH_VERSION);
  Args args;
  for (int i = 0; i < argc; ++i) args.common.command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  FlattenArgs flatten;
  CompareArgs compare;
  DeformArgs deform;
  EmbedArgs embed;
  VerifyArgs verify;
  InfoArgs info;
  SampleArgs sample;
  CLI::App* const flatten_app = app.add_subcommand("flatten", "flatten a mesh");
  CLI::App* const compare_app =
      app.add_subcommand("compare", "flatten a mesh by several methods, and set the maps side by side");
  CLI::App* const deform_app =
      app.add_subcommand("deform", "bring a mesh's own parameterization to its constraints");
  CLI::App* const embed_app =
      app.add_subcommand("embed", "put features into the edges of a mesh, flatten nothing");
  CLI::App* const verify_app =
      app.add_subcommand("verify", "check a flattened mesh from its files alone, exactly");
  CLI::App* const info_app = app.add_subcommand("info", "say what a mesh is and what is wrong with it");
  CLI::App* const sample_app = app.add_subcommand("sample", "make a mesh that looks like a scanned panel");
  CLI::App* const commands[] = {flatten_app, compare_app, deform_app, embed_app,
                                verify_app,  info_app,    sample_app};
  add_flatten(*flatten_app, flatten);
  add_compare(*compare_app, compare);
  add_deform(*deform_app, deform);
  add_embed(*embed_app, embed);
  add_verify(*verify_app, verify);
  add_info(*info_app, info);
  add_sample(*sample_app, sample);
  for (CLI::App* command : {flatten_app, compare_app, deform_app, embed_app}) {
    command->add_flag("--progress", args.common.progress,
                      "progress lines even where stderr is not a terminal");
  }
  const CLI::App* chosen = nullptr;
  for (CLI::App* command : commands) {
    add_common(*command, args.common);
    command->allow_extras();
  }
  app.allow_extras();
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    for (const CLI::App* command : commands) chosen = command->parsed() ? command : chosen;
    args.command = TextArgs{(chosen ? chosen : &app)->help()};
    return args;
  } catch (const CLI::CallForVersion&) {
    args.command = TextArgs{"planish " PLANISH_VERSION "\n"};
    return args;
  } catch (const CLI::ParseError& error) {
    for (const CLI::App* command : commands) chosen = command->parsed() ? command : chosen;
    if (app.remaining_size(true) > 0) return unknown_words(app, chosen);  // the likelier cause
    return fail(ErrorCode::BadUsage, error.what());
  }
  if (args.common.quiet && args.common.progress) {
    return fail(ErrorCode::BadUsage, "--quiet excludes --progress");
  }
  for (const CLI::App* command : commands) chosen = command->parsed() ? command : chosen;
  if (app.remaining_size(true) > 0) return unknown_words(app, chosen);
  if (!chosen)
    return fail(
        ErrorCode::BadUsage,
        "no command given: flatten, compare, deform, embed, verify, info or sample; see planish --help");
  if (chosen == flatten_app) {
    if (auto checked = check_method_options(*flatten_app, flatten.options.method); !checked)
      return fail(checked.error());
  }
  flatten.options.threads = args.common.threads;
  flatten.options.memory_limit = static_cast<std::int64_t>(flatten.memory_limit);
  deform.edit.threads = args.common.threads;
  if (chosen == flatten_app) args.command = flatten;
  if (chosen == compare_app) {
    if (auto completed = complete_contenders(compare); !completed) return fail(completed.error());
    args.command = compare;
  }
  if (chosen == deform_app) args.command = deform;
  if (chosen == embed_app) args.command = embed;
  if (chosen == verify_app) args.command = verify;
  if (chosen == info_app) args.command = info;
  if (chosen == sample_app) args.command = sample;
  return args;
}

}  // namespace planish
