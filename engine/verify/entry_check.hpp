// One entry of a report held against the map: what all kinds of constraints share.
#pragma once

#include "engine/model/verification.hpp"
#include "engine/verify/best_fit.hpp"
#include "engine/verify/measured_chain.hpp"
#include "engine/verify/prescription.hpp"

namespace planish {

inline constexpr double kLengthAllowed = 1e-9;   ///< over the size of the feature
inline constexpr double kDegreesAllowed = 1e-7;  ///< of relations

/// What constraints are measured on, and what they have to know of one another.
struct Evidence {
  const WrittenMap* map = nullptr;
  const Claims* claims = nullptr;
  const ConstraintSet* set = nullptr;  ///< null: no constraint file

  /// Null where the report has none of this name.
  const Feature* feature(const std::string& name) const;
  bool is_line(const std::string& name) const;
  /// Vertices that the line along a feature yielded, ascending.
  std::vector<Index> yielded_by_line(const std::string& name, int side) const;
};

class EntryCheck {
 public:
  EntryCheck(const Evidence& evidence, const ConstraintOutcome& entry, Prescription asked);

  ConstraintFinding finding;
  const Evidence& evidence() const { return evidence_; }
  const ConstraintOutcome& entry() const { return entry_; }
  const Prescription& asked() const { return asked_; }
  const std::vector<Index>& yielded() const { return yielded_; }
  /// Vertices that it holds where they are, ascending.
  const std::vector<Index>& held() const { return held_; }
  /// Length in the map over length in space, once measured.
  std::optional<double> factor() const { return factor_; }

  void fault(std::string what) { finding.faults.push_back(std::move(what)); }

  /// The feature, or none and a fault.
  const Feature* feature(const std::string& name);
  /// Its only feature's chain; none and a fault where it cannot be measured.
  std::optional<MeasuredChain> chain();
  void hold(std::vector<Index> vertices);
  /// Whether the report has a template of so many points; a fault where their number is another.
  bool has_template(std::size_t points);

  /// Largest distance at the places that are kept, over the size; 0 where they are fewer than determine a figure.
  /// Those that yielded must not stray.
  double largest(In<double> distance, In<std::size_t> kept, double size, std::size_t fewest);
  /// Residual of images against a template in its best pose; scale and orientation are checked by the way.
  double posed(In<Vec2> shape, In<Vec2> image, In<std::size_t> kept, double size);

  /// factor: of the map, measured on a part `reach` of the feature.
  void check_scale(double factor, double reach);
  void check_orientation(Vec2 direction);
  void check_mirror(const MeasuredChain& chain);
  /// Closed chains turn one way in the template and in the map.
  void check_turn(const MeasuredChain& chain);
  /// Edges of the template are as long as in space; shorter: or less.
  void check_template_lengths(const MeasuredChain& chain, bool shorter = false);

 private:
  const Evidence& evidence_;
  const ConstraintOutcome& entry_;
  Prescription asked_;
  std::vector<Index> yielded_, held_;
  std::optional<double> factor_;
};

/// The largest, or not a number where one of them is none: such a residual is not met.
double worst_of(In<double> values);

/// In [-period / 2, period / 2).
double wrapped(double degrees, double period);

}  // namespace planish
