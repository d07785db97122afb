#pragma once
/// \file Estimates of the error of a position-based method, and the substeps that keep it small.

#include <vector>

#include "cloth_sim/solver/error_estimate.h"
#include "constraints/particles.h"
#include "sim/archive.h"

namespace cloth_sim {

/// Bound on the error, and on the work.
struct ErrorGoal {
  double error = 0.0;  ///< of strain, and of positions over a second and the side [-]; 0: none
  int budget = 1;      ///< substeps of a step, at most
};

/// Estimates two errors while the cloth moves, and chooses the length of substeps by them.
///
/// **Position.** A position-based substep of length h takes its forces at its end:
/// (x_{n+1} - 2 x_n + x_{n-1}) / h^2 = a(x_{n+1}). Central differences would be of second order
/// with a(x_n), so accelerations are wrong by h da/dt, and positions by the double integral of that
/// over time. It is summed up here for every fourth particle, with a memory of a second. In free
/// fall and at rest it is zero. A particle that has landed is at rest as well, though gravity no
/// longer accelerates it: the error of a velocity is never larger than the velocity.
///
/// **Strain.** Lines that are projected one after the other displace a particle in vain where they
/// bear against each other (see LineProjection::projectAndMeasure). The largest of these
/// displacements over the rest length of the shortest spring measures how soft the cloth is there.
///
/// The length of substeps is 1/1200 s over a power of the square root of two. It shrinks at once
/// where an estimate exceeds the goal; longer substeps are tried after ten calm steps, and after
/// twice as many whenever a trial has failed. Longer substeps make bending softer, so a cloth that
/// rests under load, such as a fold, may jolt into another shape: be faster than it was in some ten
/// steps before. Such a trial ends at once, and the next one comes much later: the cloth comes to
/// rest. All that depends on the steps before alone, so bits do not depend on the machine.
class ErrorControl {
 public:
  explicit ErrorControl(const ErrorGoal& goal);

  /// Follows the model: its size, and which particles are sampled.
  void layOut(const Model& model);
  /// Called before the first substep of a part of a step; `particles.v` are the velocities then.
  void begin(const Particles& particles);
  /// Takes note of the largest displacement in vain over the rest length of a spring [-].
  void addCancelled(double fraction) { cancelled_ = cancelled_ < fraction ? fraction : cancelled_; }
  /// Called after the last substep; `particles.v` are the velocities then.
  /// \param duration  of all substeps since `begin` [s].
  /// \param isWhole   the step has ended; otherwise another part follows.
  void end(const Particles& particles, double h, double duration, bool isWhole);

  /// Substeps of a step of dt [s]; `configured` without a goal.
  int substepsFor(double dt, int configured) const;
  const ErrorEstimate& estimate() const { return estimate_; }
  /// Tells whether the counters and times are ones that steps can have led to. For what was read
  /// from a file.
  bool isPlausible() const;

  /// Saves what the next step depends on, and the estimates. The error that is asked for is the
  /// scene's; the budget may come from a calibration.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples_, cancelled_, level_, calm_, patience_, sinceTrial_, sinceRefined_, dt_,
            elapsed_, liveliest_, goal_.budget, estimate_.strain, estimate_.position,
            estimate_.largestStrain, estimate_.largestPosition, estimate_.sufficed,
            estimate_.budget);
  }

 private:
  /// Motion and error of a sampled particle.
  struct Sample {
    Vec3 place = Vec3::Zero();         ///< at the start of the part of the step [m]
    Vec3 velocity = Vec3::Zero();      ///< there [m/s]
    Vec3 acceleration = Vec3::Zero();  ///< in the last part [m/s^2]
    Vec3 drift = Vec3::Zero();         ///< error of the velocity [m/s]
    Vec3 error = Vec3::Zero();         ///< of the position [m]
    bool isKnown = false;              ///< the acceleration has been measured

    template <class Archive>
    void serialize(Archive& archive) {
      archive(acceleration, drift, error, isKnown);
    }
  };

  double followDrift(const Particles& particles, double h, double duration);
  bool followSpeeds(const Particles& particles);
  void chooseLevel(bool hasJolted);
  void refine(std::int32_t levels);
  void endTrial();
  static constexpr std::int32_t kPatience = 10;  ///< calm steps before a trial, at first

  ErrorGoal goal_;
  double side_ = 1.0;                  ///< of the cloth [m]
  std::vector<Sample> samples_;        ///< of every fourth vertex
  double cancelled_ = 0.0;             ///< in this step [-]
  std::int32_t level_;                 ///< substeps are of 2^(-level/2) / 1200 s
  std::int32_t calm_ = 0;              ///< steps in a row well below the goal
  std::int32_t patience_ = kPatience;  ///< calm steps before longer substeps are tried
  std::int32_t sinceTrial_ = 1000;     ///< steps since they were
  std::int32_t sinceRefined_ = 1000;   ///< steps since they became shorter
  double dt_ = 0.0;                    ///< length of the last step [s]
  double elapsed_ = 0.0;               ///< of the step under way [s]
  double liveliest_ = 0.0;  ///< squares of the samples' speeds: the most, which fades [m^2/s^2]
  ErrorEstimate estimate_;
};

}  // namespace cloth_sim
