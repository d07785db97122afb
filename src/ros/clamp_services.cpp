/// \file Services for clamps: set_clamp_pose, grasp, add_clamp, remove_clamp, follow.

#include <algorithm>

#include "cloth_sim/AddClamp.h"
#include "cloth_sim/Follow.h"
#include "cloth_sim/Grasp.h"
#include "cloth_sim/RemoveClamp.h"
#include "cloth_sim/SetClampPose.h"
#include "scene/names.h"
#include "services.h"

namespace cloth_sim {
namespace {

/// Lets a clamp track a source of poses, or ends that.
void track(const Follow::Request& request, Follow::Response& reply, ClampPorts& clamps) {
  reply.success = false;
  reply.message = sourceError(request);
  if (!reply.message.empty()) return;
  const CommandResult result = clamps.track(request.clamp, toPoseSource(request));
  reply.success = result.success;
  reply.message = result.message;
}

/// Returns a request about a clamp. If it is refused and there is no such clamp, that is the
/// reason.
Request clampFirst(Request request, const std::string& clamp, const Observation& now) {
  if (std::holds_alternative<Command>(request)) return request;  // which says it itself
  std::vector<std::string> known;
  for (const ClampSnapshot& it : now.snapshot->clamps) known.push_back(it.name);
  if (std::find(known.begin(), known.end(), clamp) != known.end()) return request;
  return Refusal{unknownName("clamp", clamp, known)};
}

}  // namespace

void advertiseClampServices(Services& services) {
  services.advertise<SetClampPose>("set_clamp_pose", [&services](const auto& request, auto& reply) {
    services.execute(clampFirst(services.checker().clampPose(request.clamp, request.pose),
                                request.clamp, services.simulation().observe()),
                     "clamp " + request.clamp + " goes there", reply);
  });
  services.advertise<Grasp>("grasp", [&services](const auto& request, auto& reply) {
    services.execute(services.checker().grasp(request.clamp, request.grasp != 0),
                     "clamp " + request.clamp + (request.grasp ? " closes" : " has let go"), reply);
  });
  // The topics of the clamp are there, or gone, when the reply is.
  services.advertise<AddClamp>("add_clamp", [&services](const auto& request, auto& reply) {
    services.execute(services.checker().newClamp(request), "clamp " + request.name + " is there",
                     reply);
    services.clamps().update(services.simulation().observe());
  });
  services.advertise<RemoveClamp>("remove_clamp", [&services](const auto& request, auto& reply) {
    services.execute(DeleteClamp{request.clamp}, "clamp " + request.clamp + " is gone", reply);
    services.clamps().update(services.simulation().observe());
  });
  services.advertise<Follow>("follow", [&services](const auto& request, auto& reply) {
    track(request, reply, services.clamps());
  });
}

}  // namespace cloth_sim
