/// \file The order of sweeps: complete, without conflicts, mostly contiguous.

#include "cloth_sim/solver/spring_schedule.h"

#include <gtest/gtest.h>

#include <set>

#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/surgery/operation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Every existing spring has one position, with its ends and constants; all other positions are
/// without effect.
void expectHoldsEverySpringOnce(const Model& model, const SpringSchedule& schedule,
                                const std::vector<std::int32_t>& slotOf) {
  std::set<std::int32_t> used;
  const std::vector<Spring>& springs = model.springs.slots();
  for (std::size_t slot = 0; slot < springs.size(); ++slot) {
    const Spring& spring = springs[slot];
    if (!spring.exists()) continue;
    const std::int32_t p = schedule.positionOf(static_cast<std::int32_t>(slot));
    ASSERT_TRUE(p >= 0 && p < schedule.size()) << "spring " << slot;
    EXPECT_TRUE(used.insert(p).second) << "two springs at position " << p;
    EXPECT_EQ(schedule.endA[p], slotOf[spring.a]);
    EXPECT_EQ(schedule.endB[p], slotOf[spring.b]);
    EXPECT_EQ(schedule.restLength[p], spring.restLength);
    EXPECT_EQ(schedule.stiffness[p], spring.stiffness);
    EXPECT_EQ(schedule.dampingAt(p), spring.damping);
  }
  for (std::int32_t p = 0; p < schedule.size(); ++p) {
    if (used.count(p) != 0) continue;
    EXPECT_EQ(schedule.stiffness[p], 0.0) << "position " << p << " is nobody's";
    EXPECT_EQ(schedule.dampingAt(p), 0.0);
  }
}

/// Batches cover every position once. Springs of a span share no particle (one colour), and neither
/// do strands of a batch (they may run at once): not even springs without effect, as they too are
/// written.
void expectBatchesAreConflictFree(const SpringSchedule& schedule) {
  std::vector<int> visits(static_cast<std::size_t>(schedule.size()), 0);
  for (const SpringSchedule::Batch& batch : schedule.batches()) {
    std::set<std::int32_t> ofBatch;
    for (std::int32_t s = batch.firstStrand; s < batch.endStrand; ++s) {
      std::set<std::int32_t> ofStrand;
      const SpringSchedule::Strand& strand = schedule.strands()[s];
      for (std::int32_t k = strand.firstSpan; k < strand.endSpan; ++k) {
        const SpringSchedule::Span& span = schedule.spans()[k];
        std::set<std::int32_t> ofSpan;
        for (std::int32_t p = span.first; p < span.first + span.count; ++p) {
          ++visits[p];
          EXPECT_TRUE(ofSpan.insert(schedule.endA[p]).second) << "position " << p;
          EXPECT_TRUE(ofSpan.insert(schedule.endB[p]).second) << "position " << p;
          if (span.isRun) {
            EXPECT_EQ(schedule.endA[p], schedule.endA[span.first] + p - span.first);
            EXPECT_EQ(schedule.endB[p], schedule.endB[span.first] + p - span.first);
          }
        }
        ofStrand.insert(ofSpan.begin(), ofSpan.end());
      }
      for (std::int32_t particle : ofStrand) {
        EXPECT_TRUE(ofBatch.insert(particle).second) << "particle slot " << particle;
      }
    }
  }
  for (int count : visits) EXPECT_EQ(count, 1);
}

/// Of a model that has nothing but a mesh.
void expectGoodSchedule(Model model) {
  model.springs = SpringNetwork(model.mesh, fabricPreset("silk"), {});
  PackedParticles particles;
  particles.layOut(model);
  SpringSchedule schedule;
  schedule.build(model, particles.slotOf);
  expectHoldsEverySpringOnce(model, schedule, particles.slotOf);
  expectBatchesAreConflictFree(schedule);
}

double shareInRuns(const SpringSchedule& schedule) {
  std::int32_t inRuns = 0;
  for (const SpringSchedule::Span& span : schedule.spans()) inRuns += span.isRun ? span.count : 0;
  return static_cast<double>(inRuns) / schedule.size();
}

