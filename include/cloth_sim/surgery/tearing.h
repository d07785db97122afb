#pragma once
/// \file Tearing: which springs fail, and where the surface opens for them. Plans only; see
/// surgery/apply.h for the edit.

#include <limits>
#include <optional>

#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// A polyline in material coordinates [m].
using MaterialPath = std::vector<Vec2>;

/// Where the cloth may tear: only at springs that cross `path` or whose middle is within
/// `halfWidth` of it.
struct Seam {
  MaterialPath path;       ///< at least two points
  double halfWidth = 0.0;  ///< [m], >= 0
};

/// Length over rest length at which a spring of each kind fails; infinity: never.
using TearRatios = std::array<double, kSpringKinds>;

struct TearingSettings {
  bool enabled = false;
  TearRatios ratio{std::numeric_limits<double>::infinity(),
                   std::numeric_limits<double>::infinity(),
                   std::numeric_limits<double>::infinity()};
  std::optional<Seam> seam;  ///< absent: the cloth may tear everywhere
};

enum class FailureCause : std::uint8_t { kTear, kCut };
const char* toString(FailureCause cause);  ///< "torn" or "cut"

/// One spring that failed.
struct FailureEvent {
  double time = 0.0;       ///< [s]
  VertexId a = kNone;      ///< its ends when it failed
  VertexId b = kNone;
  SpringKind kind = SpringKind::kStructural;
  FailureCause cause = FailureCause::kTear;
  double stretch = 0.0;             ///< length over rest length when it failed
  Vec3 position = Vec3::Zero();     ///< of its middle in the world [m]
  Vec2 material = Vec2::Zero();     ///< of its middle in material coordinates [m]
  bool overloaded = false;  ///< passed its own limit; false: went because the surface opened there
};

/// One opening of the surface: the faces in `detach` let go of `vertex`.
struct Opening {
  VertexId vertex = kNone;
  std::vector<FaceId> detach;
  std::int32_t spring = kNone;  ///< the slot that asked for it
};

}  // namespace cloth_sim
