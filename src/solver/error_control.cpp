#include "error_control.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

constexpr std::size_t kEvery = 4;           ///< vertices from one sample to the next
constexpr double kMemory = 1.0;             ///< of errors of positions [s]
constexpr double kCoarsest = 1.0 / 1200.0;  ///< longest substep [s]
constexpr std::int32_t kFirstLevel = 0;
constexpr std::int32_t kFinestLevel = 24;    ///< substeps of 0.2 microseconds
constexpr std::int32_t kMostPatience = 160;  ///< calm steps before longer substeps are tried
constexpr std::int32_t kJoltPatience = 600;  ///< calm steps before the next trial, after a jolt
constexpr std::int32_t kTrial = 10;          ///< steps in which a trial fails or has gone well
/// Part of the goal from which on errors of positions count: they add up, and none is taken back.
constexpr double kEarly = 0.5;
constexpr double kJolt = 4.0;    ///< factor by which a jolt of the cloth raises its kinetic energy
constexpr double kFade = 0.9;    ///< factor by which the memory of kinetic energy fades in a step
constexpr double kMargin = 0.8;  ///< part of the goal below which longer substeps are tried

// Measured at 128 x 128 on an edge-pinned swing and a corner hang with 10 to 40 substeps, against
// Verlet (docs/decisions/049-error-on-the-label.md).
constexpr double kPositionFactor = 1.3;  ///< true over summed up error of positions
constexpr double kSoftness = 0.3;        ///< error of the strain over a small cancelled fraction
constexpr double kFirm = 0.06;           ///< a cancelled fraction by which it grows quadratically
constexpr double kMostSoftness = 1.5;

double strainError(double cancelled) {
  return cancelled * std::clamp(cancelled / kFirm, kSoftness, kMostSoftness);
}

}  // namespace

ErrorControl::ErrorControl(const ErrorGoal& goal) : goal_(goal), level_(kFirstLevel) {
  estimate_.asked = goal.error;
  if (goal.error > 0.0) estimate_.budget = goal.budget;
}

void ErrorControl::layOut(const Model& model) {
  samples_.resize((static_cast<std::size_t>(model.particleCount()) + kEvery - 1) / kEvery);
  const auto cloths = static_cast<double>(std::max<std::size_t>(1, model.cloths.size()));
  side_ = std::sqrt(model.mesh.totalRestArea() / cloths);
}

void ErrorControl::begin(const Particles& particles) {
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto slot = static_cast<std::size_t>(particles.slotOf[kEvery * i]);
    samples_[i].place = particles.x.at(slot);
    samples_[i].velocity = particles.v.at(slot);
  }
}

/// Takes note of the speeds at the end of a step.
/// \return whether the kinetic energy of the samples has grown by `kJolt` over the most of before.
bool ErrorControl::followSpeeds(const Particles& particles) {
  double sum = 0.0;  // [m^2/s^2]
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    sum += particles.v.at(static_cast<std::size_t>(particles.slotOf[kEvery * i])).squaredNorm();
  }
  const bool hasJolted = sum > kJolt * liveliest_;
  liveliest_ = std::max(sum, kFade * liveliest_);
  return hasJolted;
}

/// Sums up the error of positions.
/// \return its root mean square over the samples [m].
double ErrorControl::followDrift(const Particles& particles, double h, double duration) {
  const double fade = std::exp(-duration / kMemory);
  double sum = 0.0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto slot = static_cast<std::size_t>(particles.slotOf[kEvery * i]);
    Sample& it = samples_[i];
    if (particles.mass[slot] == 0.0) {
      it = Sample();
      continue;
    }
    const Vec3 acceleration = (particles.v.at(slot) - it.velocity) / duration;
    if (it.isKnown) it.drift += h * (acceleration - it.acceleration);
    it.acceleration = acceleration;
    it.isKnown = true;
    it.drift *= fade;
    // The mean velocity vanishes where a motion turns; its change does not.
    const double speed = ((particles.x.at(slot) - it.place) / duration).norm() +
                         0.5 * duration * acceleration.norm();
    if (it.drift.squaredNorm() > speed * speed) it.drift *= speed / it.drift.norm();
    it.error = fade * (it.error + duration * it.drift);
    sum += it.error.squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, samples_.size())));
}

void ErrorControl::end(const Particles& particles, double h, double duration, bool isWhole) {
  estimate_.position = kPositionFactor * followDrift(particles, h, duration) / side_;
  estimate_.strain = strainError(cancelled_);
  estimate_.largestPosition = std::max(estimate_.largestPosition, estimate_.position);
  estimate_.largestStrain = std::max(estimate_.largestStrain, estimate_.strain);
  elapsed_ += duration;
  if (!isWhole) return;
  dt_ = std::exchange(elapsed_, 0.0);
  if (goal_.error > 0.0) {
    if (estimate_.position > goal_.error) estimate_.sufficed = false;
    chooseLevel(followSpeeds(particles) && sinceTrial_ == 0);
  }
  cancelled_ = 0.0;
}

/// \param hasJolted  whether the cloth has jolted as longer substeps were tried.
void ErrorControl::chooseLevel(bool hasJolted) {
  ++sinceRefined_;
  if (estimate_.strain > goal_.error) return refine(estimate_.strain > 2.0 * goal_.error ? 2 : 1);
  const double drifted = estimate_.position / (kEarly * goal_.error);
  if (drifted > 1.0 && sinceRefined_ >= kPatience) return refine(1);
  const bool mayTry = estimate_.strain < kMargin * goal_.error && std::sqrt(2.0) * drifted < 1.0;
  calm_ = mayTry ? calm_ + 1 : 0;
  if (hasJolted) return endTrial();
  ++sinceTrial_;
  if (sinceTrial_ == kTrial) patience_ = kPatience;  // the last trial has gone well
  if (calm_ <= patience_ || level_ == 0) return;
  --level_;
  calm_ = 0;
  sinceTrial_ = 0;
}

/// Makes substeps shorter. If they became longer a moment ago, they will next do so later.
void ErrorControl::refine(std::int32_t levels) {
  calm_ = 0;
  sinceRefined_ = 0;
  if (substepsFor(dt_, 0) >= goal_.budget) {
    estimate_.sufficed = false;
    return;
  }
  if (sinceTrial_ < kTrial) patience_ = std::max(patience_, std::min(2 * patience_, kMostPatience));
  sinceTrial_ = kTrial;
  level_ = std::min(level_ + levels, kFinestLevel);
}

/// Takes back longer substeps that have made the cloth jolt.
void ErrorControl::endTrial() {
  ++level_;
  calm_ = 0;
  sinceRefined_ = 0;
  sinceTrial_ = kTrial;
  patience_ = kJoltPatience;
}

int ErrorControl::substepsFor(double dt, int configured) const {
  if (goal_.error <= 0.0) return configured;
  const double exact = dt / kCoarsest * std::exp2(0.5 * level_);
  return static_cast<int>(
      std::clamp(std::ceil(exact - 1e-6), 1.0, static_cast<double>(goal_.budget)));
}

bool ErrorControl::isPlausible() const {
  constexpr std::int32_t kMost = 1 << 30;  // they count on
  for (const std::int32_t count : {calm_, sinceTrial_, sinceRefined_}) {
    if (count < 0 || count > kMost) return false;
  }
  const bool isLevel = level_ >= 0 && level_ <= kFinestLevel;
  return isLevel && patience_ > 0 && patience_ <= kJoltPatience && dt_ >= 0.0 && elapsed_ >= 0.0 &&
         liveliest_ >= 0.0;
}

}  // namespace cloth_sim
