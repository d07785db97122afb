/// \file Edits of meshes, and data per vertex that follows them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "unit/sound_mesh.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

// ---- splitting a vertex -------------------------------------------------------------------------

/// Returns the faces around `v` with a centroid of larger u.
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
  ASSERT_EQ(changes.vertices.size(), 1U);
  EXPECT_EQ(changes.vertices[0].kind, VertexEdit::Kind::kCopy);
  EXPECT_EQ(changes.vertices[0].id, 25);
  EXPECT_THAT(changes.vertices[0].from, ElementsAre(v, kNone, kNone));
  EXPECT_EQ(changes.fromRevision, 0U);
  EXPECT_EQ(changes.toRevision, 1U);
  EXPECT_EQ(mesh.revision(), 1U);
  EXPECT_EQ(changes.changedFaces, right);
  EXPECT_THAT(changes.reshapedFaces, IsEmpty());
  EXPECT_EQ(mesh.facesAround(25), right);
  EXPECT_EQ(mesh.material(25), mesh.material(v));
  EXPECT_TRUE(mesh.isBoundary(v));
  EXPECT_TRUE(mesh.isBoundary(25));
  EXPECT_FALSE(mesh.isBoundary(grid.vertex(3, 3)));
  EXPECT_EQ(validationError(mesh), "");
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
  EXPECT_EQ(editor.finish().vertices.size(), 1U);
  EXPECT_EQ(validationError(mesh), "");
  EXPECT_TRUE(mesh.isBoundary(grid.vertex(2, 1))) << "the tip of the notch is on the border now";
  EXPECT_EQ(connectedComponents(mesh).count, 1);
}

TEST(SplitVertex, SplitsTheEndsOfTheSlitThatReachTheBorder) {
  // In 3 x 3 the slit through the middle reaches both borders: their vertices would be bow-ties.
  TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  MeshEditor editor(mesh);
  EXPECT_TRUE(editor.splitVertex(4, facesRightOf(mesh, 4)));
  const MeshChanges changes = editor.finish();
  std::vector<VertexId> sources;
  for (const VertexEdit& added : changes.vertices) sources.push_back(added.from[0]);
  EXPECT_THAT(sources, UnorderedElementsAre(4, 1, 7));
  EXPECT_EQ(validationError(mesh), "");
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
  EXPECT_EQ(editor.finish().vertices.size(), 5U);
  EXPECT_EQ(mesh.facesAround(v).size(), 1U);
  EXPECT_EQ(validationError(mesh), "");
  EXPECT_EQ(connectedComponents(mesh).count, 1)
      << "the faces still hold together at their outer vertices";
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
  ASSERT_EQ(second.vertices.size(), 1U);
  EXPECT_EQ(second.vertices[0].id, 50);
  EXPECT_TRUE(editor.finish().empty());
}

// ---- edits that change shapes -------------------------------------------------------------------

/// A grid of spacing 1. Faces 2c and 2c + 1 are to the right of and above the diagonal of cell c.
TriangleMesh threeByThree() { return makeGridMesh({3, 3, 2.0, 2.0}); }

