#pragma once
/// \file The substep context: the cloth's arrays, prescribed motion, loads and contacts.

#include "constraints/kinematic_particles.h"
#include "constraints/spring_constraints.h"

namespace cloth_sim {

/// A cloth's arrays while a step is under way, and the length of its substeps. Methods read and
/// write them; they keep arrays of their own for what outlives a substep.
struct Substep {
  const Model& model;
  const Controls& controls;
  Contacts& contacts;
  Particles& particles;
  SpringConstraints& springs;
  KinematicParticles& kinematic;
  VectorArray& force;        ///< by particle slot [N]; scratch of the method
  VectorArray& scratch;      ///< of contacts and of the wind
  ScalarArray& windSpeeds;   ///< by particle slot, of the air along the normals of faces [m/s]
  double h = 0.0;            ///< length of the substep [s]
  double time = 0.0;         ///< at the end of the substep [s]
  double before = 0.0;       ///< fraction of the step that has passed at its start
  double fraction = 0.0;     ///< fraction of the step that has passed at its end
  bool isNewModel = false;   ///< the model is not that of the last step, if there was one
  bool isNewLayout = false;  ///< ... or other particles are kinematic
  int iterations = 0;        ///< of the method, over all substeps
  double residual = 0.0;     ///< of the last substep, as a mean acceleration [m/s^2]
  double addedMass = 0.0;    ///< by which the method makes the cloth heavier, over its mass [-]
  const StopFlag* stop = nullptr;  ///< of the step; null: it is never stopped

  /// Tells whether the step is to end now. Its result is thrown away then: iterations need not go
  /// on.
  bool isStopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }

  /// Tells whether the step is to end now, because it is stopped or has to be done again.
  bool isOver() const;

  /// Copies positions to `particles.start`.
  void markStart();
  /// Moves the kinematic particles to where they are at the end of the substep.
  void placeKinematic() { kinematic.place(fraction, particles); }
  /// Adds the pressure of the wind on every face, and forces on single particles, to `force`.
  ///
  /// The wind on a particle is limited to what makes it as fast as the air in h, so that no substep
  /// turns the relative velocity around and the wind is stable at any speed. A particle of mass m
  /// and area A is limited where h A density dragCoefficient |r.n| / 2 > m: on 0.1 kg/m^2 in
  /// substeps of 1/60 s above 10 m/s, of 1/1200 s above 200 m/s.
  void addLoads();
  /// Tells whether an obstacle is in the way of a free particle in the substep, or around its end.
  bool isBlocked(const ParticleView& paths) const;
  /// Tells whether an obstacle is in the way of a free particle that flies on with its velocity.
  bool isFlightBlocked();
  /// Pushes particles out of obstacles. Velocities change by the displacement over h.
  void enforceContacts();
  /// Takes from velocities what would carry particles into obstacles in the next h, and the slip
  /// that friction then stops. Positions stay.
  void enforceContactVelocities();

 private:
  void addWind(const Wind& wind);
  void sumWind(const Wind& wind);
  template <typename Visit>
  void forFreeCandidates(const Visit& visit) const;
};

/// A method of integrating one substep. SubstepSolver makes a Solver of it.
class SubstepMethod {
 public:
  virtual ~SubstepMethod() = default;

  /// Advances `particles` by the substep; adds what kinematic particles bear to `kinematic`.
  virtual void advance(Substep& now) = 0;
  /// Called before the first substep of a step; masses are set, kinematic particles known.
  virtual void begin(Substep& /*now*/) {}
  /// Called after the last substep of a step: for methods whose substeps leave no velocities.
  virtual void finish(Substep& /*now*/) {}
  /// Remembers what outlives a substep, beyond `particles`, after `begin`: the part of a step that
  /// follows may be thrown away.
  virtual void remember() {}
  /// Takes back what has changed since.
  virtual void takeBack() {}
  /// Substeps of a step, given the number that the scene asks for. Asked after every edit.
  virtual int substepsFor(const Model& /*model*/, int configured) { return configured; }

  /// Substeps of the next step of dt [s], given those of `substepsFor`.
  virtual int substepsOfStep(double /*dt*/, int substeps) const { return substeps; }
  /// The error that the method expects after a step; null if it estimates none.
  virtual const ErrorEstimate* error() const { return nullptr; }

  /// See Solver::save and Solver::load: for methods with a memory beyond `particles`.
  virtual void save(StateWriter& /*archive*/) const {}
  /// \param particles  laid out as when the state was saved.
  /// \throws std::invalid_argument if what is read contradicts itself or `particles`.
  virtual void load(StateReader& /*archive*/, const Particles& /*particles*/) {}
};

}  // namespace cloth_sim
