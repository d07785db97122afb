/// \file Edges along which cloth is folded.

#include "contact/ridges.h"

#include <gtest/gtest.h>

#include <numeric>

#include "cloth_sim/scene/build.h"

namespace cloth_sim {
namespace {

constexpr double kThickness = 0.001;                        // [m]
constexpr double kSlack = Ridges::kFlatShare * kThickness;  // [m]
constexpr double kAhead = 9.0;                              // substeps

/// A flat cloth of 5 x 5 particles, 1 cm apart, whose edges are all followed.
class FollowedEdges : public testing::Test {
 protected:
  FollowedEdges() {
    ClothSpec cloth;
    cloth.columns = cloth.rows = 5;
    cloth.width = cloth.height = 0.04;
    cloth.fabric = fabricPreset("cotton");
    model_ = buildModel(cloth);
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      const Vec2 at = model_.mesh.material()[v];
      start_.emplace_back(at.x(), at.y(), 0.0);
    }
    end_ = start_;
    mass_.assign(start_.size(), 1.0);
    loaded_.resize(start_.size());
    std::iota(loaded_.begin(), loaded_.end(), 0);
    halfThickness_.assign(start_.size(), 0.5 * kThickness);
    ridges_.build(model_.mesh);
    for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
      ridges_.watch(f);
      for (const Ridges::EdgeId e : ridges_.ownedBy(f)) {
        if (e != kNone) edges_.push_back(e);
      }
    }
  }

  void follow() { ridges_.follow({start_, end_, mass_, loaded_}, halfThickness_, kAhead); }
  bool isOnBorder(Ridges::EdgeId e) const { return ridges_[e].wing[1] == kNone; }
  /// Edges inside the cloth that may be folded.
  int foldedInside() const {
    int count = 0;
    for (const Ridges::EdgeId e : edges_) {
      if (!isOnBorder(e) && ridges_.isFolded(e)) ++count;
    }
    return count;
  }
  static constexpr VertexId kMiddle = 12;
  /// The edges at the middle vertex, and the sides opposite to it of the faces around it.
  int edgesThatMiddleFolds() const {
    int count = 0;
    for (const Ridges::EdgeId e : edges_) {
      const Ridges::Edge& edge = ridges_[e];
      const bool touches = edge.end[0] == kMiddle || edge.end[1] == kMiddle ||
                           edge.wing[0] == kMiddle || edge.wing[1] == kMiddle;
      if (touches && !isOnBorder(e)) ++count;
    }
    return count;
  }

  Model model_;
  Ridges ridges_;
  std::vector<Ridges::EdgeId> edges_;
  std::vector<Vec3> start_, end_;
  std::vector<double> mass_;
  std::vector<double> halfThickness_;  ///< by vertex [m]
  std::vector<VertexId> loaded_;
};

TEST_F(FollowedEdges, EachEdgeHasOneOwner) {
  // By Euler's formula: vertices + faces - edges = 1.
  EXPECT_EQ(static_cast<std::int32_t>(edges_.size()),
            model_.particleCount() + model_.mesh.faceCount() - 1);
}

TEST_F(FollowedEdges, FlatClothIsFoldedAtItsBorderOnly) {
  follow();
  EXPECT_EQ(foldedInside(), 0);
  for (const Ridges::EdgeId e : edges_) EXPECT_EQ(ridges_.isFolded(e), isOnBorder(e));
}

TEST_F(FollowedEdges, AVertexOffThePlaneFoldsTheEdgesAroundIt) {
  start_[kMiddle].z() = end_[kMiddle].z() = 10.0 * kSlack;
  follow();
  EXPECT_EQ(foldedInside(), edgesThatMiddleFolds());
  EXPECT_GT(foldedInside(), 6);
}

TEST_F(FollowedEdges, AVertexOffByLessThanTheSlackFoldsNothing) {
  start_[kMiddle].z() = end_[kMiddle].z() = 0.3 * kSlack;
  follow();
  EXPECT_EQ(foldedInside(), 0);
}

TEST_F(FollowedEdges, WhatWillSoonBeFoldedCounts) {
  end_[kMiddle].z() = 0.9 * kSlack;  // still flat at the end of the substep
  follow();
  EXPECT_EQ(foldedInside(), edgesThatMiddleFolds());
}

TEST_F(FollowedEdges, AnEdgeRisesOnceAndStaysARidge) {
  follow();
  const std::size_t border = ridges_.risen().size();
  EXPECT_EQ(border, 16U) << "which counts as folded";
  start_[kMiddle].z() = end_[kMiddle].z() = 10.0 * kSlack;
  follow();
  EXPECT_EQ(static_cast<int>(ridges_.risen().size()), edgesThatMiddleFolds());
  for (const Ridges::EdgeId e : ridges_.risen()) EXPECT_TRUE(ridges_.isRisen(e));
  follow();
  EXPECT_TRUE(ridges_.risen().empty());
  start_[kMiddle].z() = end_[kMiddle].z() = 0.0;
  follow();
  EXPECT_EQ(foldedInside(), 0);
  int ridges = 0;
  for (const Ridges::EdgeId e : edges_) ridges += ridges_.isRidge(e) ? 1 : 0;
  EXPECT_EQ(ridges, static_cast<int>(border) + edgesThatMiddleFolds());
  ridges_.clear();
  for (const Ridges::EdgeId e : edges_) EXPECT_FALSE(ridges_.isRidge(e));
}

TEST_F(FollowedEdges, MotionInCommonFoldsNothing) {
  for (Vec3& x : end_) x += Vec3(0.1, 0.2, 0.3);
  follow();
  EXPECT_EQ(foldedInside(), 0);
}

TEST_F(FollowedEdges, WhatIsNotLoadedMayBeFolded) {
  loaded_.erase(loaded_.begin() + kMiddle);
  follow();
  int withMiddleAsWing = 0;
  for (const Ridges::EdgeId e : edges_) {
    const Ridges::Edge& edge = ridges_[e];
    if (isOnBorder(e)) continue;
    if (edge.wing[0] == kMiddle || edge.wing[1] == kMiddle) ++withMiddleAsWing;
  }
  EXPECT_EQ(foldedInside(), withMiddleAsWing);
  EXPECT_GT(withMiddleAsWing, 0);
}

}  // namespace
}  // namespace cloth_sim
