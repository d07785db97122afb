#pragma once
/// \file What is told of every spring that fails.

#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

enum class FailureCause : std::uint8_t { kTear, kCut };
const char* toString(FailureCause cause);  ///< "torn" or "cut"

/// One spring that failed.
struct FailureEvent {
  double time = 0.0;   ///< [s]
  VertexId a = kNone;  ///< its ends when it failed
  VertexId b = kNone;
  SpringKind kind = SpringKind::kStructural;
  FailureCause cause = FailureCause::kTear;
  double stretch = 0.0;          ///< length over rest length when it failed
  Vec3 position = Vec3::Zero();  ///< of its middle in the world [m]
  Vec2 material = Vec2::Zero();  ///< of its middle in material coordinates [m]
  bool overloaded = false;  ///< passed its own limit; false: went because the surface opened there

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, a, b, kind, cause, stretch, position, material, overloaded);
  }
};

FailureEvent describeFailure(const Model& model, const State& state, const Spring& spring,
                             FailureCause cause);

}  // namespace cloth_sim
