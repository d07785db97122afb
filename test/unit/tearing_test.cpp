/// \file Which springs fail, and where the surface opens for them.

#include "cloth_sim/surgery/tearing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "cloth_sim/surgery/apply.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kNever = std::numeric_limits<double>::infinity();

TearingSettings tearingAt(double structural, std::optional<Seam> seam = std::nullopt) {
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio = {structural, kNever, kNever};
  settings.seam = std::move(seam);
  return settings;
}

/// Stretched along u by `factor`.
State pulled(const Model& model, double factor) {
  State state = flatState(model);
  for (Vec3& x : state.x) x.x() *= factor;
  return state;
}

double overload(const Model& model, const State& state, std::int32_t slot,
                const TearRatios& ratio) {
  const Spring& spring = model.springs[slot];
  return stretch(spring, state) / ratio[static_cast<std::size_t>(spring.kind)];
}

TEST(TearingPlan, IsEmptyWhereNothingPassesItsLimit) {
  const Model model = buildModel(clothOf(6, 6, 0.1));
  EXPECT_TRUE(Tearing(tearingAt(1.3), model).plan(model, pulled(model, 1.2)).empty());
  EXPECT_FALSE(Tearing(tearingAt(1.1), model).plan(model, pulled(model, 1.2)).empty());
}

TEST(TearingPlan, IsEmptyWhileDisabled) {
  const Model model = buildModel(clothOf(6, 6, 0.1));
  Tearing tearing(tearingAt(1.1), model);
  tearing.setEnabled(false);
  EXPECT_TRUE(tearing.plan(model, pulled(model, 2.0)).empty());
  tearing.setEnabled(true);
  EXPECT_FALSE(tearing.plan(model, pulled(model, 2.0)).empty());
}

TEST(TearingPlan, TakesEachKindByItsOwnLimit) {
  // Pulled by 1.2 along u: warp springs stretch by 1.2, diagonals by sqrt((1.44 + 1) / 2) = 1.1045.
  const Model model = buildModel(clothOf(6, 6, 0.1));
  Tearing tearing(tearingAt(kNever), model);
  tearing.setRatio({kNever, 1.10, kNever});
  std::set<SpringKind> kinds;
  for (const Opening& opening : tearing.plan(model, pulled(model, 1.2))) {
    for (std::int32_t slot : opening.springs) kinds.insert(model.springs[slot].kind);
  }
  EXPECT_EQ(kinds, std::set<SpringKind>{SpringKind::kShear});
  tearing.setRatio({kNever, 1.11, 1.19});
  kinds.clear();
  for (const Opening& opening : tearing.plan(model, pulled(model, 1.2))) {
    for (std::int32_t slot : opening.springs) kinds.insert(model.springs[slot].kind);
  }
  EXPECT_EQ(kinds, std::set<SpringKind>{SpringKind::kBend});
}

TEST(TearingPlan, OpensForTheMostOverloadedFirst) {
  const Model model = buildModel(clothOf(8, 8, 0.1));
  TearingSettings settings = tearingAt(1.3);
  settings.ratio = {1.3, 1.2, 1.4};
  const Tearing tearing(settings, model);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const State state = shakenState(model, 0.04, 0.0, seed);
    const std::vector<Opening> plan = tearing.plan(model, state);
    ASSERT_GT(plan.size(), 3U);
    std::set<VertexId> vertices;
    double previous = kNever;
    for (const Opening& opening : plan) {
      EXPECT_TRUE(vertices.insert(opening.vertex).second) << "one opening per vertex";
      const double now = overload(model, state, opening.springs.front(), settings.ratio);
      EXPECT_LE(now, previous);
      previous = now;
      for (std::int32_t slot : opening.springs) {
        EXPECT_GT(overload(model, state, slot, settings.ratio), 1.0);
        EXPECT_LE(overload(model, state, slot, settings.ratio), now);
      }
      EXPECT_FALSE(opening.detach.empty());
      EXPECT_LT(opening.detach.size(), model.mesh.facesAround(opening.vertex).size());
    }
  }
}

TEST(TearingPlan, TheGateAllowsWhatCrossesTheSeam) {
  const Model model = buildModel(clothOf(9, 6, 0.1));
  const Tearing tearing(tearingAt(1.1, Seam{{{0.35, 0.0}, {0.35, 0.5}}, 0.0}), model);
  const std::vector<Opening> plan = tearing.plan(model, pulled(model, 1.5));
  ASSERT_EQ(plan.size(), 6U) << "one per row";
  for (const Opening& opening : plan) {
    for (std::int32_t slot : opening.springs) {
      const Spring& spring = model.springs[slot];
      EXPECT_NEAR(model.mesh.material(spring.a).x(), 0.3, 1e-12);
      EXPECT_NEAR(model.mesh.material(spring.b).x(), 0.4, 1e-12);
    }
  }
}

