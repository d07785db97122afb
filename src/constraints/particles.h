#pragma once
/// \file A solver's own copy of the particles, as structure of arrays in an order that suits
/// sweeps.

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/solver/solver.h"
#include "linalg/vector_array.h"

namespace cloth_sim {

/// Particles in slots. Of a cloth that is a grid, each row is stored as its columns 0, 4, 8, ...,
/// then 1, 5, ..., 2, 6, ... and 3, 7, ...: then springs that span one or two columns, and that a
/// colouring lets run together, have their ends in two contiguous stretches, and a sweep needs no
/// gathers.
struct Particles {
  VectorArray x;                     ///< [m]
  VectorArray start;                 ///< positions at the start of the substep [m]
  VectorArray v;                     ///< [m/s]
  ScalarArray mass;                  ///< [kg]; 0: prescribed motion
  ScalarArray inverseMass;           ///< [1/kg]; 0: prescribed motion
  std::vector<std::int32_t> slotOf;  ///< by vertex

  std::int32_t slots = 0;  ///< some may be empty, with mass 0

  std::int32_t count() const { return static_cast<std::int32_t>(slotOf.size()); }

  /// Which slots there are. Values come with `load` and `loadMasses`, after `resize`.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(slotOf, slots);
  }

  /// Chooses slots and sizes every array.
  void layOut(const Model& model);
  /// Adds slots for the vertices that an edit made.
  void applyChanges(const MeshChanges& changes);
  void load(const State& state);
  void store(State& state) const;
  /// Whether everything is finite, and no particle faster than this [m/s].
  bool areSlowerThan(double speed) const;
  /// Sets masses; the particles in `kinematic` get zero.
  void loadMasses(const Model& model, const std::vector<KinematicTarget>& kinematic);
  ParticleView view();
  /// Makes room for every slot.
  void resize();
};

}  // namespace cloth_sim
