#include "engine/constraints/agreement.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "engine/constraints/fit.hpp"
#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

constexpr double kRounding = 1e-12;  // of the smaller size: below it templates agree

/// A similarity t -> p + c t; `then` applies another one afterwards.
Placement then(const Placement& first, const Placement& second) {
  return {second.p + multiply(second.c, first.p), multiply(second.c, first.c)};
}

Placement inverse(const Placement& m) {
  const Vec2 c = (1 / dot(m.c, m.c)) * conjugate(m.c);
  return {-multiply(c, m.p), c};
}

/// Bodies whose templates were fitted to one another, and where each lies in the frame of the first of them.
class FittedSets {
 public:
  explicit FittedSets(std::size_t n) : parent_(n), to_parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  Index root(Index b) const {
    while (parent_[b] != b) b = parent_[b];
    return b;
  }
  Placement to_root(Index b) const {
    Placement m;
    for (; parent_[b] != b; b = parent_[b]) m = then(m, to_parent_[b]);
    return m;
  }
  /// a's template lies at `m` in b's.
  void join(Index a, Index b, const Placement& m) {
    const Placement root_to_b = then(then(inverse(to_root(a)), m), to_root(b));
    const Index root_a = root(a);
    parent_[root_a] = root(b);
    to_parent_[root_a] = root_to_b;
  }
  /// Where a's template lies in b's, of the same set.
  Placement between(Index a, Index b) const { return then(to_root(a), inverse(to_root(b))); }

 private:
  std::vector<Index> parent_;
  std::vector<Placement> to_parent_;
};

class Agreeing {
 public:
  Agreeing(const Compiled& compiled, const ConstraintView& view, const OrderedMesh& mesh)
      : compiled_(compiled), view_(view), mesh_(mesh), fitted_(compiled.bodies.size()) {
    for (const Body& body : bodies()) result_.yielded.emplace_back(body.vertex.size(), 0);
    result_.mismatch.assign(bodies().size(), 0);
    result_.mismatch_with.assign(bodies().size(), kNone);
  }

  Result<Agreement> operator()() {
    find_shared();
    if (auto pinned = settle_pins(); !pinned) return fail(pinned.error());
    // Pairs that leave no freedom first: what they settle binds the others.
    for (const bool overdetermined : {true, false}) {
      for (const auto& [pair, shared] : shared_) {
        if (is_overdetermined(pair.first, pair.second, shared.size()) != overdetermined) continue;
        auto settled = overdetermined || fitted_.root(pair.first) == fitted_.root(pair.second)
                           ? fit(pair.first, pair.second, shared)
                           : Result<void>();
        if (!settled) return fail(settled.error());
      }
    }
    add_joints();
    return std::move(result_);
  }

 private:
  struct At {
    Index vertex, body, place;
  };
  using Shared = std::vector<std::pair<Index, Index>>;  // places in both

  const std::vector<Body>& bodies() const { return compiled_.bodies; }

  bool outranks(Index a, Index b) const {
    const Body &x = bodies()[a], &y = bodies()[b];
    if (rank_of(x.kind) != rank_of(y.kind)) return rank_of(x.kind) > rank_of(y.kind);
    if (x.size != y.size) return x.size > y.size;
    return a < b;
  }

  void find_shared() {
    for (Index b = 0; b < static_cast<Index>(bodies().size()); ++b) {
      const Body& body = bodies()[b];
      for (Index i = 0; i < static_cast<Index>(body.vertex.size()); ++i)
        at_.push_back({body.vertex[i], b, i});
    }
    std::sort(at_.begin(), at_.end(), [&](const At& x, const At& y) {
      if (x.vertex != y.vertex) return x.vertex < y.vertex;
      return x.body != y.body && outranks(x.body, y.body);
    });
    for (std::size_t i = 0; i < at_.size(); ++i) {
      for (std::size_t j = i + 1; j < at_.size() && at_[j].vertex == at_[i].vertex; ++j)
        shared_[{at_[j].body, at_[i].body}].emplace_back(at_[j].place, at_[i].place);
    }
  }

  bool is_overdetermined(Index a, Index b, std::size_t shared) const {
    const Body &x = bodies()[a], &y = bodies()[b];
    if (x.kind == Body::Kind::FreeLine || y.kind == Body::Kind::FreeLine) return false;
    return shared >= ((x.scale && y.scale) || one_group(x, y) ? 2u : 3u);
  }

  static bool one_group(const Body& x, const Body& y) {
    return !x.scale_group.empty() && x.scale_group == y.scale_group;
  }

  double allowed(double size) const { return view_.set->agreement * size; }

  std::string difference(double mismatch, double size) const {
    return in_words(mismatch * mesh_.unit) + ", which is " + in_words(mismatch / size) +
           " of the smaller one's size (agreement allows " + in_words(view_.set->agreement) + ")";
  }

  void yield(Index body, Index place, double mismatch, Index to) {
    result_.yielded[body][place] = 1;
    if (mismatch <= result_.mismatch[body]) return;
    result_.mismatch[body] = mismatch;
    result_.mismatch_with[body] = to;
  }

