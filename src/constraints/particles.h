#pragma once
/// \file The particles of a solver: a structure of arrays in an order that suits sweeps.

#include <string>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/solver/solver.h"
#include "linalg/vector_array.h"

namespace cloth_sim {

/// Particle data by slot, shape (slots,). A vertex keeps its slot for good; slots of removed
/// vertices stay empty.
///
/// A row of a grid is stored as its columns 0, 4, 8, ..., then 1, 5, ..., then 2, 6, ... and 3, 7,
/// .... Springs of one colour that span one or two columns then join two contiguous ranges of
/// slots, so that a sweep needs no gathers.
struct Particles {
  VectorArray x;                     ///< [m]
  VectorArray start;                 ///< positions at the start of the substep [m]
  VectorArray v;                     ///< [m/s]
  ScalarArray mass;                  ///< [kg]; 0: prescribed motion
  ScalarArray inverseMass;           ///< [1/kg]; 0: prescribed motion
  std::vector<std::int32_t> slotOf;  ///< by vertex
  std::vector<Vec3> bendOffset;      ///< by face: see State::bendOffset

  std::int32_t slots = 0;  ///< number of slots; empty ones have mass 0

  /// Number of particles.
  std::int32_t count() const { return static_cast<std::int32_t>(slotOf.size()); }

  /// Saves the layout. Values follow by `load` and `loadMasses`, after `resize`.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(slotOf, slots);
  }

  /// Checks a layout that was read from a file.
  /// \param vertices  number of vertices of the cloth.
  /// \return one sentence about the first error; empty if there is none.
  std::string validationError(std::int32_t vertices) const;

  /// Chooses slots and sizes every array.
  void layOut(const Model& model);
  /// Adds slots for the vertices that an edit made.
  void applyChanges(const MeshChanges& changes);
  /// Copies positions, velocities and sliders from a state ...
  void load(const State& state);
  /// ... and back.
  void store(State& state) const;
  /// Tells whether all numbers are finite and all particles slower than `speed` [m/s].
  bool areSlowerThan(double speed) const;
  /// Sets masses; the particles in `kinematic` get zero.
  void loadMasses(const Model& model, const std::vector<KinematicTarget>& kinematic);
  ParticleView view();
  /// Gives every array one entry a slot; masses are zero then.
  void resize();
};

/// Positions, positions at the start and masses, as contacts see them; slots are in order.
/// \param mass  by slot [kg].
ParticleView particleView(VectorArray& x, const VectorArray& start, const double* mass);

}  // namespace cloth_sim
