/// \file Edits within limits of quality, and bisection.

#include "cloth_sim/surgery/remesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/sound_mesh.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

constexpr double kDegree = M_PI / 180.0;

/// A grid of spacing 1. Faces 2c and 2c + 1 are to the right of and above the diagonal of cell c:
///
///     6 - 7 - 8
///     | / | / |
///     3 - 4 - 5
///     | / | / |
///     0 - 1 - 2
TriangleMesh threeByThree() { return makeGridMesh({3, 3, 2.0, 2.0}); }

ShapeLimits shortestOf(double minEdge) {
  ShapeLimits limits;
  limits.minEdge = minEdge;
  return limits;
}

// ---- what is allowed ----------------------------------------------------------------------------

TEST(AngleIfSplit, IsTheSmallestOfTheHalves) {
  TriangleMesh mesh = threeByThree();
  const Remesher remesher(mesh, {}, {});
  // The diagonal 0-4 at its middle: four right-angled halves.
  EXPECT_NEAR(remesher.angleIfSplit(0, 4, Vec2(0.5, 0.5)), 45.0 * kDegree, 1e-15);
  // 1-4 at t: seen from 5, what is below it spans 45 degrees - atan(1 - t).
  EXPECT_NEAR(remesher.angleIfSplit(1, 4, Vec2(1.0, 0.17)), M_PI / 4 - std::atan(0.83), 1e-14);
  EXPECT_NEAR(remesher.angleIfSplit(4, 1, Vec2(1.0, 0.17)), M_PI / 4 - std::atan(0.83), 1e-14);
  // A border edge at 0.3: seen from 4, the part right of it spans atan(0.7), the left one the rest.
  EXPECT_NEAR(remesher.angleIfSplit(0, 1, Vec2(0.3, 0.0)), M_PI / 4 - std::atan(0.7), 1e-14);
}

TEST(AngleIfSplit, RefusesSlivers) {
  TriangleMesh mesh = threeByThree();
  const Remesher remesher(mesh, {}, {});
  // 45 degrees - atan(1 - t) = 5 degrees at t = 1 - tan(40 degrees) = 0.1609.
  EXPECT_LT(remesher.angleIfSplit(1, 4, Vec2(1.0, 0.160)), 0.0);
  EXPECT_GT(remesher.angleIfSplit(1, 4, Vec2(1.0, 0.162)), 0.0);
  // Beside the edge, past the vertex across it: the face would be turned over.
  EXPECT_LT(remesher.angleIfSplit(1, 4, Vec2(-0.2, 0.5)), 0.0);
}

TEST(AngleIfSplit, RefusesShortEdges) {
  TriangleMesh mesh = threeByThree();
  EXPECT_GT(Remesher(mesh, shortestOf(0.2499), {}).angleIfSplit(1, 4, Vec2(1.0, 0.25)), 0.0);
  EXPECT_LT(Remesher(mesh, shortestOf(0.2501), {}).angleIfSplit(1, 4, Vec2(1.0, 0.25)), 0.0);
  EXPECT_LT(Remesher(mesh, shortestOf(0.2501), {}).angleIfSplit(1, 4, Vec2(1.0, 0.75)), 0.0);
  // The edge to the vertex across counts, too: it is half of the diagonal here.
  EXPECT_GT(Remesher(mesh, shortestOf(0.7071), {}).angleIfSplit(0, 4, Vec2(0.5, 0.5)), 0.0);
  EXPECT_LT(Remesher(mesh, shortestOf(0.7072), {}).angleIfSplit(0, 4, Vec2(0.5, 0.5)), 0.0);
}

TEST(AngleIfSplitFace, IsTheSmallestOfTheThree) {
  TriangleMesh mesh = threeByThree();
  const Remesher remesher(mesh, {}, {});
  // The centre of 0, 1, 4: from 0 the border edge is seen under atan(1/2).
  const Vec2 centre(2.0 / 3.0, 1.0 / 3.0);
  const double expected = M_PI / 4 - std::atan(0.5);  // to the other side, by symmetry at 4, too
  EXPECT_NEAR(remesher.angleIfSplit(0, centre), expected, 1e-14);
  EXPECT_LT(remesher.angleIfSplit(0, Vec2(0.5, 0.01)), 0.0) << "flat above the border";
  EXPECT_LT(remesher.angleIfSplit(0, Vec2(0.5, 0.6)), 0.0) << "outside";
  EXPECT_LT(Remesher(mesh, shortestOf(0.48), {}).angleIfSplit(0, centre), 0.0) << "0.471 from 1";
}

