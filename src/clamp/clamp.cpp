#include "cloth_sim/clamp/clamp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "cloth_sim/validation.h"
#include "motion_limiter.h"
#include "support/rotation.h"

namespace cloth_sim {
namespace {

/// Tolerance of `atTarget` [m], [rad], [m/s], [rad/s].
constexpr double kAtTarget = 1e-6;

void require(bool holds, const ClampSpec& spec, const char* what) {
  if (!holds) throw std::invalid_argument("clamp '" + spec.name + "': expected " + what);
}

void validate(const ClampSpec& spec) {
  const double norm = spec.pose.orientation.norm();
  require(spec.pose.position.allFinite() && isPositive(norm), spec, "a pose");
  require(isPositive(spec.plateSize.x()) && isPositive(spec.plateSize.y()), spec, "plates > 0");
  require(isPositive(spec.gapClosed), spec, "gap_closed > 0");
  require(std::isfinite(spec.gapOpen) && spec.gapOpen > spec.gapClosed, spec,
          "gap_open > gap_closed");
  require(isPositive(spec.closingSpeed), spec, "closing_speed > 0");
  require(isPositive(spec.maxLinearSpeed), spec, "max_linear_speed > 0");
  require(isPositive(spec.maxAngularSpeed), spec, "max_angular_speed > 0");
  require(isPositive(spec.maxLinearAcceleration), spec, "max_linear_acceleration > 0");
  require(!spec.gripForce || isPositive(*spec.gripForce), spec, "grip_force > 0");
}

/// Returns `v`, shortened to the length `limit` if it is longer by more than round-off.
Vec3 shortened(const Vec3& v, double limit) {
  constexpr double kRoundOff = 1e-12;
  const double length = v.norm();
  return length > limit * (1.0 + kRoundOff) ? Vec3(v * (limit / length)) : v;
}

/// Returns the shortest rotation between two orientations as axis times angle, in the axes of the
/// world [rad].
Vec3 rotationBetween(const Quat& from, const Quat& to) {
  return rotationVector(to.normalized() * from.conjugate());
}

}  // namespace

const char* toString(ClampState state) {
  switch (state) {
    case ClampState::kOpen:
      return "open";
    case ClampState::kClosing:
      return "closing";
    case ClampState::kClosed:
      return "closed";
  }
  return "";
}

Clamp::Clamp(ClampSpec spec) : spec_(std::move(spec)), pose_(spec_.pose), gap_(spec_.gapOpen) {
  validate(spec_);
  pose_.orientation.normalize();
  setTarget(pose_);
}

void Clamp::guide(const MovingPose& target) {
  target_ = target;
  target_.linear = shortened(target.linear, spec_.maxLinearSpeed);
  target_.angular = shortened(target.angular, spec_.maxAngularSpeed);
}

void Clamp::place(const Pose& pose) {
  if (!held_.empty()) {
    throw std::logic_error("clamp '" + spec_.name + "' holds cloth: it can move, but not jump");
  }
  pose_ = pose;
  pose_.orientation.normalize();
  setTarget(pose_);
  linearVelocity_.setZero();
  angularVelocity_.setZero();
}

Pose Clamp::stoppingPose() const {
  const double linear = spec_.maxLinearAcceleration;
  const double angular = linear / kClampArm;
  Pose rest = pose_;
  rest.position += linearVelocity_ * (linearVelocity_.norm() / (2.0 * linear));
  rest.orientation =
      turned(pose_.orientation, angularVelocity_, angularVelocity_.norm() / (2.0 * angular));
  return rest;
}

bool Clamp::atTarget() const {
  const Pose& there = target_.pose;
  return (there.position - pose_.position).norm() <= kAtTarget &&
         rotationBetween(pose_.orientation, there.orientation).norm() <= kAtTarget &&
         linearVelocity_.norm() <= kAtTarget && angularVelocity_.norm() <= kAtTarget;
}

bool Clamp::isStill() const {
  const Pose& there = target_.pose;
  const bool arrived = target_.isStill() && linearVelocity_.isZero(0.0) &&
                       angularVelocity_.isZero(0.0) &&
                       (there.position - pose_.position).norm() <= kArrived &&
                       rotationBetween(pose_.orientation, there.orientation).norm() <= kArrived;
  const bool opened = state_ == ClampState::kOpen && gap_ == spec_.gapOpen;
  const bool closed = state_ == ClampState::kClosed && gap_ == spec_.gapClosed;
  return arrived && (opened || closed) && !slip_.on &&
         std::all_of(grips_.begin(), grips_.end(), [](const Grip& g) { return g.squeeze == 0.0; });
}

void Clamp::close() {
  if (state_ != ClampState::kOpen) return;
  state_ = ClampState::kClosing;
  slip_ = Slip();
}

void Clamp::release() {
  state_ = ClampState::kOpen;
  grips_.clear();
  held_.clear();
  slip_ = Slip();
  wrench_ = Wrench();
}

void Clamp::advance(const Model& model, const State& state, double dt, Squeeze how) {
  if (!(dt > 0.0)) return;
  const double gapBefore = gap_;
  moveGap(dt);
  if (state_ == ClampState::kClosing) grasp(model, state, gapBefore, dt);
  slide(model, state, dt);
  squeeze(how, dt);
  moveTarget(dt);
  movePose(dt);
}

/// Moves the target on. Its velocities are means over the step, since it may stop within it.
void Clamp::moveTarget(double dt) {
  const double fraction = std::min(1.0, target_.horizon / dt);
  targetLinear_ = fraction * target_.linear;
  targetAngular_ = fraction * target_.angular;
  target_.advance(dt);
}

/// Moves the clamp towards the target, by velocities relative to the target.
void Clamp::movePose(double dt) {
  const double speed = std::min(spec_.maxLinearSpeed, speedLimit_.value_or(spec_.maxLinearSpeed));
  const MotionLimits linear{speed, spec_.maxLinearAcceleration};
  const Vec3 distance = target_.pose.position - targetLinear_ * dt - pose_.position;
  const Vec3 approach = limitedVelocity(distance, linearVelocity_ - targetLinear_, linear, dt);
  linearVelocity_ = shortened(targetLinear_ + approach, std::max(speed, linearVelocity_.norm()));
  pose_.position += linearVelocity_ * dt;

  const MotionLimits angular{spec_.maxAngularSpeed, spec_.maxLinearAcceleration / kClampArm};
  const Quat before = turned(target_.pose.orientation, targetAngular_, -dt);
  const Vec3 turn = limitedVelocity(rotationBetween(pose_.orientation, before),
                                    angularVelocity_ - targetAngular_, angular, dt);
  angularVelocity_ =
      shortened(targetAngular_ + turn, std::max(spec_.maxAngularSpeed, angularVelocity_.norm()));
  pose_.orientation = turned(pose_.orientation, angularVelocity_, dt);
}

void Clamp::moveGap(double dt) {
  const double travel = spec_.closingSpeed * dt;
  gap_ = state_ == ClampState::kOpen ? std::min(spec_.gapOpen, gap_ + travel)
                                     : std::max(spec_.gapClosed, gap_ - travel);
}

void Clamp::holdBack(const State& state, double dt) {
  double missing = 0.0;  // fraction of the motion
  for (const Grip& grip : grips_) {
    const Vec3 arm = pose_.orientation * grip.local;
    const Vec3 motion = dt * (linearVelocity_ + angularVelocity_.cross(arm));
    const Vec3 lag = pose_.position + arm - state.x[grip.vertex];
    const double square = motion.squaredNorm();
    if (square > 0.0) missing = std::max(missing, lag.dot(motion) / square);
  }
  missing = std::min(missing, 1.0);
  pose_.position -= missing * dt * linearVelocity_;
  pose_.orientation = turned(pose_.orientation, angularVelocity_, -missing * dt);
  linearVelocity_.setZero();
  angularVelocity_.setZero();
}

void Clamp::appendTargets(std::vector<KinematicTarget>& out) const {
  if (slip_.on) return;
  for (const Grip& grip : grips_) {
    const Vec3 arm = pose_.orientation * grip.local;
    const Vec3 squeezing = pose_.orientation * Vec3(0.0, 0.0, grip.squeeze);
    KinematicTarget target;
    target.vertex = grip.vertex;
    target.position = pose_.position + arm;
    target.velocity = linearVelocity_ + angularVelocity_.cross(arm) + squeezing;
    out.push_back(target);
  }
}

void Clamp::addReactions(const std::vector<KinematicTarget>& targets,
                         const std::vector<Vec3>& reactions, double fraction) {
  if (held_.empty() || slip_.on) return;
  if (targets.size() != reactions.size()) {
    throw std::invalid_argument("clamp: expected one reaction for each kinematic target");
  }
  const auto byVertex = [](const KinematicTarget& target, VertexId vertex) {
    return target.vertex < vertex;
  };
  for (const VertexId vertex : held_) {
    const auto it = std::lower_bound(targets.begin(), targets.end(), vertex, byVertex);
    if (it == targets.end() || it->vertex != vertex) continue;
    const Vec3 force = fraction * reactions[static_cast<std::size_t>(it - targets.begin())];
    wrench_.force += force;
    wrench_.torque += (it->position - pose_.position).cross(force);
  }
}

std::string Clamp::validationError(std::int32_t vertices) const {
  for (const Pose& pose : {pose_, target_.pose}) {
    const std::string error = cloth_sim::validationError(pose);
    if (!error.empty()) return error;
  }
  if (state_ < ClampState::kOpen || state_ > ClampState::kClosed) return "it has no state";
  if (!isPositive(gap_)) return "it has no gap";
  if (speedLimit_ && !isPositive(*speedLimit_)) return "its speed limit is not positive";
  if (held_.size() != grips_.size()) return "its lists of particles differ";
  for (std::size_t k = 0; k < grips_.size(); ++k) {
    const VertexId v = grips_[k].vertex;
    if (v < 0 || v >= vertices || v != held_[k]) return "it holds a particle that does not exist";
    if (k > 0 && v <= held_[k - 1]) return "its particles are not in order";
  }
  return "";
}

}  // namespace cloth_sim
