#pragma once
/// \file Particles whose motion clamps and pins prescribe, and the forces that these have to bear.

#include "cloth_sim/solver/solver.h"
#include "particles.h"

namespace cloth_sim {

/// The kinematic targets of a step (Controls::kinematic), by index: each moves its particle on a
/// straight line from where the state has it.
class KinematicParticles {
 public:
  /// Takes over the targets of a step and where their particles are.
  /// \return whether these are other particles than in the last step.
  bool load(const Controls& controls, const Particles& particles);
  /// Finds which target a slot belongs to. To be called when the particles have changed.
  void indexSlots(std::int32_t slots);
  /// Moves targets out of obstacles: nothing can hold a particle inside one.
  /// \param end  time at the end of the step [s].
  /// \param dt   its length [s].
  void keepOutOf(const Contacts& contacts, const Controls& controls, double end, double dt);
  /// Gives the particles the mean velocities of a step of length dt [s].
  void setVelocities(double dt, Particles& particles) const;

  /// Moves the particles to where they are when `fraction` of the step has passed.
  void place(double fraction, Particles& particles) const;

  bool empty() const { return slots_.empty(); }
  /// Particle slots, by target.
  const std::vector<std::int32_t>& slots() const { return slots_; }
  /// The target of a particle slot, or kNone.
  std::int32_t targetOf(std::int32_t slot) const {
    return targetOf_[static_cast<std::size_t>(slot)];
  }

  /// Adds an impulse [N s] that the cloth puts on a target.
  void addImpulse(std::int32_t target, const Vec3& impulse) {
    impulses_[static_cast<std::size_t>(target)] += impulse;
  }
  /// Adds an impulse [N s] on the particle in a slot, if it belongs to a target.
  void addImpulseAt(std::size_t slot, const Vec3& impulse) {
    if (targetOf_[slot] != kNone) addImpulse(targetOf_[slot], impulse);
  }
  /// Impulses so far [N s], by target, and taking a substep's part of them back.
  const std::vector<Vec3>& impulses() const { return impulses_; }
  void setImpulses(const std::vector<Vec3>& impulses) { impulses_ = impulses; }
  /// Adds what forces [N], by slot, do to the targets in the time h [s].
  void addForces(double h, const VectorArray& force);
  /// Finds the mean forces that holders bear in the time dt [s]: impulses over dt, weight and
  /// inertia.
  /// \param reactions  out: by target [N].
  void findReactions(const Model& model, const Controls& controls, double dt,
                     std::vector<Vec3>& reactions) const;

 private:
  std::vector<std::int32_t> slots_;     ///< by target
  std::vector<std::int32_t> previous_;  ///< slots of the last step
  std::vector<std::int32_t> targetOf_;  ///< by slot
  VectorArray from_, to_;               ///< by target [m]
  std::vector<Vec3> startVelocity_;     ///< by target [m/s]
  std::vector<Vec3> impulses_;          ///< by target [N s]
  std::vector<double> noMass_;          ///< zeros, by target
  std::vector<VertexId> near_;          ///< targets near an obstacle
};

}  // namespace cloth_sim
