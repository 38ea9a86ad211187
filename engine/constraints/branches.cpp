#include "engine/constraints/branches.hpp"

#include <algorithm>
#include <limits>

#include "engine/constraints/disjoint_sets.hpp"
#include "engine/features/feature_error.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kAgree = 1e-9;  // radians
constexpr int kMostTrials = 100000;

/// Union-find of bodies (the last one is the u axis) with the angle of each against its root; can be undone.
class AngleSets {
 public:
  explicit AngleSets(std::size_t n) : parent_(n), angle_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  Index root(Index b) const {
    while (parent_[b] != b) b = parent_[b];
    return b;
  }
  double against_root(Index b) const {
    double sum = 0;
    for (; parent_[b] != b; b = parent_[b]) sum += angle_[b];
    return sum;
  }
  /// direction of b - direction of a = difference; returns the root that was hung on, or kNone where both were in one set.
  Index join(Index a, Index b, double difference) {
    const Index root_a = root(a), root_b = root(b);
    if (root_a == root_b) return kNone;
    // b = root_b + x; a = root_a + y; root_b = root_a + y + difference - x.
    const double turn = against_root(a) + difference - against_root(b);
    parent_[root_b] = root_a;
    angle_[root_b] = turn;
    return root_b;
  }
  void undo(Index hung) { parent_[hung] = hung, angle_[hung] = 0; }

 private:
  std::vector<Index> parent_;
  std::vector<double> angle_;
};

class BranchChoice {
 public:
  BranchChoice(const Compiled& compiled, const ConstraintView& view, const Measured& measured)
      : compiled_(compiled),
        view_(view),
        axis_(static_cast<Index>(compiled.bodies.size())),
        measured_(measured) {
    measured_.angle.push_back(0);
    measured_.frame.push_back(measured_.num_frames);
  }