TEST(TearingPlan, TheHalfWidthWidensTheGate) {
  // Middles of warp springs are at u = 0.05, 0.15, ...: 0.16 around 0.4 allows 0.25 to 0.55. Even
  // though it is on the seam itself, column 0.4 counts as right of it.
  const Model model = buildModel(clothOf(9, 6, 0.1));
  const Tearing tearing(tearingAt(1.1, Seam{{{0.4, 0.0}, {0.4, 0.5}}, 0.16}), model);
  std::set<int> columns;
  for (const Opening& opening : tearing.plan(model, pulled(model, 1.5))) {
    for (std::int32_t slot : opening.springs) columns.insert(model.springs[slot].a % 9);
  }
  EXPECT_THAT(columns, testing::ElementsAre(2, 3, 4, 5));
}

TEST(TearingPlan, ASeamWithinAColumnOfCellsOpensStraightAlongTheColumnToItsRight) {
  Model model = buildModel(clothOf(9, 6, 0.1));
  State state = pulled(model, 1.5);
  const Tearing tearing(tearingAt(1.1, Seam{{{0.35, 0.0}, {0.35, 0.5}}, 0.0}), model);
  const SurgeryResult result =
      openSurface(model, state, tearing.plan(model, state), FailureCause::kTear);
  std::set<VertexId> sources;
  for (const NewVertex& added : result.changes.mesh.newVertices) {
    EXPECT_TRUE(sources.insert(added.from[0]).second) << "split once";
    EXPECT_EQ(added.from[0] % 9, 4);
  }
  EXPECT_EQ(sources.size(), 6U);
  const std::vector<double> areas = pieceAreas(model.mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], 0.4 * 0.5, 1e-14);
  EXPECT_NEAR(areas[1], 0.4 * 0.5, 1e-14);
}

TEST(TearingPlan, ASpringWhoseFailureOpensNothingDoesNotFail) {
  // A single face: letting go of any corner would leave nothing behind at it.
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}});
  model.springs = SpringNetwork(model.mesh, fabricPreset("silk"), {});
  model.mass = lumpedMasses(model.mesh, 0.1);
  EXPECT_TRUE(Tearing(tearingAt(1.1), model).plan(model, pulled(model, 3.0)).empty());
}

TEST(TearingPlan, ACrackGoesOnFromItsTip) {
  // A notch of two rows at the lower border; then only the springs beside its tip are overloaded:
  // the one at the tip's left is the first to fail there, and the tip itself opens, not its
  // neighbour.
  Model model = buildModel(clothOf(7, 7, 0.1));
  State state = flatState(model);
  openSurface(model, state, planNotch(model, {{0.25, 0.0}, {0.25, 0.14}}), FailureCause::kCut);
  const VertexId tip = model.grid->vertex(3, 2);
  ASSERT_TRUE(model.mesh.isBoundary(tip));
  state.x[model.grid->vertex(2, 2)].x() -= 0.05;
  const std::vector<Opening> plan = Tearing(tearingAt(1.4), model).plan(model, state);
  ASSERT_EQ(plan.size(), 1U);
  EXPECT_EQ(plan[0].vertex, tip);
}

TEST(TearingFollow, SpringsThatAnEditMadeMayFailToo) {
  // Two openings of the same column, one after the other; everything still follows the gate.
  Model model = buildModel(clothOf(9, 6, 0.1));
  State state = pulled(model, 1.0);
  Tearing tearing(tearingAt(1.1), model);
  state.x[model.grid->vertex(4, 0)].x() += 0.02;
  int rounds = 0;
  for (std::vector<Opening> plan = tearing.plan(model, state); !plan.empty();
       plan = tearing.plan(model, state)) {
    ASSERT_LT(++rounds, 50);
    tearing.follow(model, openSurface(model, state, plan, FailureCause::kTear).changes);
    for (Vec3& x : state.x) x.x() *= 1.05;
    if (rounds == 20) break;
  }
  // Pulled by 1.05 every round, springs everywhere pass 1.1 in the third; every piece left over at
  // the end is a single column of faces or less.
  EXPECT_GT(findPieces(model.mesh).count, 7);
  EXPECT_EQ(describeDefect(model.mesh), "");
}

