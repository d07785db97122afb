/// \file The order of sweeps: complete, without conflicts, mostly contiguous.

#include "constraints/spring_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "cloth_sim/threads/thread_limit.h"
#include "unit/scheduled.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Returns the springs of a schedule by position.
std::vector<SpringSchedule::Element> elementsOf(const SpringSchedule& schedule) {
  std::vector<SpringSchedule::Element> elements;
  schedule.forEach([&](const SpringSchedule::Element& spring) {
    EXPECT_EQ(spring.position, static_cast<std::int32_t>(elements.size()));
    elements.push_back(spring);
  });
  EXPECT_EQ(elements.size(), static_cast<std::size_t>(schedule.size()));
  return elements;
}

/// The springs there are, with their ends and parameters, are the elements that have stiffness.
void expectHoldsEverySpringOnce(const Model& model, const SpringSchedule& schedule,
                                const std::vector<std::int32_t>& slotOf) {
  using Row = std::tuple<std::int32_t, std::int32_t, double, double, double>;
  const auto row = [](std::int32_t a, std::int32_t b, const SpringParameters& p) {
    return Row(a, b, p.restLength, p.stiffness, p.damping);
  };
  std::multiset<Row> expected, found;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    expected.insert(row(slotOf[spring.a], slotOf[spring.b], spring.parameters()));
  }
  for (const SpringSchedule::Element& spring : elementsOf(schedule)) {
    if (!(spring.parameters == SpringParameters{}))
      found.insert(row(spring.a, spring.b, spring.parameters));
  }
  EXPECT_TRUE(found == expected);
}

/// Colour groups cover every position once. Springs of a span share no particle (one colour), and
/// neither do blocks of a group (they may run at once): not even springs without effect, as they
/// too are written.
void expectGroupsAreConflictFree(const SpringSchedule& schedule) {
  const std::vector<SpringSchedule::Element> elements = elementsOf(schedule);
  std::vector<int> visits(elements.size(), 0);
  for (const SpringSchedule::ColourGroup& group : schedule.groups()) {
    std::set<std::int32_t> ofGroup;
    for (std::int32_t s = group.firstBlock; s < group.endBlock; ++s) {
      std::set<std::int32_t> ofBlock;
      const SpringSchedule::Block& block = schedule.blocks()[s];
      for (std::int32_t k = block.firstSpan; k < block.endSpan; ++k) {
        const SpringSchedule::Span& span = schedule.spans()[k];
        std::set<std::int32_t> ofSpan;
        for (std::int32_t p = span.first; p < span.first + span.count; ++p) {
          ++visits[p];
          EXPECT_TRUE(ofSpan.insert(elements[p].a).second) << "position " << p;
          EXPECT_TRUE(ofSpan.insert(elements[p].b).second) << "position " << p;
          EXPECT_TRUE(span.isContiguous || !span.sharesParameters);
        }
        ofBlock.insert(ofSpan.begin(), ofSpan.end());
      }
      for (std::int32_t particle : ofBlock) {
        EXPECT_TRUE(ofGroup.insert(particle).second) << "particle slot " << particle;
      }
    }
  }
  for (int count : visits) EXPECT_EQ(count, 1);
}

/// Checks the schedule of a model, of which only the mesh is given.
void expectGoodSchedule(Model model) {
  model.springs = SpringNetwork(model.mesh, fabricPreset("silk"), {});
  Particles particles;
  particles.layOut(model);
  SpringSchedule schedule;
  schedule.build(model, particles.slotOf);
  expectHoldsEverySpringOnce(model, schedule, particles.slotOf);
  expectGroupsAreConflictFree(schedule);
}

/// Fraction of the springs that is in spans of a kind.
double fractionIn(bool SpringSchedule::Span::*kind, const SpringSchedule& schedule) {
  std::int32_t springs = 0;
  for (const SpringSchedule::Span& span : schedule.spans()) springs += span.*kind ? span.count : 0;
  return static_cast<double>(springs) / schedule.size();
}

TEST(SpringSchedule, OfAGrid) {
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(5, 3), std::pair(17, 30)}) {
    const Scheduled grid(clothOf(columns, rows, 0.1));
    expectHoldsEverySpringOnce(grid.model, grid.schedule, grid.particles.slotOf);
    expectGroupsAreConflictFree(grid.schedule);
  }
}

