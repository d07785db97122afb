/// \file Meshes, their defects, grids, and data that follows edits.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

// ---- defects
// -------------------------------------------------------------------------------------

struct BadMesh {
  const char* name;
  std::vector<Vec2> material;
  std::vector<Face> faces;
  const char* message;
};

class MeshDefect : public testing::TestWithParam<BadMesh> {};

TEST_P(MeshDefect, IsRefusedAndNamed) {
  try {
    TriangleMesh mesh(GetParam().material, GetParam().faces);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), GetParam().message);
  }
}

const std::vector<Vec2> kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const std::vector<Vec2> kBowTie{{0, 0}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};

INSTANTIATE_TEST_SUITE_P(
    All, MeshDefect,
    testing::Values(
        BadMesh{
            "NoSuchVertex", kSquare, {{0, 1, 4}}, "face 0 names vertex 4, which does not exist"},
        BadMesh{"NegativeVertex",
                kSquare,
                {{0, 1, 2}, {0, -1, 3}},
                "face 1 names vertex -1, which does not exist"},
        BadMesh{"VertexTwice", kSquare, {{0, 1, 1}}, "face 0 has a vertex twice"},
        BadMesh{"Clockwise", kSquare, {{0, 2, 1}}, "face 0 has no positive rest area"},
        BadMesh{"Degenerate",
                {{0, 0}, {1, 0}, {2, 0}},
                {{0, 1, 2}},
                "face 0 has no positive rest area"},
        BadMesh{"NotANumber",
                {{0, 0}, {1, 0}, {0, std::nan("")}},
                {{0, 1, 2}},
                "face 0 has no positive rest area"},
        BadMesh{"LonelyVertex", kSquare, {{0, 1, 2}}, "vertex 3 has no face"},
        // Two faces that lie over each other on the same side of their common edge.
        BadMesh{"EdgeTwice",
                kSquare,
                {{0, 1, 2}, {0, 1, 3}},
                "edge 0 -> 1 is run through twice in the same direction"},
        BadMesh{
            "BowTie", kBowTie, {{0, 1, 2}, {0, 3, 4}}, "vertex 0 joins faces at a single point"}),
    [](const auto& test) { return std::string(test.param.name); });

// ---- grid
// ----------------------------------------------------------------------------------------

TEST(Grid, NumbersVerticesRowByRowAndCutsCellsAlongTheRisingDiagonal) {
  const Grid grid{4, 3, 0.6, 0.8};
  const TriangleMesh mesh = makeGridMesh(grid);
  EXPECT_EQ(mesh.vertexCount(), 12);
  EXPECT_EQ(mesh.faceCount(), 2 * 3 * 2);  // two per cell
  EXPECT_EQ(grid.vertex(3, 2), 11);
  EXPECT_EQ(mesh.material(grid.vertex(3, 2)), Vec2(3 * (0.6 / 3), 2 * (0.8 / 2)));
  EXPECT_EQ(mesh.revision(), 0U);
  EXPECT_EQ(describeDefect(mesh), "");
  EXPECT_EQ(mesh.facesOnEdge(grid.vertex(0, 0), grid.vertex(1, 1))[1], 1);
  EXPECT_EQ(mesh.facesOnEdge(grid.vertex(1, 0), grid.vertex(0, 1))[0], kNone);
  // A sum of 12 rounded terms.
  EXPECT_NEAR(mesh.totalRestArea(), 0.48, 12 * 0.48 * 1e-16);
}

