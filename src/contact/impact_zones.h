#pragma once
/// \file Groups of vertices that move together where faces cannot be kept apart otherwise.

#include <vector>

#include "truncation.h"

namespace cloth_sim {

/// Impact zones (Provot 1997; Bridson et al. 2002) that only translate: vertices move on straight
/// lines, on which faces that turn together would not keep their distance.
///
/// Motion that is shortened towards its start nails the cloth to that place. So the corners of two
/// faces that do not stay apart belong to a zone, and their motion is shortened towards the common
/// motion of the zone: the mean by mass, so that it keeps its momentum. A zone with a vertex that
/// an obstacle or a holder has stopped has none.
class ImpactZones {
 public:
  /// Forgets all zones. \param vertices  of the mesh.
  void begin(std::size_t vertices);
  /// Puts the corners of a pair, and the zones that they belong to, into one zone. Zones that were
  /// there before take over its common motion; corners that belonged to none move as before.
  /// \return the common motion of the zone [m].
  Vec3 join(const FacePair& pair, const Truncation& now);
  /// Gives back the momentum that they have lost to zones that were joined since the last call.
  void restoreMomentum(const Truncation& now);

 private:
  struct Zone {
    std::vector<VertexId> vertices;
    double mass = 0.0;           ///< [kg]
    Vec3 moment = Vec3::Zero();  ///< masses times motions [kg m]
    Vec3 motion = Vec3::Zero();  ///< common to its vertices [m]
    bool isStopped = false;
    bool isJoined = false;  ///< since its momentum was restored
  };

  std::size_t zoneWith(VertexId v, const Truncation& now);
  void moveVertices(std::size_t from, std::size_t into);
  static void setMotion(const Vec3& motion, const Truncation& now, Zone& zone);

  std::vector<std::int32_t> zoneOf_;  ///< by vertex; kNone: in no zone
  std::vector<Zone> zones_;           ///< the first `count_` are in use
  std::size_t count_ = 0;
  std::vector<std::size_t> parts_;  ///< scratch: zones that are joined
};

}  // namespace cloth_sim
