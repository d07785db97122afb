/// \file Services that edit the mesh: cut, refine.

#include "cloth_sim/Cut.h"
#include "cloth_sim/Refine.h"
#include "services.h"

namespace cloth_sim {

void advertiseMeshServices(Services& services) {
  services.advertise<Cut>("cut", [&services](const auto& request, auto& reply) {
    services.execute(services.checker().stroke(request.stroke), "cut", reply);
  });
  services.advertise<Refine>("refine", [&services](const auto& request, auto& reply) {
    services.execute(services.checker().refinement(request), "refined", reply);
  });
}

}  // namespace cloth_sim
