/// \file The tearing criterion: overloaded springs, and the lines along which the surface opens.

#include "cloth_sim/surgery/tearing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "surgery/tear_line.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kStep = 0.01;  // [s]

TearingSettings tearingAt(double structural, std::optional<Seam> seam = std::nullopt) {
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio = {structural, kNever, kNever};
  settings.seam = std::move(seam);
  return settings;
}

Model clothModel(int columns, int rows) { return buildModel(clothOf(columns, rows, 0.1)); }

/// Returns a state stretched along u by `factor`.
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

std::set<SpringKind> overloadedKinds(const Model& model, const CutPlan& plan) {
  std::set<SpringKind> kinds;
  for (std::int32_t slot : plan.overloaded) kinds.insert(model.springs[slot].kind);
  return kinds;
}

double lengthOf(const SurfacePath& path) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    length += (path.points[k + 1].material - path.points[k].material).norm();
  }
  return length;
}

/// Cuts a flat cloth along a line in material coordinates.
SurgeryResult cutAlong(const std::vector<Vec2>& line, Model& model, State& state) {
  VertexData<Vec3> flat(state.x.size(), Vec3::Zero());
  for (VertexId v = 0; v < model.particleCount(); ++v) flat[v].head<2>() = model.mesh.material(v);
  std::vector<Vec3> path;
  for (const Vec2& p : line) path.emplace_back(p.x(), p.y(), 0.0);
  CutPlan plan;
  plan.paths = findPaths(strokeAlong(path, Vec3::UnitZ(), 1.0), model.mesh, flat);
  return cut(plan, {}, {}, model, state);
}

/// Plans and cuts until nothing more tears, as in one step of the simulation.
std::vector<SurgeryResult> tearOut(Tearing& tearing, Model& model, State& state,
                                   std::set<std::int32_t>* overloaded = nullptr) {
  std::vector<SurgeryResult> results;
  for (int k = 0; k < 500; ++k) {
    const CutPlan plan = tearing.plan(model, state, kStep);
    if (plan.paths.empty()) return results;
    if (overloaded != nullptr) overloaded->insert(plan.overloaded.begin(), plan.overloaded.end());
    results.push_back(cut(plan, {}, {}, model, state));
    tearing.noteOpened(results.back());
    tearing.applyChanges(model, results.back().changes);
  }
  ADD_FAILURE() << "no end of it";
  return results;
}

TEST(TearingPlan, IsEmptyWhereNothingPassesItsLimit) {
  const Model model = clothModel(6, 6);
  const CutPlan none = Tearing(tearingAt(1.3), model).plan(model, pulled(model, 1.2), kStep);
  EXPECT_TRUE(none.paths.empty());
  EXPECT_TRUE(none.overloaded.empty());
  const CutPlan some = Tearing(tearingAt(1.1), model).plan(model, pulled(model, 1.2), kStep);
  EXPECT_FALSE(some.paths.empty());
  EXPECT_EQ(some.cause, FailureCause::kTear);
}

TEST(TearingPlan, IsEmptyWhileDisabled) {
  const Model model = clothModel(6, 6);
  Tearing tearing(tearingAt(1.1), model);
  tearing.setEnabled(false);
  EXPECT_TRUE(tearing.plan(model, pulled(model, 2.0), kStep).paths.empty());
  tearing.setEnabled(true);
  EXPECT_FALSE(tearing.plan(model, pulled(model, 2.0), kStep).paths.empty());
}

TEST(TearingLimits, AreThoseOfSpringsBeyondHalfOfTheStrain) {
  const Model model = clothModel(6, 6);
  Tearing tearing(tearingAt(1.3), model);
  std::vector<LengthLimit> limits(1);
  tearing.listLimits(model, pulled(model, 1.14), limits);
  EXPECT_TRUE(limits.empty());
  tearing.listLimits(model, pulled(model, 1.16), limits);
  EXPECT_EQ(limits.size(), 30U);  // what runs along u
  for (const LengthLimit& limit : limits) {
    EXPECT_EQ(model.mesh.material(limit.a).y(), model.mesh.material(limit.b).y());
    EXPECT_NEAR(limit.length, 0.13, 1e-12);
  }
  tearing.setEnabled(false);
  tearing.listLimits(model, pulled(model, 1.16), limits);
  EXPECT_TRUE(limits.empty());
}