struct Scheduled {
  explicit Scheduled(const ClothSpec& spec) : model(buildModel(spec)), state(flatState(model)) {
    particles.layOut(model);
    schedule.build(model, particles.slotOf);
  }
  /// Cuts or refines the cloth somewhere; tells the particles, not the schedule.
  ModelChanges edit(Generator& random) {
    const Grid& grid = *model.cloths[0].grid;
    const auto somewhere = [&] {
      return Vec3(uniform(random, -0.1, 1.1) * grid.width, uniform(random, -0.1, 1.1) * grid.height,
                  0.0);
    };
    SurgeryLimits limits;
    limits.shape.minEdge = 0.05 * std::min(grid.spacingU(), grid.spacingV());
    const std::vector<Vec3> path{somewhere(), somewhere(), somewhere()};
    ModelChanges changes;
    if (random() % 4 == 0) {
      const Refinement refinement{1.5 * grid.spacingU(), 2, 0.0};
      changes = refine({{path[0]}, refinement}, limits, {}, model, state).changes;
    } else {
      CutPlan plan;
      plan.paths = findPaths(strokeAlong(path, Vec3::UnitZ(), 1.0), model.mesh, state.x);
      changes = cut(plan, limits, {}, model, state).changes;
    }
    if (!changes.mesh.empty()) particles.follow(changes.mesh);
    return changes;
  }
  void follow(const ModelChanges& changes) {
    schedule.follow(model, changes.springs, particles.slotOf);
  }

  Model model;
  State state;
  PackedParticles particles;
  SpringSchedule schedule;
};

TEST(SpringSchedule, OfAGrid) {
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(5, 3), std::pair(17, 30)}) {
    const Scheduled grid(clothOf(columns, rows, 0.1));
    expectHoldsEverySpringOnce(grid.model, grid.schedule, grid.particles.slotOf);
    expectBatchesAreConflictFree(grid.schedule);
  }
}

TEST(SpringSchedule, OfAMeshThatIsNoGrid) {
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {1, 0.1}, {0.9, 1}, {-0.1, 0.8}, {0.4, 0.5}},
                            {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  expectGoodSchedule(model);
}

TEST(SpringSchedule, OfAGridNeedsFewBatchesAndIsNearlyAllRuns) {
  // Two colours for each of six families of parallel springs, joined where strands of rows share
  // no particle (all but the springs between two strands and bend springs along columns). Runs are
  // a quarter of a row, and only at their seams (where a span crosses from one residue of the
  // interleaving to the next) are springs left over: fewer than one in ten at 64 columns.
  const Scheduled grid(clothOf(64, 64, 1.0 / 63.0));
  EXPECT_LE(grid.schedule.batches().size(), 4U);
  EXPECT_GT(shareInRuns(grid.schedule), 0.9);
}

TEST(SpringSchedule, HalvesOfEveryBatchOfALargeGridAreTheSameHalvesOfTheCloth) {
  // What one thread has moved in a batch another one should not have to fetch in the next.
  const int rows = 96;
  const Scheduled grid(clothOf(96, rows, 1.0 / 95.0));
  const SpringSchedule& schedule = grid.schedule;
  const auto rowOf = [](std::int32_t slot) { return slot / 96; };
  for (const SpringSchedule::Batch& batch : schedule.batches()) {
    const std::int32_t strands = batch.endStrand - batch.firstStrand;
    if (strands == 1) continue;
    EXPECT_EQ(strands % 2, 0);
    int lastOfFirstHalf = 0;
    int firstOfSecondHalf = rows;
    for (std::int32_t s = batch.firstStrand; s < batch.endStrand; ++s) {
      const bool isFirst = s - batch.firstStrand < strands / 2;
      const SpringSchedule::Strand& strand = schedule.strands()[s];
      for (std::int32_t k = strand.firstSpan; k < strand.endSpan; ++k) {
        const SpringSchedule::Span& span = schedule.spans()[k];
        for (std::int32_t p = span.first; p < span.first + span.count; ++p) {
          for (const std::int32_t end : {schedule.endA[p], schedule.endB[p]}) {
            if (isFirst) lastOfFirstHalf = std::max(lastOfFirstHalf, rowOf(end));
            if (!isFirst) firstOfSecondHalf = std::min(firstOfSecondHalf, rowOf(end));
          }
        }
      }
    }
    EXPECT_NEAR(lastOfFirstHalf, rows / 2, 4);
    EXPECT_NEAR(firstOfSecondHalf, rows / 2, 4);
  }
}

