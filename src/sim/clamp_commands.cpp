#include "cloth_sim/sim/commands/clamp_commands.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace cloth_sim {
namespace {

/// Returns the distance from the clamp to the nearest particle of its patch [m].
double distanceToPatch(const Clamp& clamp, const SimulationParts& parts) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const VertexId v : patchParticles(parts.model, *clamp.spec().patch)) {
    nearest = std::min(nearest, (parts.state.x[v] - clamp.pose().position).norm());
  }
  return nearest;
}

/// Returns why a clamp that is open cannot grasp its patch from where it is; empty if it can.
std::string outOfReach(const Clamp& clamp, const SimulationParts& parts) {
  if (!clamp.spec().patch) return "";
  const double distance = distanceToPatch(clamp, parts);
  const double reach = patchReach(clamp.spec());
  if (distance <= reach) return "";
  char numbers[100];
  std::snprintf(numbers, sizeof numbers, "%.3f m from its patch, and reaches %.3f m", distance,
                reach);
  return "clamp '" + clamp.spec().name + "' is " + numbers +
         "; move it there first (in a phase: attach)";
}

}  // namespace

std::string obstacleAround(const Vec3& point, const SimulationParts& parts) {
  for (const Collider& collider : parts.obstacles.colliders().all()) {
    if (collider.gap(point, parts.time()) + collider.margin() < 0.0) {
      return collider.obstacle().name;
    }
  }
  return "";
}

CommandResult doneWithTarget(const Clamp& clamp, const SimulationParts& parts) {
  const std::string obstacle = obstacleAround(clamp.target().position, parts);
  if (obstacle.empty()) return done();
  return {true, "",
          "clamp '" + clamp.spec().name + "' is told to go into obstacle '" + obstacle +
              "', which does not stop it"};
}

double patchReach(const ClampSpec& spec) { return spec.gapOpen + 0.5 * spec.plateSize.norm(); }

CommandResult setClosed(const std::string& clamp, bool closed, SimulationParts& parts) {
  Clamp* it = parts.holders.find(clamp);
  if (it == nullptr) return refuseUnknown("clamp", clamp, parts.holders.clampNames());
  if (!closed) {
    it->release();
    return done();
  }
  const std::string error = it->state() == ClampState::kOpen ? outOfReach(*it, parts) : "";
  if (!error.empty()) return refuse(error);
  it->close();
  return done();
}

}  // namespace cloth_sim
