/// \file Spring networks: the springs of grids, their joint stiffness, and their updates after
/// edits.

#include "cloth_sim/cloth/spring_network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

// ---- which there are ----------------------------------------------------------------------------

TEST(SpringNetwork, OfAGridHasFewDifferentSpringsAndKeepsEachOnce) {
  // Otherwise a cloth of a million particles takes half as much memory again.
  for (const char* fabric : {"cotton", "silk", "denim"}) {
    for (const int side : {33, 64, 128}) {
      const SpringNetwork springs(makeGridMesh({side, side, 1.0, 1.0}), fabricPreset(fabric), {});
      EXPECT_LT(springs.slots().typeCount(), springs.slots().size() / 20)
          << fabric << ", " << side << " particles a side";
    }
  }
}

TEST(SpringNetwork, DoesNotDependOnTheDiagonalsOfTheCells) {
  using Key = std::tuple<SpringKind, VertexId, VertexId>;
  const auto constants = [](Diagonals diagonals) {
    ClothSpec cloth = clothOf(6, 7, 0.1, fabricPreset("cotton"));
    cloth.springs.bend = false;  // their areas follow the masses, which do depend
    cloth.diagonals = diagonals;
    const Model model = buildModel(cloth);
    std::map<Key, double> all;
    for (const Spring& spring : model.springs.slots()) {
      all[{spring.kind, std::min(spring.a, spring.b), std::max(spring.a, spring.b)}] =
          spring.stiffness;
    }
    return all;
  };
  const std::map<Key, double> oneWay = constants(Diagonals::kOneWay);
  const std::map<Key, double> alternating = constants(Diagonals::kAlternating);
  ASSERT_EQ(oneWay.size(), alternating.size());
  for (const auto& [spring, stiffness] : oneWay) {
    ASSERT_EQ(alternating.count(spring), 1u);
    EXPECT_NEAR(alternating.at(spring), stiffness, 1e-12 * stiffness);
  }
}

TEST(SpringNetwork, GridHasTheClassicStencil) {
  const int n = 7;
  const Model model = buildModel(clothOf(n, n, 0.1));
  EXPECT_EQ(model.springs.count(SpringKind::kStructural), 2 * n * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kShear), 2 * (n - 1) * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kBend), 2 * n * (n - 2));
  EXPECT_EQ(model.springs.count(), 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2));

  // Offsets, in columns and rows, at which the particle in the middle has neighbours.
  std::map<SpringKind, std::vector<std::pair<int, int>>> offsets;
  const VertexId middle = model.cloths[0].grid->vertex(3, 3);
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

// ---- how stiff they are together ----------------------------------------------------------------

/// Returns the elastic energy per rest area of cloth under the affine deformation `f` [J/m^2].
double energyDensity(const Model& model, const Eigen::Matrix2d& f) {
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v].head<2>() = f * model.mesh.material(v);
  }
  return energies(model, state, Vec3::Zero()).elastic / model.mesh.totalRestArea();
}

/// Returns 2 W / e^2, W the energy per area under a strain `e` along `axis`, with the other axis
/// free to contract. W is quadratic in the lateral strain up to relative terms of O(e), so three
/// values give its minimum. The mean over +e and -e removes the cubic term of W and leaves a
/// relative error of O(e^2).
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
  // The tension of bend springs is taken from the structural ones. The bend springs of a row
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

// ---- after bisections ---------------------------------------------------------------------------

/// A cloth of square cells, all of whose faces were bisected several times.
Model bisectedPatch(bool bend, int generations) {
  Scene scene;
  scene.cloths[0] = clothOf(9, 9, 0.02, fabricPreset("cotton"));
  scene.cloths[0].springs.bend = bend;
  Simulation simulation(scene);
  RefineMesh everywhere;
  everywhere.request.path = {Vec3::Zero()};
  everywhere.request.refinement = {1.0, generations, 0.0};
  EXPECT_TRUE(simulation.apply(everywhere).success);
  EXPECT_GE(simulation.model().mesh.faceCount(), (2 * 8 * 8) << generations);
  return simulation.model();
}

/// Strains of a patch along warp, along weft, in both, and in shear.
std::vector<Eigen::Matrix2d> patchStrains() {
  const double e = 1e-4;
  std::vector<Eigen::Matrix2d> all(4, Eigen::Matrix2d::Identity());
  all[0](0, 0) += e;
  all[1](1, 1) += e;
  all[2] *= 1.0 + e;
  all[3](0, 1) = all[3](1, 0) = 0.5 * e;
  return all;
}

