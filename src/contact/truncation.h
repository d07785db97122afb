#pragma once
/// \file The motion of two faces that would not stay apart is changed: it slides, or is shortened.

#include <cstdint>
#include <vector>

#include "face_pair.h"

namespace cloth_sim {

/// Passes of the certificate in which only vertices slide that nobody holds; then moving held ones
/// slide as well.
constexpr int kPassesOfFree = 12;

/// A substep whose motion may be changed.
struct Truncation {
  SubstepMotion motion;
  std::vector<std::uint8_t>& truncated;  ///< by vertex: set to `pass` if its motion is changed
  /// By vertex: 1 if an obstacle or a holder has stopped it.
  const std::vector<std::uint8_t>& stopped;
  std::uint8_t pass = 1;       ///< from 1 on
  Vec3 common = Vec3::Zero();  ///< motion that is not shortened [m]
};

/// Adds to the motion of a vertex [m].
void moveBy(VertexId v, const Vec3& way, const Truncation& now);
/// Shortens the motion of a vertex, but for the common one, to the fraction `t` of what it is.
void moveBack(VertexId v, double t, const Truncation& now);
/// Moves the vertices of a pair that would not stay apart to where it does, along its direction;
/// they keep the motion that they have in common, and their momentum unless some are held. Other
/// pairs may fail then, or this one again.
/// \param least  distance below which the faces do not come nearer [m].
/// \return whether they were apart at the start; if not, nothing moves.
bool slide(const FacePair& pair, double least, const Truncation& now);
/// Shortens the motion of the vertices of a pair that would not stay apart. It stays apart from
/// then on in this substep, however motion is shortened further.
/// \param least  distance below which the faces do not come nearer [m].
/// \return whether they were apart at the start; if not, or hardly so at a common corner, all
/// vertices stay where they are.
bool shorten(FacePair& pair, double least, const Truncation& now);

}  // namespace cloth_sim