/// Rotates the corners of a face so that the smallest one comes first.
Face turned(Face face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

std::vector<Face> turnedFaces(const TriangleMesh& mesh, const std::vector<FaceId>& which) {
  std::vector<Face> faces;
  for (FaceId f : which) faces.push_back(turned(mesh.face(f)));
  return faces;
}

/// Returns whether a face marks an edge as part of the original border.
bool isOriginalBoundaryEdge(const TriangleMesh& mesh, VertexId a, VertexId b) {
  for (FaceId f : mesh.facesOnEdge(a, b)) {
    for (int k = 0; f != kNone && k < 3; ++k) {
      const VertexId from = mesh.face(f)[k];
      const VertexId to = mesh.face(f)[(k + 1) % 3];
      if (((from == a && to == b) || (from == b && to == a)) && mesh.isOriginalBoundary(f, k))
        return true;
    }
  }
  return false;
}

/// Checks what every edit except `removeComponents` conserves.
void expectSound(const TriangleMesh& mesh, double area, double rim) {
  testing_support::expectSound(mesh, area);
  EXPECT_NEAR(testing_support::rimLength(mesh), rim, 1e-13 * rim);
}

TEST(SplitEdge, InsideHalvesBothFaces) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  editor.raiseGeneration(0);
  EXPECT_EQ(editor.splitEdge(1, 4, 0.25), 9);
  const MeshChanges changes = editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_EQ(mesh.material(9), Vec2(1.0, 0.25));
  ASSERT_EQ(changes.vertices.size(), 1U);
  EXPECT_EQ(changes.vertices[0].kind, VertexEdit::Kind::kInsert);
  EXPECT_EQ(changes.vertices[0].id, 9);
  EXPECT_THAT(changes.vertices[0].from, ElementsAre(1, 4, kNone));
  EXPECT_THAT(changes.vertices[0].weight, ElementsAre(0.75, 0.25, 0.0));
  EXPECT_THAT(changes.changedFaces, ElementsAre(0, 3, 8, 9));
  EXPECT_THAT(changes.reshapedFaces, ElementsAre(0, 3, 8, 9));
  EXPECT_THAT(changes.touched, ElementsAre(0, 1, 4, 5, 9));
  EXPECT_THAT(changes.removedFaces, IsEmpty());
  EXPECT_THAT(turnedFaces(mesh, {0, 3, 8, 9}),
              UnorderedElementsAre(Face{0, 1, 9}, Face{0, 9, 4}, Face{4, 9, 5}, Face{1, 5, 9}));
  EXPECT_DOUBLE_EQ(mesh.restArea(0) + mesh.restArea(8), 0.5) << "halves of the same face";
  EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 0, 1));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 1, 9));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 0, 9));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 0, 4));
  EXPECT_THAT((std::vector<int>{mesh.generation(0), mesh.generation(8), mesh.generation(3),
                                mesh.generation(9)}),
              ElementsAre(1, 1, 0, 0))
      << "halves are of their face's generation";
}

TEST(SplitEdge, AtTheBorderHalvesOneFaceAndBothPartsAreOriginalBoundary) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  EXPECT_EQ(editor.splitEdge(1, 0, 0.5), 9);
  const MeshChanges changes = editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_EQ(mesh.faceCount(), 9);
  EXPECT_THAT(changes.changedFaces, ElementsAre(0, 8));
  EXPECT_THAT(changes.reshapedFaces, ElementsAre(0, 8));
  EXPECT_THAT(changes.touched, ElementsAre(0, 1, 4, 9));
  EXPECT_THAT(turnedFaces(mesh, {0, 8}), UnorderedElementsAre(Face{0, 9, 4}, Face{1, 4, 9}));
  EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 0, 9));
  EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 9, 1));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 9, 4));
  EXPECT_TRUE(mesh.isBoundary(9));
}

TEST(SplitEdge, WhereItCameApartMakesNoOriginalBoundary) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  ASSERT_TRUE(editor.splitVertex(1, {2, 3}));  // opens 1-4; the copy is 9
  editor.splitEdge(9, 4, 0.5);
  editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 9, 10));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 10, 4));
  EXPECT_TRUE(mesh.isBoundary(10));
}

TEST(SplitFace, MakesThreeByWeight) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  editor.raiseGeneration(0);
  EXPECT_EQ(editor.splitFace(0, {0.5, 0.25, 0.25}), 9);
  const MeshChanges changes = editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_EQ(mesh.material(9), Vec2(0.5, 0.25));
  EXPECT_THAT(turnedFaces(mesh, {0, 8, 9}),
              UnorderedElementsAre(Face{0, 1, 9}, Face{1, 4, 9}, Face{0, 9, 4}));
  EXPECT_THAT(changes.changedFaces, ElementsAre(0, 8, 9));
  EXPECT_THAT(changes.reshapedFaces, ElementsAre(0, 8, 9));
  EXPECT_THAT(changes.touched, ElementsAre(0, 1, 4, 9));
  for (FaceId f : changes.changedFaces) {
    EXPECT_EQ(mesh.generation(f), 1);
    // The part opposite a corner has its weight.
    const bool opposite0 = turned(mesh.face(f)) == Face{1, 4, 9};
    EXPECT_DOUBLE_EQ(mesh.restArea(f), opposite0 ? 0.25 : 0.125);
  }
  EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 0, 1));
  EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 1, 4));
}