  Result<Oriented> operator()() {
    tie_frames();
    std::vector<Index> all(relations().size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<double> difference;
    if (!assign(all, difference)) {
      if (gave_up_) return fail(too_many_choices());
      return fail(name_conflict(all));
    }
    return finish(difference);
  }

 private:
  const std::vector<Relation>& relations() const { return compiled_.relations; }
  Index a_of(const Relation& r) const { return r.a == kNone ? axis_ : r.a; }
  Index b_of(const Relation& r) const { return r.b == kNone ? axis_ : r.b; }

  /// direction(b) - direction(a) for each representative, as it was given first.
  std::vector<double> representatives(const Relation& r) const {
    const double shift = r.along_a - r.along_b, degrees = r.degrees * kDegree;
    std::vector<double> angle = {degrees};
    if (!r.oriented) angle = {degrees, degrees + kPi, -degrees, -degrees + kPi};
    const double now = measured_.angle[b_of(r)] - measured_.angle[a_of(r)];
    for (double& x : angle) x = now + reduce_angle(x + shift - now);
    return angle;
  }

  /// The same, nearest to the measured one first.
  std::vector<double> candidates(const Relation& r) const {
    std::vector<double> angle = representatives(r);
    const double now = measured_.angle[b_of(r)] - measured_.angle[a_of(r)];
    std::stable_sort(angle.begin(), angle.end(),
                     [&](double x, double y) { return std::abs(x - now) < std::abs(y - now) - kAgree; });
    std::vector<double> distinct;
    for (const double x : angle) {
      const bool known = std::any_of(distinct.begin(), distinct.end(),
                                     [&](double y) { return std::abs(reduce_angle(x - y)) <= kAgree; });
      if (!known) distinct.push_back(x);
    }
    return distinct;
  }

  /// Frames of components are free to turn: the first relation between two of them decides how they lie, by the
  /// representative that suits their other relations best, else as it is given: where a frame lies by itself says nothing.
  void tie_frames() {
    frame_turn_.assign(measured_.num_frames + 1, 0);
    DisjointSets sets(measured_.num_frames + 1);
    for (const Relation& r : relations()) {
      const Index a = a_of(r), b = b_of(r);
      const Index frame_a = measured_.frame[a], frame_b = measured_.frame[b];
      if (sets.root(frame_a) == sets.root(frame_b)) continue;
      const Index moving = sets.root(frame_b) == sets.root(measured_.num_frames) ? frame_a : frame_b;
      const Index set = sets.root(moving), other = sets.root(moving == frame_b ? frame_a : frame_b);
      const auto turn_set = [&](double by) {
        for (std::size_t k = 0; k < measured_.angle.size(); ++k) {
          if (sets.root(measured_.frame[k]) == set) measured_.angle[k] += by;
        }
      };
      const double now = measured_.angle[b] - measured_.angle[a];
      double by = 0, least = kInfinity;
      for (const double candidate : representatives(r)) {
        const double turn = reduce_angle(candidate - now) * (moving == frame_b ? 1 : -1);
        turn_set(turn);
        double misfit = 0;
        for (const Relation& q : relations()) {
          const Index p_a = sets.root(measured_.frame[a_of(q)]), p_b = sets.root(measured_.frame[b_of(q)]);
          if (std::minmax(p_a, p_b) != std::minmax(set, other)) continue;
          misfit += std::abs(candidates(q).front() - (measured_.angle[b_of(q)] - measured_.angle[a_of(q)]));
        }
        turn_set(-turn);
        if (misfit < least - kAgree) least = misfit, by = turn;
      }
      for (Index f = 0; f <= measured_.num_frames; ++f) {
        if (sets.root(f) == set) frame_turn_[f] += by;
      }
      turn_set(by);
      sets.unite(frame_a, frame_b);
    }
    frame_set_ = sets.labels();
  }

  /// Relations from a to b that close no cycle.
  std::vector<std::size_t> path(const std::vector<Index>& chosen,
                                const std::vector<std::vector<std::size_t>>& tree, Index a, Index b) const {
    constexpr std::size_t kUnseen = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> by(tree.size(), kUnseen);  // relation over which a body was reached
    std::vector<Index> queue = {a};
    const auto other_end = [&](std::size_t k, Index body) {
      const Relation& r = relations()[chosen[k]];
      return a_of(r) == body ? b_of(r) : a_of(r);
    };
    for (std::size_t head = 0; head < queue.size() && by[b] == kUnseen; ++head) {
      for (const std::size_t k : tree[queue[head]]) {
        const Index next = other_end(k, queue[head]);
        if (next == a || by[next] != kUnseen) continue;
        by[next] = k;
        queue.push_back(next);
      }
    }
    std::vector<std::size_t> result;
    for (Index at = b; at != a; at = other_end(by[at], at)) result.push_back(by[at]);
    std::sort(result.begin(), result.end());
    return result;
  }

  /// Places in `chosen` of relations that cycles tie together; what one block chooses is nothing to another. In each block
  /// a cycle follows the other, so that a bad choice shows early.
  std::vector<std::vector<std::size_t>> blocks(const std::vector<Index>& chosen) const {
    DisjointSets joined(axis_ + 1), tied(static_cast<Index>(chosen.size()));
    std::vector<std::vector<std::size_t>> tree(axis_ + 1);
    std::vector<std::uint8_t> listed(chosen.size(), 0);
    std::vector<std::size_t> order;
    const auto list = [&](std::size_t k) {
      if (!listed[k]) order.push_back(k);
      listed[k] = 1;
    };
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const Index a = a_of(relations()[chosen[k]]), b = b_of(relations()[chosen[k]]);
      if (joined.unite(a, b)) {
        tree[a].push_back(k);
        tree[b].push_back(k);
        continue;
      }
      for (const std::size_t other : path(chosen, tree, a, b)) {
        tied.unite(static_cast<Index>(other), static_cast<Index>(k));
        list(other);
      }
      list(k);
    }
    for (std::size_t k = 0; k < chosen.size(); ++k) list(k);
    const std::vector<Index> label = tied.labels();
    std::vector<std::vector<std::size_t>> result(tied.count());
    for (const std::size_t k : order) result[label[k]].push_back(k);
    return result;
  }

  bool assign(const std::vector<Index>& chosen, std::vector<double>& difference) const {
    difference.assign(chosen.size(), 0);
    const auto all = blocks(chosen);
    return std::all_of(all.begin(), all.end(), [&](const std::vector<std::size_t>& block) {
      return assign_block(chosen, block, difference);
    });
  }

