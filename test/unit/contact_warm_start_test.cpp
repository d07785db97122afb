#include "constraints/contact_warm_start.h"

#include <gtest/gtest.h>

#include "cloth_sim/contact/collider.h"
#include "core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kH = 0.01;  // [s]

/// Four particles on a plane, falling into it by a millimetre a substep.
class WarmContactsTest : public testing::Test {
 protected:
  WarmContactsTest()
      : model_(buildModel(clothOf(2, 2, 0.1))), plane_(makePlane(), {ContactProperties{}}) {
    particles_.layOut(model_);
    particles_.loadMasses(model_, {});
    touch({0, 1, 2, 3});
  }

  static Obstacle makePlane() {
    Obstacle plane;
    plane.name = "plane";
    plane.shape = PlaneShape{};
    return plane;
  }

  void touch(const std::vector<VertexId>& vertices) {
    contacts_.clear();
    contacts_.add(&plane_).vertices = vertices;
  }

  void fall(double depth) {
    for (std::size_t k = 0; k < 4; ++k) {
      particles_.start.set(k, Vec3(0.1 * static_cast<double>(k), 0.0, 0.0));
      particles_.x.set(k, particles_.start.at(k) - depth * Vec3::UnitZ());
    }
  }

  /// Upward accelerations by slot.
  ScalarArray accelerations() const {
    VectorArray force;
    force.resize(4);
    warm_.addForces(ScalarArray(4, 1.0), force);
    return force.z;
  }

  Model model_;
  Particles particles_;
  Collider plane_;
  Contacts contacts_;
  ContactWarmStart warm_;
};

TEST_F(WarmContactsTest, RemembersMostOfWhatStoppedAParticle) {
  warm_.begin(contacts_, particles_, 0.0, kH);
  EXPECT_EQ(accelerations(), ScalarArray(4, 0.0));
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  EXPECT_NEAR(particles_.x.z[0], 0.0, 1e-15);
  EXPECT_NEAR(accelerations()[0], 0.95 * 1e-3 / (kH * kH), 1e-9);
  EXPECT_NEAR(contacts_.candidates[0].impulse.linear.z(), -totalMass(model_) * 1e-3 / kH, 1e-12);
}

TEST_F(WarmContactsTest, AForceThatTookPartIsNotCountedTwice) {
  warm_.begin(contacts_, particles_, 0.0, kH);
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  const double carried = accelerations()[0];
  contacts_.candidates[0].impulse.linear.setZero();
  fall(1e-3 - kH * kH * carried);  // as much of the fall as it leaves
  warm_.enforce(2.0 * kH, kH, contacts_, particles_);
  EXPECT_NEAR(particles_.x.z[0], 0.0, 1e-15);
  EXPECT_NEAR(accelerations()[0], carried, 1e-9);
  EXPECT_NEAR(contacts_.candidates[0].impulse.linear.z(), -totalMass(model_) * 1e-3 / kH, 1e-12);
}

TEST_F(WarmContactsTest, LetsGoOfAParticleThatLeaves) {
  warm_.begin(contacts_, particles_, 0.0, kH);
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  fall(-1e-2);
  warm_.enforce(2.0 * kH, kH, contacts_, particles_);
  EXPECT_EQ(accelerations()[0], 0.0);
  EXPECT_NEAR(particles_.x.z[0], 1e-2 - 0.95e-3, 1e-15);  // without the force that held it
}

TEST_F(WarmContactsTest, ForgetsWhoIsNotNearAnyMore) {
  warm_.begin(contacts_, particles_, 0.0, kH);
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  touch({1});
  warm_.begin(contacts_, particles_, kH, kH);
  touch({0, 1});
  warm_.begin(contacts_, particles_, 2.0 * kH, kH);
  const ScalarArray known = accelerations();
  EXPECT_EQ(known[static_cast<std::size_t>(particles_.slotOf[0])], 0.0);
  EXPECT_GT(known[static_cast<std::size_t>(particles_.slotOf[1])], 0.0);
}

TEST_F(WarmContactsTest, AStepThatIsTakenAgainBeginsWithWhatItBeganWith) {
  warm_.begin(contacts_, particles_, 0.0, kH);
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  const ScalarArray before = accelerations();
  warm_.begin(contacts_, particles_, kH, kH);
  fall(std::numeric_limits<double>::quiet_NaN());
  warm_.enforce(2.0 * kH, kH, contacts_, particles_);
  warm_.begin(contacts_, particles_, kH, 0.5 * kH);
  EXPECT_EQ(accelerations(), before);
}

TEST_F(WarmContactsTest, AParticleNearTwoObstaclesCountsOnce) {
  contacts_.add(&plane_).vertices = {0, 1, 2, 3};
  warm_.begin(contacts_, particles_, 0.0, kH);
  fall(1e-3);
  warm_.enforce(kH, kH, contacts_, particles_);
  EXPECT_NEAR(accelerations()[0], 0.95 * 1e-3 / (kH * kH), 1e-9);
}

}  // namespace
}  // namespace cloth_sim
