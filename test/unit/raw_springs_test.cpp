/// \file Spring networks with constants per spring.

#include <gtest/gtest.h>

#include <optional>

#include "cloth_sim/cloth/spring_network.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

TEST(RawSprings, HoldForEveryWholeSpring) {
  const TriangleMesh mesh = makeGridMesh({6, 6, 0.5, 0.5});
  const RawSprings raw{{300.0, 200.0, 100.0}, false, 7.0};
  const SpringNetwork springs(mesh, raw, {});
  for (const Spring& spring : springs.slots()) {
    // Shares of one or two or more faces that sum to one, up to rounding.
    EXPECT_DOUBLE_EQ(spring.stiffness, raw.constant[static_cast<int>(spring.kind)]);
    EXPECT_DOUBLE_EQ(spring.damping, 7.0);
  }
}

TEST(RawSprings, PerStretchDividesByTheRestLength) {
  // f = c (l / l0 - 1) = (c / l0) (l - l0).
  const TriangleMesh mesh = makeGridMesh({5, 4, 0.5, 0.5});
  const RawSprings raw{{3e4, 2e4, 1e4}, true, 0.0};
  const SpringNetwork springs(mesh, raw, {});
  for (const Spring& spring : springs.slots()) {
    const double constant = raw.constant[static_cast<int>(spring.kind)];
    EXPECT_NEAR(spring.stiffness * spring.restLength, constant, 1e-12 * constant);
  }
}

TEST(RawSprings, AreSharedWhereTheSurfaceOpens) {
  // Splitting a column doubles its edges, and each pair shares one constant. What crossed the
  // column (bend springs, and no edges) is gone.
  const Grid grid{6, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  const RawSprings raw{{300.0, 200.0, 100.0}, false, 7.0};
  SpringNetwork springs(mesh, raw, {});
  const auto sum = [&](SpringKind kind, double Spring::*value) {
    double total = 0.0;
    for (const Spring& s : springs.slots()) total += s.exists() && s.kind == kind ? s.*value : 0.0;
    return total;
  };
  const double structural = sum(SpringKind::kStructural, &Spring::stiffness);
  const double shear = sum(SpringKind::kShear, &Spring::stiffness);
  const double dashpots = sum(SpringKind::kStructural, &Spring::damping);

  const int column = 3;
  MeshEditor editor(mesh);
  for (int j = 0; j < grid.rows; ++j) {
    const VertexId v = grid.vertex(column, j);
    std::vector<FaceId> right;
    for (FaceId f : mesh.facesAround(v)) {
      for (VertexId w : mesh.face(f)) {
        if (mesh.material(w).x() > mesh.material(v).x() + 1e-9) {
          right.push_back(f);
          break;
        }
      }
    }
    editor.splitVertex(v, right);
  }
  springs.applyChanges(mesh, editor.finish());

  EXPECT_EQ(springs.count(SpringKind::kStructural), 5 * 5 + 6 * 4 + (grid.rows - 1));
  EXPECT_NEAR(sum(SpringKind::kStructural, &Spring::stiffness), structural, 1e-12 * structural);
  EXPECT_NEAR(sum(SpringKind::kStructural, &Spring::damping), dashpots, 1e-12 * dashpots);
  EXPECT_NEAR(sum(SpringKind::kShear, &Spring::stiffness), shear, 1e-12 * shear);
  for (const Spring& spring : springs.slots()) {
    if (!spring.exists() || spring.kind != SpringKind::kStructural) continue;
    const double seam = mesh.material(grid.vertex(column, 0)).x();
    const bool onSeam = mesh.material(spring.a).x() == seam && mesh.material(spring.b).x() == seam;
    EXPECT_NEAR(spring.stiffness, onSeam ? 150.0 : 300.0, 1e-10) << "half the area on either side";
  }
}

// ---- on refined meshes --------------------------------------------------------------------------

std::optional<Spring> find(const SpringNetwork& springs, VertexId a, VertexId b, SpringKind kind) {
  for (const Spring& s : springs.slots()) {
    if (s.kind == kind && s.a == std::min(a, b) && s.b == std::max(a, b)) return s;
  }
  return std::nullopt;
}

const RawSprings kRaw{{300.0, 200.0, 100.0}, false, 7.0};

class RawSplitEdge : public testing::TestWithParam<bool> {
 protected:
  /// Makes square cells, or cells twice as high as wide.
  Grid grid() const { return {6, 6, 0.5, GetParam() ? 0.5 : 1.0}; }
};

TEST_P(RawSplitEdge, HalvesOfASpringAreTwiceAsStiff) {
  for (const bool perStretch : {false, true}) {
    TriangleMesh mesh = makeGridMesh(grid());
    RawSprings raw = kRaw;
    raw.perStretch = perStretch;
    SpringNetwork springs(mesh, raw, {});
    const std::array<VertexId, 2> warp{grid().vertex(2, 3), grid().vertex(3, 3)};
    const std::array<VertexId, 2> weft{grid().vertex(4, 1), grid().vertex(4, 2)};
    for (const auto& [a, b] : {warp, weft}) {
      const Spring whole = *find(springs, a, b, SpringKind::kStructural);
      MeshEditor editor(mesh);
      const VertexId middle = editor.splitEdge(a, b, 0.5);
      springs.applyChanges(mesh, editor.finish());
      EXPECT_FALSE(find(springs, a, b, SpringKind::kStructural));
      for (VertexId end : {a, b}) {
        const std::optional<Spring> half = find(springs, end, middle, SpringKind::kStructural);
        ASSERT_TRUE(half);
        EXPECT_NEAR(half->stiffness, 2.0 * whole.stiffness, 1e-12 * whole.stiffness);
      }
    }
  }
}

TEST_P(RawSplitEdge, ConstantsOfOtherSpringsDoNotChange) {
  // Also of those on the outer edges of faces that were split: no spring that is whole and has
  // cloth on the same sides as before is any other than it was.
  Generator random(3);
  TriangleMesh mesh = makeGridMesh(grid());
  SpringNetwork springs(mesh, kRaw, {});
  const SpringNetwork before = springs;
  MeshEditor editor(mesh);
  editor.splitEdge(grid().vertex(2, 3), grid().vertex(3, 3), 0.5);
  springs.applyChanges(mesh, editor.finish());
  int kept = 0;
  for (const Spring& spring : before.slots()) {
    const std::optional<Spring> now = find(springs, spring.a, spring.b, spring.kind);
    if (!now) continue;
    ++kept;
    EXPECT_NEAR(now->stiffness, spring.stiffness, 1e-12 * spring.stiffness)
        << toString(spring.kind) << " " << spring.a << "-" << spring.b;
    EXPECT_NEAR(now->damping, spring.damping, 1e-12 * spring.damping)
        << toString(spring.kind) << " " << spring.a << "-" << spring.b;
  }
  EXPECT_GT(kept, before.count() - 10);
}

INSTANTIATE_TEST_SUITE_P(Cells, RawSplitEdge, testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "Square" : "High");
});

}  // namespace
}  // namespace cloth_sim
