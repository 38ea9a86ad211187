#include <Eigen/Dense>

#include "engine/constraints/poses.hpp"

namespace planish {
namespace {

constexpr double kRank = 1e-9;        // pivots below this part of the largest one are dependent
constexpr double kMet = 1e-14;        // residual that no step improves
constexpr double kLargestTurn = 0.5;  // of a Newton step, radians or units of the mesh
constexpr int kMostSteps = 60;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Residuals and derivatives of a group's joints.
struct JointEquations {
  Eigen::VectorXd residual;
  Rows derivative;
};

}  // namespace

struct PoseGroup::Dense {
  Eigen::MatrixXd along, across;    // orthonormal: null space of the joints at the base, and what is left
  Eigen::VectorXd base;             // values at the base
  mutable Eigen::MatrixXd tangent;  // d slots / d y where the group was moved to last
};

namespace {

class EquationWriter {
 public:
  EquationWriter(const std::vector<Body>& bodies, const std::vector<PoseSlots>& slots,
                 const std::vector<Index>& place, const Poses& poses, Eigen::Index columns)
      : bodies_(bodies), slots_(slots), place_(place), poses_(poses), columns_(columns) {}

  void add(const Joint& joint) {
    switch (joint.kind) {
      case Joint::Kind::Coincide:
        row_ = begin(poses_.point(joint.a, joint.place_a) - poses_.point(joint.b, joint.place_b));
        add_point(joint.a, joint.place_a, 1);
        add_point(joint.b, joint.place_b, -1);
        break;
      case Joint::Kind::Pin:
        row_ = begin(poses_.point(joint.a, joint.place_a) - joint.p0);
        add_point(joint.a, joint.place_a, 1);
        break;
      case Joint::Kind::Fixed:
        row_ = begin(poses_.translation(joint.a) - joint.p0);
        add_translation(joint.a, 1);
        add_factor_equation(joint);
        break;
      case Joint::Kind::Fit: {
        const Vec2 cb = poses_.factor(joint.b);
        row_ = begin(poses_.translation(joint.a) - poses_.translation(joint.b) - multiply(cb, joint.p0));
        add_translation(joint.a, 1);
        add_translation(joint.b, -1);
        add_factor(joint.b, -joint.p0);
        add_factor_equation(joint);
        break;
      }
    }
  }

  JointEquations finish() {
    JointEquations result;
    const auto rows = static_cast<Eigen::Index>(residual_.size());
    result.residual = Eigen::Map<const Eigen::VectorXd>(residual_.data(), rows);
    result.derivative = Eigen::Map<const Rows>(entries_.data(), rows, columns_);
    return result;
  }

 private:
  /// Two rows for a complex residual.
  Eigen::Index begin(Vec2 residual) {
    residual_.push_back(residual.x);
    residual_.push_back(residual.y);
    entries_.resize(entries_.size() + 2 * columns_, 0.0);
    return static_cast<Eigen::Index>(residual_.size()) - 2;
  }

  void at(Index slot, Vec2 dz) {
    entries_[row_ * columns_ + place_[slot]] += dz.x;
    entries_[(row_ + 1) * columns_ + place_[slot]] += dz.y;
  }

  void add_point(Index body, Index place, double sign) {
    poses_.visit_slots(body, place, [&](Index slot, Vec2 dz) { at(slot, sign * dz); });
  }

  void add_translation(Index body, double sign) {
    const Index p = slots_[body].p;
    if (p == kNone) return;
    at(p, {sign, 0});
    at(p + 1, {0, sign});
  }

  /// weight times the derivative of c.
  void add_factor(Index body, Vec2 weight) {
    const PoseSlots& s = slots_[body];
    const Vec2 c = poses_.factor(body);
    if (s.c != kNone) {
      at(s.c, weight);
      at(s.c + 1, {-weight.y, weight.x});
    }
    if (s.scale_slot != kNone) at(s.scale_slot, multiply(weight, poses_.heading(body)));
    if (s.angle_slot != kNone) at(s.angle_slot, multiply(weight, {-c.y, c.x}));
  }

  /// c_a = c_b c0 (of a fixed body: c_a = c0); where both sizes are given, the directions alone.
  void add_factor_equation(const Joint& joint) {
    const bool fixed = joint.kind == Joint::Kind::Fixed;
    const bool sizes_given = bodies_[joint.a].scale && (fixed || bodies_[joint.b].scale);
    const Vec2 ca = poses_.factor(joint.a);
    const Vec2 wanted = fixed ? joint.c0 : multiply(poses_.factor(joint.b), joint.c0);
    if (!sizes_given) {
      row_ = begin(ca - wanted);
      add_factor(joint.a, {1, 0});
      if (!fixed) add_factor(joint.b, -joint.c0);
      return;
    }
    // The angle between them, and a row of zeros.
    row_ = begin({argument(multiply(ca, conjugate(wanted))), 0});
    if (slots_[joint.a].angle_slot != kNone) at(slots_[joint.a].angle_slot, {1, 0});
    if (!fixed && slots_[joint.b].angle_slot != kNone) at(slots_[joint.b].angle_slot, {-1, 0});
  }