TEST(TearingPlan, TakesEachKindByItsOwnLimit) {
  // Pulled by 1.2 along u: warp springs stretch by 1.2, diagonals by sqrt((1.44 + 1) / 2) = 1.1045.
  const Model model = clothModel(6, 6);
  const State state = pulled(model, 1.2);
  Tearing tearing(tearingAt(kNever), model);
  tearing.setRatio({kNever, 1.10, kNever});
  EXPECT_EQ(overloadedKinds(model, tearing.plan(model, state, kStep)),
            std::set<SpringKind>{SpringKind::kShear});
  tearing.setRatio({kNever, 1.11, 1.19});
  EXPECT_EQ(overloadedKinds(model, tearing.plan(model, state, kStep)),
            std::set<SpringKind>{SpringKind::kBend});
  tearing.setRatio({1.19, 1.10, 1.21});
  EXPECT_EQ(overloadedKinds(model, tearing.plan(model, state, kStep)),
            (std::set<SpringKind>{SpringKind::kStructural, SpringKind::kShear}));
}

TEST(TearingPlan, NamesExactlyTheOverloadedSprings) {
  const Model model = clothModel(8, 8);
  TearingSettings settings = tearingAt(1.3);
  settings.ratio = {1.3, 1.2, 1.4};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const State state = shakenState(model, 0.04, 0.0, seed);
    Tearing tearing(settings, model);
    const CutPlan plan = tearing.plan(model, state, kStep);
    std::vector<std::int32_t> expected;
    for (std::int32_t slot = 0; slot < model.springs.count(); ++slot) {
      if (overload(model, state, slot, settings.ratio) > 1.0) expected.push_back(slot);
    }
    ASSERT_GT(expected.size(), 3U);
    EXPECT_EQ(plan.overloaded, expected);
  }
}

TEST(TearingPlan, BeginsAtTheMostOverloadedAndNotNearATearThatBegins) {
  // No line begins within three edges of another one's spring; the first is through the faces of
  // the most overloaded spring.
  const Model model = clothModel(30, 30);
  const TearingSettings settings = tearingAt(1.3);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const State state = shakenState(model, 0.04, 0.0, seed);
    Tearing tearing(settings, model);
    const CutPlan plan = tearing.plan(model, state, kStep);
    ASSERT_GE(plan.paths.size(), 1U);
    const auto worst = std::max_element(plan.overloaded.begin(), plan.overloaded.end(),
                                        [&](std::int32_t a, std::int32_t b) {
                                          return overload(model, state, a, settings.ratio) <
                                                 overload(model, state, b, settings.ratio);
                                        });
    const Spring& spring = model.springs[*worst];
    const Vec2 middle = 0.5 * (model.mesh.material(spring.a) + model.mesh.material(spring.b));
    const SurfacePath& first = plan.paths.front();
    // The line lies over the two faces on the spring, no farther away than two of their edges.
    EXPECT_LT((first.points.front().material - middle).norm(), 2.0 * 0.1 * std::sqrt(2.0));
    for (std::size_t k = 0; k < plan.paths.size(); ++k) {
      for (std::size_t j = 0; j < k; ++j) {
        EXPECT_GT((plan.paths[k].points[0].material - plan.paths[j].points[0].material).norm(),
                  0.1 * (3.0 - 2.0 * std::sqrt(2.0)))
            << "two tears begin at the same place";
      }
    }
  }
}

