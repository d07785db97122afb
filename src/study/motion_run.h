#pragma once
/// \file Runs of a motion, by a method of this package or by another engine, and their errors.

#include <memory>
#include <optional>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/error_estimate.h"
#include "motion.h"
#include "run.h"

namespace cloth_sim {

/// A method with its settings.
struct MotionSetting {
  std::string method;  ///< of the registry
  int substeps = 0;    ///< per step; 0: chosen by `error`
  int iterations = 0;  ///< 0: the method has no such parameter
  double error = 0.0;  ///< solver.error; 0: fixed substeps
};

/// A cloth that moves in steps of the scene.
class MovingCloth {
 public:
  virtual ~MovingCloth() = default;
  virtual void step() = 0;
  virtual const Model& model() const = 0;
  virtual const State& state() const = 0;
  /// The force on all holders together, or on the first clamp if the motion tears the cloth, mean
  /// over the last step [N].
  virtual Vec3 holdingForce() const = 0;
  /// Springs that have failed by tears.
  virtual int torn() const { return 0; }
  virtual int pieces() const { return 1; }
  /// Why it failed; "" if it has not.
  virtual std::string failure() const { return ""; }
  virtual std::optional<ErrorEstimate> estimate() const { return std::nullopt; }
};

/// Makes a cloth of this package.
std::unique_ptr<MovingCloth> movingCloth(const Motion& motion, const MotionSetting& setting);

/// The cloth at one time, but for its positions.
struct MotionSample {
  std::vector<double> strains;  ///< of structural and shear springs [-]
  Vec3 force = Vec3::Zero();    ///< see `MovingCloth::holdingForce` [N]
  Energies energies;
};

/// Record of a run.
struct MotionRecord {
  Grid grid;                          ///< of the cloth
  Trajectory trajectory;              ///< until the first spring fails
  std::vector<MotionSample> samples;  ///< at the times of the trajectory
  double cost = 0.0;                  ///< CPU time of the calling thread per step [s]
  double peakForce = 0.0;             ///< largest holding force in a step [N]
  double separation = 0.0;            ///< when it came apart [s]; 0: it has not
  std::string failure;                ///< "" if it ended well
  std::optional<ErrorEstimate> estimate;
};

/// Records a cloth while it moves.
class MotionRun {
 public:
  MotionRun(const Motion& motion, std::unique_ptr<MovingCloth> cloth);
  /// Advances to the next sample. \return false if there is none, or the cloth failed.
  bool advance();
  const MotionRecord& record() const { return record_; }

 private:
  void step();
  void sample();

  std::unique_ptr<MovingCloth> cloth_;
  Vec3 gravity_;
  double dt_;
  int steps_;
  int done_ = 0;
  double cpuTime_ = 0.0;  ///< of all steps [s]
  MotionRecord record_;
};

/// Records a whole run of a method.
MotionRecord recordMotion(const Motion& motion, const MotionSetting& setting);

/// Differences of a run from a reference.
struct MotionErrors {
  double position = 0.0;   ///< root mean square over times and particles, over the side [-]
  double strain = 0.0;     ///< largest difference of the largest strain at a time [-]
  double strain999 = 0.0;  ///< largest 99.9th percentile of the differences of springs [-]
  double force = 0.0;      ///< root mean square error of the holding force, over that force [-]
  double energy = 0.0;     ///< largest error of the mechanical energy, over the energy released [-]
  // Of a cloth that comes to rest, at the end; NaN for others.
  double restStrain = 0.0;   ///< difference of the largest strain [-]
  double restElastic = 0.0;  ///< relative difference of the elastic energy [-]
  double restRadius = 0.0;   ///< difference of the mean distance of the border from the z axis [m]
  // Of a cloth that tears; NaN for others. The errors above are those until it begins to, and NaN
  // if it does so long before the reference.
  double peakForce = 0.0;   ///< relative difference of the peak force [-]
  double separation = 0.0;  ///< difference of the times at which the cloth comes apart [s]
};

/// Compares a run with a reference. All errors of a run that failed are NaN.
MotionErrors compareMotions(const Motion& motion, const MotionRecord& run,
                            const MotionRecord& reference);

/// A reference with the differences of a run with half as many substeps.
struct MotionReference {
  MotionSetting setting;
  MotionRecord record;
  MotionErrors own;
};

/// Runs the explicit method of second order with 0.35 of the longest stable substep.
MotionReference makeReference(const Motion& motion);

}  // namespace cloth_sim
