/// \file The edges of faces in order, and which of them are the border.

#include "cloth_sim/mesh/face_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cloth_sim {
namespace {

using testing::ElementsAre;

using Pair = std::array<VertexId, 2>;

/// Two triangles around the edge 0, 3.
const std::vector<Face> kCell{{0, 1, 3}, {0, 3, 2}};

TEST(FaceEdges, AreInTheOrderOfTheirVerticesOnceForEachFace) {
  const FaceEdges sorted = sortEdges(kCell, 4);
  EXPECT_THAT(sorted.first, ElementsAre(0, 4, 5, 6, 6));
  std::vector<VertexId> upper;
  for (const FaceEdges::Edge& edge : sorted.edges) upper.push_back(edge.upper);
  EXPECT_THAT(upper, ElementsAre(1, 2, 3, 3, 3, 3));
  EXPECT_EQ(sorted.edges[0].opposite, 3);
  EXPECT_EQ(sorted.edges[1].opposite, 3);
  EXPECT_EQ(sorted.edges[2].opposite + sorted.edges[3].opposite, 1 + 2);
}

TEST(FaceEdges, BorderHasOneFace) {
  EXPECT_THAT(borderEdges(sortEdges(kCell, 4)),
              ElementsAre(Pair{0, 1}, Pair{0, 2}, Pair{1, 3}, Pair{2, 3}));
}

TEST(FaceEdges, ClosedSurfaceHasNoBorder) {
  const std::vector<Face> tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(borderEdges(sortEdges(tetrahedron, 4)).empty());
}

TEST(FaceEdges, NoFacesHaveNoEdges) {
  EXPECT_TRUE(sortEdges({}, 0).edges.empty());
  EXPECT_TRUE(borderEdges(sortEdges({}, 3)).empty());
}

}  // namespace
}  // namespace cloth_sim
