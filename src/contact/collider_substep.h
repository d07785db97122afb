#pragma once
/// \file A collider during one substep, and where it stops a point of the cloth.

#include <cmath>

#include "cloth_sim/contact/shape_contract.h"

namespace cloth_sim {

/// Move along the normal below which a sticking particle returns to exactly the place on the
/// collider that it had [m]. The move is round-off, and without this rule a particle at rest
/// creeps.
constexpr double kRestTolerance = 1e-12;

/// The collider during one substep: the same for all particles.
struct ColliderSubstep {
  Vec3 position = Vec3::Zero();                        ///< of the collider at the end [m]
  Vec3 before = Vec3::Zero();                          ///< its position at the start [m]
  Vec3 carry = Vec3::Zero();                           ///< displacement of the collider [m]
  bool turns = false;                                  ///< whether it turns
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from the start to the end
  double friction = 0.0;                               ///< Coulomb coefficient [-]
  double keep = 1.0;  ///< fraction of its slip that a particle keeps after the decay [-]
  double rise = 0.0;  ///< limit on the push of a particle that starts inside [m]

  /// Returns where a particle would be if it moved along with the collider.
  Vec3 carried(const Vec3& start) const {
    return turns ? Vec3(position + turn * (start - before)) : Vec3(start + carry);
  }
};

/// Returns the end of a particle of positive mass that the collider stops.
/// \param anchor  place of the particle if it had moved along with the collider [m].
/// \param end     place of the particle without contact [m].
[[gnu::always_inline]] inline Vec3 stopAt(const ColliderSubstep& substep, const SweepHit& hit,
                                          const Vec3& anchor, const Vec3& end) {
  const Vec3 moved = end - anchor;
  const double along = hit.normal.dot(moved);
  const double rise = along + hit.push;
  Vec3 slip = moved - along * hit.normal;
  const double stopped = substep.friction * hit.push;
  if (slip.squaredNorm() <= stopped * stopped) {
    return std::abs(rise) <= kRestTolerance ? anchor : Vec3(anchor + rise * hit.normal);
  }
  slip *= substep.keep * (1.0 - stopped / slip.norm());
  return anchor + rise * hit.normal + slip;
}

/// Moments of displacements of particles: over h, impulses.
struct Moments {
  Vec3 first = Vec3::Zero();    ///< mass times displacement [kg m]
  Vec3 turning = Vec3::Zero();  ///< position times that, as a cross product [kg m^2]

  /// \param at  position of the particle before its displacement `by` [m].
  void add(double mass, const Vec3& at, const Vec3& by) {
    const Vec3 moment = mass * by;
    first += moment;
    turning += at.cross(moment);
  }
  void operator+=(const Moments& other) {
    first += other.first;
    turning += other.turning;
  }
};

}  // namespace cloth_sim
