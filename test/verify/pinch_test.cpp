/// \file Two obstacles hold cloth between them by friction alone, as the fingers of a robot whose
/// links are obstacles.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

constexpr double kHold = 0.3;       ///< time at rest [s]
constexpr double kLift = 0.5;       ///< time of lifting [s]
constexpr double kLiftSpeed = 0.2;  ///< [m/s]
constexpr double kThickness = 1.5;  ///< of the cloth [mm]
constexpr double kSqueezed = 0.1;   ///< of the thickness, by two fingers that hold [mm]
constexpr double kGravity = 9.81;   ///< [m/s^2]
constexpr double kLowest = 0.4;     ///< z of the lower side of the cloth at the start [m]
constexpr double kCloth = 0.2;      ///< height of the cloth [m]

/// A strip that hangs between two fingers, which stay, and then rise.
/// \param gap  between the fingers [mm].
Scene pinched(double gap, double friction) {
  const std::string y = std::to_string(0.005 + 0.0005 * gap);
  const std::string rest =
      ", size: [0.12, 0.01, 0.03], friction: " + std::to_string(friction) + "}";
  const std::string up = "{velocity: [0, 0, " + std::to_string(kLiftSpeed) + "]}";
  return parseScene(R"(
cloth:
  size: [0.1, 0.2]
  particles: [21, 41]
  pose: {position: [0, 0, 0.5], rpy: [1.5707963267948966, 0, 0]}
  fabric: {preset: cotton, areal_density: 0.25}
  thickness: 0.0015
obstacles:
  a: {type: box, position: [0, -)" +
                        y + ", 0.56]" + rest + R"(
  b: {type: box, position: [0, )" +
                        y + ", 0.56]" + rest + R"(
phases:
  - {name: hold, timeout: )" +
                        std::to_string(kHold) + R"(, on_timeout: continue}
  - {name: lift, obstacles: {a: )" +
                        up + ", b: " + up + R"(}}
)",
                    "pinched");
}

/// The height of the lower side of the cloth after it was to be held and lifted [m].
double lowestAfterLift(double gap, double friction) {
  Simulation simulation(pinched(gap, friction));
  while (simulation.time() < kHold + kLift) simulation.step();
  double lowest = simulation.state().x[0].z();
  for (const Vec3& x : simulation.state().x) lowest = std::min(lowest, x.z());
  return lowest;
}

/// Up to round-off in when phases begin (two steps of 1/60 s), it follows the fingers; it hangs
/// stretched by less than 2 % of its height.
TEST(Pinch, FingersThatSqueezeTheClothLiftIt) {
  const double lifted = kLowest + kLiftSpeed * kLift;
  const double lateness = kLiftSpeed * 2.0 / 60.0;
  EXPECT_NEAR(lowestAfterLift(kThickness - kSqueezed, 0.3), lifted, lateness + 0.02 * kCloth);
}

TEST(Pinch, ItFallsFreelyWithoutFriction) {
  const double time = kHold + kLift;
  EXPECT_NEAR(lowestAfterLift(kThickness - kSqueezed, 0.0), kLowest - 0.5 * kGravity * time * time,
              0.05 * 0.5 * kGravity * time * time);
}

TEST(Pinch, ItFallsFreelyBetweenFingersThatDoNotTouchIt) {
  const double time = kHold + kLift;
  EXPECT_NEAR(lowestAfterLift(kThickness + kSqueezed, 0.3), kLowest - 0.5 * kGravity * time * time,
              0.05 * 0.5 * kGravity * time * time);
}

/// The friction of slack fingers brakes it, but does not hold it.
TEST(Pinch, ItSlipsWhereFrictionIsTooWeak) {
  const double time = kHold + kLift;
  const double lowest = lowestAfterLift(kThickness - kSqueezed, 0.1);
  EXPECT_LT(lowest, kLowest);
  EXPECT_GT(lowest, kLowest - 0.9 * 0.5 * kGravity * time * time);
}

}  // namespace
}  // namespace cloth_sim