TEST(SpringSchedule, HoldsAParticleWithMoreSpringsThanOneWordHasColours) {
  const int petals = 150;  // a fan around one particle
  std::vector<Vec2> material{{0.0, 0.0}};
  std::vector<Face> faces;
  for (int k = 0; k < petals; ++k) {
    const double angle = 2.0 * M_PI * k / petals;
    material.emplace_back(std::cos(angle), std::sin(angle));
    faces.push_back({0, 1 + k, 1 + (k + 1) % petals});
  }
  Model model;
  model.mesh = TriangleMesh(material, faces);
  expectGoodSchedule(model);
}

TEST(SpringSchedule, StaysCompleteAndConflictFreeOverCutsAndRefinements) {
  Generator random(17);
  for (int sequence = 0; sequence < 10; ++sequence) {
    Scheduled cloth(clothOf(whole(random, 2, 12), whole(random, 2, 20), 0.05));
    for (int edit = 0; edit < 8; ++edit) {
      cloth.follow(cloth.edit(random));
      expectHoldsEverySpringOnce(cloth.model, cloth.schedule, cloth.particles.slotOf);
      expectBatchesAreConflictFree(cloth.schedule);
    }
  }
}

TEST(SpringSchedule, DependsOnTheSlotsAloneAndNotOnTheOrderOfEdits) {
  // One schedule follows every edit as it comes, the other all of them at the end.
  const ClothSpec spec = clothOf(9, 9, 0.1);
  Scheduled stepwise(spec);
  Scheduled atOnce(spec);
  Generator random(23), again(23);
  SpringChanges all;
  std::set<std::int32_t> seen;
  for (int edit = 0; edit < 8; ++edit) {
    stepwise.follow(stepwise.edit(random));
    const ModelChanges changes = atOnce.edit(again);
    for (const auto* slots :
         {&changes.springs.added, &changes.springs.modified, &changes.springs.removed}) {
      seen.insert(slots->begin(), slots->end());
    }
  }
  all.modified.assign(seen.begin(), seen.end());
  atOnce.schedule.follow(atOnce.model, all, atOnce.particles.slotOf);
  EXPECT_EQ(atOnce.schedule.endA, stepwise.schedule.endA);
  EXPECT_EQ(atOnce.schedule.endB, stepwise.schedule.endB);
  EXPECT_EQ(atOnce.schedule.stiffness, stepwise.schedule.stiffness);
  // A spring that changed before it went leaves another length behind, without effect.
  for (std::int32_t p = 0; p < stepwise.schedule.size(); ++p) {
    if (stepwise.schedule.stiffness[p] == 0.0) continue;
    EXPECT_EQ(atOnce.schedule.restLength[p], stepwise.schedule.restLength[p]) << p;
  }
}

TEST(PackedParticles, LayOutIsAPermutationOfTheGrid) {
  for (const int columns : {2, 3, 4, 5, 6, 7, 8, 13}) {
    const Model model = buildModel(clothOf(columns, 3, 0.1));
    PackedParticles particles;
    particles.layOut(model);
    const std::set<std::int32_t> slots(particles.slotOf.begin(), particles.slotOf.end());
    EXPECT_EQ(slots.size(), static_cast<std::size_t>(model.particleCount()));
    EXPECT_EQ(*slots.begin(), 0);
    EXPECT_EQ(*slots.rbegin(), model.particleCount() - 1);
  }
}

}  // namespace
}  // namespace cloth_sim
