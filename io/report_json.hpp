// The reports (DESIGN 4.3), the answers of `info --json` and `verify --json`, and errors, as JSON text: docs/*.schema.json describe
// all but the last. Numbers read back bit for bit; infinite and undefined ones are null.
#pragma once

#include <string>
#include <vector>

#include "engine/model/deformation.hpp"
#include "engine/model/embedding.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/price.hpp"
#include "engine/model/verification.hpp"
#include "engine/prepare/repair.hpp"
#include "engine/prepare/validate.hpp"

namespace planish {

/// Largest resident size of the process up to the end of a step.
struct StepPeak {
  std::string step;
  Offset bytes = 0;
};

/// Beside the result itself, what the program knows.
struct ReportContext {
  std::string input;                    ///< path of the mesh as given
  std::string command;                  ///< command line
  std::vector<Mending> mendings;        ///< of --repair
  std::vector<std::string> warnings;    ///< readers' and writers'
  std::vector<StepTime> extra_timings;  ///< read, write
  Offset peak_memory_bytes = 0;
  std::vector<StepPeak> peaks = {};  ///< in the order of the steps; may be empty
};

/// What cutting along seams did.
struct CutFacts {
  Index cut_edges = 0;    ///< edges with two copies
  double cut_length = 0;  ///< their length in space, mesh units
  Index charts = 0;       ///< components after the cut
};

/// What a report of flatten or deform has beside the map, where there is such.
struct ReportParts {
  const Embedding* embedding = nullptr;
  const CutFacts* cut = nullptr;
  const Price* price = nullptr;
  const DeformFacts* deformation = nullptr;
};

/// Of `flatten` and `deform`.
std::string report_json(const Flattening& flattening, const ReportContext& context,
                        const ReportParts& parts = {});

/// Of `embed`: a report without a flattening.
std::string embed_report_json(const Embedding& embedding, const ReportContext& context,
                              const CutFacts* cut = nullptr);

std::string diagnosis_json(const Diagnosis& diagnosis, const std::string& input,
                           const std::vector<Mending>& mendings, const std::vector<std::string>& warnings);

/// Beside the result itself, what the program knows of a verification; "" where a file was not given.
struct VerificationContext {
  std::string mesh, report, constraints;
  std::string uv_set;                        ///< spelling of the parameterization in the file
  std::vector<std::string> other_sets = {};  ///< spellings that were not looked at
  std::vector<std::string> warnings = {};    ///< the reader's
};

std::string verification_json(const Verification& verification, const VerificationContext& context);

/// {"error": {...}}; parts of the place that are not known are null.
std::string error_json(const Error& error);

}  // namespace planish
