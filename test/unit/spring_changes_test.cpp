/// \file Spring networks that follow edits of the mesh.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <sstream>
#include <tuple>

#include "cloth_sim/cloth/spring_network.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

using Row = std::tuple<VertexId, VertexId, int, int, VertexId, VertexId, double, double, double>;

Row rowOf(const Spring& s) {
  return {std::min(s.a, s.b),
          std::max(s.a, s.b),
          static_cast<int>(s.kind),
          static_cast<int>(s.direction),
          std::min(s.support[0], s.support[1]),
          std::max(s.support[0], s.support[1]),
          s.restLength,
          s.stiffness,
          s.damping};
}

std::vector<Row> sortedRows(const SpringNetwork& springs) {
  std::vector<Row> rows;
  for (const Spring& spring : springs.slots()) {
    if (spring.exists()) rows.push_back(rowOf(spring));
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// Describes a row: ids, kind and constants.
std::string describe(const Row& row) {
  std::ostringstream out;
  out << "kind " << std::get<2>(row) << ": " << std::get<0>(row) << "-" << std::get<1>(row)
      << " on " << std::get<4>(row) << "-" << std::get<5>(row) << ", k = " << std::get<7>(row);
  return out.str();
}

/// Describes the difference of two sorted lists; empty if they are equal.
std::string difference(const std::vector<Row>& rows, const std::vector<Row>& expected) {
  std::vector<Row> more, less;
  std::set_difference(rows.begin(), rows.end(), expected.begin(), expected.end(),
                      std::back_inserter(more));
  std::set_difference(expected.begin(), expected.end(), rows.begin(), rows.end(),
                      std::back_inserter(less));
  std::string text;
  for (const Row& row : more) text += "unexpected " + describe(row) + "\n";
  for (const Row& row : less) text += "missing " + describe(row) + "\n";
  return text;
}

bool same(const Spring& s, const Spring& t) { return s.a == t.a && rowOf(s) == rowOf(t); }

/// Checks that `before` and `after` differ in the slots that `changes` lists, and in no others.
void expectChangesList(const std::vector<Spring>& before, const SpringSlots& after,
                       const SpringChanges& changes) {
  std::vector<std::int32_t> added, modified, removed;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(after.size()); ++slot) {
    const bool was = slot < static_cast<std::int32_t>(before.size()) && before[slot].exists();
    if (!was && after[slot].exists()) added.push_back(slot);
    if (was && !after[slot].exists()) removed.push_back(slot);
    if (was && after[slot].exists() && !same(before[slot], after[slot])) modified.push_back(slot);
  }
  EXPECT_EQ(changes.added, added);
  EXPECT_EQ(changes.modified, modified);
  EXPECT_EQ(changes.removed, removed);
  ASSERT_EQ(changes.removedSprings.size(), removed.size());
  for (std::size_t k = 0; k < removed.size(); ++k) {
    EXPECT_TRUE(same(changes.removedSprings[k], before[removed[k]]));
  }
}

/// Checks that `springsOn` lists, for every vertex, exactly the springs that it supports.
void expectSupportsAgree(const TriangleMesh& mesh, const SpringNetwork& springs) {
  std::vector<std::vector<std::int32_t>> expected(mesh.vertexCount());
  const auto count = static_cast<std::int32_t>(springs.slots().size());
  for (std::int32_t slot = 0; slot < count; ++slot) {
    for (VertexId v : springs[slot].support) {
      if (v != kNone) expected[v].push_back(slot);
    }
  }
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    std::vector<std::int32_t> listed = springs.springsOn(v);
    std::sort(listed.begin(), listed.end());
    EXPECT_EQ(listed, expected[v]) << "vertex " << v;
  }
}

/// A denim sheet of random size and its network.
struct RandomSheet {
  /// \param least, most  rows and columns.
  /// \param number  decides which kinds of springs there are.
  RandomSheet(Generator& random, int least, int most, int number)
      : mesh(makeGridMesh({whole(random, least, most), whole(random, least, most), 0.7, 0.9})),
        selection{number % 3 != 1, number % 3 != 2},
        springs(mesh, fabric, selection) {}
  void expectFollows(const MeshChanges& edit);

  TriangleMesh mesh;
  Fabric fabric = fabricPreset("denim");
  SpringSelection selection;
  SpringNetwork springs;
};

/// Applies the changes of an edit, and checks that the network is the one of the edited mesh. The
/// sums run over the same faces in the same order, so they are equal to the bit.
void RandomSheet::expectFollows(const MeshChanges& edit) {
  const std::vector<Spring> before(springs.slots());
  const SpringChanges changes = springs.applyChanges(mesh, edit);
  expectChangesList(before, springs.slots(), changes);
  expectSupportsAgree(mesh, springs);
  const SpringNetwork scratch(mesh, fabric, selection);
  ASSERT_EQ(difference(sortedRows(springs), sortedRows(scratch)), "");
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    ASSERT_EQ(springs.count(static_cast<SpringKind>(kind)),
              scratch.count(static_cast<SpringKind>(kind)));
  }
}