/// Expects the energy of a strained patch to be that of the whole faces after 1 to 6 bisections.
/// \param tolerance  relative [-].
void expectEnergyKept(bool bend, double tolerance) {
  const Model whole = bisectedPatch(bend, 0);
  for (int generations = 1; generations <= 6; ++generations) {
    const Model parts = bisectedPatch(bend, generations);
    for (const Eigen::Matrix2d& f : patchStrains()) {
      const double ratio = energyDensity(parts, f) / energyDensity(whole, f);
      EXPECT_NEAR(ratio, 1.0, tolerance) << generations << " bisections, strain\n" << f;
    }
  }
}

TEST(SpringStiffness, OfAMembraneIsKeptByBisections) { expectEnergyKept(false, 1e-6); }

/// Bend springs of a border are missing, and so is what they would add in tension; the finer the
/// springs, the more this is.
TEST(SpringStiffness, WithBendSpringsIsKeptByBisections) { expectEnergyKept(true, 0.01); }

// ---- raw constants ------------------------------------------------------------------------------

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

// ---- following edits ----------------------------------------------------------------------------

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

/// Applies the changes of an edit, and checks that the network is the one of the edited mesh. The
/// sums run over the same faces in the same order, so they are equal to the bit.
void expectNetworkOfEditedMesh(const TriangleMesh& mesh, const MeshChanges& edit,
                               const Fabric& fabric, const SpringSelection& selection,
                               SpringNetwork& springs) {
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
    const Grid grid{whole(random, 2, 8), whole(random, 2, 8), 0.7, 0.9};
    TriangleMesh mesh = makeGridMesh(grid);
    const Fabric fabric = fabricPreset("denim");
    const SpringSelection selection{sequence % 3 != 1, sequence % 3 != 2};
    SpringNetwork springs(mesh, fabric, selection);
    for (int edit = 0; edit < 15; ++edit) {
      SCOPED_TRACE(testing::Message() << "sequence " << sequence << ", edit " << edit);
      MeshEditor editor(mesh);
      for (int k = whole(random, 1, 3); k > 0; --k) {
        const Opening opening = randomOpening(mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      ASSERT_NO_FATAL_FAILURE(
          expectNetworkOfEditedMesh(mesh, editor.finish(), fabric, selection, springs));
    }
  }
}

TEST(SpringNetworkChanges, GivesTheNetworkOfTheEditedMeshForEveryKindOfEdit) {
  Generator random(12);
  for (int sequence = 0; sequence < 20; ++sequence) {
    const Grid grid{whole(random, 3, 7), whole(random, 3, 7), 0.7, 0.9};
    TriangleMesh mesh = makeGridMesh(grid);
    const Fabric fabric = fabricPreset("denim");
    const SpringSelection selection{sequence % 3 != 1, sequence % 3 != 2};
    SpringNetwork springs(mesh, fabric, selection);
    MeshEditor editor(mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 60; ++edit) {
      SCOPED_TRACE(testing::Message() << "sequence " << sequence << ", edit " << edit);
      for (int k = whole(random, 1, 4); k > 0; --k) edits.any();
      ASSERT_NO_FATAL_FAILURE(
          expectNetworkOfEditedMesh(mesh, editor.finish(), fabric, selection, springs));
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

// ---- raw constants on refined meshes ------------------------------------------------------------

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

TEST(RawSprings, SpringsFarAwayKeepTheirBits) {
  const Grid grid{8, 8, 0.7, 0.7};
  TriangleMesh mesh = makeGridMesh(grid);
  SpringNetwork springs(mesh, kRaw, {});
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

// ---- masses -------------------------------------------------------------------------------------

Model modelOn(TriangleMesh mesh) {
  Model model;
  model.mesh = std::move(mesh);
  return model;
}

TEST(Masses, AreAThirdOfEveryFaceToEachCorner) {
  const Grid grid{4, 4, 0.3, 0.3};
  Model model = modelOn(makeGridMesh(grid));
  lumpMasses(0.2, model);
  const double face = 0.2 * 0.5 * grid.spacingU() * grid.spacingV();  // density times area [kg]
  EXPECT_NEAR(face, 0.2 * 0.5 * 0.1 * 0.1, 1e-14 * face);
  EXPECT_NEAR(model.mass[grid.vertex(1, 1)], 6 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(1, 0)], 3 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(0, 0)], 2 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(3, 0)], 1 * face / 3, 1e-18);
  for (double density : model.arealDensity) EXPECT_EQ(density, 0.2);
}

TEST(Masses, OfParticlesAreTheSameForAll) {
  Model model = modelOn(makeGridMesh({3, 3, 2.0, 2.0}));
  setParticleMasses(0.5, 0, model);
  for (double mass : model.mass) EXPECT_EQ(mass, 0.5);
  EXPECT_DOUBLE_EQ(model.arealDensity[4], 0.5 / (6 * 0.5 / 3));  // six faces around the middle
  EXPECT_DOUBLE_EQ(model.arealDensity[2], 0.5 / (1 * 0.5 / 3));
}

TEST(Masses, FollowSplitsByTheAreaOnEachSideAndKeepTheTotal) {
  Generator random(5);
  for (int sequence = 0; sequence < 20; ++sequence) {
    Model model = modelOn(makeGridMesh({6, 6, 0.5, 0.5}));
    lumpMasses(0.3, model);
    const double before = totalMass(model);
    for (int edit = 0; edit < 10; ++edit) {
      MeshEditor editor(model.mesh);
      for (int k = 0; k < 3; ++k) {
        const Opening opening = randomOpening(model.mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      applyMassChanges(editor.finish(), model);
    }
    EXPECT_NEAR(totalMass(model), before, 1e-13 * before);
    // Masses that were by area stay by area.
    Model expected = modelOn(model.mesh);
    lumpMasses(0.3, expected);
    for (VertexId v = 0; v < model.mesh.vertexCount(); ++v) {
      EXPECT_NEAR(model.mass[v], expected.mass[v], 1e-12 * expected.mass[v]);
    }
  }
}

TEST(Masses, OfEqualParticlesAreSharedToo) {
  Model model = modelOn(makeGridMesh({3, 3, 1.0, 1.0}));
  setParticleMasses(1.0, 0, model);
  MeshEditor editor(model.mesh);
  ASSERT_TRUE(editor.splitVertex(4, {model.mesh.facesAround(4)[0]}));
  applyMassChanges(editor.finish(), model);
  EXPECT_NEAR(model.mass[9], 1.0 / 6.0, 1e-15);  // one of six equal faces
  EXPECT_NEAR(model.mass[4], 5.0 / 6.0, 1e-15);
  EXPECT_NEAR(model.mass[8], 1.0, 1e-15) << "its own faces did not change";
}

enum class MassMode { kFabric, kParticles };

class AnyEdit : public testing::TestWithParam<MassMode> {};

TEST_P(AnyEdit, KeepsTheTotalMass) {
  Generator random(6);
  for (int sequence = 0; sequence < 10; ++sequence) {
    Model model = modelOn(irregularMesh({6, 5, 0.5, 0.4}, 0.2, random));
    if (GetParam() == MassMode::kFabric) {
      lumpMasses(0.3, model);
    } else {
      setParticleMasses(1e-3, 0, model);
    }
    const double before = totalMass(model);
    MeshEditor editor(model.mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 100; ++edit) {
      for (int k = whole(random, 1, 3); k > 0; --k) edits.any();
      applyMassChanges(editor.finish(), model);
      ASSERT_EQ(model.mass.size(), static_cast<std::size_t>(model.particleCount()));
    }
    EXPECT_NEAR(totalMass(model), before, 1e-13 * before);
    for (double mass : model.mass) EXPECT_GT(mass, 0.0);
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      const double lumped = model.arealDensity[v] * areaAround(model.mesh, v) / 3.0;
      EXPECT_NEAR(model.mass[v], lumped, 1e-12 * lumped);
      if (GetParam() == MassMode::kFabric) {
        EXPECT_NEAR(model.arealDensity[v], 0.3, 0.3e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Masses, AnyEdit, testing::Values(MassMode::kFabric, MassMode::kParticles),
                         [](const auto& test) {
                           return std::string(test.param == MassMode::kFabric ? "Fabric"
                                                                              : "Particles");
                         });

TEST(Masses, OfPiecesGoWithThem) {
  // Opened along the middle column of 3 x 3: two halves of the same area.
  Model model = modelOn(makeGridMesh({3, 3, 1.0, 1.0}));
  lumpMasses(0.3, model);
  MeshEditor editor(model.mesh);
  ASSERT_TRUE(editor.splitVertex(4, {3, 6, 7}));
  applyMassChanges(editor.finish(), model);
  ASSERT_EQ(connectedComponents(model.mesh).count, 2);
  editor.removeComponents({0, 1, 4, 5});
  applyMassChanges(editor.finish(), model);
  EXPECT_NEAR(totalMass(model), 0.15, 1e-15);
  Model expected = modelOn(model.mesh);
  lumpMasses(0.3, expected);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    EXPECT_NEAR(model.mass[v], expected.mass[v], 1e-15);
  }
}

}  // namespace
}  // namespace cloth_sim
