#pragma once
/// \file Events of grips: closed, slipping, lost, and so on.

#include <string>
#include <vector>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/contact/collider.h"
#include "cloth_sim/contact/layers.h"

namespace cloth_sim {

/// The contents of a clamp's grip.
struct GripContents {
  int held = 0;        ///< number of particles
  double area = 0.0;   ///< rest area of the cloth that they represent [m^2]
  int onObstacle = 0;  ///< number of the particles that touch an obstacle or lie in one

  template <class Archive>
  void serialize(Archive& archive) {
    archive(held, area, onObstacle);
  }
};

/// Gap to an obstacle below which a particle touches it [m].
constexpr double kTouching = 1e-4;

/// Counts what a clamp holds.
GripContents gripContents(const Clamp& clamp, const Model& model, const State& state,
                          const ColliderSet& colliders);

/// Tells whether a layer of cloth kept a particle that the clamp holds from following it in the
/// last substep. \param layers  null if layers do not touch: then never.
bool isBlocked(const Clamp& clamp, const LayerContact* layers);

/// A change of a clamp's grip, noticed at the end of a step.
struct GripEvent {
  enum class Kind {
    kClosed,    ///< the plates have closed; `contents` may be empty
    kSlipping,  ///< the cloth pulls with more than the grip force, and slides
    kHolding,   ///< the cloth has stopped sliding
    kLost,      ///< the last held particle has slid out of the plates
    kReleased,  ///< the clamp was opened
    kBlocked,   ///< a layer of cloth keeps what the clamp holds from following it
    kFreed      ///< all that the clamp holds follows it again
  };
  double time = 0.0;  ///< [s]
  std::string clamp;
  Kind kind = Kind::kClosed;
  GripContents contents;
  Vec3 force = Vec3::Zero();  ///< of the cloth on the clamp, mean over the step, in the world [N]
  double slipped = 0.0;       ///< distance that the cloth has slid since the grasp [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, clamp, kind, contents, force, slipped);
  }
};
const char* toString(GripEvent::Kind kind);  ///< "closed", "slipping", ...

/// Compares the grips of clamps with those at the end of the step before.
class GripWatch {
 public:
  /// Returns the kinds of events since the last call for this clamp, in order.
  /// \param blocked  whether a layer of cloth keeps what it holds from following it.
  std::vector<GripEvent::Kind> update(const Clamp& clamp, bool blocked);
  /// Forgets a clamp that was removed.
  void forget(const std::string& clamp);

 private:
  /// Saved as one byte: 0 and 1 are what it was before clamps could be blocked.
  enum class Hold : std::uint8_t { kNothing, kFollows, kBlocked };

  /// The grip of a clamp at the last call.
  struct Seen {
    std::string clamp;
    ClampState state = ClampState::kOpen;
    bool slipping = false;
    Hold hold = Hold::kNothing;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(clamp, state, slipping, hold);
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