TEST(SpringNetworkChanges, GivesTheNetworkOfTheEditedMesh) {
  Generator random(11);
  for (int sequence = 0; sequence < 20; ++sequence) {
    RandomSheet sheet(random, 2, 8, sequence);
    for (int edit = 0; edit < 15; ++edit) {
      SCOPED_TRACE(testing::Message() << "sequence " << sequence << ", edit " << edit);
      MeshEditor editor(sheet.mesh);
      for (int k = whole(random, 1, 3); k > 0; --k) {
        const Opening opening = randomOpening(sheet.mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      ASSERT_NO_FATAL_FAILURE(sheet.expectFollows(editor.finish()));
    }
  }
}

TEST(SpringNetworkChanges, GivesTheNetworkOfTheEditedMeshForEveryKindOfEdit) {
  Generator random(12);
  for (int sequence = 0; sequence < 20; ++sequence) {
    RandomSheet sheet(random, 3, 7, sequence);
    MeshEditor editor(sheet.mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 60; ++edit) {
      SCOPED_TRACE(testing::Message() << "sequence " << sequence << ", edit " << edit);
      for (int k = whole(random, 1, 4); k > 0; --k) edits.any();
      ASSERT_NO_FATAL_FAILURE(sheet.expectFollows(editor.finish()));
    }
  }
}

TEST(SpringNetworkChanges, CountsASpringThatTurnedIntoAnotherKind) {
  // The middle of 3 x 3 moves by 0.45 of a spacing along u: the spring to the one below it turns
  // by 24 degrees, past the 22.5 that make it a bias spring, and the diagonal to the lower left by
  // 10 degrees, so that it stays one (34.6 degrees).
  TriangleMesh mesh = makeGridMesh({3, 3, 2.0, 2.0});
  const SpringSelection selection{true, false};
  SpringNetwork springs(mesh, fabricPreset("silk"), selection);
  MeshEditor editor(mesh);
  editor.moveVertex(4, 6, {0.55, 0.45, 0.0});  // face 6 is 4, 5, 8
  springs.applyChanges(mesh, editor.finish());
  const SpringNetwork scratch(mesh, fabricPreset("silk"), selection);
  EXPECT_EQ(difference(sortedRows(springs), sortedRows(scratch)), "");
  EXPECT_EQ(scratch.count(SpringKind::kStructural), 10) << "4-1 and 4-7 are bias now";
  EXPECT_EQ(springs.count(SpringKind::kStructural), scratch.count(SpringKind::kStructural));
  EXPECT_EQ(springs.count(SpringKind::kShear), scratch.count(SpringKind::kShear));
}

/// Kind, material coordinates of the ends, and constants of every spring, sorted: independent of
/// the numbers of vertices and faces.
using MaterialRow = std::array<double, 8>;

std::vector<MaterialRow> materialRows(const TriangleMesh& mesh, const SpringNetwork& springs) {
  std::vector<MaterialRow> rows;
  for (const Spring& s : springs.slots()) {
    if (!s.exists()) continue;
    std::array<double, 2> a{mesh.material(s.a).x(), mesh.material(s.a).y()};
    std::array<double, 2> b{mesh.material(s.b).x(), mesh.material(s.b).y()};
    if (b < a) std::swap(a, b);
    rows.push_back({static_cast<double>(s.kind), a[0], a[1], b[0], b[1], s.restLength, s.stiffness,
                    s.damping});
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

void expectSameByMaterial(const std::vector<MaterialRow>& rows,
                          const std::vector<MaterialRow>& expected) {
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t i = 0; i < rows[k].size(); ++i) {
      ASSERT_NEAR(rows[k][i], expected[k][i], 1e-12 * std::abs(expected[k][i]));
    }
  }
}

/// Removal of components: their springs vanish, and all others are renumbered.
void expectRemoval(Generator& random, const std::vector<FaceId>& faces, TriangleMesh& mesh,
                   SpringNetwork& springs, const Fabric& fabric) {
  const std::vector<Spring> before(springs.slots());
  MeshEditor editor(mesh);
  editor.removeComponents(faces);
  const SpringChanges changes = springs.applyChanges(mesh, editor.finish());
  EXPECT_TRUE(changes.added.empty());
  expectChangesList(before, springs.slots(), changes);
  expectSupportsAgree(mesh, springs);
  expectSameByMaterial(materialRows(mesh, springs),
                       materialRows(mesh, SpringNetwork(mesh, fabric, {})));
  // ... and it goes on from there.
  RandomEditor edits(editor, random);
  for (int k = 0; k < 10; ++k) edits.any();
  springs.applyChanges(mesh, editor.finish());
  expectSupportsAgree(mesh, springs);
  expectSameByMaterial(materialRows(mesh, springs),
                       materialRows(mesh, SpringNetwork(mesh, fabric, {})));
}

TEST(SpringNetworkChanges, GivesTheNetworkOfTheMeshWithoutRemovedComponents) {
  Generator random(14);
  Fabric fabric = fabricPreset("denim");
  fabric.damping = 1e-3;
  int taken = 0;
  for (int sequence = 0; sequence < 30; ++sequence) {
    const Grid grid{whole(random, 3, 6), whole(random, 3, 6), 0.7, 0.9};
    TriangleMesh mesh = makeGridMesh(grid);
    SpringNetwork springs(mesh, fabric, {});
    MeshEditor editor(mesh);
    RandomEditor edits(editor, random);
    while (connectedComponents(mesh).count < 4) {
      edits.open();
      edits.any();
    }
    springs.applyChanges(mesh, editor.finish());
    const ConnectedComponents components = connectedComponents(mesh);
    const int kept = whole(random, 0, components.count - 1);
    std::vector<FaceId> faces;
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      const bool goes = components.ofFace[f] != kept && components.ofFace[f] % 2 == sequence % 2;
      if (goes) faces.push_back(f);
    }
    if (faces.empty()) continue;
    ++taken;
    expectRemoval(random, faces, mesh, springs, fabric);
    if (HasFatalFailure()) FAIL() << "sequence " << sequence;
  }
  EXPECT_GT(taken, 20);
}

TEST(SpringNetworkChanges, KeepsTheSlotOfASpringWhoseEndWasSplit) {
  const Grid grid{5, 5, 1.0, 1.0};
  TriangleMesh mesh = makeGridMesh(grid);
  SpringNetwork springs(mesh, fabricPreset("silk"), {});
  const auto slotBetween = [&](VertexId a, VertexId b) {
    for (std::size_t slot = 0; slot < springs.slots().size(); ++slot) {
      const Spring& s = springs.slots()[slot];
      if (std::min(s.a, s.b) == std::min(a, b) && std::max(s.a, s.b) == std::max(a, b) &&
          s.kind == SpringKind::kStructural) {
        return static_cast<std::int32_t>(slot);
      }
    }
    return kNone;
  };
  // All faces but those at the left let go of the middle: the spring to its right goes with them.
  const VertexId middle = grid.vertex(2, 2);
  const std::int32_t slot = slotBetween(middle, grid.vertex(3, 2));
  std::vector<FaceId> right;
  for (FaceId f : mesh.facesAround(middle)) {
    for (VertexId w : mesh.face(f)) {
      if (w == grid.vertex(3, 2)) right.push_back(f);
    }
  }
  MeshEditor editor(mesh);
  ASSERT_TRUE(editor.splitVertex(middle, right));
  const SpringChanges changes = springs.applyChanges(mesh, editor.finish());
  EXPECT_EQ(slotBetween(25, grid.vertex(3, 2)), slot);
  EXPECT_THAT(changes.modified, testing::Contains(slot));
}

TEST(SpringNetworkChanges, DoesNothingForNoChange) {
  TriangleMesh mesh = makeGridMesh({4, 4, 1.0, 1.0});
  SpringNetwork springs(mesh, fabricPreset("silk"), {});
  MeshEditor editor(mesh);
  const SpringChanges changes = springs.applyChanges(mesh, editor.finish());
  EXPECT_TRUE(changes.added.empty() && changes.modified.empty() && changes.removed.empty());
}

TEST(RawSprings, SpringsFarAwayKeepTheirBits) {
  const Grid grid{8, 8, 0.7, 0.7};
  TriangleMesh mesh = makeGridMesh(grid);
  SpringNetwork springs(mesh, RawSprings{{300.0, 200.0, 100.0}, false, 7.0}, {});
  const std::vector<Spring> before(springs.slots());
  MeshEditor editor(mesh);
  editor.splitFace(0, {0.4, 0.3, 0.3});
  editor.moveVertex(grid.vertex(1, 1), 0, {0.1, 0.1, 0.8});
  editor.flipEdge(grid.vertex(0, 2), grid.vertex(1, 3));
  const MeshChanges changes = editor.finish();
  springs.applyChanges(mesh, changes);
  for (std::size_t slot = 0; slot < before.size(); ++slot) {
    bool stands = false;
    for (VertexId v : before[slot].support) {
      stands = stands || std::binary_search(changes.touched.begin(), changes.touched.end(), v);
    }
    if (!stands) {
      EXPECT_TRUE(same(springs.slots()[slot], before[slot]));
    }
  }
}

}  // namespace
}  // namespace cloth_sim
