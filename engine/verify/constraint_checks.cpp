#include "engine/verify/constraint_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "engine/verify/relation_checks.hpp"
#include "engine/verify/shape_checks.hpp"

namespace planish {
namespace {

using Checks = std::vector<EntryCheck>;

std::optional<double> residual_of(EntryCheck& check) {
  const std::string& type = check.asked().type;
  if (check.asked().is_relation()) return check_relation(check);
  if (type == "pin") return check_pin(check);
  if (check.asked().features.empty()) {
    check.fault("the report does not name its feature");
    return std::nullopt;
  }
  if (type == "line") return check_line(check);
  if (type == "circle") return check_circle(check);
  if (type == "curve") return check_curve(check);
  if (type == "region") return check_region(check);
  check.fault("its type \"" + type + "\" is not known");
  return std::nullopt;
}

/// The entry speaks of what the constraint file does.
void check_subject(EntryCheck& check) {
  const ConstraintOutcome& entry = check.entry();
  const Prescription& asked = check.asked();
  if (entry.type != asked.type)
    check.fault(fmt::format("it is a {} in the report, a {} in the constraint file", entry.type, asked.type));
  if (entry.features != asked.features || entry.edges != asked.edges || entry.pinned != asked.pinned)
    check.fault("the report and the constraint file name different features, edges or vertices");
}

void judge_residual(EntryCheck& check) {
  const double allowed = check.finding.allowed, stated = check.entry().residual;
  const char* unit = check.finding.degrees ? " degrees" : "";
  if (check.finding.residual && !(*check.finding.residual <= allowed))
    check.fault(fmt::format("its residual is {:.3g}{}, {:g} is allowed; the report says {:.3g}",
                            *check.finding.residual, unit, allowed, stated));
  else if (!(stated <= allowed))
    check.fault(
        fmt::format("the report says a residual of {:.3g}{}, {:g} is allowed", stated, unit, allowed));
}

void run(EntryCheck& check) {
  check_subject(check);
  check.finding.residual = residual_of(check);
  judge_residual(check);
}

// ---- the report as a whole ----

bool is_seam(const Evidence& evidence, const Feature& chain) {
  const std::size_t n = chain.vertex.size();
  for (std::size_t k = 0; k < (chain.closed ? n : n - 1); ++k) {
    if (!evidence.map->is_torn(chain.vertex[k], chain.vertex[(k + 1) % n])) return false;
  }
  return true;
}

/// Each constraint of the file has an entry, of one on a seam a side each.
void check_answered(const Evidence& evidence, const Constraint& constraint,
                    std::vector<std::string>& faults) {
  std::vector<int> sides;
  for (const ConstraintOutcome& entry : evidence.claims->constraints) {
    if (entry.name == constraint.name) sides.push_back(entry.side);
  }
  std::sort(sides.begin(), sides.end());
  const bool once = sides == std::vector{0}, by_sides = sides == std::vector{1, 2};
  if (sides.empty()) {
    faults.push_back(fmt::format("constraint \"{}\" has no answer in the report", constraint.name));
  } else if (!once && !by_sides) {
    faults.push_back(
        fmt::format("constraint \"{}\" has {} entries in the report, not one, or one a side of a seam",
                    constraint.name, sides.size()));
  } else if (once) {
    const std::string& type = constraint.type;
    if (type != "line" && type != "circle" && type != "curve") return;
    const Feature* chain = evidence.feature(prescription_of(constraint).features.front());
    if (chain != nullptr && !chain->is_region() && is_seam(evidence, *chain))
      faults.push_back(
          fmt::format("constraint \"{}\" is on a seam, and has one entry, not one a side", constraint.name));
  }
}

/// Free scales of a group are one.
void check_groups(const Checks& checks, std::vector<std::string>& faults) {
  std::map<std::string, const EntryCheck*> first;
  for (const EntryCheck& check : checks) {
    if (check.asked().scale_group.empty() || check.asked().scale || !check.factor()) continue;
    const EntryCheck& other = *first.try_emplace(check.asked().scale_group, &check).first->second;
    if (!(std::abs(*check.factor() / *other.factor() - 1) <= 10 * kLengthAllowed))
      faults.push_back(fmt::format(
          "\"{}\" and \"{}\" share the scale group \"{}\" and have the scales {:.12g} and {:.12g}",
          other.finding.name, check.finding.name, check.asked().scale_group, *other.factor(),
          *check.factor()));
  }
}

/// Pins yield to none, lines and circles before curves, curves before regions; relations hold no vertex.
int rank_of(const std::string& type) {
  if (type == "pin") return 0;
  if (type == "line" || type == "circle") return 1;
  return type == "curve" ? 2 : 3;
}

/// Who yields leaves a vertex to someone of the same rank or above.
void check_yielded(const Checks& checks, std::vector<std::string>& faults) {
  for (const EntryCheck& check : checks) {
    for (const Index v : check.yielded()) {
      const bool is_held = std::ranges::any_of(checks, [&](const EntryCheck& other) {
        return &other != &check && rank_of(other.asked().type) <= rank_of(check.asked().type) &&
               std::ranges::binary_search(other.held(), v);
      });
      if (is_held) continue;
      faults.push_back(fmt::format("\"{}\" yielded vertex {}, which no constraint of its rank or above holds",
                                   check.finding.name, v));
      break;
    }
  }
}

}  // namespace

std::vector<ConstraintFinding> check_constraints(const Evidence& evidence, std::vector<std::string>& faults) {
  std::map<std::string, const Constraint*> of_file;
  if (evidence.set != nullptr) {
    for (const Constraint& constraint : evidence.set->constraints) {
      of_file[constraint.name] = &constraint;
      check_answered(evidence, constraint, faults);
    }
  }
  Checks checks;
  for (const ConstraintOutcome& entry : evidence.claims->constraints) {
    const auto found = of_file.find(entry.name);
    if (evidence.set != nullptr && found == of_file.end())
      faults.push_back(
          fmt::format("the report has a constraint \"{}\", the constraint file none", entry.name));
    checks.emplace_back(evidence, entry,
                        found == of_file.end() ? prescription_of(entry) : prescription_of(*found->second));
    run(checks.back());
  }
  check_groups(checks, faults);
  check_yielded(checks, faults);
  std::vector<ConstraintFinding> findings;
  for (EntryCheck& check : checks) findings.push_back(std::move(check.finding));
  return findings;
}

}  // namespace planish
