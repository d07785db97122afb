/// \file Tears by energy: their force does not depend on the mesh.

#include "study/reality_tear.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fewer_cases.h"

namespace cloth_sim {
namespace {

TEST(TrouserTear, NeedsHalfOfTheTearEnergyOnEveryMeshAndAtEveryAngle) {
  for (const int particles : {33, 65}) {
    for (const double angle : fewerCasesOf<double>({0.0, 15.0, 30.0, 45.0})) {
      TrouserTear tear;
      tear.particles = particles;
      tear.angle = angle;
      const TearForce force = trouserForce(tear);
      EXPECT_NEAR(force.mean, 0.5 * tear.energy, 0.05 * 0.5 * tear.energy)
          << particles << " a side at " << angle << " degrees";
      EXPECT_GE(force.advances, particles / 8);
    }
  }
}

TEST(TrouserTear, NeedsForceInProportionToTheEnergy) {
  TrouserTear tear;
  tear.energy = 1.0;
  EXPECT_NEAR(trouserForce(tear).mean, 0.5, 0.05 * 0.5);
  tear.energy = 4.0;
  EXPECT_NEAR(trouserForce(tear).mean, 2.0, 0.05 * 2.0);
}

TEST(NotchedStrip, IsAsStrongOnEveryMesh) {
  NotchedStrip strip;
  strip.particles = 17;
  const double coarse = strengthOf(strip);
  strip.particles = 33;
  EXPECT_NEAR(coarse, strengthOf(strip), 0.05 * coarse);
}

TEST(NotchedStrip, IsWeakerWithTheRootOfItsNotch) {
  NotchedStrip strip;
  strip.notch = 0.05;
  const double shorter = strengthOf(strip);
  strip.notch = 0.1;
  // The strip has an end, which takes a little more from the longer notch (Tada, Paris & Irwin).
  EXPECT_NEAR(shorter / strengthOf(strip), std::sqrt(2.0), 0.05 * std::sqrt(2.0));
}

}  // namespace
}  // namespace cloth_sim
