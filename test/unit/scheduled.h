#pragma once
/// \file Springs of a cloth in the order of sweeps, over edits.

#include "cloth_sim/surgery/operation.h"
#include "constraints/particles.h"
#include "constraints/spring_schedule.h"
#include "unit/core_support.h"

namespace cloth_sim::testing_support {

/// A cloth as solvers have it, to be cut and refined.
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
    if (!changes.mesh.empty()) particles.applyChanges(changes.mesh);
    return changes;
  }
  void applyChanges(const ModelChanges& changes) {
    schedule.applyChanges(model, changes.springs, particles.slotOf);
  }

  Model model;
  State state;
  Particles particles;
  SpringSchedule schedule;
};

}  // namespace cloth_sim::testing_support