TEST(TearingPlan, TheGateAllowsWhatCrossesTheSeam) {
  const Model model = clothModel(9, 6);
  Tearing tearing(tearingAt(1.1, Seam{{{0.35, 0.0}, {0.35, 0.5}}, 0.0}), model);
  const CutPlan plan = tearing.plan(model, pulled(model, 1.5), kStep);
  ASSERT_EQ(plan.overloaded.size(), 6U) << "one per row";
  for (std::int32_t slot : plan.overloaded) {
    const Spring& spring = model.springs[slot];
    EXPECT_NEAR(model.mesh.material(spring.a).x(), 0.3, 1e-12);
    EXPECT_NEAR(model.mesh.material(spring.b).x(), 0.4, 1e-12);
  }
  ASSERT_FALSE(plan.paths.empty());
  for (const SurfacePath& path : plan.paths) {
    for (const SurfacePoint& p : path.points) EXPECT_NEAR(p.material.x(), 0.35, 1e-12);
  }
}

TEST(TearingPlan, TheHalfWidthWidensTheGate) {
  // Middles of warp springs are at u = 0.05, 0.15, ...: 0.16 around 0.4 allows 0.25 to 0.55.
  const Model model = clothModel(9, 6);
  Tearing tearing(tearingAt(1.1, Seam{{{0.4, 0.0}, {0.4, 0.5}}, 0.16}), model);
  std::set<int> columns;
  for (std::int32_t slot : tearing.plan(model, pulled(model, 1.5), kStep).overloaded) {
    columns.insert(model.springs[slot].a % 9);
  }
  EXPECT_THAT(columns, testing::ElementsAre(2, 3, 4, 5));
}

TEST(TearingPlan, ASeamOpensExactlyWhereItLies) {
  // Half-way between columns every row is split; elsewhere, a vertex may slide onto the seam along
  // the border instead, and then the spring that crossed it is not severed but shortened.
  for (const double u : {0.35, 0.337, 0.38}) {
    Model model = clothModel(9, 6);
    State state = pulled(model, 1.5);
    state.t = 2.5;
    TearingSettings settings = tearingAt(1.1, Seam{{{u, 0.0}, {u, 0.5}}, 0.0});
    settings.tipSpeed = 1e6;
    Tearing tearing(settings, model);
    std::set<std::pair<VertexId, VertexId>> springs;
    int overloaded = 0;
    for (const SurgeryResult& result : tearOut(tearing, model, state)) {
      EXPECT_LT(result.deviation, 1e-12);
      for (const FailureEvent& event : result.events) {
        EXPECT_EQ(event.time, 2.5);
        EXPECT_EQ(event.cause, FailureCause::kTear);
        if (event.kind != SpringKind::kStructural) continue;
        EXPECT_TRUE(springs.insert({event.a, event.b}).second) << "each fails once";
        if (u == 0.35) {
          EXPECT_NEAR(event.material.x(), u, 1e-12);
        }
        if (!event.overloaded) continue;
        ++overloaded;
        EXPECT_NEAR(event.stretch, 1.5, 1e-12);
      }
    }
    EXPECT_GE(overloaded, 1);
    EXPECT_LE(springs.size(), 6U);
    EXPECT_TRUE(u != 0.35 || springs.size() == 6U) << "one structural spring per row";
    const std::vector<double> areas = pieceAreas(model.mesh);
    ASSERT_EQ(areas.size(), 2U);
    EXPECT_NEAR(std::min(areas[0], areas[1]), u * 0.5, 1e-12);
    EXPECT_NEAR(std::max(areas[0], areas[1]), (0.8 - u) * 0.5, 1e-12);
  }
}

TEST(TearingPlan, ATearGoesOnFromTheTipOfACut) {
  // A notch at the lower border, and one overloaded spring near its tip: the line begins there.
  Model model = clothModel(9, 9);
  State state = flatState(model);
  Tearing tearing(tearingAt(1.4), model);
  const SurgeryResult notch = cutAlong({{0.35, -0.1}, {0.35, 0.25}}, model, state);
  tearing.noteTips(notch);
  tearing.applyChanges(model, notch.changes);
  for (Vec3& x : state.x) x.x() *= 1.5;
  const CutPlan plan = tearing.plan(model, state, kStep);
  ASSERT_FALSE(plan.paths.empty());
  const auto fromTip = [](const SurfacePath& path) {
    return (path.points.front().material - Vec2(0.35, 0.25)).norm() < 1e-9;
  };
  const auto onward = std::find_if(plan.paths.begin(), plan.paths.end(), fromTip);
  ASSERT_NE(onward, plan.paths.end());
  // Pulled along u alone: it runs along v, onwards.
  const Vec2 run = onward->points.back().material - onward->points.front().material;
  EXPECT_GT(run.y(), 0.0);
  EXPECT_LT(std::abs(run.x()), 0.2 * run.y());
}