TEST(FlipEdge, SwapsTheDiagonalAndKeepsTheOriginalBoundary) {
  for (const bool reversed : {false, true}) {
    TriangleMesh mesh = threeByThree();
    MeshEditor editor(mesh);
    editor.raiseGeneration(1);
    editor.flipEdge(reversed ? 4 : 0, reversed ? 0 : 4);
    const MeshChanges changes = editor.finish();
    expectSound(mesh, 4.0, 8.0);
    EXPECT_THAT(turnedFaces(mesh, {0, 1}), UnorderedElementsAre(Face{0, 1, 3}, Face{1, 4, 3}));
    EXPECT_THAT(changes.vertices, IsEmpty());
    EXPECT_THAT(changes.changedFaces, ElementsAre(0, 1));
    EXPECT_THAT(changes.reshapedFaces, ElementsAre(0, 1));
    EXPECT_THAT(changes.touched, ElementsAre(0, 1, 3, 4));
    EXPECT_EQ(changes.toRevision, 1U);
    EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 0, 1));
    EXPECT_TRUE(isOriginalBoundaryEdge(mesh, 3, 0));
    EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 1, 3));
    EXPECT_FALSE(isOriginalBoundaryEdge(mesh, 1, 4));
    EXPECT_EQ(mesh.generation(0), 1);
    EXPECT_EQ(mesh.generation(1), 1);
  }
}

TEST(FlipEdge, TwiceGivesTheSameFaces) {
  TriangleMesh mesh = threeByThree();
  const std::vector<Face> before = turnedFaces(mesh, {0, 1, 2, 3, 4, 5, 6, 7});
  MeshEditor editor(mesh);
  editor.flipEdge(0, 4);
  editor.flipEdge(1, 3);
  EXPECT_THAT(turnedFaces(mesh, {0, 1, 2, 3, 4, 5, 6, 7}),
              testing::UnorderedElementsAreArray(before));
  expectSound(mesh, 4.0, 8.0);
}

TEST(MoveVertex, InsideReshapesTheFacesAround) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  editor.moveVertex(4, 7, {0.5, 0.25, 0.25});  // face 7 is 4, 8, 7
  const MeshChanges changes = editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_EQ(mesh.material(4), Vec2(1.25, 1.5));
  ASSERT_EQ(changes.vertices.size(), 1U);
  EXPECT_EQ(changes.vertices[0].kind, VertexEdit::Kind::kMove);
  EXPECT_EQ(changes.vertices[0].id, 4);
  EXPECT_THAT(changes.vertices[0].from, ElementsAre(4, 8, 7));
  EXPECT_THAT(changes.changedFaces, IsEmpty());
  EXPECT_EQ(changes.reshapedFaces, mesh.facesAround(4));
  EXPECT_THAT(changes.touched, ElementsAre(0, 1, 3, 4, 5, 7, 8));
  EXPECT_EQ(changes.toRevision, 1U);
}

TEST(MoveVertex, AlongAStraightBorderKeepsTheArea) {
  TriangleMesh mesh = threeByThree();
  MeshEditor editor(mesh);
  editor.moveVertex(1, 2, {0.75, 0.25, 0.0});  // face 2 is 1, 2, 5
  const MeshChanges changes = editor.finish();
  expectSound(mesh, 4.0, 8.0);
  EXPECT_EQ(mesh.material(1), Vec2(1.25, 0.0));
  EXPECT_THAT(changes.reshapedFaces, ElementsAre(0, 2, 3));
  EXPECT_THAT(changes.touched, ElementsAre(0, 1, 2, 4, 5));
}

// ---- removing components ------------------------------------------------------------------------

const std::vector<Vec2> kUnitSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// Separate unit squares at u = 0, 2, 4 ...: square k has vertices 4 k to 4 k + 3 and faces 2 k and
/// 2 k + 1.
TriangleMesh squares(int count) {
  std::vector<Vec2> material;
  std::vector<Face> faces;
  for (int k = 0; k < count; ++k) {
    for (const Vec2& p : kUnitSquare) material.emplace_back(p.x() + 2.0 * k, p.y());
    faces.push_back({4 * k, 4 * k + 1, 4 * k + 2});
    faces.push_back({4 * k, 4 * k + 2, 4 * k + 3});
  }
  return TriangleMesh(std::move(material), std::move(faces));
}

TEST(RemoveComponents, TheLastTakeTheFreePlaces) {
  TriangleMesh mesh = squares(3);
  MeshEditor editor(mesh);
  editor.raiseGeneration(4);
  editor.finish();
  editor.removeComponents({0, 1});
  const MeshChanges changes = editor.finish();
  EXPECT_EQ(testing_support::validateMesh(mesh), "");
  EXPECT_EQ(mesh.faceCount(), 4);
  EXPECT_EQ(mesh.vertexCount(), 8);
  EXPECT_THAT(changes.removedFaces, ElementsAre(1, 0));
  ASSERT_EQ(changes.vertices.size(), 4U);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(changes.vertices[k].kind, VertexEdit::Kind::kRemove);
    EXPECT_EQ(changes.vertices[k].id, 3 - k);
    EXPECT_EQ(changes.vertices[k].from[0], 11 - k);
    EXPECT_EQ(mesh.material(k), kUnitSquare[k] + Vec2(4.0, 0.0));
  }
  EXPECT_EQ(mesh.generation(0), 1) << "what was face 4";
  EXPECT_NEAR(testing_support::rimLength(mesh), 8.0, 1e-14);
}