  /// Lays a's template nearest to b's; a yields what they share.
  Result<void> fit(Index a, Index b, const Shared& shared) {
    const Body &low = bodies()[a], &high = bodies()[b];
    std::vector<Vec2> from, to;
    for (const auto& [i, j] : shared) {
      from.push_back(low.shape[i]);
      to.push_back(high.shape[j]);
    }
    const bool known = fitted_.root(a) == fitted_.root(b);
    const double ratio = one_group(low, high) ? 1 : low.scale && high.scale ? *low.scale / *high.scale : 0;
    const Placement placement = known ? fitted_.between(a, b) : best_placement(from, to, ratio);
    const double size = std::min(low.size, high.size);
    double mismatch = 0;
    for (std::size_t k = 0; k < from.size(); ++k)
      mismatch = std::max(mismatch, norm(placement.p + multiply(placement.c, from[k]) - to[k]));
    if (!(mismatch <= std::max(allowed(size), kRounding * size))) {
      return fail(conflict(*view_.set, {low.constraint, high.constraint},
                           "on the " + std::to_string(shared.size()) +
                               " vertices that they share their shapes differ by " +
                               difference(mismatch, size)));
    }
    for (const auto& [i, j] : shared)
      yield(a, i, mismatch <= kRounding * size ? 0 : mismatch, high.constraint);
    if (known) return {};
    fitted_.join(a, b, placement);
    result_.joints.push_back(
        {.kind = Joint::Kind::Fit, .a = a, .b = b, .p0 = placement.p, .c0 = placement.c});
    return {};
  }

  // ---- pins ----

  Result<void> settle_pins() {
    std::map<Index, std::vector<std::pair<Index, Index>>> pinned;  // body: places and pins
    for (Index k = 0; k < static_cast<Index>(compiled_.pins.size()); ++k) {
      const auto first = std::lower_bound(at_.begin(), at_.end(), compiled_.pins[k].vertex,
                                          [](const At& x, Index v) { return x.vertex < v; });
      for (auto i = first; i != at_.end() && i->vertex == compiled_.pins[k].vertex; ++i)
        pinned[i->body].emplace_back(i->place, k);
    }
    for (const auto& [body, pins] : pinned) {
      auto settled = settle_pins_of(body, pins);
      if (!settled) return settled;
    }
    return {};
  }

  Result<void> settle_pins_of(Index b, const std::vector<std::pair<Index, Index>>& pins) {
    const Body& body = bodies()[b];
    const bool rigid = body.kind != Body::Kind::FreeLine && pins.size() >= (body.scale ? 2u : 3u);
    if (!rigid) {
      for (const auto& [place, pin] : pins) {
        result_.joints.push_back(
            {.kind = Joint::Kind::Pin, .a = b, .place_a = place, .p0 = compiled_.pins[pin].uv, .pin = pin});
      }
      return {};
    }
    std::vector<Vec2> from, to;
    for (const auto& [place, pin] : pins) {
      from.push_back(body.shape[place]);
      to.push_back(compiled_.pins[pin].uv);
    }
    const Placement placement = best_placement(from, to, body.scale.value_or(0));
    double mismatch = 0;
    for (std::size_t k = 0; k < from.size(); ++k)
      mismatch = std::max(mismatch, norm(placement.p + multiply(placement.c, from[k]) - to[k]));
    if (!(mismatch <= std::max(allowed(body.size), kRounding * body.size))) {
      std::vector<Index> involved = {body.constraint};
      for (const auto& [place, pin] : pins) involved.push_back(compiled_.pins[pin].constraint);
      return fail(conflict(*view_.set, involved,
                           "the nearest place of \"" + view_.set->constraints[body.constraint].name +
                               "\" misses its " + std::to_string(pins.size()) + " pins by " +
                               difference(mismatch, body.size)));
    }
    for (const auto& [place, pin] : pins)
      yield(b, place, mismatch <= kRounding * body.size ? 0 : mismatch, compiled_.pins[pin].constraint);
    result_.joints.push_back({.kind = Joint::Kind::Fixed,
                              .a = b,
                              .p0 = placement.p,
                              .c0 = placement.c,
                              .pin = pins.front().second});
    return {};
  }

  // ---- joints at single vertices ----

  void add_joints() {
    for (std::size_t i = 0; i < at_.size();) {
      std::size_t end = i;
      const At* owner = nullptr;
      for (; end < at_.size() && at_[end].vertex == at_[i].vertex; ++end) {
        const At& at = at_[end];
        if (result_.yielded[at.body][at.place]) continue;
        if (owner) {
          result_.joints.push_back({.kind = Joint::Kind::Coincide,
                                    .a = at.body,
                                    .b = owner->body,
                                    .place_a = at.place,
                                    .place_b = owner->place});
        } else {
          owner = &at;
        }
      }
      i = end;
    }
  }

  const Compiled& compiled_;
  const ConstraintView& view_;
  const OrderedMesh& mesh_;
  FittedSets fitted_;
  std::vector<At> at_;                                // by vertex, then by rank
  std::map<std::pair<Index, Index>, Shared> shared_;  // lower rank, higher rank
  Agreement result_;
};

}  // namespace

bool part(Agreement& agreement, const Compiled& compiled, const Joint& joint, double mismatch) {
  const auto found = std::find_if(agreement.joints.begin(), agreement.joints.end(), [&](const Joint& other) {
    return other.kind == Joint::Kind::Coincide && other.a == joint.a && other.b == joint.b &&
           other.place_a == joint.place_a && other.place_b == joint.place_b;
  });
  if (found == agreement.joints.end()) return false;
  agreement.joints.erase(found);
  std::erase_if(agreement.joints, [&](const Joint& other) {
    return other.kind == Joint::Kind::Pin && other.a == joint.a && other.place_a == joint.place_a;
  });
  agreement.yielded[joint.a][joint.place_a] = 1;
  if (mismatch >= agreement.mismatch[joint.a]) {
    agreement.mismatch[joint.a] = mismatch;
    agreement.mismatch_with[joint.a] = compiled.bodies[joint.b].constraint;
  }
  return true;
}

Result<Agreement> agree(const Compiled& compiled, const ConstraintView& view, const OrderedMesh& mesh) {
  return Agreeing(compiled, view, mesh)();
}

}  // namespace planish