TEST(TearingSpeed, ATipRunsNoFasterThanItMay) {
  // A notched cloth, overloaded everywhere, over 0.1 s at 2 m/s: the tip of the notch gets 0.2 m
  // on, one stride more at most, whatever the step.
  for (const double dt : {0.002, 0.005, 0.01, 0.02}) {
    Model model = clothModel(21, 21);
    State state = flatState(model);
    TearingSettings settings = tearingAt(1.4);
    settings.tipSpeed = 2.0;
    Tearing tearing(settings, model);
    const SurgeryResult notch = cutAlong({{1.03, -0.1}, {1.03, 0.45}}, model, state);
    tearing.noteTips(notch);
    tearing.applyChanges(model, notch.changes);
    for (Vec3& x : state.x) {
      // Only the middle columns are pulled: the rest moves along.
      if (x.x() > 0.9) x.x() += std::min(x.x() - 0.9, 0.2);
    }
    double length = 0.0;
    double longest = 0.0;
    for (double t = dt; t < 0.1 + 1e-9; t += dt) {
      state.t = t;
      for (int stride = 0; stride < 16; ++stride) {
        const CutPlan plan = tearing.plan(model, state, dt);
        if (plan.paths.empty()) break;
        for (const SurfacePath& path : plan.paths) {
          if (path.points.front().material.y() < 0.44) continue;
          longest = std::max(longest, lengthOf(path));
          length += lengthOf(path);
        }
        const SurgeryResult result = cut(plan, {}, {}, model, state);
        tearing.noteOpened(result);
        tearing.applyChanges(model, result.changes);
      }
    }
    EXPECT_GT(longest, 0.0) << dt;
    EXPECT_GE(length, 0.2 - longest - 2.0 * dt) << dt;
    EXPECT_LE(length, 0.2 + longest + 2.0 * dt) << dt;
  }
}

TEST(TearingChanges, SpringsThatAnEditMadeMayFailToo) {
  // Pulled farther and farther, at an angle to the threads, so that tears split springs.
  const Vec2 d(std::cos(0.4), std::sin(0.4));
  Model model = clothModel(9, 6);
  State state = flatState(model);
  TearingSettings settings = tearingAt(1.1);
  settings.tipSpeed = 1e6;
  Tearing tearing(settings, model);
  const auto before = static_cast<std::int32_t>(model.springs.slots().size());
  std::set<std::int32_t> overloaded;
  for (int round = 0; round < 12; ++round) {
    for (Vec3& x : state.x) x.head<2>() += 0.07 * d.dot(x.head<2>()) * d;
    state.t += 2.0;  // longer than it is known where tears ran
    tearOut(tearing, model, state, &overloaded);
  }
  ASSERT_FALSE(overloaded.empty());
  EXPECT_GE(*overloaded.rbegin(), before);
  EXPECT_GT(connectedComponents(model.mesh).count, 1);
  EXPECT_EQ(validationError(model.mesh), "");
}

