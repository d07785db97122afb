/// \file Opening of a mesh along marked edges.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "cloth_sim/surgery/remesher.h"
#include "unit/sound_mesh.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

using Chain = std::vector<VertexId>;

void markAll(const std::vector<Chain>& chains, Remesher& remesher) {
  for (const Chain& chain : chains) {
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) remesher.mark(chain[k], chain[k + 1]);
  }
}

/// Marks and opens edges, and checks the invariants.
MeshChanges openAlong(const std::vector<Chain>& chains, TriangleMesh& mesh) {
  const double area = preciseArea(mesh);
  const double rim = rimLength(mesh);
  const int faces = mesh.faceCount();
  Remesher remesher(mesh, {}, {});
  markAll(chains, remesher);
  remesher.openMarkedEdges();
  EXPECT_TRUE(remesher.marks().empty());
  MeshChanges changes = remesher.finish();
  expectSound(mesh, area);
  EXPECT_EQ(rimLength(mesh), rim);
  EXPECT_EQ(mesh.faceCount(), faces);
  return changes;
}

TEST(OpenMarkedEdges, APolylineAcrossGivesTwoPieces) {
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const MeshChanges changes = openAlong({{1, 6, 11, 16, 21}}, mesh);
  EXPECT_EQ(changes.vertices.size(), 5U);
  EXPECT_THAT(pieceAreas(mesh), ElementsAre(0.25, 0.75));
}

TEST(OpenMarkedEdges, AClosedPolylineFreesADisc) {
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const MeshChanges changes = openAlong({{6, 7, 8, 13, 18, 17, 16, 11, 6}}, mesh);
  EXPECT_EQ(changes.vertices.size(), 8U);
  EXPECT_THAT(pieceAreas(mesh), UnorderedElementsAre(0.75, 0.25));
}

TEST(OpenMarkedEdges, ASingleInnerEdgeOpensNothing) {
  TriangleMesh mesh = makeGridMesh({5, 5, 1.0, 1.0});
  const MeshChanges changes = openAlong({{12, 13}}, mesh);
  EXPECT_TRUE(changes.empty());
  EXPECT_EQ(mesh.vertexCount(), 25);
}

TEST(OpenMarkedEdges, TwoInnerEdgesInARowOpenAtTheVertexBetween) {
  TriangleMesh mesh = makeGridMesh({5, 5, 1.0, 1.0});
  const MeshChanges changes = openAlong({{11, 12, 13}}, mesh);
  ASSERT_EQ(changes.vertices.size(), 1U);
  EXPECT_EQ(changes.vertices[0].kind, VertexEdit::Kind::kCopy);
  EXPECT_EQ(changes.vertices[0].from[0], 12);
  EXPECT_EQ(connectedComponents(mesh).count, 1);
  EXPECT_TRUE(mesh.isBoundary(11));
  EXPECT_TRUE(mesh.isBoundary(13));
}

TEST(OpenMarkedEdges, AnEdgeFromTheBorderOpensANotch) {
  TriangleMesh mesh = makeGridMesh({5, 5, 1.0, 1.0});
  const MeshChanges changes = openAlong({{2, 7}}, mesh);
  ASSERT_EQ(changes.vertices.size(), 1U);
  EXPECT_EQ(changes.vertices[0].from[0], 2);
}

/// A grid of 5 x 5 with a permutation of its vertex numbers.
TriangleMesh renumberedGrid(const std::vector<VertexId>& order) {
  const TriangleMesh grid = makeGridMesh({5, 5, 1.0, 1.0});
  std::vector<Vec2> material(grid.material().size());
  std::vector<Face> faces = grid.faces();
  for (VertexId v = 0; v < grid.vertexCount(); ++v) material[order[v]] = grid.material(v);
  for (Face& face : faces) {
    for (VertexId& v : face) v = order[v];
  }
  return TriangleMesh(std::move(material), std::move(faces));
}

class Junctions : public testing::TestWithParam<int> {
 protected:
  /// The identity, the reverse order, or a random permutation.
  std::vector<VertexId> order() const {
    std::vector<VertexId> numbers(25);
    std::iota(numbers.begin(), numbers.end(), 0);
    if (GetParam() == 1) std::reverse(numbers.begin(), numbers.end());
    Generator random(static_cast<std::uint64_t>(GetParam()));
    for (std::size_t k = 24; GetParam() > 1 && k > 0; --k) {
      std::swap(numbers[k], numbers[whole(random, 0, static_cast<int>(k))]);
    }
    return numbers;
  }

  void expectPieces(std::vector<Chain> chains, const std::vector<double>& areas,
                    std::size_t copies) {
    const std::vector<VertexId> numbers = order();
    TriangleMesh mesh = renumberedGrid(numbers);
    for (Chain& chain : chains) {
      for (VertexId& v : chain) v = numbers[v];
    }
    const MeshChanges changes = openAlong(chains, mesh);
    EXPECT_THAT(pieceAreas(mesh), testing::UnorderedElementsAreArray(areas));
    EXPECT_EQ(changes.vertices.size(), copies);
  }
};