TEST(RemoveComponents, OfTheEndRenumbersNothing) {
  TriangleMesh mesh = squares(3);
  const std::vector<Face> before(mesh.faces().begin(), mesh.faces().begin() + 4);
  MeshEditor editor(mesh);
  editor.removeComponents({4, 5});
  editor.finish();
  EXPECT_EQ(testing_support::validateMesh(mesh), "");
  EXPECT_EQ(mesh.faces(), before);
}

TEST(RemoveComponents, AnyOfManyAndDataFollows) {
  // Every subset of five components that leaves something.
  for (unsigned gone = 1; gone < 31U; ++gone) {
    TriangleMesh mesh = squares(5);
    VertexData<Vec2> data(mesh.material());
    std::vector<FaceId> faces;
    std::vector<double> left;
    for (int k = 0; k < 5; ++k) {
      if ((gone >> k) & 1U) {
        faces.insert(faces.end(), {2 * k, 2 * k + 1});
      } else {
        left.push_back(2.0 * k);
      }
    }
    MeshEditor editor(mesh);
    editor.removeComponents(faces);
    data.applyChanges(editor.finish());
    ASSERT_EQ(testing_support::validateMesh(mesh), "") << gone;
    EXPECT_EQ(data.values(), mesh.material()) << gone;
    EXPECT_DOUBLE_EQ(mesh.totalRestArea(), static_cast<double>(left.size()));
    EXPECT_EQ(connectedComponents(mesh).count, static_cast<int>(left.size()));
    std::vector<double> corners;
    for (const Vec2& p : mesh.material()) {
      if (std::fmod(p.x(), 2.0) == 0.0 && p.y() == 0.0) corners.push_back(p.x());
    }
    EXPECT_THAT(corners, testing::UnorderedElementsAreArray(left));
  }
}

// ---- any edits ----------------------------------------------------------------------------------

TEST(MeshEditor, LongRandomSequencesKeepAManifoldAndItsData) {
  using namespace testing_support;
  Generator random(17);
  int done = 0;
  for (int sequence = 0; sequence < 12; ++sequence) {
    const Grid grid{whole(random, 3, 7), whole(random, 3, 7), uniform(random, 0.5, 2.0),
                    uniform(random, 0.5, 2.0)};
    TriangleMesh mesh = makeGridMesh(grid);
    const double area = preciseArea(mesh);
    const double rim = rimLength(mesh);
    VertexData<Vec2> material(mesh.material());
    VertexData<double> affine(static_cast<std::size_t>(mesh.vertexCount()), 0.0);
    const auto function = [](const Vec2& p) { return 3.0 + 2.0 * p.x() - 5.0 * p.y(); };
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) affine[v] = function(mesh.material(v));
    MeshEditor editor(mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 400; ++edit) {
      done += edits.any() ? 1 : 0;
      if (whole(random, 0, 4) != 0) continue;
      const MeshChanges changes = editor.finish();
      material.applyChanges(changes);
      affine.applyChanges(changes);
      ASSERT_EQ(validateMesh(mesh), "") << "sequence " << sequence << ", edit " << edit;
    }
    const MeshChanges last = editor.finish();
    material.applyChanges(last);
    affine.applyChanges(last);
    expectSound(mesh, area, rim);
    EXPECT_EQ(material.values(), mesh.material()) << "the mesh blends as data does, to the bit";
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
      EXPECT_NEAR(affine[v], function(mesh.material(v)), 1e-12);
    }
  }
  EXPECT_GT(done, 1000) << "edits that did something, of all sequences";
}

