#pragma once
/// \file The particles and springs of a hanging cloth, as solvers have them.

#include "constraints/particles.h"
#include "constraints/spring_schedule.h"
#include "scenes.h"

namespace cloth_sim::bench {

constexpr double kFrame = 1.0 / 60.0;
constexpr double kSubstep = kFrame / 20.0;  ///< of `xpbd`

/// Order of particles in memory.
enum class Order {
  kGrid,  ///< as Particles chooses for a grid
  kAny,   ///< along a Z curve: neighbours are near, but no two springs of a colour are in a row
};

/// A hanging cloth of n x n particles.
struct Packed {
  Packed(int n, Order order, const std::string& bending = "springs");
  /// Cuts and refines it; springs and particles follow.
  void slit();

  Simulation simulation;
  Particles particles;
  SpringSchedule schedule;
  VectorArray force;

 private:
  void load();
};

}  // namespace cloth_sim::bench