TEST(SpringSchedule, OfAMeshThatIsNoGrid) {
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {1, 0.1}, {0.9, 1}, {-0.1, 0.8}, {0.4, 0.5}},
                            {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  expectGoodSchedule(model);
}

TEST(SpringSchedule, OfAGridNeedsFewColourGroupsAndIsAllContiguous) {
  // Two colours for each of six families of parallel springs, joined where blocks of rows share
  // no particle (all but the springs between two blocks and bend springs along columns). Runs are
  // a quarter of a row at least.
  const Scheduled grid(clothOf(64, 64, 1.0 / 63.0));
  EXPECT_LE(grid.schedule.groups().size(), 4U);
  EXPECT_EQ(fractionIn(&SpringSchedule::Span::isContiguous, grid.schedule), 1.0);
}

TEST(SpringSchedule, OfAGridStoresTheParametersOfARowOnceForAllRows) {
  for (const double spacing : {1.0 / 63.0, 0.1, 0.7 / 63.0}) {
    const Scheduled grid(clothOf(64, 50, spacing));
    EXPECT_EQ(fractionIn(&SpringSchedule::Span::sharesParameters, grid.schedule), 1.0) << spacing;
    EXPECT_LT(grid.schedule.parameters.size(), 0.1 * grid.schedule.size()) << spacing;
  }
}

/// Both have the same springs at the same positions.
void expectSame(const SpringSchedule& a, const SpringSchedule& b) {
  const std::vector<SpringSchedule::Element> ofA = elementsOf(a);
  const std::vector<SpringSchedule::Element> ofB = elementsOf(b);
  ASSERT_EQ(ofA.size(), ofB.size());
  for (std::size_t p = 0; p < ofA.size(); ++p) {
    EXPECT_EQ(ofA[p].a, ofB[p].a);
    EXPECT_EQ(ofA[p].b, ofB[p].b);
    EXPECT_TRUE(ofA[p].parameters == ofB[p].parameters) << "position " << p;
  }
}

TEST(SpringSchedule, RowsShareParametersAgainWhenAllSpringsAreTuned) {
  Scheduled grid(clothOf(64, 50, 0.1));
  const std::size_t before = grid.schedule.parameters.size();
  const SpringChanges changes = grid.model.springs.setScale(grid.model.mesh, 3.0);
  grid.schedule.applyChanges(grid.model, changes, grid.particles.slotOf);
  EXPECT_EQ(grid.schedule.parameters.size(), before);
  expectHoldsEverySpringOnce(grid.model, grid.schedule, grid.particles.slotOf);
}

TEST(SpringSchedule, OnlySpansWithSpringsThatChangedGetParametersOfTheirOwn) {
  const Scheduled whole(clothOf(64, 50, 0.1));
  Scheduled grid(clothOf(64, 50, 0.1));
  MeshEditor editor(grid.model.mesh);
  const VertexId middle = 25 * 64 + 32;
  const IndexSpan around = grid.model.mesh.facesAround(middle);
  ASSERT_TRUE(editor.splitVertex(middle, {*around.begin()}));
  const MeshChanges edit = editor.finish();
  grid.particles.applyChanges(edit);
  const SpringChanges changes = grid.model.springs.applyChanges(grid.model.mesh, edit);
  grid.schedule.applyChanges(grid.model, changes, grid.particles.slotOf);
  expectHoldsEverySpringOnce(grid.model, grid.schedule, grid.particles.slotOf);

  std::set<std::pair<std::int32_t, std::int32_t>> changed;  // ends before, by particle slot
  for (const auto* slots : {&changes.removed, &changes.modified}) {
    for (const std::int32_t slot : *slots) {
      const Spring& spring = whole.model.springs[slot];
      changed.insert({whole.particles.slotOf[spring.a], whole.particles.slotOf[spring.b]});
    }
  }
  const std::vector<SpringSchedule::Element> elements = elementsOf(whole.schedule);
  int own = 0;
  for (std::size_t k = 0; k < whole.schedule.spans().size(); ++k) {
    const SpringSchedule::Span& span = whole.schedule.spans()[k];
    const auto first = elements.begin() + span.first;
    const bool hasChanged = std::any_of(first, first + span.count, [&](const auto& element) {
      return changed.count({element.a, element.b}) > 0;
    });
    ASSERT_TRUE(span.sharesParameters);
    const bool isShared = grid.schedule.spans()[k].sharesParameters;
    EXPECT_TRUE(isShared || hasChanged) << "span " << k;
    own += isShared ? 0 : 1;
  }
  EXPECT_GT(own, 0);
}