TEST(AngleIfMoved, InsideTheFacesAround) {
  TriangleMesh mesh = threeByThree();
  const Remesher remesher(mesh, {}, {});
  EXPECT_NEAR(remesher.angleIfMoved(4, Vec2(1.0, 1.0)), 45.0 * kDegree, 1e-14);
  // Towards 8 by 0.5: from 8 to 5 and from 5 back there are atan(0.5 / 0.5) and atan(0.5 / 0.5);
  // the sharpest angle is at 0 and 3, 0-4-3 having its top at (1.5, 1.5): 45 degrees at 0, and at
  // the corner (1.5, 1.5) the angle between (-1.5, -1.5) and (-1.5, -0.5).
  EXPECT_NEAR(remesher.angleIfMoved(4, Vec2(1.5, 1.5)), M_PI / 4 - std::atan(1.0 / 3.0), 1e-14);
  EXPECT_LT(remesher.angleIfMoved(4, Vec2(1.95, 1.95)), 0.0) << "a sliver";
  EXPECT_LT(remesher.angleIfMoved(4, Vec2(2.5, 1.0)), 0.0) << "turns faces over";
  EXPECT_LT(Remesher(mesh, shortestOf(0.71), {}).angleIfMoved(4, Vec2(1.5, 1.5)), 0.0);
  EXPECT_GT(Remesher(mesh, shortestOf(0.70), {}).angleIfMoved(4, Vec2(1.5, 1.5)), 0.0);
}

TEST(AngleIfMoved, RefusesHeldAndMarkedOnes) {
  TriangleMesh mesh = makeGridMesh({4, 4, 3.0, 3.0});
  Remesher remesher(mesh, {}, {5});
  EXPECT_LT(remesher.angleIfMoved(5, Vec2(1.1, 1.1)), 0.0) << "held from the start";
  EXPECT_GT(remesher.angleIfMoved(10, Vec2(2.1, 2.1)), 0.0);
  remesher.hold(10);
  EXPECT_LT(remesher.angleIfMoved(10, Vec2(2.1, 2.1)), 0.0);
  EXPECT_GT(remesher.angleIfMoved(6, Vec2(2.1, 1.1)), 0.0);
  EXPECT_GT(remesher.angleIfMoved(9, Vec2(1.1, 2.1)), 0.0);
  remesher.mark(6, 9);
  EXPECT_LT(remesher.angleIfMoved(6, Vec2(2.1, 1.1)), 0.0);
  EXPECT_LT(remesher.angleIfMoved(9, Vec2(1.1, 2.1)), 0.0);
}

TEST(AngleIfMoved, AtABorderOnlyAlongIt) {
  TriangleMesh mesh = threeByThree();
  const Remesher remesher(mesh, {}, {});
  EXPECT_GT(remesher.angleIfMoved(1, Vec2(1.2, 0.0)), 0.0);
  EXPECT_GT(remesher.angleIfMoved(1, Vec2(0.8, 0.0)), 0.0);
  EXPECT_LT(remesher.angleIfMoved(1, Vec2(1.0, 0.2)), 0.0);
  EXPECT_LT(remesher.angleIfMoved(1, Vec2(1.2, 1e-9)), 0.0);
  EXPECT_GT(remesher.angleIfMoved(5, Vec2(2.0, 1.2)), 0.0);
  for (VertexId corner : {0, 2, 6, 8}) {
    for (const Vec2& d : {Vec2(0.2, 0.0), Vec2(0.0, 0.2), Vec2(-0.2, 0.0), Vec2(0.0, -0.2)}) {
      EXPECT_LT(remesher.angleIfMoved(corner, mesh.material(corner) + d), 0.0);
    }
  }
}

