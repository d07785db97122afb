/// \file Springs of grids: which there are, how stiff they are together, and how they follow edits.

#include "cloth_sim/cloth/spring_network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "cloth_sim/cloth/state.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

// ---- which there are
// -----------------------------------------------------------------------------

TEST(SpringNetwork, GridHasTheClassicStencil) {
  const int n = 7;
  const Model model = buildModel(clothOf(n, n, 0.1));
  EXPECT_EQ(model.springs.count(SpringKind::kStructural), 2 * n * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kShear), 2 * (n - 1) * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kBend), 2 * n * (n - 2));
  EXPECT_EQ(model.springs.count(), 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2));

  // Offsets, in columns and rows, at which the particle in the middle has neighbours.
  std::map<SpringKind, std::vector<std::pair<int, int>>> offsets;
  const VertexId middle = model.grid->vertex(3, 3);
  for (const Spring& spring : model.springs.slots()) {
    if (spring.a != middle && spring.b != middle) continue;
    const VertexId other = spring.a == middle ? spring.b : spring.a;
    offsets[spring.kind].emplace_back(other % n - 3, other / n - 3);
  }
  using Offsets = std::vector<std::pair<int, int>>;
  EXPECT_THAT(offsets[SpringKind::kStructural],
              testing::UnorderedElementsAreArray(Offsets{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}));
  EXPECT_THAT(offsets[SpringKind::kShear],
              testing::UnorderedElementsAreArray(Offsets{{1, 1}, {-1, -1}, {-1, 1}, {1, -1}}));
  EXPECT_THAT(offsets[SpringKind::kBend],
              testing::UnorderedElementsAreArray(Offsets{{2, 0}, {-2, 0}, {0, 2}, {0, -2}}));
}

TEST(SpringNetwork, CountsOnARectangle) {
  const int c = 6, r = 4;
  const Model model = buildModel(clothOf(c, r, 0.1));
  EXPECT_EQ(model.springs.count(SpringKind::kStructural), (c - 1) * r + c * (r - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kShear), 2 * (c - 1) * (r - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kBend), (c - 2) * r + c * (r - 2));
}

TEST(SpringNetwork, KnowsDirectionsAndRestLengths) {
  const Model model = buildModel(clothOf(5, 5, 0.2));
  for (const Spring& spring : model.springs.slots()) {
    const Vec2 d = model.mesh.material(spring.b) - model.mesh.material(spring.a);
    const bool alongU = std::abs(d.y()) < 1e-12;
    const bool alongV = std::abs(d.x()) < 1e-12;
    const ThreadDirection expected = alongU   ? ThreadDirection::kWarp
                                     : alongV ? ThreadDirection::kWeft
                                              : ThreadDirection::kBias;
    EXPECT_EQ(spring.direction, expected);
    EXPECT_EQ(spring.kind == SpringKind::kShear, expected == ThreadDirection::kBias);
    EXPECT_DOUBLE_EQ(spring.restLength, d.norm());
    EXPECT_GT(spring.stiffness, 0.0);
  }
}

TEST(SpringNetwork, LeavesOutWhatIsNotAskedFor) {
  const TriangleMesh mesh = makeGridMesh({5, 5, 1.0, 1.0});
  const SpringNetwork bare(mesh, fabricPreset("silk"), {false, false});
  EXPECT_EQ(bare.count(SpringKind::kShear), 0);
  EXPECT_EQ(bare.count(SpringKind::kBend), 0);
  EXPECT_EQ(bare.count(), 2 * 5 * 4);
}

TEST(SpringNetwork, DashpotsAreTheRetardationTimeTimesTheStiffness) {
  Fabric fabric = fabricPreset("denim");
  fabric.damping = 2.5e-3;
  const SpringNetwork springs(makeGridMesh({4, 4, 1.0, 1.0}), fabric, {});
  for (const Spring& spring : springs.slots()) {
    EXPECT_DOUBLE_EQ(spring.damping, 2.5e-3 * spring.stiffness);
  }
}

// ---- how stiff they are together
// -----------------------------------------------------------------

/// Elastic energy per rest area of the cloth deformed affinely by `f` [J/m^2].
double energyDensity(const Model& model, const Eigen::Matrix2d& f) {
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v].head<2>() = f * model.mesh.material(v);
  }
  return energies(model, state, Vec3::Zero()).elastic / model.mesh.totalRestArea();
}

/// 2 W / strain^2 for a strain `e` along `axis`, with the other axis free to contract. W is
/// quadratic in the lateral strain up to relative terms of O(e), so three values give its minimum;
/// the mean over +e and -e removes the cubic term of W, which leaves a relative error of O(e^2).
double uniaxialStiffness(const Model& model, int axis) {
  const double e = 1e-4;
  double sum = 0.0;
  for (const double strain : {e, -e}) {
    const auto density = [&](double lateral) {
      Eigen::Matrix2d f = Eigen::Matrix2d::Identity();
      f(axis, axis) += strain;
      f(1 - axis, 1 - axis) += lateral;
      return energyDensity(model, f);
    };
    const double low = density(-e), middle = density(0.0), high = density(e);
    const double free = 0.5 * e * (low - high) / (low - 2.0 * middle + high);
    sum += 2.0 * density(free) / (strain * strain);
  }
  return 0.5 * sum;
}

