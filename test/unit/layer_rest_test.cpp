/// \file Parts of a step: the rest of one, after a failure, goes on with the pairs of its first
/// part; one in which cloth comes near itself unexpectedly is done again.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "cloth_sim/contact/layers.h"
#include "core_support.h"
#include "layer_support.h"
#include "linalg/vector_array.h"

namespace cloth_sim {
namespace {

class PartOfAStep : public testing::Test {
 protected:
  /// Does the contact of a substep in which all particles move by `motion` [m].
  void substep(const Vec3& motion) {
    VectorArray to = x_;
    for (std::size_t k = 0; k < mass_.size(); ++k) to.set(k, x_.at(k) + motion);
    substep(to);
  }
  /// The same, with places at the end [m].
  void substep(const VectorArray& to) {
    start_ = x_;
    x_ = to;
    layers_.load(view());
    layers_.project(view(), 1e-3);
    layers_.certify(view());
  }
  ParticleView view() {
    return {x_.x.data(),     x_.y.data(),     x_.z.data(),  start_.x.data(),
            start_.y.data(), start_.z.data(), mass_.data(), nullptr};
  }

  static VectorArray placesOf(const State& state) {
    VectorArray places;
    places.resize(static_cast<std::size_t>(state.x.size()));
    for (std::size_t k = 0; k < state.x.size(); ++k) {
      places.set(k, state.x[static_cast<VertexId>(k)]);
    }
    return places;
  }

  const Vec3 slowly_{1e-6, 0.0, 0.0};
  Model model_ = buildModel(cottonSheet(17));
  LayerContact layers_{model_, {{1e-3, 0.3}}};
  VectorArray x_ = placesOf(rolled(model_, 0.05, 2e-3));  // a roll of three turns
  VectorArray start_;
  std::vector<double> mass_ = std::vector<double>(x_.x.size(), 1e-4);
};

using RestOfAStep = PartOfAStep;
using StepOfClearCloth = PartOfAStep;

TEST_F(RestOfAStep, SearchesNoMoreWhereTheFirstPartEnded) {
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
  ASSERT_GT(layers_.report().pairs, 0);
  layers_.beginStep(model_, StepPart::kRest);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 0);
  EXPECT_GT(layers_.report().pairs, 0);
}

TEST_F(RestOfAStep, SearchesAgainElsewhere) {
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  layers_.beginStep(model_, StepPart::kRest);
  for (std::size_t k = 0; k < mass_.size(); ++k) x_.set(k, x_.at(k) + slowly_);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1) << "the cloth was moved between";
}

TEST_F(RestOfAStep, SearchesAgainAfterAnEdit) {
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  layers_.onModelChanged(model_);
  layers_.beginStep(model_, StepPart::kRest);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
}

TEST_F(RestOfAStep, ANewStepForgets) {
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
}

TEST_F(StepOfClearCloth, SearchesNoFaces) {
  x_ = placesOf(rolled(model_, 0.3, 0.0));  // half a turn
  layers_.beginStep(model_, StepPart::kWhole);
  for (int k = 0; k < 25; ++k) substep(slowly_);
  EXPECT_TRUE(layers_.endStep(view()));
  EXPECT_EQ(layers_.report().detections, 0);
  EXPECT_EQ(layers_.report().pairs, 0);
}

TEST_F(StepOfClearCloth, IsDoneAgainIfItComesNearItself) {
  const VectorArray far = placesOf(rolled(model_, 0.3, 0.0));
  const VectorArray near = x_;
  x_ = far;
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  EXPECT_FALSE(layers_.hasComeNear()) << "nobody has looked yet";
  substep(near);
  EXPECT_FALSE(layers_.endStep(view()));
  EXPECT_TRUE(layers_.hasComeNear());
  x_ = far;
  layers_.beginStep(model_, StepPart::kAgain);
  substep(slowly_);
  EXPECT_FALSE(layers_.hasComeNear());
  EXPECT_EQ(layers_.report().detections, 1) << "it looks for faces from the start on";
  EXPECT_TRUE(layers_.endStep(view()));
}

TEST_F(StepOfClearCloth, ThatComesNearItselfIsNoticedAfterSomeSubsteps) {
  const VectorArray near = x_;
  x_ = placesOf(rolled(model_, 0.3, 0.0));
  layers_.beginStep(model_, StepPart::kWhole);
  substep(slowly_);
  int substeps = 1;
  for (; substeps < 20 && !layers_.hasComeNear(); ++substeps) substep(near);
  EXPECT_LE(substeps, 10);
  EXPECT_FALSE(layers_.endStep(view()));
}

/// A cloth and one that flies at it with 5 m/s from 30 mm above.
class CollidingCloths {
 public:
  CollidingCloths() : solver_(testing_support::makeSolver(findSolver("line_xpbd"), model_, 20)) {
    state_.x = VertexData<Vec3>(laidFlat(model_, 0.03));
    state_.v = VertexData<Vec3>(state_.x.size(), Vec3::Zero());
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      if (model_.clothOf(v) == 1) state_.v[v] = Vec3(0.3 * state_.x[v].x(), 0.0, -5.0);
    }
    contacts_.layers = &layers_;
  }
  /// Advances by a frame that begins as `part`. \return whether it had to be done again.
  bool advance(StepPart part) {
    bool isDoneAgain = false;
    layers_.beginStep(model_, part);
    while (solver_->step(model_, state_, controls_, contacts_, {1.0 / 60.0}).status ==
           StepStatus::kCameNear) {
      EXPECT_FALSE(isDoneAgain);
      isDoneAgain = true;
      layers_.beginStep(model_, StepPart::kAgain);
    }
    return isDoneAgain;
  }
  std::uint64_t hash() const { return stateHash(model_, state_); }

 private:
  Model model_ = buildModel(std::vector<ClothSpec>{cottonSheet(17), cottonSheet(17)});
  State state_;
  Controls controls_;
  Contacts contacts_;
  LayerContact layers_{model_, {{1e-3, 0.3}, {1e-3, 0.3}}};
  std::unique_ptr<Solver> solver_;
};

TEST(StepOfCollidingCloths, HasTheBitsOfOneThatLooksForFacesFromTheStartOn) {
  CollidingCloths cloths;
  CollidingCloths looking;
  int again = 0;
  for (int step = 0; step < 5; ++step) {
    again += cloths.advance(StepPart::kWhole) ? 1 : 0;
    EXPECT_FALSE(looking.advance(StepPart::kAgain));
    EXPECT_EQ(cloths.hash(), looking.hash()) << "step " << step;
  }
  EXPECT_EQ(again, 1);
}

}  // namespace
}  // namespace cloth_sim
