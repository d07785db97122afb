/// \file The search for pairs of faces that may touch.

#include "contact/material_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "layer_support.h"

namespace cloth_sim {
namespace {

TEST(GradientBall, GrowsToContainBoth) {
  RandomPoints random(6);
  for (int k = 0; k < 200; ++k) {
    GradientBall a, b;
    a.centre = {random.point(), random.point()};
    b.centre = {random.point(), random.point()};
    a.radius = std::abs(random.number());
    b.radius = std::abs(random.number());
    GradientBall both = a;
    both.add(b);
    EXPECT_LE((both.centre - a.centre).norm() + a.radius, both.radius + 1e-12);
    EXPECT_LE((both.centre - b.centre).norm() + b.radius, both.radius + 1e-12);
  }
}

/// Boxes and gradients of the faces of a cloth.
struct FaceBounds {
  std::vector<QuickBox> boxes;
  std::vector<GradientBall> balls;
};

FaceBounds boundsOf(const Model& model, const State& state) {
  FaceBounds bounds;
  for (const Face& face : model.mesh.faces()) {
    Box box;
    for (const VertexId v : face) box.add({state.x[v], state.x[v]});
    bounds.boxes.emplace_back(box);
    GradientBall ball;
    ball.centre =
        Gradient::of(state.x[face[1]] - state.x[face[0]], state.x[face[2]] - state.x[face[0]],
                     inverseRestOf(model.mesh, face));
    ball.radius = 0.05;
    bounds.balls.push_back(ball);
  }
  return bounds;
}

std::vector<FaceId> allFaces(const Model& model) {
  std::vector<FaceId> faces(static_cast<std::size_t>(model.mesh.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

std::vector<FaceIds> searchPairs(const Model& model, const FaceBounds& bounds) {
  MaterialTree tree;
  tree.build(model, allFaces(model));
  tree.refit(bounds.boxes, bounds.balls);
  std::vector<FaceIds> pairs;
  tree.collectOwn({bounds.boxes, pairs});
  return pairs;
}

std::vector<FaceIds> searchPairs(const Model& model, const State& state) {
  return searchPairs(model, boundsOf(model, state));
}

TEST(MaterialTree, FindsEveryPairThatMeetsAndNoneInASmoothSheet) {
  const Model model = buildModel(cottonSheet(21));
  EXPECT_TRUE(searchPairs(model, rolled(model, 10.0, 0.0)).empty()) << "nearly flat";
  EXPECT_LT(searchPairs(model, rolled(model, 0.3, 0.0)).size(), 500U) << "half a turn";
  int meeting = 0;
  for (const double radius : {0.05, 0.08, 0.11}) {
    const State state = rolled(model, radius, -0.006);
    std::set<std::pair<FaceId, FaceId>> listed;
    for (const FaceIds& pair : searchPairs(model, state)) {
      EXPECT_LT(pair.first, pair.second);
      EXPECT_TRUE(listed.insert({pair.first, pair.second}).second) << "listed twice";
    }
    const std::vector<Face>& faces = model.mesh.faces();
    for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
      for (FaceId g = f + 1; g < model.mesh.faceCount(); ++g) {
        if (!meet(faces[f], faces[g], state.x.values())) continue;
        ++meeting;
        EXPECT_EQ(listed.count({f, g}), 1U) << f << ' ' << g;
      }
    }
  }
  EXPECT_GT(meeting, 20);
}

/// A tree that is searched around changed faces again and again, and all pairs that it has found.
class RepeatedSearch {
 public:
  RepeatedSearch(const Model& model, const FaceBounds& bounds) : model_(model), bounds_(bounds) {
    tree_.build(model, allFaces(model));
    tree_.refit(bounds.boxes, bounds.balls);
    collect();
  }
  void searchAround(const std::vector<FaceId>& changed) {
    tree_.refit(changed, bounds_.boxes, bounds_.balls);
    collect();
  }
  /// Tells whether it has found whatever a search of all faces finds now.
  bool isComplete() const {
    const std::vector<FaceIds> all = searchPairs(model_, bounds_);
    return std::all_of(all.begin(), all.end(), [this](const FaceIds& pair) {
      return found_.count({pair.first, pair.second}) == 1;
    });
  }
  std::size_t count() const { return found_.size(); }

 private:
  void collect() {
    std::vector<FaceIds> pairs;
    tree_.collectOwn({bounds_.boxes, pairs});
    for (const FaceIds& pair : pairs) found_.insert({pair.first, pair.second});
  }

  const Model& model_;
  const FaceBounds& bounds_;
  MaterialTree tree_;
  std::set<std::pair<FaceId, FaceId>> found_;
};

FaceId randomFace(const Model& model, RandomPoints& random) {
  return static_cast<FaceId>(std::abs(random.number()) * 0.999 *
                             static_cast<double>(model.mesh.faceCount()));
}

TEST(MaterialTree, ASearchAroundChangedFacesMissesNothing) {
  const Model model = buildModel(cottonSheet(21));
  RandomPoints random(9);
  FaceBounds bounds = boundsOf(model, rolled(model, 0.11, -0.006));
  RepeatedSearch search(model, bounds);
  for (int round = 0; round < 60; ++round) {
    ASSERT_TRUE(search.isComplete()) << "round " << round;
    std::vector<FaceId> changed;
    for (int k = 0; k <= round % 5; ++k) {
      const FaceId f = randomFace(model, random);
      const Vec3 at = 0.5 * random.point();
      bounds.boxes[f].add(QuickBox({at, at}));
      bounds.balls[f].radius = std::abs(random.number());
      changed.push_back(f);
    }
    search.searchAround(changed);
  }
  EXPECT_GT(search.count(), 500U);
}

/// A pair of nodes may be ruled out by a square with other nodes in it. If these change, the pair
/// has to be looked at, though neither it nor anything above it has changed.
TEST(MaterialTree, ASearchAroundChangedFacesMissesNothingThatOthersHadRuledOut) {
  const Model model = buildModel(cottonSheet(7));
  const auto faces = static_cast<std::size_t>(model.mesh.faceCount());
  RandomPoints random(11);
  const auto randomBall = [&] {
    return GradientBall{
        {Vec3::UnitX() + 0.45 * random.point(), Vec3::UnitY() + 0.45 * random.point()}, 0.02};
  };
  const QuickBox everywhere({Vec3::Constant(-1.0), Vec3::Constant(1.0)});
  for (int cloth = 0; cloth < 20; ++cloth) {
    FaceBounds bounds{std::vector<QuickBox>(faces, everywhere), {}};
    for (std::size_t f = 0; f < faces; ++f) bounds.balls.push_back(randomBall());
    RepeatedSearch search(model, bounds);
    for (int round = 0; round < 30; ++round) {
      ASSERT_TRUE(search.isComplete()) << "cloth " << cloth << ", round " << round;
      const FaceId f = randomFace(model, random);
      bounds.balls[f] = randomBall();
      search.searchAround({f});
    }
    EXPECT_GT(search.count(), 500U);
  }
}

TEST(MaterialTree, ASearchEndsWhenThereAreEnoughPairs) {
  const Model model = buildModel(cottonSheet(21));
  FaceBounds bounds = boundsOf(model, rolled(model, 0.11, -0.006));
  for (GradientBall& ball : bounds.balls) ball.radius = 2.0;  // nothing is proven
  const std::vector<FaceIds> all = searchPairs(model, bounds);
  MaterialTree tree;
  tree.build(model, allFaces(model));
  tree.refit(bounds.boxes, bounds.balls);
  std::vector<FaceIds> pairs;
  tree.collectOwn({bounds.boxes, pairs, 20});
  ASSERT_GT(pairs.size(), 20U);
  ASSERT_LT(pairs.size(), 40U);
  ASSERT_GT(all.size(), 40U);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    EXPECT_EQ(pairs[k].first, all[k].first);
    EXPECT_EQ(pairs[k].second, all[k].second);
  }
}

}  // namespace
}  // namespace cloth_sim
