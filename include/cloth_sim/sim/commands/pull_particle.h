#pragma once
/// \file The command with which a pointer pulls at the cloth.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Pulls a particle along with a ray; the first command of a pull picks the particle. To be sent
/// again and again while the pull lasts, since it ends after `Drag::kPatience` without one.
struct PullParticle {
  static constexpr const char* kKind = "pull_particle";
  static constexpr Wakes kWakes = Wakes::kAlways;

  bool held = true;  ///< false: let go (the ray does not matter)
  Ray ray;           ///< in the world

  std::string describe() const { return held ? "along " + toText(ray.direction) : "let go"; }
  std::string validationError() const { return held ? cloth_sim::validationError(ray) : ""; }
  CommandResult apply(SimulationParts& parts) const {
    Drag& drag = parts.holders.drag();
    if (!held) {
      drag.release();
      return done();
    }
    if (!drag.pick(ray, parts.state)) {
      const int reach = static_cast<int>(Drag::kReach * 1e3);
      return refuse("no particle is within " + std::to_string(reach) + " mm of the ray");
    }
    drag.aim(ray, parts.time());
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(held, ray);
  }
};

}  // namespace cloth_sim