TEST(SpringSchedule, OfAMeshWhoseRowsAllDiffer) {
  const Grid grid{24, 40, 0.7, 0.9};
  const TriangleMesh even = makeGridMesh(grid);
  std::vector<Vec2> material;
  for (VertexId v = 0; v < even.vertexCount(); ++v) {
    const Vec2& at = even.material(v);
    material.emplace_back(at.x(), at.y() * (1.0 + at.y()));
  }
  Model model;
  model.mesh = TriangleMesh(std::move(material), even.faces());
  expectGoodSchedule(std::move(model));
}

TEST(SpringSchedule, HalvesOfEveryColourGroupOfALargeGridAreTheSameHalvesOfTheCloth) {
  // Otherwise a thread would fetch from the other's cache what that has moved in the group before.
  const int rows = 96;
  const int middle = rows / 2;
  const Scheduled grid(clothOf(96, rows, 1.0 / 95.0));
  const SpringSchedule& schedule = grid.schedule;
  const std::vector<SpringSchedule::Element> elements = elementsOf(schedule);
  const auto rowOf = [](std::int32_t slot) { return slot / 96; };
  for (const SpringSchedule::ColourGroup& group : schedule.groups()) {
    const std::int32_t blocks = group.endBlock - group.firstBlock;
    if (blocks == 1) continue;
    EXPECT_EQ(blocks % 2, 0);
    int lastOfFirstHalf = 0;
    int firstOfSecondHalf = rows;
    for (std::int32_t s = group.firstBlock; s < group.endBlock; ++s) {
      const bool isFirst = s - group.firstBlock < blocks / 2;
      const SpringSchedule::Block& block = schedule.blocks()[s];
      for (std::int32_t k = block.firstSpan; k < block.endSpan; ++k) {
        const SpringSchedule::Span& span = schedule.spans()[k];
        for (std::int32_t p = span.first; p < span.first + span.count; ++p) {
          for (const std::int32_t end : {elements[p].a, elements[p].b}) {
            if (isFirst) lastOfFirstHalf = std::max(lastOfFirstHalf, rowOf(end));
            if (!isFirst) firstOfSecondHalf = std::min(firstOfSecondHalf, rowOf(end));
          }
        }
      }
    }
    EXPECT_NEAR(lastOfFirstHalf, middle, 4);
    EXPECT_NEAR(firstOfSecondHalf, middle, 4);
  }
}

/// Positions in the order in which one thread sweeps them.
std::vector<std::int32_t> sweptAlone(const SpringSchedule& schedule) {
  std::vector<std::int32_t> positions;
  schedule.sweep(
      [&](const SpringSchedule::Element& spring) { positions.push_back(spring.position); });
  return positions;
}

/// Every particle is moved by the springs of earlier groups, and earlier colours, first.
void expectSweepsEachParticleInOrder(const SpringSchedule& schedule) {
  const std::vector<SpringSchedule::Element> elements = elementsOf(schedule);
  const std::vector<std::int32_t> swept = sweptAlone(schedule);
  ASSERT_EQ(swept.size(), elements.size());
  std::map<std::int32_t, std::int32_t> last;  // position, by particle slot
  for (const std::int32_t position : swept) {
    for (const std::int32_t end : {elements[position].a, elements[position].b}) {
      const auto [at, isFirst] = last.emplace(end, position);
      ASSERT_TRUE(isFirst || at->second < position) << "particle slot " << end;
      at->second = position;
    }
  }
}

