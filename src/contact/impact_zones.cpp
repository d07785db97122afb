#include "impact_zones.h"

#include <algorithm>
#include <utility>

namespace cloth_sim {

void ImpactZones::begin(std::size_t vertices) {
  zoneOf_.assign(vertices, kNone);
  count_ = 0;
}

Vec3 ImpactZones::join(const FacePair& pair, const Truncation& now) {
  parts_.clear();
  for (const Face* face : {&pair.a, &pair.b}) {
    for (const VertexId v : *face) {
      const std::size_t zone = zoneWith(v, now);
      if (std::find(parts_.begin(), parts_.end(), zone) == parts_.end()) parts_.push_back(zone);
    }
  }
  Zone& joined = zones_[parts_.front()];
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    joined.mass += zones_[parts_[k]].mass;
    joined.moment += zones_[parts_[k]].moment;
    joined.isStopped = joined.isStopped || zones_[parts_[k]].isStopped;
  }
  const Vec3 motion = joined.isStopped ? Vec3(Vec3::Zero()) : Vec3(joined.moment / joined.mass);
  for (const std::size_t part : parts_) setMotion(motion, now, zones_[part]);
  for (std::size_t k = 1; k < parts_.size(); ++k) moveVertices(parts_[k], parts_.front());
  joined.isJoined = true;
  return motion;
}

/// The number of the zone that a vertex belongs to; a new one if there is none.
std::size_t ImpactZones::zoneWith(VertexId v, const Truncation& now) {
  if (zoneOf_[v] != kNone) return static_cast<std::size_t>(zoneOf_[v]);
  zoneOf_[v] = static_cast<std::int32_t>(count_);
  if (count_ == zones_.size()) zones_.emplace_back();
  Zone& zone = zones_[count_];
  zone.vertices.assign(1, v);
  zone.mass = now.motion.mass[v];
  zone.moment = zone.mass * (now.motion.end[v] - now.motion.start[v]);
  zone.motion = Vec3::Zero();
  zone.isJoined = false;
  zone.isStopped = zone.mass == 0.0 || now.stopped[v] != 0;
  return count_++;
}

/// Puts the vertices of a zone into another one.
void ImpactZones::moveVertices(std::size_t from, std::size_t into) {
  Zone& gone = zones_[from];
  Zone& zone = zones_[into];
  for (const VertexId v : gone.vertices) zoneOf_[v] = static_cast<std::int32_t>(into);
  zone.vertices.insert(zone.vertices.end(), gone.vertices.begin(), gone.vertices.end());
  gone.isJoined = false;
}

/// Changes the common motion of a zone. A vertex alone moves as before.
void ImpactZones::setMotion(const Vec3& motion, const Truncation& now, Zone& zone) {
  const Vec3 way = motion - zone.motion;
  zone.motion = motion;
  if (zone.vertices.size() == 1 || way.isZero(0.0)) return;
  for (const VertexId v : zone.vertices) moveBy(v, way, now);
}

void ImpactZones::restoreMomentum(const Truncation& now) {
  for (std::size_t k = 0; k < count_; ++k) {
    Zone& zone = zones_[k];
    if (!std::exchange(zone.isJoined, false) || zone.isStopped) continue;
    Vec3 lost = zone.moment;
    for (const VertexId v : zone.vertices) {
      lost -= now.motion.mass[v] * (now.motion.end[v] - now.motion.start[v]);
    }
    setMotion(zone.motion + lost / zone.mass, now, zone);
  }
}

}  // namespace cloth_sim