  const std::vector<Body>& bodies_;
  const std::vector<PoseSlots>& slots_;
  const std::vector<Index>& place_;
  const Poses& poses_;
  Eigen::Index columns_, row_ = 0;
  std::vector<double> residual_, entries_;
};

}  // namespace

/// What a group asks of the poses it belongs to.
struct PoseAccess {
  static JointEquations equations(const Poses& poses, const std::vector<Index>& joints, std::size_t columns) {
    EquationWriter writer(poses.compiled_->bodies, poses.slots_, poses.slot_place_, poses,
                          static_cast<Eigen::Index>(columns));
    for (const Index k : joints) writer.add(poses.agreement_->joints[k]);
    return writer.finish();
  }
  static std::vector<double>& values(Poses& poses) { return poses.value_; }
  static bool is_angle(const Poses& poses, Index slot) {
    return std::any_of(poses.slots_.begin(), poses.slots_.end(),
                       [&](const PoseSlots& s) { return s.angle_slot == slot; });
  }
};

PoseGroup::PoseGroup(Poses& poses, std::vector<Index> slot, std::vector<Index> joint)
    : poses_(poses), slot_(std::move(slot)), joint_(std::move(joint)), dense_(std::make_unique<Dense>()) {
  linear_ =
      std::none_of(slot_.begin(), slot_.end(), [&](Index s) { return PoseAccess::is_angle(poses_, s); });
}

PoseGroup::~PoseGroup() = default;

double PoseGroup::close() {
  std::vector<double>& value = PoseAccess::values(poses_);
  for (int step = 0;; ++step) {
    const JointEquations now = PoseAccess::equations(poses_, joint_, slot_.size());
    const double gap = now.residual.size() > 0 ? now.residual.cwiseAbs().maxCoeff() : 0;
    if (gap <= kMet || step == kMostSteps || !std::isfinite(gap)) return gap;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(kRank);
    solver.compute(now.derivative);
    Eigen::VectorXd change = solver.solve(-now.residual);
    const double largest = change.cwiseAbs().maxCoeff();
    if (!(largest > 1e-16)) return gap;
    if (largest > kLargestTurn) change *= kLargestTurn / largest;
    for (std::size_t i = 0; i < slot_.size(); ++i) value[slot_[i]] += change[static_cast<Eigen::Index>(i)];
  }
}

void PoseGroup::set_base() {
  const auto n = static_cast<Eigen::Index>(slot_.size());
  const JointEquations now = PoseAccess::equations(poses_, joint_, slot_.size());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kRank);
  qr.compute(now.derivative.transpose());
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  dense_->across = q.leftCols(qr.rank());
  dense_->along = q.rightCols(n - qr.rank());
  dense_->tangent = dense_->along;
  dense_->base.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) dense_->base[i] = PoseAccess::values(poses_)[slot_[i]];
}

Index PoseGroup::num_free() const { return static_cast<Index>(dense_->along.cols()); }

bool PoseGroup::move_to(In<double> y) {
  constexpr int kMoveSteps = 20;
  constexpr double kSmallEnough = 1e-12;
  const Eigen::Map<const Eigen::VectorXd> free(y.data(), static_cast<Eigen::Index>(y.size()));
  Eigen::VectorXd at = dense_->base + dense_->along * free;
  std::vector<double>& value = PoseAccess::values(poses_);
  const auto apply = [&] {
    for (std::size_t i = 0; i < slot_.size(); ++i) value[slot_[i]] = at[static_cast<Eigen::Index>(i)];
  };
  apply();
  if (linear_) return true;
  for (int step = 0; step < kMoveSteps; ++step) {
    const JointEquations now = PoseAccess::equations(poses_, joint_, slot_.size());
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
    solver.setThreshold(kRank);
    solver.compute(now.derivative * dense_->across);
    const double residual = now.residual.cwiseAbs().maxCoeff();
    const Eigen::VectorXd change = solver.solve(-now.residual);
    const bool settled = residual <= kMet || step + 1 == kMoveSteps || change.cwiseAbs().maxCoeff() <= 1e-16;
    if (settled && residual <= kSmallEnough) {
      if (num_free() > 0)
        dense_->tangent = dense_->along - dense_->across * solver.solve(now.derivative * dense_->along);
      return true;
    }
    if (!change.allFinite() || change.cwiseAbs().maxCoeff() > 1) return false;
    at += dense_->across * change;
    apply();
  }
  return false;
}

void PoseGroup::pull_back(In<double> slot_gradient, Out<double> gradient) const {
  if (gradient.empty()) return;  // joints leave nothing free
  Eigen::VectorXd g(static_cast<Eigen::Index>(slot_.size()));
  for (std::size_t i = 0; i < slot_.size(); ++i) g[static_cast<Eigen::Index>(i)] = slot_gradient[slot_[i]];
  Eigen::Map<Eigen::VectorXd>(gradient.data(), static_cast<Eigen::Index>(gradient.size())) =
      dense_->tangent.transpose() * g;
}

std::vector<Vec2> PoseGroup::reactions(In<double> slot_gradient) const {
  const JointEquations now = PoseAccess::equations(poses_, joint_, slot_.size());
  Eigen::VectorXd g(static_cast<Eigen::Index>(slot_.size()));
  for (std::size_t i = 0; i < slot_.size(); ++i) g[static_cast<Eigen::Index>(i)] = slot_gradient[slot_[i]];
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kRank);
  solver.compute(now.derivative.transpose());
  const Eigen::VectorXd multiplier = solver.solve(g);
  std::vector<Vec2> reaction;
  for (Eigen::Index row = 0; row < multiplier.size(); row += 2)
    reaction.push_back({multiplier[row], multiplier[row + 1]});
  return reaction;
}

double PoseGroup::at_base(Index place, Index k) const { return dense_->along(place, k); }

}  // namespace planish