TEST(MeshEditor, ListsOfChangesAreSortedAndNameAllThatChanged) {
  using namespace testing_support;
  Generator random(23);
  TriangleMesh mesh = makeGridMesh({6, 6, 1.0, 1.0});
  MeshEditor editor(mesh);
  RandomEditor edits(editor, random);
  const auto ascending = [](const std::vector<std::int32_t>& ids) {
    return std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) == ids.end();
  };
  for (int edit = 0; edit < 100; ++edit) {
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): edits change `mesh`
    const TriangleMesh before = mesh;
    for (int k = 0; k < 3; ++k) edits.any();
    const MeshChanges changes = editor.finish();
    EXPECT_TRUE(ascending(changes.changedFaces));
    EXPECT_TRUE(ascending(changes.reshapedFaces));
    EXPECT_TRUE(ascending(changes.touched));
    const auto named = [](const std::vector<std::int32_t>& ids, std::int32_t id) {
      return std::binary_search(ids.begin(), ids.end(), id);
    };
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      const bool isNew = f >= before.faceCount();
      if (isNew || turned(mesh.face(f)) != turned(before.face(f))) {
        EXPECT_TRUE(named(changes.changedFaces, f));
      }
      bool sameShape = !isNew;
      for (int k = 0; k < 3 && sameShape; ++k) {
        sameShape = mesh.material(mesh.face(f)[k]) == before.material(before.face(f)[k]);
      }
      if (!sameShape) {
        EXPECT_TRUE(named(changes.reshapedFaces, f));
      }
    }
    for (FaceId f : changes.reshapedFaces) {
      for (VertexId v : mesh.face(f)) EXPECT_TRUE(named(changes.touched, v));
    }
    for (VertexId v = 0; v < before.vertexCount(); ++v) {
      const bool same = mesh.facesAround(v) == before.facesAround(v) &&
                        mesh.neighbours(v) == before.neighbours(v);
      if (!same) {
        EXPECT_TRUE(named(changes.touched, v));
      }
    }
  }
}

// ---- data that follows --------------------------------------------------------------------------

using Kind = VertexEdit::Kind;

MeshChanges changesOf(std::vector<VertexEdit> edits) {
  MeshChanges changes;
  changes.fromRevision = 3;
  changes.toRevision = 4;
  changes.vertices = std::move(edits);
  return changes;
}

VertexEdit copyOf(VertexId from, VertexId id) {
  return {Kind::kCopy, id, {from, kNone, kNone}, {1.0, 0.0, 0.0}};
}

TEST(VertexData, CopiesForSplitVerticesAndBlendsForNewOnes) {
  VertexData<double> data(std::vector<double>{1.0, 10.0}, 3);
  data.applyChanges(changesOf({copyOf(1, 2),
                               {Kind::kInsert, 3, {0, 2, kNone}, {0.25, 0.75, 0.0}},
                               {Kind::kInsert, 4, {0, 1, 3}, {0.5, 0.25, 0.25}}}));
  const double blend = 0.25 * 1.0 + 0.75 * 10.0;
  EXPECT_THAT(data.values(),
              ElementsAre(1.0, 10.0, 10.0, blend, 0.5 * 1.0 + 0.25 * 10.0 + 0.25 * blend));
  EXPECT_EQ(data.revision(), 4U);
}

TEST(VertexData, MovedOnesTakeTheBlendOfWhatWasThere) {
  VertexData<double> data(std::vector<double>{1.0, 10.0, 100.0}, 3);
  data.applyChanges(changesOf({{Kind::kMove, 1, {1, 2, 0}, {0.5, 0.25, 0.25}},
                               {Kind::kMove, 0, {1, kNone, kNone}, {1.0, 0.0, 0.0}}}));
  const double moved = 5.0 + 25.0 + 0.25;
  EXPECT_THAT(data.values(), ElementsAre(moved, moved, 100.0));
}

TEST(VertexData, TheLastTakesThePlaceOfARemovedOne) {
  VertexData<double> data(std::vector<double>{0.0, 1.0, 2.0, 3.0}, 3);
  data.applyChanges(changesOf({{Kind::kRemove, 3, {3, kNone, kNone}, {1.0, 0.0, 0.0}},
                               {Kind::kRemove, 0, {2, kNone, kNone}, {1.0, 0.0, 0.0}}}));
  EXPECT_THAT(data.values(), ElementsAre(2.0, 1.0));
}

TEST(VertexData, RefusesChangesFromAnotherRevision) {
  VertexData<double> behind(std::vector<double>{1.0}, 2);
  EXPECT_THROW(behind.applyChanges(changesOf({})), std::logic_error);
  VertexData<double> twice(std::vector<double>{1.0}, 3);
  twice.applyChanges(changesOf({copyOf(0, 1)}));
  EXPECT_THROW(twice.applyChanges(changesOf({copyOf(0, 1)})), std::logic_error);
  EXPECT_EQ(twice.size(), 2U) << "a refused change leaves no rows behind";
}

}  // namespace
}  // namespace cloth_sim
