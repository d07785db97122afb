#pragma once
/// \file The moving part of a cloth.

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

struct State {
  VertexData<Vec3> x;  ///< positions in the world [m]
  VertexData<Vec3> v;  ///< velocities [m/s]
  double t = 0.0;      ///< [s]

  /// New vertices take the position and velocity of what they came from.
  void applyChanges(const MeshChanges& changes) {
    x.applyChanges(changes);
    v.applyChanges(changes);
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(x, v, t);
  }
};

/// Whether every coordinate and velocity is a finite number.
bool isFinite(const State& state);

/// to = from, on several threads where that pays.
void copyState(const State& from, State& to);

struct Energies {
  double kinetic = 0.0;  ///< [J]
  double elastic = 0.0;  ///< of all springs [J]
  double gravity = 0.0;  ///< against the world's origin [J]
};
Energies energies(const Model& model, const State& state, const Vec3& gravity);

Vec3 linearMomentum(const Model& model, const State& state);                      ///< [kg m/s]
Vec3 angularMomentum(const Model& model, const State& state, const Vec3& about);  ///< [kg m^2/s]
Vec3 centreOfMass(const Model& model, const State& state);                        ///< [m]
double meanSpeed(const State& state);                                             ///< [m/s]

/// Length over rest length of one spring.
double stretch(const Spring& spring, const State& state);
/// Largest `stretch` of all structural and shear springs (1 for a cloth at rest).
double maxStretch(const Model& model, const State& state);

/// Over time, positions, velocities and faces: equal hashes mean equal bits (see hash.h).
std::uint64_t stateHash(const Model& model, const State& state);

}  // namespace cloth_sim
