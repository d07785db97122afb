/// \file Meshes, their validation, and grids.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

// ---- invalid meshes -----------------------------------------------------------------------------

struct BadMesh {
  const char* name;
  std::vector<Vec2> material;
  std::vector<Face> faces;
  const char* message;
};

class InvalidMesh : public testing::TestWithParam<BadMesh> {};

TEST_P(InvalidMesh, IsRefusedAndNamed) {
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
    All, InvalidMesh,
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

// ---- grid ---------------------------------------------------------------------------------------

TEST(Grid, NumbersVerticesRowByRowAndCutsCellsAlongTheRisingDiagonal) {
  const Grid grid{4, 3, 0.6, 0.8};
  const TriangleMesh mesh = makeGridMesh(grid);
  EXPECT_EQ(mesh.vertexCount(), 12);
  EXPECT_EQ(mesh.faceCount(), 2 * 3 * 2);  // two per cell
  EXPECT_EQ(grid.vertex(3, 2), 11);
  EXPECT_LT((mesh.material(grid.vertex(3, 2)) - Vec2(0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(mesh.revision(), 0U);
  EXPECT_EQ(validationError(mesh), "");
  EXPECT_EQ(mesh.facesOnEdge(grid.vertex(0, 0), grid.vertex(1, 1))[1], 1);
  EXPECT_EQ(mesh.facesOnEdge(grid.vertex(1, 0), grid.vertex(0, 1))[0], kNone);
  EXPECT_NEAR(mesh.totalRestArea(), 0.48, 1e-14);
}

TEST(Grid, AlternatesItsDiagonalsIfAsked) {
  const Grid grid{5, 4, 0.6, 0.8, Diagonals::kAlternating};
  const TriangleMesh mesh = makeGridMesh(grid);
  EXPECT_EQ(validationError(mesh), "");
  EXPECT_EQ(mesh.faceCount(), 2 * 4 * 3);
  EXPECT_NEAR(mesh.totalRestArea(), 0.48, 1e-14);
  for (int j = 0; j + 1 < grid.rows; ++j) {
    for (int i = 0; i + 1 < grid.columns; ++i) {
      const bool rises = (i + j) % 2 == 0;
      const FaceId rising = mesh.facesOnEdge(grid.vertex(i, j), grid.vertex(i + 1, j + 1))[0];
      const FaceId falling = mesh.facesOnEdge(grid.vertex(i + 1, j), grid.vertex(i, j + 1))[0];
      EXPECT_EQ(rising != kNone, rises) << i << ", " << j;
      EXPECT_EQ(falling != kNone, !rises) << i << ", " << j;
    }
  }
}

TEST(Grid, HasCellsThatAreTheSameToTheLastBitAlsoBesideOtherCloths) {
  for (const double side : {0.3, 0.7, 1.0, 12.0}) {
    for (const int columns : {2, 4, 50, 128, 1024}) {
      const Grid grid{columns, columns, side, side};
      for (const double offset : {0.0, 2.0 * std::ceil(side)}) {
        for (int i = 1; i < columns; ++i) {
          const double before = offset + grid.material(i - 1, 0).x();
          EXPECT_EQ(offset + grid.material(i, 0).x() - before, grid.spacingU());
        }
      }
      EXPECT_NEAR(grid.material(columns - 1, 0).x(), side, 1e-15 * (columns - 1) * side);
      EXPECT_EQ(grid.material(0, columns - 1).y(), grid.material(columns - 1, 0).x());
    }
  }
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

TEST(Mesh, FindsConnectedComponentsInTheOrderOfTheirFirstFaces) {
  const TriangleMesh mesh({{5, 0}, {6, 0}, {5, 1}, {0, 0}, {1, 0}, {0, 1}, {1, 1}},
                          {{0, 1, 2}, {3, 4, 5}, {5, 4, 6}});
  const ConnectedComponents components = connectedComponents(mesh);
  EXPECT_EQ(components.count, 2);
  EXPECT_THAT(components.ofFace, ElementsAre(0, 1, 1));
}

TEST(Mesh, OriginalBoundaryGoesOnceAround) {
  const TriangleMesh mesh = makeGridMesh({5, 4, 1.0, 1.0});
  int rim = 0;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Face& face = mesh.face(f);
      const bool border = mesh.facesOnEdge(face[k], face[(k + 1) % 3])[1] == kNone;
      EXPECT_EQ(mesh.isOriginalBoundary(f, k), border);
      rim += border ? 1 : 0;
    }
    EXPECT_EQ(mesh.generation(f), 0);
  }
  EXPECT_EQ(rim, 14) << "2 (columns - 1) + 2 (rows - 1)";
}

}  // namespace
}  // namespace cloth_sim
