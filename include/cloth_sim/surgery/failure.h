#pragma once
/// \file Events that report failed springs.

#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// The operation that broke a spring.
enum class FailureCause : std::uint8_t { kTear, kCut };
/// The name of a cause: "torn" or "cut".
const char* toString(FailureCause cause);

/// The failure of one spring, with the ends and the geometry that it had at that time.
struct FailureEvent {
  double time = 0.0;  ///< simulated [s]
  VertexId a = kNone;
  VertexId b = kNone;
  SpringKind kind = SpringKind::kStructural;
  FailureCause cause = FailureCause::kTear;
  double stretch = 0.0;          ///< length over rest length
  Vec3 position = Vec3::Zero();  ///< of its midpoint in the world [m]
  Vec2 material = Vec2::Zero();  ///< of its midpoint in material coordinates [m]
  bool overloaded = false;       ///< it exceeded its limit; false: the surface opened across it

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, a, b, kind, cause, stretch, position, material, overloaded);
  }
};

/// Makes the event of a spring that fails in the given state.
FailureEvent describeFailure(const Model& model, const State& state, const Spring& spring,
                             FailureCause cause);

}  // namespace cloth_sim
