#pragma once
/// \file Simulations that the benchmarks measure.

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim::bench {

/// A cloth of n x n particles on one metre that hangs from two corners; 0.2 kg.
/// \param bending  the scene key of that name.
Scene hanging(int n, const std::string& method, const std::string& bending = "springs");

/// The same cloth, level, just above a sphere.
Scene overSphere(int n, const std::string& method);

/// The scene, where what is cut is refined twice around the cuts.
Scene refinedWhenCut(Scene scene);
/// Cuts three slits, side by side, into the middle of a cloth that hangs as these do.
void cutSlits(Simulation& simulation);

/// A simulation that has gone on by some steps. Going back to that state takes what later steps
/// left behind out of a measurement.
class Warm {
 public:
  Warm(Scene scene, int steps);
  /// \param simulation  that has gone on already.
  Warm(std::unique_ptr<Simulation> simulation, int steps);
  Simulation& simulation() { return *simulation_; }
  /// Restores the saved state and takes a step, so that everything derived from the state is up to
  /// date.
  void goBack();

 private:
  std::unique_ptr<Simulation> simulation_;
  std::string bytes_;
};

/// Times steps. After each `stretch` of them it goes back, which is not timed; a simulation that
/// fails makes the benchmark fail: it would time nothing.
void timeSteps(Warm& warm, int stretch, benchmark::State& run);

/// Tells the time per spring, besides that per iteration.
void tellPerSpring(double springs, benchmark::State& run);

}  // namespace cloth_sim::bench
