/// \file Added inertia follows the length of substeps.

#include "solver/added_inertia.h"  // private: a method shows motions, not inertia

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "sim/archive.h"

namespace cloth_sim {
namespace {

constexpr double kMass = 1e-4;  // [kg]

/// Inertia that was found with substeps of 1/2400 s: thrice the mass of the first of two particles,
/// and four fifths of that of the second, which adds nothing.
AddedInertia foundInertia() {
  std::ostringstream bytes;
  StateWriter writer(bytes);
  const std::vector<Vec3> still(2, Vec3::Zero());
  writer(1.0 / 2400.0, ScalarArray{3.0 * kMass, 0.8 * kMass}, still, still);
  StateReader reader(bytes.str());
  AddedInertia inertia;
  inertia.load(reader);
  return inertia;
}

Particles twoParticles() {
  Particles particles;
  particles.mass = {kMass, kMass};
  particles.inverseMass = {1.0 / kMass, 1.0 / kMass};
  return particles;
}

ScalarArray wholeAt(double h) {
  AddedInertia inertia = foundInertia();
  inertia.setStep(h);
  inertia.find(twoParticles());
  return inertia.whole();
}

TEST(AddedInertia, GrowsWithTheSquareOfLongerSubsteps) {
  // So do displacements in vain: no substep finds lines softer than the last one did.
  const ScalarArray whole = wholeAt(1.0 / 1200.0);
  EXPECT_NEAR(whole[0], 12.0 * kMass, 1e-12);
  EXPECT_NEAR(whole[1], 3.2 * kMass, 1e-12);
}

TEST(AddedInertia, DoesNotGrowBeyondWhatItWasFoundFor) {
  // A few shorter substeps, as the step guard takes, hardly let it fade.
  AddedInertia inertia = foundInertia();
  inertia.setStep(1.0 / 9600.0);
  inertia.setStep(1.0 / 2400.0);
  inertia.find(twoParticles());
  EXPECT_EQ(inertia.whole(), (ScalarArray{3.0 * kMass, kMass}));
}

TEST(AddedInertia, StaysForShorterSubsteps) {
  EXPECT_EQ(wholeAt(1.0 / 4800.0), (ScalarArray{3.0 * kMass, kMass}));
  EXPECT_EQ(wholeAt(1.0 / 2400.0), (ScalarArray{3.0 * kMass, kMass}));
}

}  // namespace
}  // namespace cloth_sim