/// Springs move every particle in the order of their positions, on so many threads.
void expectSweepsInOrder(const SpringSchedule& schedule, const Particles& particles, int threads) {
  std::vector<std::int32_t> last(static_cast<std::size_t>(particles.slots), -1);
  std::atomic<int> faults{0};
  const auto meet = [&](std::int32_t slot, std::int32_t position) {
    if (last[slot] >= position) ++faults;
    last[slot] = position;
  };
  const ThreadLimit limit(threads);
  ThreadPool pool;
  const ThreadPool::ParallelRegion region(pool);
  schedule.sweepSpans([&](const SpringSchedule::Span* span, const SpringSchedule::Span* end) {
    for (; span != end; ++span) {
      schedule.visit(*span, [&](const SpringSchedule::Element& spring) {
        meet(spring.a, spring.position);
        meet(spring.b, spring.position);
      });
    }
  });
  EXPECT_EQ(faults.load(), 0);
}

TEST(SpringSchedule, SweepsEachParticleInOrderOnAnyNumberOfThreads) {
  Generator random(7);
  for (const auto& [columns, rows] : {std::pair(3, 4), std::pair(64, 90), std::pair(150, 200)}) {
    Scheduled cloth(clothOf(columns, rows, 0.01));
    for (int edits = 0; edits < 4; ++edits) {
      for (int again = 0; again < 20; ++again) {
        for (const int threads : {1, 2, 3}) {
          expectSweepsInOrder(cloth.schedule, cloth.particles, threads);
        }
      }
      cloth.applyChanges(cloth.edit(random));
    }
  }
}

TEST(SpringSchedule, SweepsParticlesThatAreNumberedAtRandomInOrder) {
  Model model = buildModel(clothOf(80, 80, 0.01));
  std::vector<std::int32_t> at(static_cast<std::size_t>(model.particleCount()));  // by vertex
  std::iota(at.begin(), at.end(), 0);
  std::shuffle(at.begin(), at.end(), Generator(3));
  std::vector<Vec2> material(at.size());
  for (std::size_t v = 0; v < at.size(); ++v) {
    material[at[v]] = model.mesh.material(static_cast<VertexId>(v));
  }
  std::vector<Face> faces = model.mesh.faces();
  for (Face& face : faces) face = {at[face[0]], at[face[1]], at[face[2]]};
  model = Model();
  model.mesh = TriangleMesh(material, faces);
  model.springs = SpringNetwork(model.mesh, fabricPreset("silk"), {});
  Particles particles;
  particles.layOut(model);
  SpringSchedule schedule;
  schedule.build(model, particles.slotOf);
  expectGroupsAreConflictFree(schedule);
  for (const int threads : {1, 2, 3}) expectSweepsInOrder(schedule, particles, threads);
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
      cloth.applyChanges(cloth.edit(random));
      expectHoldsEverySpringOnce(cloth.model, cloth.schedule, cloth.particles.slotOf);
      expectGroupsAreConflictFree(cloth.schedule);
      expectSweepsEachParticleInOrder(cloth.schedule);
      const std::vector<SpringSchedule::Span>& spans = cloth.schedule.spans();
      EXPECT_TRUE(std::none_of(spans.begin() + cloth.schedule.firstOverflow(), spans.end(),
                               [](const SpringSchedule::Span& span) { return span.isContiguous; }));
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
    stepwise.applyChanges(stepwise.edit(random));
    const ModelChanges changes = atOnce.edit(again);
    for (const auto* slots :
         {&changes.springs.added, &changes.springs.modified, &changes.springs.removed}) {
      seen.insert(slots->begin(), slots->end());
    }
  }
  all.modified.assign(seen.begin(), seen.end());
  atOnce.schedule.applyChanges(atOnce.model, all, atOnce.particles.slotOf);
  expectSame(atOnce.schedule, stepwise.schedule);
}

TEST(Particles, LayOutIsAPermutationOfTheGrid) {
  for (const int columns : {2, 3, 4, 5, 6, 7, 8, 13}) {
    const Model model = buildModel(clothOf(columns, 3, 0.1));
    Particles particles;
    particles.layOut(model);
    const std::set<std::int32_t> slots(particles.slotOf.begin(), particles.slotOf.end());
    EXPECT_EQ(slots.size(), static_cast<std::size_t>(model.particleCount()));
    EXPECT_EQ(*slots.begin(), 0);
    EXPECT_EQ(*slots.rbegin(), model.particleCount() - 1);
  }
}

}  // namespace
}  // namespace cloth_sim
