#include "cloth_sim/solver/spring_schedule.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cloth_sim {
namespace {

/// Shorter stretches are not worth a loop of their own.
constexpr std::int32_t kShortestRun = 8;
/// Absorbs rounding in material coordinates when they are divided by a spacing.
constexpr double kGridTolerance = 1e-6;

/// Springs of one kind along one direction; on a grid two colours suffice for each.
int family(const Model& model, const Spring& spring) {
  const Vec2 d = model.mesh.material(spring.b) - model.mesh.material(spring.a);
  switch (spring.direction) {
    case ThreadDirection::kWarp:
      return spring.kind == SpringKind::kBend ? 4 : 0;
    case ThreadDirection::kWeft:
      return spring.kind == SpringKind::kBend ? 5 : 1;
    case ThreadDirection::kBias:
      return d.x() * d.y() > 0.0 ? 2 : 3;
  }
  return 0;
}

/// The colour that a spring would have on a grid, from its place in material coordinates.
int gridColour(const Model& model, const Spring& spring) {
  const Vec2& p = model.mesh.material(spring.a);
  const Vec2& q = model.mesh.material(spring.b);
  const int axis = spring.direction == ThreadDirection::kWarp ? 0 : 1;
  const double low = std::min(p[axis], q[axis]);
  const double extent = std::abs(q[axis] - p[axis]);
  const auto cell = static_cast<long>(std::floor(low / extent + kGridTolerance));
  return 2 * family(model, spring) + static_cast<int>(cell & 1);
}

/// Greedy colouring that prefers a given colour where it is free.
class Colouring {
 public:
  explicit Colouring(std::int32_t particles) : used_(static_cast<std::size_t>(particles)) {}

  int pick(const Spring& spring, int preferred) {
    std::vector<bool>& a = used_[spring.a];
    std::vector<bool>& b = used_[spring.b];
    int colour = preferred;
    if (isUsed(a, colour) || isUsed(b, colour)) {
      colour = 0;
      while (isUsed(a, colour) || isUsed(b, colour)) ++colour;
    }
    use(a, colour);
    use(b, colour);
    return colour;
  }

 private:
  static bool isUsed(const std::vector<bool>& set, int colour) {
    return static_cast<std::size_t>(colour) < set.size() && set[colour];
  }
  static void use(std::vector<bool>& set, int colour) {
    if (set.size() <= static_cast<std::size_t>(colour)) set.resize(colour + 1, false);
    set[colour] = true;
  }

  std::vector<std::vector<bool>> used_;
};

}  // namespace

void SpringSchedule::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  truncate(0, 0);
  originalSlots_ = static_cast<std::int32_t>(model.springs.slots().size());
  std::vector<std::int32_t> all(originalSlots_);
  std::iota(all.begin(), all.end(), 0);
  position_.assign(originalSlots_, kNone);
  append(model, slotOf, colour(model, all));
  originalPosition_ = position_;
  originalPositions_ = size();
  originalBatches_ = batches_.size();
}

void SpringSchedule::follow(const Model& model, const SpringChanges& changes,
                            const std::vector<std::int32_t>& slotOf) {
  for (const auto* slots : {&changes.removed, &changes.modified, &changes.added}) {
    for (std::int32_t slot : *slots) settle(model.springs[slot], slot, slotOf);
  }
  truncate(originalPositions_, originalBatches_);
  position_.resize(model.springs.slots().size(), kNone);
  append(model, slotOf, colour(model, {appended_.begin(), appended_.end()}));
}

void SpringSchedule::settle(const Spring& spring, std::int32_t slot,
                            const std::vector<std::int32_t>& slotOf) {
  const std::int32_t home = slot < originalSlots_ ? originalPosition_[slot] : kNone;
  const bool atHome = spring.exists() && home != kNone && endA[home] == slotOf[spring.a] &&
                      endB[home] == slotOf[spring.b];
  if (atHome) {
    place(spring, home, slotOf);
    position_[slot] = home;
  } else if (home != kNone) {
    stiffness[home] = damping[home] = 0.0;
  }
  if (spring.exists() && !atHome) {
    appended_.insert(slot);
  } else {
    appended_.erase(slot);
  }
}

