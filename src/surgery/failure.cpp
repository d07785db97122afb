#include "cloth_sim/surgery/failure.h"

namespace cloth_sim {

const char* toString(FailureCause cause) { return cause == FailureCause::kTear ? "torn" : "cut"; }

FailureEvent describeFailure(const Model& model, const State& state, const Spring& spring,
                             FailureCause cause) {
  FailureEvent event;
  event.time = state.t;
  event.a = spring.a;
  event.b = spring.b;
  event.kind = spring.kind;
  event.cause = cause;
  event.stretch = stretch(spring, state);
  event.position = 0.5 * (state.x[spring.a] + state.x[spring.b]);
  event.material = 0.5 * (model.mesh.material(spring.a) + model.mesh.material(spring.b));
  return event;
}

}  // namespace cloth_sim
