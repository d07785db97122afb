/// \file Added inertia follows the length of substeps, and the tension of threads.

#include "solver/added_inertia.h"  // private: a method shows motions, not inertia

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "sim/archive.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

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

/// A cloth that is stretched along x, with the inertia for substeps of 1/1200 s.
class Stretched {
 public:
  explicit Stretched(double stretch) {
    particles_.layOut(model_);
    particles_.load(flatState(model_));
    particles_.loadMasses(model_, {});
    for (double& x : particles_.x.x) x *= stretch;
    AddedInertia inertia;
    inertia.layOut(model_, particles_);
    inertia.followTension(model_, particles_, kStep);
    inertia.find(particles_);
    whole_ = inertia.whole();
  }
  double massOf(VertexId v) const { return model_.mass[v]; }
  double inertiaOf(VertexId v) const { return whole_[slotOf(v)]; }
  /// The square of h w, if the neighbours of a particle move against it.
  double squareOf(VertexId v) const {
    double sum = 0.0;  // of T / l [N/m]
    for (const Spring spring : model_.springs.slots()) {
      if (spring.a != v && spring.b != v) continue;
      const double l = (at(spring.b) - at(spring.a)).norm();
      sum += std::max(0.0, spring.stiffness * (l - spring.restLength)) / l;
    }
    return kStep * kStep * 2.0 * sum / inertiaOf(v);
  }

 private:
  static constexpr double kStep = 1.0 / 1200.0;  // [s]

  std::size_t slotOf(VertexId v) const { return static_cast<std::size_t>(particles_.slotOf[v]); }
  Vec3 at(VertexId v) const { return particles_.x.at(slotOf(v)); }

  Model model_ = buildModel(clothOf(9, 9, 0.01, fabricPreset("cotton")));
  Particles particles_;
  ScalarArray whole_;
};

TEST(AddedInertia, KeepsTightThreadsFromVibratingAtTheRateOfSubsteps) {
  const Stretched tight(1.1);
  for (const VertexId v : {0, 4, 40, 80}) EXPECT_NEAR(tight.squareOf(v), 1.0, 1e-12) << v;
  const Stretched slack(0.999);
  for (const VertexId v : {0, 4, 40, 80}) EXPECT_EQ(slack.inertiaOf(v), slack.massOf(v)) << v;
}

}  // namespace
}  // namespace cloth_sim