TEST(AngleIfMoved, RefusesTheMouthOfANotch) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  ASSERT_TRUE(editor.splitVertex(1, {2, 3}));
  editor.finish();
  const Remesher remesher(mesh, {}, {});
  for (VertexId v : {1, 9}) {
    EXPECT_LT(remesher.angleIfMoved(v, Vec2(1.1, 0.0)), 0.0);
    EXPECT_LT(remesher.angleIfMoved(v, Vec2(0.9, 0.0)), 0.0);
    EXPECT_LT(remesher.angleIfMoved(v, Vec2(1.0, 0.1)), 0.0);
  }
}

// ---- doing it -----------------------------------------------------------------------------------

TEST(Remesher, SplitsOnAnEdgeAndBesideIt) {
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {});
  EXPECT_EQ(remesher.splitEdge(1, 4, Vec2(1.0, 0.375)), 9);
  EXPECT_EQ(mesh.material(9), Vec2(1.0, 0.375));
  EXPECT_EQ(remesher.edits().size(), 1U) << "on the edge there is nothing to move";
  EXPECT_EQ(remesher.splitEdge(4, 7, Vec2(1.1, 1.5)), 10);
  EXPECT_LT((mesh.material(10) - Vec2(1.1, 1.5)).norm(), 1e-15);
  EXPECT_FALSE(remesher.finish().empty());
  expectSound(mesh, 4.0);
}

TEST(Remesher, MovesAndSplitsFacesToWhereItIsTold) {
  Generator random(1);
  for (int trial = 0; trial < 100; ++trial) {
    TriangleMesh mesh = irregularMesh({5, 5, 1.0, 1.0}, 0.25, random);
    Remesher remesher(mesh, {}, {});
    const FaceId f = whole(random, 0, mesh.faceCount() - 1);
    const Vec2 at = pointIn(mesh, f, randomWeights(random, 0.05));
    const VertexId v = mesh.face(f)[0];
    const double moved = remesher.angleIfMoved(v, at);
    const double split = remesher.angleIfSplit(f, at);
    if (moved > split) {
      remesher.moveVertex(v, at);
      EXPECT_LT((mesh.material(v) - at).norm(), 1e-15);
      for (FaceId g : mesh.facesAround(v)) EXPECT_GE(minAngle(mesh, g), moved - 1e-12);
    } else if (split > 0.0) {
      const VertexId middle = remesher.splitFace(f, at);
      EXPECT_LT((mesh.material(middle) - at).norm(), 1e-15);
      for (FaceId g : mesh.facesAround(middle)) EXPECT_GE(minAngle(mesh, g), split - 1e-12);
    }
    remesher.finish();
    expectSound(mesh, 1.0);
  }
}

TEST(Remesher, PartsOfAMarkedEdgeAreMarked) {
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {});
  remesher.mark(4, 1);
  EXPECT_TRUE(remesher.isMarked(1, 4));
  const VertexId v = remesher.splitEdge(1, 4, Vec2(1.0, 0.5));
  EXPECT_THAT(remesher.marks(), UnorderedElementsAre(EdgeKey{1, v}, EdgeKey{4, v}));
  EXPECT_LT(remesher.angleIfMoved(v, Vec2(1.05, 0.5)), 0.0) << "the new vertex is on a mark";
  remesher.splitEdge(4, 7, Vec2(1.0, 1.5));
  EXPECT_EQ(remesher.marks().size(), 2U);
}

TEST(Remesher, WhatIsMadeBetweenHeldVerticesIsHeld) {
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {0, 1, 4});
  const VertexId onEdge = remesher.splitEdge(1, 4, Vec2(1.0, 0.5));
  EXPECT_LT(remesher.angleIfMoved(onEdge, Vec2(1.05, 0.5)), 0.0);
  const VertexId free = remesher.splitEdge(4, 7, Vec2(1.0, 1.5));
  EXPECT_GT(remesher.angleIfMoved(free, Vec2(1.05, 1.5)), 0.0);
  TriangleMesh other = threeByThree();
  Remesher second(other, {}, {0, 1, 4});
  const VertexId inFace = second.splitFace(0, Vec2(0.6, 0.3));
  EXPECT_LT(second.angleIfMoved(inFace, Vec2(0.65, 0.3)), 0.0);
}

// ---- bisection ----------------------------------------------------------------------------------

