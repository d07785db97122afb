/// \file The rest of a step, after a failure, goes on with the pairs of its first part.

#include <gtest/gtest.h>

#include <vector>

#include "cloth_sim/contact/layers.h"
#include "layer_support.h"
#include "linalg/vector_array.h"

namespace cloth_sim {
namespace {

class RestOfAStep : public testing::Test {
 protected:
  /// Does the contact of a substep in which all particles move by `motion` [m].
  void substep(const Vec3& motion) {
    start_ = x_;
    for (std::size_t k = 0; k < mass_.size(); ++k) x_.set(k, x_.at(k) + motion);
    const ParticleView view{x_.x.data(),     x_.y.data(),     x_.z.data(),  start_.x.data(),
                            start_.y.data(), start_.z.data(), mass_.data(), nullptr};
    layers_.load(view);
    layers_.project(view, 1e-3);
    layers_.certify(view);
  }

  static Model modelOf() {
    ClothSpec cloth;
    cloth.columns = cloth.rows = 17;
    cloth.fabric = fabricPreset("cotton");
    return buildModel(cloth);
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
  Model model_ = modelOf();
  LayerContact layers_{model_, {{1e-3, 0.3}}};
  VectorArray x_ = placesOf(rolled(model_, 0.05, 2e-3));  // a roll of three turns
  VectorArray start_;
  std::vector<double> mass_ = std::vector<double>(x_.x.size(), 1e-4);
};

TEST_F(RestOfAStep, SearchesNoMoreWhereTheFirstPartEnded) {
  layers_.beginStep(StepPart::kWhole);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
  ASSERT_GT(layers_.report().pairs, 0);
  layers_.beginStep(StepPart::kRest);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 0);
  EXPECT_GT(layers_.report().pairs, 0);
}

TEST_F(RestOfAStep, SearchesAgainElsewhere) {
  layers_.beginStep(StepPart::kWhole);
  substep(slowly_);
  layers_.beginStep(StepPart::kRest);
  for (std::size_t k = 0; k < mass_.size(); ++k) x_.set(k, x_.at(k) + slowly_);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1) << "the cloth was moved between";
}

TEST_F(RestOfAStep, SearchesAgainAfterAnEdit) {
  layers_.beginStep(StepPart::kWhole);
  substep(slowly_);
  layers_.onModelChanged(model_);
  layers_.beginStep(StepPart::kRest);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
}

TEST_F(RestOfAStep, ANewStepForgets) {
  layers_.beginStep(StepPart::kWhole);
  substep(slowly_);
  layers_.beginStep(StepPart::kWhole);
  substep(slowly_);
  EXPECT_EQ(layers_.report().detections, 1);
}

}  // namespace
}  // namespace cloth_sim