SpringSchedule::Coloured SpringSchedule::colour(const Model& model,
                                                const std::vector<std::int32_t>& slots) const {
  Coloured colours;
  Colouring colouring(model.particleCount());
  for (std::int32_t slot : slots) {
    const Spring& spring = model.springs[slot];
    if (!spring.exists()) continue;
    const auto chosen =
        static_cast<std::size_t>(colouring.pick(spring, gridColour(model, spring)));
    if (colours.size() <= chosen) colours.resize(chosen + 1);
    colours[chosen].push_back(slot);
  }
  return colours;
}

void SpringSchedule::append(const Model& model, const std::vector<std::int32_t>& slotOf,
                            Coloured colours) {
  for (std::vector<std::int32_t>& slots : colours) {
    if (slots.empty()) continue;
    Batch batch;
    findRuns(batch, slots, model.springs, slotOf);
    for (std::int32_t slot : slots) {
      const std::int32_t position = size();
      position_[slot] = position;
      endA.push_back(kNone);
      endB.push_back(kNone);
      restLength.push_back(0.0);
      stiffness.push_back(0.0);
      damping.push_back(0.0);
      place(model.springs[slot], position, slotOf);
    }
    batches_.push_back(std::move(batch));
  }
}

void SpringSchedule::findRuns(Batch& batch, std::vector<std::int32_t>& slots,
                              const SpringNetwork& springs,
                              const std::vector<std::int32_t>& slotOf) {
  const auto end = [&](std::int32_t slot) { return slotOf[springs[slot].a]; };
  const auto follows = [&](std::int32_t s, std::int32_t t) {
    return slotOf[springs[t].a] == slotOf[springs[s].a] + 1 &&
           slotOf[springs[t].b] == slotOf[springs[s].b] + 1;
  };
  std::sort(slots.begin(), slots.end(),
            [&](std::int32_t s, std::int32_t t) { return end(s) < end(t); });
  std::vector<std::int32_t> inRuns;
  std::vector<std::int32_t> singles;
  for (std::size_t k = 0; k < slots.size();) {
    std::size_t stop = k + 1;
    while (stop < slots.size() && follows(slots[stop - 1], slots[stop])) ++stop;
    const auto count = static_cast<std::int32_t>(stop - k);
    const bool isRun = count >= kShortestRun;
    if (isRun) batch.runs.push_back({size() + static_cast<std::int32_t>(inRuns.size()), count});
    std::vector<std::int32_t>& target = isRun ? inRuns : singles;
    target.insert(target.end(), slots.begin() + static_cast<std::ptrdiff_t>(k),
                  slots.begin() + static_cast<std::ptrdiff_t>(stop));
    k = stop;
  }
  batch.firstSingle = size() + static_cast<std::int32_t>(inRuns.size());
  batch.endSingle = batch.firstSingle + static_cast<std::int32_t>(singles.size());
  inRuns.insert(inRuns.end(), singles.begin(), singles.end());
  slots = std::move(inRuns);
}

void SpringSchedule::place(const Spring& spring, std::int32_t position,
                           const std::vector<std::int32_t>& slotOf) {
  endA[position] = slotOf[spring.a];
  endB[position] = slotOf[spring.b];
  restLength[position] = spring.restLength;
  stiffness[position] = spring.stiffness;
  damping[position] = spring.damping;
  if (spring.damping > 0.0) damped = true;
}

void SpringSchedule::truncate(std::int32_t positions, std::size_t batches) {
  endA.resize(positions);
  endB.resize(positions);
  restLength.resize(positions);
  stiffness.resize(positions);
  damping.resize(positions);
  batches_.resize(batches);
}

}  // namespace cloth_sim