TEST(Bisect, HalvesAFaceAndItsNeighbourAtTheLongestEdge) {
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {});
  EXPECT_TRUE(remesher.bisect(0));
  EXPECT_EQ(mesh.vertexCount(), 10);
  EXPECT_EQ(mesh.material(9), Vec2(0.5, 0.5));
  EXPECT_EQ(mesh.faceCount(), 10);
  EXPECT_THAT(mesh.facesAround(9), ElementsAre(0, 1, 8, 9));
  for (FaceId f = 0; f < 10; ++f) {
    EXPECT_EQ(mesh.generation(f), f < 2 || f > 7 ? 1 : 0);
    EXPECT_EQ(mesh.restArea(f), f < 2 || f > 7 ? 0.25 : 0.5);
  }
  // At a border the face is alone.
  const FaceId below = mesh.facesOnEdge(0, 1)[0];
  EXPECT_TRUE(remesher.bisect(below));
  EXPECT_EQ(mesh.faceCount(), 11);
  EXPECT_EQ(mesh.generation(below), 2);
  remesher.finish();
  expectSound(mesh, 4.0);
  EXPECT_TRUE(isConforming(mesh));
}

TEST(Bisect, HalvesOthersThatMustComeFirst) {
  // Face 0 is halved first, over 0-4. To halve what is now right of 9 over 1-4, face 3 beyond that
  // edge has to be halved at its own longest edge 1-5 before, together with face 2.
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {});
  ASSERT_TRUE(remesher.bisect(0));
  const auto on = mesh.facesOnEdge(1, 4);
  const FaceId right = mesh.oppositeVertex(on[0], 1, 4) == 9 ? on[0] : on[1];
  EXPECT_TRUE(remesher.bisect(right));
  EXPECT_EQ(mesh.facesOnEdge(1, 5)[0], kNone);
  EXPECT_EQ(mesh.facesOnEdge(1, 4)[0], kNone);
  EXPECT_EQ(mesh.vertexCount(), 12);
  EXPECT_TRUE(isConforming(mesh));
  EXPECT_EQ(mesh.generation(right), 2);
}

TEST(Bisect, OfARightAngledGridKeepsItsAnglesAndHalvesAreas) {
  Generator random(2);
  for (int sequence = 0; sequence < 10; ++sequence) {
    const Grid grid{whole(random, 2, 5), whole(random, 2, 5), 0.0, 0.0};
    const double h = 0.25;
    const Grid square{grid.columns, grid.rows, h * (grid.columns - 1), h * (grid.rows - 1)};
    TriangleMesh mesh = makeGridMesh(square);
    const double area = preciseArea(mesh);
    Remesher remesher(mesh, {}, {});
    for (int k = 0; k < 80; ++k) {
      ASSERT_TRUE(remesher.bisect(whole(random, 0, mesh.faceCount() - 1)));
      ASSERT_TRUE(isConforming(mesh));
    }
    remesher.finish();
    expectSound(mesh, area);
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      // The others are 45 and 90 degrees then: half of the square over its legs.
      EXPECT_NEAR(minAngle(mesh, f), 45.0 * kDegree, 1e-12);
      const double expected = 0.5 * h * h * std::exp2(-mesh.generation(f));
      EXPECT_NEAR(mesh.restArea(f), expected, 1e-12 * expected);
    }
  }
}

TEST(Bisect, OfIrregularMeshesKeepsHalfOfTheSmallestAngle) {
  // Rosenberg and Stenger (1975).
  Generator random(3);
  for (int sequence = 0; sequence < 30; ++sequence) {
    TriangleMesh mesh = irregularMesh({6, 6, 1.0, uniform(random, 0.6, 1.6)}, 0.25, random);
    const double area = preciseArea(mesh);
    const double smallest = smallestAngle(mesh);
    ShapeLimits limits;
    limits.minAngle = 0.0;
    Remesher remesher(mesh, limits, {});
    for (int k = 0; k < 60; ++k) {
      const FaceId f = whole(random, 0, mesh.faceCount() - 1);
      const int faces = mesh.faceCount();
      const int generation = mesh.generation(f);
      ASSERT_TRUE(remesher.bisect(f)) << "sequence " << sequence << ", bisection " << k;
      EXPECT_GT(mesh.faceCount(), faces);
      EXPECT_GT(mesh.generation(f), generation);
      ASSERT_TRUE(isConforming(mesh));
    }
    remesher.finish();
    expectSound(mesh, area);
    EXPECT_GE(smallestAngle(mesh), 0.5 * smallest - 1e-12);
  }
}

