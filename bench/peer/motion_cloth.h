#pragma once
/// \file Bullet's soft body in the motions of the study.

#include "study/motion_run.h"

namespace cloth_sim::bench {

/// Settings of a soft body.
struct BulletSetting {
  int substeps = 1;    ///< per frame
  int iterations = 1;  ///< per substep
  bool bends = true;   ///< whether links across a node resist bending
};

/// Puts a soft body in the place of the cloth of a motion. Its links are as stiff as they can be.
/// \throws std::invalid_argument if the motion has obstacles or clamps.
std::unique_ptr<MovingCloth> bulletMotion(const Motion& motion, const BulletSetting& setting);

}  // namespace cloth_sim::bench
