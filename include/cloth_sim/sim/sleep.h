#pragma once
/// \file Sleep: a cloth that has come to rest need not be computed.

#include <optional>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// Sleep of a simulation. It falls asleep at the end of a step after which it has been at
/// rest for long enough, and sleeps until `wake`, which is called for everything that may move the
/// cloth.
class Sleep {
 public:
  /// \param settings  absent: it never sleeps.
  explicit Sleep(const std::optional<SleepSettings>& settings) : settings_(settings) {}

  bool isAsleep() const { return settings_ && asleep_; }
  /// Simulated time slept through since the start or the last reset [s].
  double timeAsleep() const { return timeAsleep_; }

  /// Remembers where particles are before a step.
  void beginStep(const State& state);
  /// Tells whether every particle has moved less in the step of `dt` [s] than at the settings'
  /// speed; false if it never sleeps, or if the step has changed the number of particles. What goes
  /// to and fro within a step, as from one substep with bending to the next, does not count.
  bool isSlow(const State& state, double dt) const;

  /// Counts a step of `dt` [s] towards the rest.
  /// \param rests  whether nothing moved and nothing changed during the step.
  /// \return whether it falls asleep now.
  bool endStep(bool rests, double dt);
  /// Counts a step of `dt` [s] that was slept through.
  void sleepOn(double dt) { timeAsleep_ += dt; }
  /// Wakes it up, if it sleeps; its rest begins anew.
  void wake();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(asleep_, atRest_, timeAsleep_);
  }

 private:
  std::optional<SleepSettings> settings_;
  std::vector<Vec3> before_;  ///< positions before the step, by vertex [m]
  bool asleep_ = false;
  double atRest_ = 0.0;      ///< how long it has been at rest [s]
  double timeAsleep_ = 0.0;  ///< [s]
};

}  // namespace cloth_sim