TEST_P(Junctions, ATeeGivesThreePieces) {
  // Each vertex of the bar is doubled, the one where the stem begins is tripled.
  expectPieces({{10, 11, 12, 13, 14}, {12, 7, 2}}, {0.5, 0.25, 0.25}, 5 + 1 + 2);
  expectPieces({{10, 11, 12, 13, 14}, {12, 17, 22}}, {0.5, 0.25, 0.25}, 5 + 1 + 2);
  expectPieces({{2, 7, 12, 17, 22}, {12, 13, 14}}, {0.5, 0.25, 0.25}, 5 + 1 + 2);
  expectPieces({{2, 7, 12, 17, 22}, {10, 11, 12}}, {0.5, 0.25, 0.25}, 5 + 1 + 2);
}

TEST_P(Junctions, ACrossGivesFourPieces) {
  expectPieces({{10, 11, 12, 13, 14}, {2, 7, 12, 17, 22}}, {0.25, 0.25, 0.25, 0.25}, 9 + 2);
}

TEST_P(Junctions, AStarOfThreeTipsTriplesItsMiddle) {
  expectPieces({{11, 12}, {12, 17}, {12, 6}}, {1.0}, 2);
}

TEST_P(Junctions, ATeeWithTipsOpensOnlyInside) {
  expectPieces({{10, 11, 12, 13}, {12, 7}}, {1.0}, 4);
}

TEST_P(Junctions, TwoPolylinesFromOneBorderVertex) {
  // The middle, and from its upper end down to the left border over the diagonal 16-22.
  expectPieces({{2, 7, 12, 17, 22}, {15, 16, 22}}, {0.5, 0.40625, 0.09375}, 5 + 2 + 1);
}

INSTANTIATE_TEST_SUITE_P(Numbering, Junctions, testing::Range(0, 8));

/// The expected result of opening: corners of faces that share a vertex stay one vertex if the
/// faces are connected across unmarked edges; faces connected across such edges stay one component.
struct Expected {
  int vertices = 0;
  int pieces = 0;
};

class Sets {
 public:
  explicit Sets(int size) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int of(int k) {
    while (parent_[k] != k) k = parent_[k];
    return k;
  }
  void join(int a, int b) { parent_[of(a)] = of(b); }
  int count() {
    int sets = 0;
    for (int k = 0; k < static_cast<int>(parent_.size()); ++k) sets += of(k) == k ? 1 : 0;
    return sets;
  }

 private:
  std::vector<int> parent_;
};

int cornerAt(const TriangleMesh& mesh, FaceId f, VertexId v) {
  const Face& face = mesh.face(f);
  return 3 * f + static_cast<int>(std::find(face.begin(), face.end(), v) - face.begin());
}

Expected expectedFor(const TriangleMesh& mesh, const std::set<EdgeKey>& marks) {
  Sets corners(3 * mesh.faceCount());
  Sets faces(mesh.faceCount());
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const VertexId a = mesh.face(f)[k];
      const VertexId b = mesh.face(f)[(k + 1) % 3];
      const auto on = mesh.facesOnEdge(a, b);
      if (on[1] == kNone || marks.count(edgeKey(a, b)) != 0) continue;
      faces.join(on[0], on[1]);
      for (VertexId v : {a, b}) corners.join(cornerAt(mesh, on[0], v), cornerAt(mesh, on[1], v));
    }
  }
  return {corners.count(), faces.count()};
}

TEST(OpenMarkedEdges, AnySetOfEdgesOpensExactlyAlongThem) {
  Generator random(5);
  for (int trial = 0; trial < 300; ++trial) {
    TriangleMesh mesh =
        irregularMesh({whole(random, 3, 7), whole(random, 3, 7), 1.0, 1.0}, 0.2, random);
    const double area = preciseArea(mesh);
    // Twice, so that marks meet what has been opened before.
    for (int round = 0; round < 2; ++round) {
      Remesher remesher(mesh, {}, {});
      const int percent = whole(random, 5, 60);
      for (FaceId f = 0; f < mesh.faceCount(); ++f) {
        if (whole(random, 0, 99) >= percent) continue;
        const int k = whole(random, 0, 2);
        remesher.mark(mesh.face(f)[k], mesh.face(f)[(k + 1) % 3]);
      }
      const Expected expected = expectedFor(mesh, remesher.marks());
      remesher.openMarkedEdges();
      remesher.finish();
      ASSERT_EQ(validateMesh(mesh), "") << "trial " << trial;
      ASSERT_EQ(mesh.vertexCount(), expected.vertices) << "trial " << trial;
      ASSERT_EQ(connectedComponents(mesh).count, expected.pieces) << "trial " << trial;
    }
    expectSound(mesh, area);
  }
}

}  // namespace
}  // namespace cloth_sim
