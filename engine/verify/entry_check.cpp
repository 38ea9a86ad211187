#include "engine/verify/entry_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace planish {
namespace {

constexpr double kDegrees = 180 / kPi;

std::vector<Index> ascending(std::vector<Index> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::vector<Vec2> picked(In<Vec2> points, In<std::size_t> places) {
  std::vector<Vec2> chosen;
  for (const std::size_t k : places) chosen.push_back(points[k]);
  return chosen;
}

}  // namespace

double worst_of(In<double> values) {
  double worst = 0;
  for (const double value : values) {
    if (std::isnan(value)) return value;
    worst = std::max(worst, value);
  }
  return worst;
}

double wrapped(double degrees, double period) {
  return degrees - period * std::floor(degrees / period + 0.5);
}

const Feature* Evidence::feature(const std::string& name) const {
  const auto found = std::ranges::find(claims->features, name, &Feature::name);
  return found == claims->features.end() ? nullptr : &*found;
}

bool Evidence::is_line(const std::string& name) const {
  return std::ranges::any_of(claims->constraints, [&](const ConstraintOutcome& c) {
    return c.type == "line" && !c.features.empty() && c.features.front() == name;
  });
}

std::vector<Index> Evidence::yielded_by_line(const std::string& name, int side) const {
  for (const int wanted : {side, 0}) {
    for (const ConstraintOutcome& c : claims->constraints) {
      if (c.type == "line" && c.side == wanted && !c.features.empty() && c.features.front() == name)
        return ascending(c.yielded);
    }
  }
  return {};
}

EntryCheck::EntryCheck(const Evidence& evidence, const ConstraintOutcome& entry, Prescription asked)
    : evidence_(evidence), entry_(entry), asked_(std::move(asked)), yielded_(ascending(entry.yielded)) {
  finding = {.name = entry.name,
             .type = asked_.type,
             .side = entry.side,
             .degrees = asked_.is_relation(),
             .allowed = asked_.is_relation() ? kDegreesAllowed : kLengthAllowed};
}

const Feature* EntryCheck::feature(const std::string& name) {
  const Feature* found = evidence_.feature(name);
  if (found == nullptr) fault(fmt::format("the report has no feature \"{}\"", name));
  return found;
}

std::optional<MeasuredChain> EntryCheck::chain() {
  const Feature* found = feature(asked_.features.front());
  if (found == nullptr) return std::nullopt;
  auto measured = measure_chain(*evidence_.map, *found, entry_.side, yielded_);
  if (!measured) {
    fault(measured.error());
    return std::nullopt;
  }
  hold(measured->vertex);
  return std::move(*measured);
}

void EntryCheck::hold(std::vector<Index> vertices) {
  const std::vector<Index> own = ascending(std::move(vertices));
  std::set_difference(own.begin(), own.end(), yielded_.begin(), yielded_.end(), std::back_inserter(held_));
  std::vector<Index> strangers;
  std::set_difference(yielded_.begin(), yielded_.end(), own.begin(), own.end(),
                      std::back_inserter(strangers));
  if (!strangers.empty())
    fault(fmt::format("the report says that it yielded vertex {}, which is none of its own",
                      strangers.front()));
}

bool EntryCheck::has_template(std::size_t points) {
  if (entry_.shape.size() == points) return true;
  fault(fmt::format("its template has {} points in the report, its feature {}", entry_.shape.size(), points));
  return false;
}

double EntryCheck::largest(In<double> distance, In<std::size_t> kept, double size, std::size_t fewest) {
  std::vector<double> held, strayed(distance.begin(), distance.end());
  for (const std::size_t k : kept) {
    held.push_back(distance[k]);
    strayed[k] = 0;
  }
  const double stray = worst_of(strayed);
  // A vertex yields up to the agreement for each of the constraints that it is shared with.
  if (evidence_.set != nullptr && !(stray <= 10 * evidence_.set->agreement * size))
    fault(fmt::format("a vertex that it yielded lies {:.3g} away from its place, far beyond the agreement",
                      stray));
  return kept.size() < fewest ? 0 : worst_of(held) / size;
}

double EntryCheck::posed(In<Vec2> shape, In<Vec2> image, In<std::size_t> kept, double size) {
  std::vector<std::size_t> used(kept.begin(), kept.end());
  const bool determined = used.size() > 1;
  if (!determined) {
    used.resize(image.size());
    std::iota(used.begin(), used.end(), std::size_t{0});
  }
  const bool by_lengths = asked_.type == "circle" || asked_.type == "line";  // their edges tell the scale
  const fit::Pose pose =
      fit::best_pose(picked(shape, used), picked(image, used), by_lengths ? std::nullopt : asked_.scale);
  if (determined) {
    check_orientation(pose.turn);
    if (!by_lengths) check_scale(norm(pose.turn), std::min(1.0, pose.spread / size));
  }
  std::vector<double> distance;
  for (std::size_t k = 0; k < image.size(); ++k) distance.push_back(norm(pose.place(shape[k]) - image[k]));
  return largest(distance, kept, size, 2);
}

void EntryCheck::check_scale(double factor, double reach) {
  factor_ = factor;
  const double allowed = kLengthAllowed / reach;
  if (asked_.scale && !(std::abs(factor / *asked_.scale - 1) <= allowed))
    fault(fmt::format("its scale in the map is {:.12g}, the constraint file asks for {:.12g}", factor,
                      *asked_.scale));
  if (entry_.scale && !(std::abs(factor / *entry_.scale - 1) <= allowed))
    fault(fmt::format("its scale in the map is {:.12g}, the report says {:.12g}", factor, *entry_.scale));
  if (!entry_.scale) fault("the report does not state its scale");
}

void EntryCheck::check_orientation(Vec2 direction) {
  constexpr double kAllowed = 1e-6;  // degrees
  const double found = kDegrees * argument(direction);
  if (entry_.orientation && !(std::abs(wrapped(found - *entry_.orientation, 360)) <= kAllowed))
    fault(fmt::format("its orientation in the map is {:.9g} degrees, the report says {:.9g}", found,
                      *entry_.orientation));
}

void EntryCheck::check_mirror(const MeasuredChain& chain) {
  if (asked_.mirror && !chain.closed && entry_.mirrored != *asked_.mirror)
    fault(fmt::format("\"mirror\" is {} in the constraint file, \"mirrored\" {} in the report",
                      *asked_.mirror, entry_.mirrored));
}

void EntryCheck::check_turn(const MeasuredChain& chain) {
  if (chain.closed && !(twice_area(entry_.shape) * twice_area(chain.image) > 0))
    fault("its template and its image run round in opposite directions");
}

void EntryCheck::check_template_lengths(const MeasuredChain& chain, bool shorter) {
  std::vector<double> excesses;
  for (const MeasuredChain::Step& s : chain.step) {
    const double excess = norm(entry_.shape[s.to] - entry_.shape[s.from]) - s.length;
    excesses.push_back(shorter ? excess : std::abs(excess));
  }
  const double worst = worst_of(excesses);
  if (!(worst <= kLengthAllowed * chain.length))
    fault(fmt::format("an edge of its template in the report is off by {:.3g} from its length in space",
                      worst));
}

}  // namespace planish