Model membraneOf(const Fabric& fabric, int columns, int rows) {
  ClothSpec spec = clothOf(columns, rows, 0.02, fabric);
  spec.springs.bend = false;
  return buildModel(spec);
}

class PresetStiffness : public testing::TestWithParam<std::string> {};

// With e = 1e-4 the error of the method above is a few e^2 = 1e-8; border springs count by the area
// that they stand for, so a patch of any size is as stiff as the fabric.
constexpr double kStiffnessTolerance = 1e-7;

TEST_P(PresetStiffness, OfAPatchAlongBothThreadsIsTheFabrics) {
  const Fabric fabric = fabricPreset(GetParam());
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(5, 5), std::pair(9, 4)}) {
    const Model model = membraneOf(fabric, columns, rows);
    EXPECT_NEAR(uniaxialStiffness(model, 0) / fabric.tensileWarp, 1.0, kStiffnessTolerance);
    EXPECT_NEAR(uniaxialStiffness(model, 1) / fabric.tensileWeft, 1.0, kStiffnessTolerance);
  }
}

TEST_P(PresetStiffness, OfAPatchInShearIsTheFabrics) {
  // A simple shear g stretches one thread by g^2/2 as well, which adds K g^2 / (4 G): below 1e-8
  // for K/G < 400 and g = 1e-5. The mean over both signs removes the term of O(g).
  const Fabric fabric = fabricPreset(GetParam());
  const Model model = membraneOf(fabric, 6, 5);
  const double g = 1e-5;
  double sum = 0.0;
  for (const double angle : {g, -g}) {
    Eigen::Matrix2d f = Eigen::Matrix2d::Identity();
    f(0, 1) = angle;
    sum += 2.0 * energyDensity(model, f) / (g * g);
  }
  EXPECT_NEAR(0.5 * sum / fabric.shear, 1.0, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(All, PresetStiffness, testing::ValuesIn(fabricPresetNames()),
                         [](const auto& test) { return test.param; });

TEST(SpringStiffness, BendSpringsAddNoTension) {
  // What bend springs add in tension is taken from the structural ones. The bend springs of a row
  // of n stand for n - 2 of its n - 1 spacings, so a patch lacks C_b / (n - 1), where C_b =
  // 4 l^2 * 16 B / (l^4 theta^2), theta = 50 l (docs/model.md). Without shear the energy is exactly
  // quadratic, so only rounding remains: 1e-16 / e of a length, relative to e.
  Fabric fabric = fabricPreset("silk");
  fabric.shear = 0.0;
  const double l = 0.02;
  const double fold = 50.0 * l;
  const double bend = 64.0 * fabric.bending / (l * l * fold * fold);
  ASSERT_LT(bend, 0.5 * fabric.tensileWeft) << "else the cap is tested";
  for (const int n : {4, 8, 16}) {
    const Model model = buildModel(clothOf(n, n, l, fabric));
    EXPECT_NEAR(uniaxialStiffness(model, 0), fabric.tensileWarp - bend / (n - 1), 1e-4);
    EXPECT_NEAR(uniaxialStiffness(model, 1), fabric.tensileWeft - bend / (n - 1), 1e-4);
  }
}

TEST(SpringStiffness, DoesNotDependOnTheMeshWidth) {
  const Fabric fabric = fabricPreset("cotton");
  for (const double spacing : {0.1, 0.01, 0.001}) {
    ClothSpec spec = clothOf(5, 5, spacing, fabric);
    spec.springs.bend = false;
    EXPECT_NEAR(uniaxialStiffness(buildModel(spec), 0) / fabric.tensileWarp, 1.0,
                kStiffnessTolerance);
  }
}

// ---- raw constants
// -------------------------------------------------------------------------------

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
  springs.follow(mesh, editor.finish());

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

// ---- following edits
// -----------------------------------------------------------------------------

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

bool same(const Spring& s, const Spring& t) { return s.a == t.a && rowOf(s) == rowOf(t); }

/// The slots that `changes` names, and no others, differ between `before` and `after`.
void expectChangesTell(const std::vector<Spring>& before, const std::vector<Spring>& after,
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

/// `standingOn` names, for every vertex, the springs whose support it is in, and no others.
void expectStandingAgrees(const TriangleMesh& mesh, const SpringNetwork& springs) {
  std::vector<std::vector<std::int32_t>> expected(mesh.vertexCount());
  const auto count = static_cast<std::int32_t>(springs.slots().size());
  for (std::int32_t slot = 0; slot < count; ++slot) {
    for (VertexId v : springs[slot].support) {
      if (v != kNone) expected[v].push_back(slot);
    }
  }
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    std::vector<std::int32_t> listed = springs.standingOn(v);
    std::sort(listed.begin(), listed.end());
    EXPECT_EQ(listed, expected[v]) << "vertex " << v;
  }
}

TEST(SpringNetworkFollow, GivesTheNetworkOfTheEditedMesh) {
  // The same sums over the same faces in the same order: equal to the bit.
  Generator random(11);
  for (int sequence = 0; sequence < 20; ++sequence) {
    const Grid grid{whole(random, 2, 8), whole(random, 2, 8), 0.7, 0.9};
    TriangleMesh mesh = makeGridMesh(grid);
    const Fabric fabric = fabricPreset("denim");
    const SpringSelection selection{sequence % 3 != 1, sequence % 3 != 2};
    SpringNetwork springs(mesh, fabric, selection);
    for (int edit = 0; edit < 15; ++edit) {
      MeshEditor editor(mesh);
      for (int k = whole(random, 1, 3); k > 0; --k) {
        const Opening opening = randomOpening(mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      const std::vector<Spring> before = springs.slots();
      const SpringChanges changes = springs.follow(mesh, editor.finish());
      expectChangesTell(before, springs.slots(), changes);
      expectStandingAgrees(mesh, springs);
      const SpringNetwork scratch(mesh, fabric, selection);
      ASSERT_EQ(sortedRows(springs), sortedRows(scratch))
          << "sequence " << sequence << ", edit " << edit;
      for (int kind = 0; kind < kSpringKinds; ++kind) {
        EXPECT_EQ(springs.count(static_cast<SpringKind>(kind)),
                  scratch.count(static_cast<SpringKind>(kind)));
      }
    }
  }
}

TEST(SpringNetworkFollow, KeepsTheSlotOfASpringWhoseEndWasSplit) {
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
  const SpringChanges changes = springs.follow(mesh, editor.finish());
  EXPECT_EQ(slotBetween(25, grid.vertex(3, 2)), slot);
  EXPECT_THAT(changes.modified, testing::Contains(slot));
}

TEST(SpringNetworkFollow, DoesNothingForNoChange) {
  TriangleMesh mesh = makeGridMesh({4, 4, 1.0, 1.0});
  SpringNetwork springs(mesh, fabricPreset("silk"), {});
  MeshEditor editor(mesh);
  const SpringChanges changes = springs.follow(mesh, editor.finish());
  EXPECT_TRUE(changes.added.empty() && changes.modified.empty() && changes.removed.empty());
}

// ---- masses
// --------------------------------------------------------------------------------------

TEST(Masses, AreAThirdOfEveryFaceToEachCorner) {
  const Grid grid{4, 4, 0.3, 0.3};
  const TriangleMesh mesh = makeGridMesh(grid);
  const double face = 0.2 * 0.5 * 0.1 * 0.1;  // density times area [kg]
  const VertexData<double> mass = lumpedMasses(mesh, 0.2);
  EXPECT_NEAR(mass[grid.vertex(1, 1)], 6 * face / 3, 1e-18);
  EXPECT_NEAR(mass[grid.vertex(1, 0)], 3 * face / 3, 1e-18);
  EXPECT_NEAR(mass[grid.vertex(0, 0)], 2 * face / 3, 1e-18);
  EXPECT_NEAR(mass[grid.vertex(3, 0)], 1 * face / 3, 1e-18);
}

TEST(Masses, FollowSplitsByTheAreaOnEachSideAndKeepTheTotal) {
  Generator random(5);
  for (int sequence = 0; sequence < 20; ++sequence) {
    TriangleMesh mesh = makeGridMesh({6, 6, 0.5, 0.5});
    VertexData<double> mass = lumpedMasses(mesh, 0.3);
    double before = 0.0;
    for (double m : mass) before += m;
    for (int edit = 0; edit < 10; ++edit) {
      MeshEditor editor(mesh);
      for (int k = 0; k < 3; ++k) {
        const Opening opening = randomOpening(mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      shareMass(mesh, editor.finish(), mass);
    }
    double after = 0.0;
    for (double m : mass) after += m;
    EXPECT_NEAR(after, before, 1e-12 * before);
    // Masses that were by area stay by area.
    const VertexData<double> expected = lumpedMasses(mesh, 0.3);
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
      EXPECT_NEAR(mass[v], expected[v], 1e-12 * expected[v]);
    }
  }
}

TEST(Masses, OfEqualParticlesAreSharedToo) {
  TriangleMesh mesh = makeGridMesh({3, 3, 1.0, 1.0});
  VertexData<double> mass(9, 1.0);
  MeshEditor editor(mesh);
  ASSERT_TRUE(editor.splitVertex(4, {mesh.facesAround(4)[0]}));
  shareMass(mesh, editor.finish(), mass);
  EXPECT_DOUBLE_EQ(mass[9], 1.0 / 6.0);  // one of six equal faces
  EXPECT_DOUBLE_EQ(mass[4], 5.0 / 6.0);
}

}  // namespace
}  // namespace cloth_sim
