#pragma once
/// \file The state of a cloth: positions and velocities, and quantities computed from them.

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// Positions, velocities and time.
struct State {
  VertexData<Vec3> x;  ///< positions in the world [m]
  VertexData<Vec3> v;  ///< velocities [m/s]
  double t = 0.0;      ///< [s]
  /// Where the sliders of bending friction are, by face (SlipElement) [1/m]; empty without
  /// friction.
  std::vector<Vec3> bendOffset;

  /// Copies and interpolates positions and velocities to new vertices, and drops removed ones.
  /// Faces keep their sliders; those with a new rest shape begin as cloth that was bent from the
  /// flat. \param mesh  after the edit.
  void applyChanges(const MeshChanges& changes, const TriangleMesh& mesh);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(x, v, t, bendOffset);
  }
};

/// Returns whether every position and velocity is finite.
bool isFinite(const State& state);

/// Copies a state, on several threads where that pays.
void copyState(const State& from, State& to);

/// The parts of the mechanical energy.
struct Energies {
  double kinetic = 0.0;  ///< [J]
  double elastic = 0.0;  ///< of all springs, bending elements and their friction [J]
  double gravity = 0.0;  ///< relative to the origin of the world [J]
};
/// \param gravity  acceleration, (3,) [m/s^2].
Energies energies(const Model& model, const State& state, const Vec3& gravity);

Vec3 linearMomentum(const Model& model, const State& state);                      ///< [kg m/s]
Vec3 angularMomentum(const Model& model, const State& state, const Vec3& about);  ///< [kg m^2/s]
Vec3 centreOfMass(const Model& model, const State& state);                        ///< [m]
double meanSpeed(const State& state);                                             ///< [m/s]

/// Returns the length of a spring over its rest length.
double stretch(const Spring& spring, const State& state);
/// Returns the largest `stretch` of all membrane springs: structural and shear. It is 1 at rest.
double maxStretch(const Model& model, const State& state);

/// Returns a hash over time, positions, velocities, faces and sliders of bending friction. Equal
/// hashes mean equal bits, see support/hash.h.
std::uint64_t stateHash(const Model& model, const State& state);

}  // namespace cloth_sim
