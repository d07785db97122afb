/// \file Cloth that intersects itself is opened up, or it is said how much is left.

#include "contact/untangle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/contact/layers.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/intersections.h"

namespace cloth_sim {
namespace {

constexpr double kSide = 0.3;  // [m]
constexpr int kRows = 21;
constexpr double kCell = kSide / (kRows - 1);
constexpr double kGap = 0.005;  // between the sheets [m]

/// Two sheets, one above the other, which tests bend into each other.
class TwoSheets : public testing::Test {
 protected:
  TwoSheets()
      : scene_(parseScene(R"(
cloth:
  - {name: lower, size: [0.3, 0.3], particles: [21, 21], fabric: cotton}
  - {name: upper, size: [0.3, 0.3], particles: [21, 21], fabric: cotton,
     pose: {position: [0.006, 0.0025, 0.005]}}
self_contact: true
)",
                          "two.yaml")),
        model_(buildModel(scene_.cloths)),
        layers_(buildLayers(scene_, model_)),
        x_(initialState(scene_.cloths, model_, 1).x.values()) {
    options_.step = 0.1 * kCell;
    options_.isHeld.assign(x_.size(), 0);
  }

  bool isUpper(std::size_t v) const { return v >= x_.size() / 2; }
  /// Raises the particles of a sheet by a function of their place [m].
  template <typename Height>
  void raise(bool upper, const Height& height) {
    for (std::size_t v = 0; v < x_.size(); ++v) {
      if (isUpper(v) == upper) x_[v].z() += height(x_[v].x(), x_[v].y());
    }
  }
  Untangled run() {
    return untangle(
        model_.mesh, options_,
        [this](const std::vector<Vec3>& at) { return layers_->findOverlap(model_, at).pairs; }, x_);
  }
  int intersections() const {
    State state;
    state.x = VertexData<Vec3>(x_.size(), Vec3::Zero());
    for (std::size_t v = 0; v < x_.size(); ++v) state.x[static_cast<VertexId>(v)] = x_[v];
    return countIntersections(model_, state);
  }
  double largestStrain() const {
    double most = 0.0;
    for (const Face& face : model_.mesh.faces()) {
      for (int k = 0; k < 3; ++k) {
        const VertexId a = face[k];
        const VertexId b = face[(k + 1) % 3];
        const double rest = (model_.mesh.material(a) - model_.mesh.material(b)).norm();
        most = std::max(most, (x_[a] - x_[b]).norm() / rest - 1.0);
      }
    }
    return most;
  }

  Scene scene_;
  Model model_;
  std::unique_ptr<LayerContact> layers_;
  std::vector<Vec3> x_;
  UntangleOptions options_;
};

double bump(double x, double y) { return 0.012 * std::exp(-(x * x + y * y) / (0.04 * 0.04)); }

TEST_F(TwoSheets, ThatAreApartStayAsTheyAre) {
  const std::vector<Vec3> before = x_;
  const Untangled result = run();
  EXPECT_EQ(result.pairs, 0);
  EXPECT_EQ(result.passes, 0);
  EXPECT_EQ(x_, before);
}

TEST_F(TwoSheets, OverlapIsFoundAmongThePairsOfSomeFaces) {
  raise(false, bump);
  const FacePairList all = layers_->findOverlap(model_, x_).pairs;
  ASSERT_GT(all.size(), 20u);
  const FaceId asked = all[7][0];
  FacePairList wanted;
  for (const auto& pair : all) {
    if (pair[0] == asked || pair[1] == asked) wanted.push_back(pair);
  }
  EXPECT_EQ(layers_->findOverlap(model_, x_, {asked}).pairs, wanted);
  EXPECT_TRUE(layers_->findOverlap(model_, x_, {}).pairs.empty());
}

TEST_F(TwoSheets, BumpThatSticksThroughIsTakenBack) {
  raise(false, bump);
  EXPECT_GT(intersections(), 0);
  const Untangled result = run();
  EXPECT_GT(result.pairs, 20);
  EXPECT_EQ(result.left, 0);
  EXPECT_EQ(intersections(), 0);
  EXPECT_LT(result.farthest, 0.012);
  EXPECT_LT(largestStrain(), 0.1);
}

TEST_F(TwoSheets, CornerThatSticksThroughIsTakenBack) {
  raise(true, [](double a, double b) { return -0.3 * std::max(0.0, a + b - 0.2); });
  EXPECT_GT(intersections(), 0);
  EXPECT_EQ(run().left, 0);
  EXPECT_EQ(intersections(), 0);
  EXPECT_LT(largestStrain(), 0.3);
}

TEST_F(TwoSheets, ManyBumpsAreTakenBack) {
  raise(false, [](double a, double b) { return 0.01 * std::sin(40.0 * a) * std::sin(33.0 * b); });
  EXPECT_GT(run().pairs, 300);
  EXPECT_EQ(intersections(), 0);
}

TEST_F(TwoSheets, HeldParticlesStay) {
  raise(false, bump);
  const std::vector<Vec3> before = x_;
  for (std::size_t v = 0; v < x_.size(); ++v) options_.isHeld[v] = isUpper(v) ? 0 : 1;
  EXPECT_EQ(run().left, 0);
  EXPECT_EQ(intersections(), 0);
  for (std::size_t v = 0; v < x_.size(); ++v) {
    if (!isUpper(v)) {
      ASSERT_EQ(x_[v], before[v]);
    }
  }
}

TEST_F(TwoSheets, InTheSamePlaceAreLeft) {
  raise(true, [](double, double) { return -kGap; });
  const std::vector<Vec3> before = x_;
  const Untangled result = run();
  EXPECT_GT(result.pairs, 1000);
  EXPECT_EQ(result.left, result.pairs);
  EXPECT_EQ(x_, before);
}

/// A second cloth falls on the first, whose corner sticks through it at the start.
std::string crossedCloths(const std::string& more) {
  return R"(
cloth:
  - {name: lower, size: [0.3, 0.3], particles: [21, 21], fabric: cotton,
     pose: {position: [0, 0, 0.02]}}
  - {name: upper, size: [0.3, 0.3], particles: [21, 21], fabric: cotton,
     pose: {position: [0.08, 0.05, 0.03], rpy: [0, 0.12, 0.3]}}
self_contact: true
obstacles: {table: {type: plane, friction: 0.5}}
)" + more;
}

TEST(SceneThatIntersectsItself, IsRefusedWithThePlace) {
  try {
    const Simulation simulation(parseScene(crossedCloths(""), "crossed.yaml"));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("pairs of faces, the first at (0.1"), std::string::npos) << text;
  }
}

TEST(SceneThatIntersectsItself, IsOpenedUpOnRequest) {
  Simulation simulation(parseScene(crossedCloths("contact: {start: untangle}"), "crossed.yaml"));
  ASSERT_EQ(simulation.warnings().size(), 1U);
  const std::string text = simulation.warnings().front().text;
  EXPECT_NE(text.find("it was opened up"), std::string::npos) << text;
  for (int step = 0; step < 40; ++step) {
    ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << step;
    simulation.step();
    ASSERT_FALSE(simulation.failed());
  }
}

TEST(SceneThatIntersectsItself, IsRefusedWhereThatCannotBe) {
  const std::string text = R"(
cloth:
  - {name: lower, size: [0.3, 0.3], particles: [9, 9], fabric: cotton}
  - {name: upper, size: [0.3, 0.3], particles: [9, 9], fabric: cotton}
self_contact: true
contact: {start: untangle}
)";
  try {
    const Simulation simulation(parseScene(text, "same_place.yaml"));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("; `untangle` leaves "), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cloth_sim