TEST(Grid, RefusesWhatHasNoCells) {
  EXPECT_THROW(makeGridMesh({1, 5, 1.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(makeGridMesh({5, 1, 1.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(makeGridMesh({5, 5, 0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(makeGridMesh({5, 5, 1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(makeGridMesh({5, 5, std::nan(""), 1.0}), std::invalid_argument);
}

TEST(Mesh, KnowsFacesOnEdgesAndWhatLiesAcross) {
  const TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  EXPECT_THAT(mesh.facesOnEdge(4, 1), UnorderedElementsAre(0, 3));  // inside
  EXPECT_THAT(mesh.facesOnEdge(0, 1), ElementsAre(0, kNone));       // border
  EXPECT_THAT(mesh.facesOnEdge(0, 8), ElementsAre(kNone, kNone));   // no edge
  EXPECT_EQ(mesh.oppositeVertex(0, 0, 1), 4);
  EXPECT_EQ(mesh.oppositeVertex(0, 4, 0), 1);
}

TEST(Mesh, KnowsNeighboursAndBorder) {
  const TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  // Four along the threads and two along the rising diagonal.
  EXPECT_THAT(mesh.neighbours(4), ElementsAre(0, 1, 3, 5, 7, 8));
  EXPECT_THAT(mesh.neighbours(2), ElementsAre(1, 5));
  for (VertexId v = 0; v < 9; ++v) EXPECT_EQ(mesh.isBoundary(v), v != 4) << v;
  EXPECT_THAT(mesh.facesAround(4), ElementsAre(0, 1, 3, 4, 6, 7));
}

TEST(Mesh, EveryVertexOfAManifoldHasOneFan) {
  const TriangleMesh mesh = makeGridMesh({4, 5, 1.0, 1.0});
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_THAT(fansAround(mesh, v), ElementsAre(mesh.facesAround(v)));
  }
}

TEST(Mesh, FindsPiecesInTheOrderOfTheirFirstFaces) {
  const TriangleMesh mesh({{5, 0}, {6, 0}, {5, 1}, {0, 0}, {1, 0}, {0, 1}, {1, 1}},
                          {{0, 1, 2}, {3, 4, 5}, {5, 4, 6}});
  const Pieces pieces = findPieces(mesh);
  EXPECT_EQ(pieces.count, 2);
  EXPECT_THAT(pieces.ofFace, ElementsAre(0, 1, 1));
}

TEST(Mesh, BoundaryEdgesGoOnceAround) {
  // 2 (columns - 1) + 2 (rows - 1).
  EXPECT_EQ(boundaryEdges(makeGridMesh({5, 4, 1.0, 1.0})).size(), 14U);
}

// ---- splitting a vertex
// --------------------------------------------------------------------------

/// Faces around `v` whose middle lies right of v (u greater).
std::vector<FaceId> facesRightOf(const TriangleMesh& mesh, VertexId v) {
  std::vector<FaceId> right;
  for (FaceId f : mesh.facesAround(v)) {
    double u = 0.0;
    for (VertexId w : mesh.face(f)) u += mesh.material(w).x() / 3.0;
    if (u > mesh.material(v).x()) right.push_back(f);
  }
  return right;
}

TEST(SplitVertex, InsideOpensASlitAlongTwoEdges) {
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const double area = mesh.totalRestArea();
  const VertexId v = grid.vertex(2, 2);
  const std::vector<FaceId> right = facesRightOf(mesh, v);
  MeshEditor editor(mesh);
  EXPECT_TRUE(editor.splitVertex(v, right));
  const MeshChanges changes = editor.finish();

  // Both ends of the slit are inside the cloth, so nothing else comes apart.
  ASSERT_EQ(changes.newVertices.size(), 1U);
  EXPECT_EQ(changes.newVertices[0].id, 25);
  EXPECT_THAT(changes.newVertices[0].from, ElementsAre(v, kNone));
  EXPECT_EQ(changes.fromRevision, 0U);
  EXPECT_EQ(changes.toRevision, 1U);
  EXPECT_EQ(mesh.revision(), 1U);
  EXPECT_EQ(changes.changedFaces, right);
  EXPECT_EQ(mesh.facesAround(25), right);
  EXPECT_EQ(mesh.material(25), mesh.material(v));
  EXPECT_TRUE(mesh.isBoundary(v));
  EXPECT_TRUE(mesh.isBoundary(25));
  EXPECT_FALSE(mesh.isBoundary(grid.vertex(3, 3)));
  EXPECT_EQ(describeDefect(mesh), "");
  EXPECT_EQ(mesh.totalRestArea(), area);  // the same faces, with the same corners
  EXPECT_TRUE(std::is_sorted(changes.touched.begin(), changes.touched.end()));
  for (FaceId f : right) {
    for (VertexId w : mesh.face(f)) {
      EXPECT_TRUE(std::binary_search(changes.touched.begin(), changes.touched.end(), w));
    }
  }
  EXPECT_TRUE(std::binary_search(changes.touched.begin(), changes.touched.end(), v));
}

TEST(SplitVertex, AtTheBorderOpensANotch) {
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const VertexId v = grid.vertex(2, 0);
  MeshEditor editor(mesh);
  EXPECT_TRUE(editor.splitVertex(v, facesRightOf(mesh, v)));
  EXPECT_EQ(editor.finish().newVertices.size(), 1U);
  EXPECT_EQ(describeDefect(mesh), "");
  EXPECT_TRUE(mesh.isBoundary(grid.vertex(2, 1))) << "the tip of the notch is on the border now";
  EXPECT_EQ(findPieces(mesh).count, 1);
}

TEST(SplitVertex, SplitsTheEndsOfTheSlitThatReachTheBorder) {
  // In 3 x 3 the slit through the middle reaches both borders: their vertices would be bow-ties.
  TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  MeshEditor editor(mesh);
  EXPECT_TRUE(editor.splitVertex(4, facesRightOf(mesh, 4)));
  const MeshChanges changes = editor.finish();
  std::vector<VertexId> sources;
  for (const NewVertex& added : changes.newVertices) sources.push_back(added.from[0]);
  EXPECT_THAT(sources, UnorderedElementsAre(4, 1, 7));
  EXPECT_EQ(describeDefect(mesh), "");
  EXPECT_THAT(testing_support::pieceAreas(mesh), ElementsAre(0.5, 0.5));
}

TEST(SplitVertex, ScatteredFacesEachGetTheirOwnCopy) {
  // The six faces around an inner vertex are 6, 7, 8, 15, 16, 17 on this grid; every other one in
  // the circle lets go. Left behind are three single faces, too: six fans, so five copies.
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const VertexId v = grid.vertex(2, 2);
  std::vector<FaceId> circle{mesh.facesAround(v)[0]};
  while (circle.size() < 6) {
    for (FaceId f : mesh.facesAround(v)) {
      const bool taken = std::find(circle.begin(), circle.end(), f) != circle.end();
      int shared = 0;
      for (VertexId w : mesh.face(f)) {
        for (VertexId x : mesh.face(circle.back())) shared += w == x ? 1 : 0;
      }
      if (!taken && shared == 2) {
        circle.push_back(f);
        break;
      }
    }
  }
  MeshEditor editor(mesh);
  EXPECT_TRUE(editor.splitVertex(v, {circle[0], circle[2], circle[4]}));
  EXPECT_EQ(editor.finish().newVertices.size(), 5U);
  EXPECT_EQ(mesh.facesAround(v).size(), 1U);
  EXPECT_EQ(describeDefect(mesh), "");
  EXPECT_EQ(findPieces(mesh).count, 1) << "the faces still hold together at their outer vertices";
}

TEST(SplitVertex, DoesNothingForNoneOrAllOfTheFaces) {
  TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  MeshEditor editor(mesh);
  EXPECT_FALSE(editor.splitVertex(4, {}));
  EXPECT_FALSE(editor.splitVertex(4, mesh.facesAround(4)));
  EXPECT_FALSE(editor.splitVertex(2, mesh.facesAround(2)));
  const MeshChanges changes = editor.finish();
  EXPECT_TRUE(changes.empty());
  EXPECT_TRUE(changes.changedFaces.empty());
  EXPECT_EQ(mesh.revision(), 0U);
  EXPECT_EQ(mesh.vertexCount(), 9);
}

TEST(MeshEditor, GivesTheChangesSinceTheLastFinish) {
  const Grid grid{7, 7, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  MeshEditor editor(mesh);
  editor.splitVertex(grid.vertex(2, 2), facesRightOf(mesh, grid.vertex(2, 2)));
  editor.finish();
  editor.splitVertex(grid.vertex(3, 4), facesRightOf(mesh, grid.vertex(3, 4)));
  const MeshChanges second = editor.finish();
  EXPECT_EQ(second.fromRevision, 1U);
  EXPECT_EQ(second.toRevision, 2U);
  ASSERT_EQ(second.newVertices.size(), 1U);
  EXPECT_EQ(second.newVertices[0].id, 50);
  EXPECT_TRUE(editor.finish().empty());
}

// ---- data that follows
// ---------------------------------------------------------------------------

MeshChanges changesOf(std::vector<NewVertex> added) {
  MeshChanges changes;
  changes.fromRevision = 3;
  changes.toRevision = 4;
  changes.newVertices = std::move(added);
  return changes;
}

TEST(VertexData, CopiesForSplitVerticesAndBlendsForNewOnes) {
  VertexData<double> data(std::vector<double>{1.0, 10.0}, 3);
  data.follow(changesOf({{2, {1, kNone}, {1.0, 0.0}}, {3, {0, 2}, {0.25, 0.75}}}));
  EXPECT_THAT(data.values(), ElementsAre(1.0, 10.0, 10.0, 0.25 * 1.0 + 0.75 * 10.0));
  EXPECT_EQ(data.revision(), 4U);
}

TEST(VertexData, RefusesChangesFromAnotherRevision) {
  VertexData<double> behind(std::vector<double>{1.0}, 2);
  EXPECT_THROW(behind.follow(changesOf({})), std::logic_error);
  VertexData<double> twice(std::vector<double>{1.0}, 3);
  twice.follow(changesOf({{1, {0, kNone}, {1.0, 0.0}}}));
  EXPECT_THROW(twice.follow(changesOf({{1, {0, kNone}, {1.0, 0.0}}})), std::logic_error);
  EXPECT_EQ(twice.size(), 2U) << "a refused change leaves no rows behind";
}

}  // namespace
}  // namespace cloth_sim
