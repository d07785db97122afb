#pragma once
/// \file A cloth that a peer or this package simulates, as the comparison sees it.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "figures.h"

namespace cloth_sim::bench {

/// The same for all: a square cloth, and what it falls on.
struct Task {
  int particles = 128;  ///< along each side
  double side = 1.0;    ///< [m]
  double mass = 0.2;    ///< [kg]
  double frame = 1.0 / 60.0;
  double duration = 5.0;  ///< [s]
  /// It hangs from its two upper corners; or it falls on a sphere that stands on the ground.
  struct Sphere {
    Vec3 centre;
    double radius = 0.0;  ///< [m]
  };
  std::optional<Sphere> sphere;
  double height = 1.0;  ///< of its middle, at the start [m]
};

class Cloth {
 public:
  virtual ~Cloth() = default;
  /// Goes on by a frame.
  virtual void advance() = 0;
  virtual Grid3 positions() const = 0;
  virtual Grid3 velocities() const = 0;
};

/// A way to simulate it.
struct Contender {
  std::string engine;
  std::string setting;
  std::function<std::unique_ptr<Cloth>(const Task&)> make;
};

/// Bullet's soft body with so many substeps in a frame and iterations in a substep.
Contender bullet(int substeps, int iterations);
/// This package, by a method of its registry and its parameters ("solver.iterations=2").
Contender own(const std::string& method, const std::vector<std::string>& overrides);

}  // namespace cloth_sim::bench