TEST(Bisect, EndsWhereTheLimitsForbidIt) {
  TriangleMesh mesh = threeByThree();
  // Halves of the diagonal are 0.707 long, those of the legs 0.5.
  Remesher remesher(mesh, shortestOf(0.6), {});
  EXPECT_TRUE(remesher.bisect(0));
  EXPECT_FALSE(remesher.bisect(0));
  EXPECT_GE(shortestEdge(mesh), 0.6);
  remesher.finish();
  expectSound(mesh, 4.0);
  EXPECT_TRUE(isConforming(mesh));
}

TEST(Bisect, MarksGoOnOverHalves) {
  TriangleMesh mesh = threeByThree();
  Remesher remesher(mesh, {}, {});
  remesher.mark(0, 4);
  remesher.mark(4, 8);
  for (FaceId f = 0; f < 8; ++f) EXPECT_TRUE(remesher.bisect(f));
  remesher.openMarkedEdges();
  remesher.finish();
  expectSound(mesh, 4.0);
  EXPECT_THAT(pieceAreas(mesh), ElementsAre(2.0, 2.0));
}

// ---- improving ----------------------------------------------------------------------------------

TEST(Improve, FlipsTheDiagonalThatMakesBadAngles) {
  // A flat rhombus along its long diagonal, whose border is split: from 2 that half of the border
  // is seen under atan(0.15 / 1.5), less than six degrees.
  TriangleMesh mesh({{-1.0, 0.0}, {0.0, -0.3}, {1.0, 0.0}, {0.0, 0.3}}, {{0, 1, 2}, {0, 2, 3}});
  Remesher remesher(mesh, {}, {});
  remesher.splitEdge(0, 1, Vec2(-0.5, -0.15));
  EXPECT_NEAR(smallestAngle(mesh), std::atan(0.1), 1e-14);
  remesher.improveAngles();
  remesher.finish();
  expectSound(mesh, 0.6);
  EXPECT_GT(smallestAngle(mesh), 10.0 * kDegree);
  EXPECT_EQ(mesh.facesOnEdge(0, 2)[0], kNone);
}

TEST(Improve, MakesNothingWorseAndKeepsMarks) {
  Generator random(4);
  for (int sequence = 0; sequence < 30; ++sequence) {
    TriangleMesh mesh = irregularMesh({6, 6, 1.0, 1.0}, 0.25, random);
    Remesher remesher(mesh, {}, {});
    for (int k = 0; k < 25; ++k) {
      const FaceId f = whole(random, 0, mesh.faceCount() - 1);
      const Face face = mesh.face(f);
      const Vec2 at = pointIn(mesh, f, randomWeights(random, 0.1));
      if (remesher.angleIfSplit(f, at) > 0.0) remesher.splitFace(f, at);
      const Vec2 middle = 0.5 * (mesh.material(face[0]) + mesh.material(face[1]));
      const bool isEdge = mesh.facesOnEdge(face[0], face[1])[0] != kNone;
      if (isEdge && remesher.angleIfSplit(face[0], face[1], middle) > 0.0) {
        remesher.splitEdge(face[0], face[1], middle);
      }
      if (k % 5 == 0) remesher.mark(face[1], face[2]);
    }
    const double smallest = smallestAngle(mesh);
    const int faces = mesh.faceCount();
    const std::set<EdgeKey> marks = remesher.marks();
    remesher.improveAngles();
    EXPECT_EQ(remesher.marks(), marks);
    for (const EdgeKey& edge : marks) EXPECT_NE(mesh.facesOnEdge(edge[0], edge[1])[0], kNone);
    EXPECT_EQ(mesh.faceCount(), faces);
    EXPECT_GE(smallestAngle(mesh), smallest - 1e-12);
    remesher.finish();
    expectSound(mesh, 1.0);
  }
}

}  // namespace
}  // namespace cloth_sim
