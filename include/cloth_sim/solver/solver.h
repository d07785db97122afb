#pragma once
/// \file The interface of time-stepping methods.

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/solver/error_estimate.h"

namespace cereal {
class PortableBinaryOutputArchive;
}  // namespace cereal

namespace cloth_sim {

using StateWriter = cereal::PortableBinaryOutputArchive;  ///< see sim/archive.h
class StateReader;

/// Prescribed motion of a particle during a step, by a clamp or a pin: on a straight line from
/// where the state has it to `position`.
struct KinematicTarget {
  VertexId vertex = kNone;
  Vec3 position = Vec3::Zero();  ///< at the end of the step [m]
  Vec3 velocity = Vec3::Zero();  ///< at the end of the step [m/s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex, position, velocity);
  }
};

/// Wind pressure on faces. A face of area A and unit normal n, past which air moves with the
/// relative velocity r, gets the force f = 1/2 density dragCoefficient A |r.n| (r.n) n, a third at
/// each corner.
struct Wind {
  Vec3 velocity = Vec3::Zero();  ///< of the air [m/s]
  double density = 1.2;          ///< of the air [kg/m^3]
  double dragCoefficient = 1.0;  ///< of a face normal to the flow [-]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(velocity, density, dragCoefficient);
  }
};

/// A force on one particle, constant during a step.
struct PointForce {
  VertexId vertex = kNone;
  Vec3 force = Vec3::Zero();  ///< [N]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex, force);
  }
};

/// Everything that acts on the cloth in a step except its own springs and contacts.
struct Controls {
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);  ///< [m/s^2]
  double drag = 0.0;                     ///< rate of linear air drag: dv/dt = -drag v [1/s]
  bool quasiStatic = false;              ///< accelerations are negligible: methods may add inertia
  std::optional<Wind> wind;              ///< if absent, no face is visited
  std::vector<KinematicTarget> kinematic;  ///< ascending by vertex, unique
  std::vector<PointForce> forces;          ///< in any order
  std::vector<LengthLimit> limits;         ///< the step ends early where one is passed

  /// Tells whether wind or point forces act.
  bool hasLoads() const { return wind.has_value() || !forces.empty(); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(gravity, drag, quasiStatic, wind, kinematic, forces);
  }
};

/// A request to end a step before its end: set by any thread, or by a signal handler.
using StopFlag = std::atomic<bool>;

/// Length and division of a step.
struct StepLength {
  double dt = 0.0;                 ///< of the whole step [s], > 0
  double substepFactor = 1.0;      ///< multiplies the configured number of substeps, > 0
  double done = 0.0;               ///< fraction of the step that has passed already, in [0, 1)
  const StopFlag* stop = nullptr;  ///< asked between substeps and iterations; null: never stopped

  /// Time that is left of the step [s].
  double left() const { return (1.0 - done) * dt; }
};

enum class StepStatus {
  kOk,
  kDiverged,  ///< a number is not finite, or a particle faster than 10 km/s
  kStopped,   ///< the stop flag was set
  kCameNear,  ///< cloth has come near itself unexpectedly; the step is to be done again
};

/// Outcome of a step.
struct StepReport {
  StepStatus status = StepStatus::kOk;
  double fraction = 1.0;     ///< of the whole step that has passed; below 1 if it ended early
  bool passedLimit = false;  ///< whether a length limit was passed in the last substep
  double substep = 0.0;      ///< length of a substep, h [s]
  int substeps = 0;          ///< number of substeps in a whole step
  int iterations = 0;        ///< of the method, over all substeps
  double residual = 0.0;     ///< of the last substep, as a mean acceleration [m/s^2]; 0: none
  double addedMass = 0.0;    ///< by which the method made the cloth heavier, over its mass [-]
  /// Reactions [N], in the order of Controls::kinematic: the mean force that springs, damping,
  /// weight, wind and inertia of the cloth put on the holder of each kinematic particle.
  std::vector<Vec3> reactions;
  std::optional<ErrorEstimate> error;  ///< absent: the method estimates none
};

/// A method of advancing a cloth in time. It keeps what it derives from the model (packed arrays,
/// colourings, factorisations) and refreshes it in `onModelChanged`.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Advances `state` to the end of the step, or to the end of the first substep in which a length
  /// limit is passed. If the method diverges or is stopped, the report says so and the state is as
  /// it was.
  /// Allocates no memory once arrays have their sizes.
  virtual const StepReport& step(const Model& model, State& state, const Controls& controls,
                                 Contacts& contacts, const StepLength& length) = 0;

  /// Number of substeps in a step with a `substepFactor` of 1.
  virtual int substeps() const = 0;

  /// Follows an edit of the model. To be called after every edit, before the next step.
  virtual void onModelChanged(const Model& model, const ModelChanges& changes) = 0;

  /// Saves the memory of the method: whatever the next step depends on, to the bit, besides the
  /// model and the state.
  virtual void save(StateWriter& archive) const = 0;
  /// Loads what `save` wrote, into a solver made for the undamaged model with the same parameters.
  /// It then continues as the saved one would. \param model  as it was when the solver was saved.
  virtual void load(StateReader& archive, const Model& model) = 0;
};

}  // namespace cloth_sim