  /// Depth first, the nearest representatives first.
  bool assign_block(const std::vector<Index>& chosen, const std::vector<std::size_t>& block,
                    std::vector<double>& difference) const {
    AngleSets sets(compiled_.bodies.size() + 1);
    int trials = 0;
    const auto next = [&](auto&& self, std::size_t i) -> bool {
      if (i == block.size()) return true;
      const Relation& r = relations()[chosen[block[i]]];
      for (const double candidate : candidates(r)) {
        if (++trials > kMostTrials) {
          gave_up_ = true;
          return false;
        }
        const Index hung = sets.join(a_of(r), b_of(r), candidate);
        if (hung == kNone) {
          const double now = sets.against_root(b_of(r)) - sets.against_root(a_of(r));
          if (std::abs(reduce_angle(now - candidate)) > kAgree) continue;
        }
        difference[block[i]] = candidate;
        if (self(self, i + 1)) return true;
        if (hung != kNone) sets.undo(hung);
      }
      return false;
    };
    return next(next, 0);
  }

  Error too_many_choices() const {
    return {
        .code = ErrorCode::ConstraintInvalid,
        .what = "among the angles that undirected constraints allow no choice that adds up was found in " +
                std::to_string(kMostTrials) + " trials; make some of them oriented",
        .place = {.file = {}, .pointer = "/constraints"}};
  }

  /// Leaves out one relation after the other, as long as what remains still cannot hold.
  Error name_conflict(std::vector<Index> conflicting) const {
    std::vector<double> difference;
    for (std::size_t k = conflicting.size(); k-- > 0;) {
      std::vector<Index> without = conflicting;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
      if (!assign(without, difference)) conflicting = std::move(without);
    }
    std::vector<Index> constraints;
    for (const Index k : conflicting) constraints.push_back(relations()[k].constraint);
    // The others hold: how far is the last one off?
    std::vector<Index> others(conflicting.begin(), conflicting.end() - 1);
    assign(others, difference);
    AngleSets sets(compiled_.bodies.size() + 1);
    for (std::size_t k = 0; k < others.size(); ++k)
      sets.join(a_of(relations()[others[k]]), b_of(relations()[others[k]]), difference[k]);
    const Relation& last = relations()[conflicting.back()];
    const double now = sets.against_root(b_of(last)) - sets.against_root(a_of(last));
    double off = kInfinity;
    for (const double candidate : candidates(last))
      off = std::min(off, std::abs(reduce_angle(now - candidate)));
    return conflict(
        *view_.set, constraints,
        "their angles do not add up, they miss one another by " + in_words(off / kDegree) + " degrees");
  }

  Oriented finish(const std::vector<double>& difference) {
    AngleSets sets(compiled_.bodies.size() + 1);
    for (std::size_t k = 0; k < relations().size(); ++k)
      sets.join(a_of(relations()[k]), b_of(relations()[k]), difference[k]);
    Oriented result;
    const std::size_t n = compiled_.bodies.size();
    DisjointSets clusters(static_cast<Index>(n + 1));
    for (Index b = 0; b <= axis_; ++b) clusters.unite(b, sets.root(b));
    const std::vector<Index> label = clusters.labels();
    result.clusters.directed.assign(clusters.count(), 0);
    const bool axis_alone = std::count(label.begin(), label.end(), label[axis_]) == 1;
    if (!axis_alone) result.clusters.directed[label[axis_]] = 1;
    const double axis_angle = sets.against_root(axis_);
    for (std::size_t b = 0; b < n; ++b) {
      const bool directed = label[b] == label[axis_];
      result.clusters.of.push_back(label[b]);
      result.clusters.offset.push_back(sets.against_root(static_cast<Index>(b)) -
                                       (directed ? axis_angle : 0));
    }
    for (std::size_t k = 0; k < relations().size(); ++k) {
      const Relation& r = relations()[k];
      result.chosen.push_back(reduce_angle(difference[k] - r.along_a + r.along_b));
    }
    const Index axis_frame = measured_.num_frames;
    result.frame_turn.assign(frame_turn_.begin(), frame_turn_.end() - 1);
    result.frame_set.assign(frame_set_.begin(), frame_set_.end() - 1);
    result.directed_set.assign(
        static_cast<std::size_t>(*std::max_element(frame_set_.begin(), frame_set_.end())) + 1, 0);
    result.directed_set[frame_set_[axis_frame]] = 1;
    return result;
  }

  const Compiled& compiled_;
  const ConstraintView& view_;
  Index axis_;
  Measured measured_;
  std::vector<double> frame_turn_;
  std::vector<Index> frame_set_;
  mutable bool gave_up_ = false;
};

}  // namespace

Result<Oriented> choose_branches(const Compiled& compiled, const ConstraintView& view,
                                 const Measured& measured) {
  return BranchChoice(compiled, view, measured)();
}

}  // namespace planish
