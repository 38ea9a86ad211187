#include <fmt/core.h>

#include <algorithm>

#include "app/commands.hpp"
#include "app/flat_result.hpp"
#include "app/opened.hpp"
#include "engine/compare.hpp"
#include "io/comparison_files.hpp"
#include "io/file.hpp"
#include "io/picture_sheet.hpp"

namespace planish {
namespace {

class CompareCommand {
 public:
  CompareCommand(const CommonArgs& common, const CompareArgs& args)
      : common_(common),
        args_(args),
        files_{args.mesh, args.constraints, args.repair, args.cut},
        exec_(common.threads),
        progress_(progress_style(common)),
        monitor_(monitor_of(progress_)) {}

  Result<int> operator()() {
    return make_folder(args_.folder)
        .and_then([&] { return open_mesh(exec_, files_, monitor_, stopwatch_, opened_, warnings_); })
        .and_then([&] { return compare_all(); })
        .and_then([&] { return write(); })
        .map([&] { return conclude(); });
  }

 private:
  Result<void> compare_all() {
    auto rows = compare(opened_.flat_surface(), opened_.constraints(), args_.contenders, common_.threads,
                        args_.time_limit, monitor_);
    if (!rows) return fail(files_.placed(rows.error()));
    rows_ = std::move(*rows);
    const auto mapped = std::ranges::find_if(rows_, &ComparedMethod::has_map);
    if (mapped == rows_.end()) return {};
    const std::string unwelded = unwelded_warning(opened_, mapped->flattening.mesh);
    if (!unwelded.empty()) warnings_.push_back(unwelded);
    return {};
  }

  Result<void> write() {
    progress_.show({.phase = Phase::Write});
    for (const ComparedMethod& row : rows_) {
      if (!row.has_map()) continue;
      if (auto written = write_map(row); !written) return written;
    }
    const ComparisonContext context{args_.mesh, args_.constraints, common_.command_line};
    return write_sheet()
        .and_then([&] { return write_file(in_folder("compare.json"), comparison_json(rows_, context)); })
        .and_then([&] { return write_file(in_folder("compare.md"), comparison_table(rows_, context)); });
  }

  Result<void> write_map(const ComparedMethod& row) {
    const std::string stem = in_folder(name(row.contender));
    auto written = write_flattened(exec_, stem + ".ply", opened_.featured,
                                   opened_.cut ? &*opened_.cut : nullptr, row.flattening.uv, warnings_);
    if (!written) return written;
    const std::vector<PlacedFeature> placed = features_on(row);
    return write_picture(exec_, stem + ".png", opened_.flat_surface(), row.flattening.uv,
                         row.flattening.certificate,
                         {.title = file_name(args_.mesh) + ": " + name(row.contender), .features = placed});
  }

  Result<void> write_sheet() {
    std::vector<SheetMap> maps;
    std::vector<std::vector<PlacedFeature>> placed;
    placed.reserve(rows_.size());
    for (const ComparedMethod& row : rows_) {
      if (!row.has_map()) continue;
      placed.push_back(features_on(row));
      maps.push_back({.uv = row.flattening.uv,
                      .certificate = &row.flattening.certificate,
                      .features = placed.back(),
                      .caption = comparison_caption(row)});
    }
    if (maps.empty()) return {};
    return write_picture_sheet(exec_, in_folder("compare.png"), opened_.flat_surface(), maps,
                               {.width = args_.width, .title = file_name(args_.mesh)},
                               SheetModel{model_caption(opened_.flat_surface().num_triangles())});
  }

  /// Those of another map where this one has no constraints: all features where none has.
  std::vector<PlacedFeature> features_on(const ComparedMethod& row) const {
    const auto has_outcome = [](const ComparedMethod& r) {
      return !r.flattening.constraints.outcome.empty();
    };
    const auto same = std::ranges::find_if(rows_, has_outcome);
    if (same == rows_.end()) return all_placed(opened_.flat_features());
    const ComparedMethod& from = has_outcome(row) ? row : *same;
    return placed_features(opened_.flat_features(), from.flattening.constraints);
  }

  int conclude() {
    progress_.finish();
    std::sort(warnings_.begin(), warnings_.end());
    warnings_.erase(std::unique(warnings_.begin(), warnings_.end()),
                    warnings_.end());  // each map has the same
    say_warnings(common_, warnings_);
    const bool any = std::ranges::any_of(rows_, &ComparedMethod::has_map);
    if (common_.quiet) return any ? 0 : 6;
    say_mendings(opened_.featured.input.mendings);
    fmt::print("{:<13} {:>11} {:>11} {:>9} {:>9} {:>8} {:>9} {:>11} {:>8}\n", "method", "arap", "conformal",
               "s2 min", "s1 max", "flipped", "overwound", "overlapping", "seconds");
    for (const ComparedMethod& row : rows_) {
      const Certificate& c = row.flattening.certificate;
      if (row.has_map()) {
        fmt::print("{:<13} {:>11.4e} {:>11.4e} {:>9.4f} {:>9.4f} {:>8} {:>9} {:>11} {:>8.2f}{}\n",
                   name(row.contender), c.arap, row.conformal, c.sigma_min.min, c.sigma_max.max,
                   c.flipped_triangles, c.overwound_vertices, c.overlapping_pairs, row.seconds,
                   row.flattening.up_to_scale.empty() ? "" : "  sizes free");
      } else {
        fmt::print("{:<13} {}: {}\n", name(row.contender), row.supported ? "failed" : "not supported",
                   row.reason);
      }
    }
    return any ? 0 : 6;
  }

  std::string in_folder(const std::string& file) const { return args_.folder + "/" + file; }

  const CommonArgs& common_;
  const CompareArgs& args_;
  OpenedFiles files_;
  Exec exec_;
  ProgressLine progress_;
  Monitor monitor_;
  Stopwatch stopwatch_;
  OpenedMesh opened_;
  std::vector<std::string> warnings_;
  std::vector<ComparedMethod> rows_;
};

}  // namespace

Result<int> run_compare(const CommonArgs& common, const CompareArgs& args) {
  return CompareCommand(common, args)();
}

}  // namespace planish
