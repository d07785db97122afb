#pragma once
/// \file Tearing: which springs fail, and where the surface opens for them. Plans only; see
/// surgery/apply.h for the edit.

#include <limits>
#include <optional>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/surgery/material_path.h"

namespace cloth_sim {

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
  TearRatios ratio{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                   std::numeric_limits<double>::infinity()};
  std::optional<Seam> seam;  ///< absent: the cloth may tear everywhere
};

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
};

/// One opening of the surface: the faces in `detach` let go of `vertex`.
struct Opening {
  VertexId vertex = kNone;
  std::vector<FaceId> detach;
  std::vector<std::int32_t> springs;  ///< slots of the springs that fail by it, the first decided
};

/// Finds the springs that fail, and how the surface opens for each.
///
/// A failed spring opens the surface at the end of it that lies to the right of the crack: the
/// faces around that vertex that reach to the left let go. The crack so runs along mesh edges
/// within one edge of where it should be, and which vertices it passes through does not depend on
/// the order of failures. A spring whose failure would open nothing does not fail.
class Tearing {
 public:
  Tearing(TearingSettings settings, const Model& model);

  const TearingSettings& settings() const { return settings_; }
  void setEnabled(bool enabled) { settings_.enabled = enabled; }
  void setRatio(const TearRatios& ratio) { settings_.ratio = ratio; }

  /// What fails now, most overloaded first (by stretch over limit; ties by slot); at most one
  /// opening per vertex. Visits only springs that the gate allows.
  std::vector<Opening> plan(const Model& model, const State& state) const;

  /// To be called after every edit of the model.
  void follow(const Model& model, const ModelChanges& changes);

 private:
  bool allowed(const Model& model, const Spring& spring) const;

  TearingSettings settings_;
  std::vector<std::int32_t>
      candidates_;  ///< slots that the gate allows, ascending; some may be gone
};

/// Openings along `path`: every structural spring that crosses it fails, as if cut.
std::vector<Opening> planNotch(const Model& model, const MaterialPath& path);

}  // namespace cloth_sim