TEST(Notch, OpensTheTwelveRowsThatItCrosses) {
  // The published scene: the seam between columns 63 and 64, rows 0 to 11 (12/127 m is beyond). The
  // diagonals that cross between rows 11 and 12 do so at 11.5/127 = 0.09055: beyond its end, too.
  ClothSpec spec = clothOf(128, 20, 1.0 / 127.0);
  spec.springs.bend = false;
  Model model = buildModel(spec);
  State state = flatState(model);
  const std::vector<Opening> plan = planNotch(model, {{0.5, 0.0}, {0.5, 0.089}});
  const SurgeryResult result = openSurface(model, state, plan, FailureCause::kCut);
  std::set<VertexId> sources;
  for (const NewVertex& added : result.changes.mesh.newVertices) sources.insert(added.from[0]);
  std::set<VertexId> expected;
  for (int j = 0; j < 12; ++j) expected.insert(model.grid->vertex(64, j));
  EXPECT_EQ(sources, expected);
  EXPECT_EQ(result.changes.mesh.newVertices.size(), 12U);
  for (const FailureEvent& event : result.events) {
    EXPECT_EQ(event.cause, FailureCause::kCut);
    EXPECT_FALSE(event.overloaded);
  }
  EXPECT_EQ(findPieces(model.mesh).count, 1);
}

TEST(Notch, OutsideOfTheClothOpensNothing) {
  const Model model = buildModel(clothOf(6, 6, 0.1));
  EXPECT_TRUE(planNotch(model, {{-0.05, 0.0}, {-0.05, 0.5}}).empty());
  EXPECT_TRUE(planNotch(model, {{0.05, 0.6}, {0.05, 0.7}}).empty());
}

TEST(OpenSurface, DescribesEveryFailureOnce) {
  Model model = buildModel(clothOf(9, 6, 0.1));
  State state = pulled(model, 1.5);
  state.t = 2.5;
  const int before = model.springs.count();
  const Tearing tearing(tearingAt(1.1, Seam{{{0.35, 0.0}, {0.35, 0.5}}, 0.0}), model);
  const SurgeryResult result =
      openSurface(model, state, tearing.plan(model, state), FailureCause::kTear);
  std::set<std::tuple<VertexId, VertexId, SpringKind>> springs;
  int overloaded = 0;
  for (const FailureEvent& event : result.events) {
    EXPECT_TRUE(springs.insert({event.a, event.b, event.kind}).second);
    EXPECT_EQ(event.time, 2.5);
    EXPECT_EQ(event.cause, FailureCause::kTear);
    if (!event.overloaded) continue;
    ++overloaded;
    EXPECT_NEAR(event.stretch, 1.5, 1e-12);
    EXPECT_NEAR(event.material.x(), 0.35, 1e-12);
    EXPECT_NEAR(event.position.x(), 1.5 * 0.35, 1e-12);
  }
  // Six rows: when five have opened, the last comes apart with the one before it; its spring has
  // failed all the same.
  EXPECT_EQ(overloaded, 6);
  EXPECT_LT(static_cast<int>(result.events.size()), before);
}

TEST(OpenSurface, SplitsOnceWhereTwoOpeningsAskForTheSame) {
  Model model = buildModel(clothOf(5, 5, 0.1));
  State state = flatState(model);
  const VertexId v = model.grid->vertex(2, 2);
  const std::vector<FaceId> around = model.mesh.facesAround(v);
  const Opening first{v, {around[0], around[1]}, {0}};
  const Opening second{v, {around[0], around[1]}, {1}};
  const SurgeryResult result = openSurface(model, state, {first, second}, FailureCause::kCut);
  EXPECT_EQ(result.changes.mesh.newVertices.size(), 1U);
  ASSERT_GE(result.events.size(), 2U);  // both springs have failed
  EXPECT_EQ(result.events[0].a, model.springs[0].a);
  EXPECT_EQ(result.events[1].b, model.springs[1].b);
}

TEST(OpenSurface, WithNothingToOpenChangesNothing) {
  Model model = buildModel(clothOf(5, 5, 0.1));
  State state = flatState(model);
  const std::uint64_t hash = stateHash(model, state);
  const SurgeryResult result = openSurface(model, state, {}, FailureCause::kTear);
  EXPECT_TRUE(result.changes.mesh.empty());
  EXPECT_TRUE(result.events.empty());
  EXPECT_EQ(stateHash(model, state), hash);
}

}  // namespace
}  // namespace cloth_sim
