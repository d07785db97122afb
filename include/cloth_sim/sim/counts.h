#pragma once
/// \file Counts of what has come loose: failed springs, and pieces that were taken away.

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// Counts of failed springs. total = structural + shear + bend = torn + cut.
struct BrokenCounts {
  int total = 0;
  std::array<int, kSpringKinds> byKind{0, 0, 0};
  int torn = 0;
  int cut = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(total, byKind, torn, cut);
  }
};

/// Pieces that were taken away: small loose ones, and strips along cuts.
struct DroppedScraps {
  int count = 0;
  double mass = 0.0;      ///< [kg]
  double restArea = 0.0;  ///< [m^2]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(count, mass, restArea);
  }
};

}  // namespace cloth_sim