TEST(TearingChanges, SeesAfterEditsWhatANewOneWould) {
  const auto limitsOf = [](Tearing& tearing, const Model& model, const State& state) {
    std::vector<LengthLimit> limits;
    tearing.listLimits(model, state, limits);
    std::vector<std::tuple<VertexId, VertexId, double>> found;
    for (const LengthLimit& limit : limits) found.emplace_back(limit.a, limit.b, limit.length);
    return found;
  };
  TearingSettings settings = tearingAt(1.3);
  settings.ratio = {1.3, 1.35, 1.4};
  Generator random(5);
  std::size_t most = 0;
  for (const int generations : {0, 1}) {
    Model model = clothModel(30, 30);
    State state = pulled(model, 1.14);
    Tearing tearing(settings, model);
    for (int step = 0; step < 40; ++step) {
      for (Vec3& x : state.x) x += randomVector(random, 1e-4);
      if (step % 4 == 0) {
        CutPlan plan;
        const auto place = [&] {
          return Vec3(uniform(random, 0.1, 3.0), uniform(random, 0.1, 2.8), 0.0);
        };
        plan.paths =
            findPaths(strokeAlong({place(), place()}, Vec3::UnitZ(), 1.0), model.mesh, state.x);
        if (generations > 0) plan.refine = Refinement{0.1, generations, 0.0};
        const SurgeryResult result = cut(plan, {}, {}, model, state);
        tearing.applyChanges(model, result.changes);
      }
      Tearing fresh(settings, model);
      const auto limits = limitsOf(tearing, model, state);
      ASSERT_EQ(limits, limitsOf(fresh, model, state)) << "step " << step;
      most = std::max(most, limits.size());
    }
  }
  EXPECT_GT(most, 20U);
}

TEST(TearLine, TensionPointsAlongThePull) {
  // A patch pulled by 1.2 along a direction, and not at all across: largest traction there, within
  // what the weave (stiffer along its threads) turns it by.
  const Model model = buildModel(clothOf(9, 9, 0.1, fabricPreset("interlock")));
  for (const double angle : {0.0, 0.5 * M_PI, 0.25 * M_PI}) {
    const Vec2 d(std::cos(angle), std::sin(angle));
    State state = flatState(model);
    for (Vec3& x : state.x) x.head<2>() += 0.2 * d.dot(x.head<2>()) * d;
    const Vec2 found = tensionDirection(model, state, model.cloths[0].grid->vertex(4, 4));
    EXPECT_NEAR(found.norm(), 1.0, 1e-12);
    EXPECT_GT(std::abs(found.dot(d)), std::cos(0.2)) << angle;
  }
}

TEST(Notch, OutsideOfTheClothOpensNothing) {
  Model model = clothModel(6, 6);
  State state = flatState(model);
  const std::uint64_t hash = stateHash(model, state);
  for (const auto& line :
       {std::vector<Vec2>{{-0.05, 0.0}, {-0.05, 0.5}}, {{0.05, 0.6}, {0.05, 0.7}}}) {
    const SurgeryResult result = cutAlong(line, model, state);
    EXPECT_TRUE(result.changes.mesh.empty());
    EXPECT_TRUE(result.events.empty());
  }
  EXPECT_EQ(stateHash(model, state), hash);
}

TEST(Notch, SeversTheTwelveRowsThatItCrosses) {
  // The published scene: a notch between columns 63 and 64, up to v = 0.089: it crosses rows 0 to
  // 11 (12/127 m is beyond). Their structural springs are severed, once each, and the halves live.
  ClothSpec spec = clothOf(128, 20, 1.0 / 127.0);
  spec.springs.bend = false;
  Model model = buildModel(spec);
  State state = flatState(model);
  const SurgeryResult result = cutAlong({{0.5, 0.0}, {0.5, 0.089}}, model, state);
  std::set<int> rows;
  for (const FailureEvent& event : result.events) {
    EXPECT_EQ(event.cause, FailureCause::kCut);
    EXPECT_FALSE(event.overloaded);
    if (event.kind != SpringKind::kStructural) continue;
    EXPECT_NEAR(event.material.x(), 0.5, 1e-12);
    EXPECT_TRUE(rows.insert(static_cast<int>(std::lround(event.material.y() * 127.0))).second);
  }
  EXPECT_EQ(rows.size(), 12U);
  EXPECT_EQ(*rows.begin(), 0);
  EXPECT_EQ(*rows.rbegin(), 11);
  EXPECT_NEAR(result.length, 0.089, 1e-12);
  EXPECT_EQ(connectedComponents(model.mesh).count, 1);
}

}  // namespace
}  // namespace cloth_sim
