#pragma once
/// \file What became of a grasp, for whoever watches clamps.

#include <string>
#include <vector>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

/// What a clamp holds.
struct GripContents {
  int held = 0;        ///< particles
  double area = 0.0;   ///< of the cloth that they stand for, at rest [m^2]
  int onObstacle = 0;  ///< of the particles: how many touch an obstacle or lie in one

  template <class Archive>
  void serialize(Archive& archive) {
    archive(held, area, onObstacle);
  }
};

/// A particle that is this near to an obstacle's surface touches it [m].
constexpr double kTouching = 1e-4;

GripContents gripContents(const Clamp& clamp, const Model& model, const State& state,
                          const ColliderSet& colliders);

/// Something that happened to a grasp, noticed at the end of a step.
struct GripEvent {
  enum class Kind {
    kClosed,    ///< the plates have closed; what they hold is in `contents`, maybe nothing
    kSlipping,  ///< the cloth pulls with more than the grip force, and slides
    kHolding,   ///< it slides no more
    kLost,      ///< the last of it has slid out of the plates
    kReleased   ///< the clamp was opened
  };
  double time = 0.0;  ///< [s]
  std::string clamp;
  Kind kind = Kind::kClosed;
  GripContents contents;
  Vec3 force = Vec3::Zero();  ///< of the cloth on the clamp, mean over the step, in the world [N]
  double slipped = 0.0;       ///< how far the cloth has slid since it was grasped [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, clamp, kind, contents, force, slipped);
  }
};
const char* toString(GripEvent::Kind kind);  ///< "closed", "slipping", ...

/// Where the clamps stood at the end of the last step; tells what has changed since.
class GripWatch {
 public:
  /// Which kinds of events the clamp's change since the last call amounts to, in order.
  std::vector<GripEvent::Kind> update(const Clamp& clamp);
  /// Forgets a clamp that is no more.
  void forget(const std::string& clamp);

 private:
  struct Seen {
    std::string clamp;
    ClampState state = ClampState::kOpen;
    bool slipping = false;
    bool held = false;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(clamp, state, slipping, held);
    }
  };

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(seen_);
  }
  Seen& find(const std::string& clamp);

  std::vector<Seen> seen_;
};

}  // namespace cloth_sim
