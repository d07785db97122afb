#pragma once
/// \file What every time-stepping method looks like from outside.

#include <memory>
#include <optional>
#include <string>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"

namespace cereal {
class PortableBinaryOutputArchive;
class PortableBinaryInputArchive;
}  // namespace cereal

namespace cloth_sim {

using StateWriter = cereal::PortableBinaryOutputArchive;  ///< see sim/archive.h
using StateReader = cereal::PortableBinaryInputArchive;

/// A particle whose motion is prescribed during a step (by a clamp or a pin): it moves on a
/// straight line from where the state has it to `position`.
struct KinematicTarget {
  VertexId vertex = kNone;
  Vec3 position = Vec3::Zero();  ///< at the end of the step [m]
  Vec3 velocity = Vec3::Zero();  ///< at the end of the step [m/s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex, position, velocity);
  }
};

/// Air that moves past the cloth and presses on each face by its relative velocity r and unit
/// normal n: f = 1/2 density dragCoefficient A |r.n| (r.n) n, a third to each corner.
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
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);    ///< [m/s^2]
  double drag = 0.0;                       ///< rate of linear air drag: dv/dt = -drag v [1/s]
  std::optional<Wind> wind;                ///< absent: no face is visited
  std::vector<KinematicTarget> kinematic;  ///< ascending by vertex, unique
  std::vector<PointForce> forces;          ///< in any order; none: not looked at
  std::vector<LengthLimit> limits;         ///< where one is passed, the step ends early

  /// Whether anything presses or pulls on particles, besides gravity and drag.
  bool hasLoads() const { return wind.has_value() || !forces.empty(); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(gravity, drag, wind, kinematic, forces);
  }
};

/// How far a solver goes, and how finely.
struct StepLength {
  double dt = 0.0;             ///< of the whole step [s], > 0
  double substepFactor = 1.0;  ///< times the substeps that the method was configured with, > 0
  double done = 0.0;           ///< share of the step that has passed already, in [0, 1)

  double left() const { return (1.0 - done) * dt; }  ///< [s]
};

enum class StepStatus {
  kOk,
  kDiverged,  ///< something is not finite, or faster than 10 km/s
};

struct StepReport {
  StepStatus status = StepStatus::kOk;
  double fraction = 1.0;     ///< of the whole step that has passed, below 1 if it ended early
  bool passedLimit = false;  ///< in the last substep
  double substep = 0.0;      ///< length [s]
  int substeps = 0;          ///< that a whole step has
  int iterations = 0;        ///< over all substeps
  double residual = 0.0;     ///< of the last substep, in the method's own measure (0: it has none)
  /// Mean force over what has been stepped that the cloth's springs, damping, weight, wind and
  /// inertia put on each kinematic target, in the order of Controls::kinematic [N]: what its holder
  /// must bear.
  std::vector<Vec3> reactions;
};

/// A method of advancing a cloth in time. It keeps what it derives from the model (packed arrays,
/// colourings, factorisations) and refreshes it in `onModelChanged`.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Advances `state` to the end of the step, or of the first substep in which a limit was passed;
  /// if it diverges, says so in the status and leaves the state as it was.
  /// Allocates nothing once warm.
  virtual const StepReport& step(const Model& model, State& state, const Controls& controls,
                                 Contacts& contacts, const StepLength& length) = 0;

  /// How many substeps a step takes whose `substepFactor` is 1.
  virtual int substeps() const = 0;

  /// To be called after every edit of the model, before the next step.
  virtual void onModelChanged(const Model& model, const ModelChanges& changes) = 0;

  /// Writes what earlier steps and edits left behind, that the next step depends on to the bit, and
  /// that does not follow from the model and the state.
  virtual void save(StateWriter& archive) const = 0;
  /// Reads it, in a solver that was made for the undamaged model with the same parameters; it then
  /// goes on as the one that was saved would.
  /// \param model  as it was when the solver was saved.
  virtual void load(StateReader& archive, const Model& model) = 0;
};

}  // namespace cloth_sim
