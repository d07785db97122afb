#pragma once
/// \file The components of a simulation, as commands and phases act on them.

#include "cloth_sim/sim/measurements.h"
#include "cloth_sim/sim/result_watch.h"
#include "cloth_sim/sim/sleep.h"
#include "cloth_sim/sim/surgery.h"

namespace cloth_sim {

/// The components of a simulation. Each keeps its own state and its own rules; `Simulation` calls
/// them in the order of a step, commands and phases change them between two steps.
struct SimulationParts {
  /// \throws std::invalid_argument if the scene contradicts itself.
  explicit SimulationParts(Scene scene);

  Scene scene;                               ///< as it was loaded
  Model model;                               ///< mesh, springs and masses of all cloths
  std::vector<ResultWarning> sceneWarnings;  ///< about the scene as it was loaded
  std::unique_ptr<LayerContact> layers;      ///< null if layers of cloth do not touch
  State state;                               ///< positions, velocities, time
  Controls controls;                         ///< gravity, air, and what holders do in the step
  Holders holders;
  Obstacles obstacles;
  GuardedSolver solver;
  Surgery surgery;
  PhaseScript script;
  Sleep sleep;
  Measurements measurements;
  ResultWatch watch;
  std::uint64_t stepCount = 0;  ///< steps since the start or the last reset
  std::string failure;          ///< why the simulation stopped; "" while it goes on
  std::uint64_t startHash = 0;  ///< stateHash before the first step

  double dt() const { return scene.solver.dt; }  ///< length of a step [s]
  double time() const { return state.t; }        ///< [s]
  bool failed() const { return !failure.empty(); }

  /// All doubts about the result, see Simulation::warnings.
  std::vector<ResultWarning> warnings() const;
  /// Returns the settings that commands may change, as they are now.
  Tuning tuning() const;
  /// Tells whether only the cloth itself moves it, and nothing else is about to.
  bool isStill() const;
  /// Shifts the clock by `by` [s], and with it everything that depends on it.
  void shiftTime(double by);

  SteppedCloth steppedCloth() {
    return {model, state, controls, holders, obstacles, layers.get(), surgery.tearing()};
  }
  EditedCloth editedCloth() { return {model, state, holders, solver, layers.get()}; }
};

}  // namespace cloth_sim
