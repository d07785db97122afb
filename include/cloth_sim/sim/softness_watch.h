#pragma once
/// \file Says in words when a cloth is stretched by more than the forces on it explain.

#include <string>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// Compares the strain of a cloth with the forces on it, whatever the method.
///
/// A method that does not finish its work leaves springs longer than their forces allow. Two
/// quantities show that from outside, both as a strain [-]:
///   - imbalance: f + m (g - a), with f the springs and dashpots of a particle and a its mean
///     acceleration, over the stiffness times length of its stiffest spring. A vector that is
///     averaged over `kMemory`, so that vibrations cancel. Of free particles away from obstacles;
///   - excess: the strain of a spring less the strain at which it alone would bear everything that
///     acts on the cloth (weight, inertia, wind, holders and obstacles).
/// Springs with raw constants do not count: their strain is nobody's fabric.
///
/// It measures every few steps, reads only, and keeps nothing in saved states: after one is loaded,
/// the average begins anew.
class SoftnessWatch {
 public:
  /// Unexplained strain above which there is a warning [-].
  static constexpr double kBound = 0.05;

  /// Measures the cloth at the end of a step, if it is time.
  /// \param step    number of the step.
  /// \param report  of the step.
  void observe(std::uint64_t step, const Model& model, const State& state,
               const Controls& controls, const Contacts& contacts, const StepReport& report);

  /// The largest strain so far that forces did not explain, averaged over `kMemory` [-].
  double unexplainedStrain() const { return largest_; }
  /// One sentence, from the time on when `unexplainedStrain` first passes the bound; before, "".
  const std::string& warning() const { return warning_; }

 private:
  using Vec3f = Eigen::Vector3f;

  static constexpr std::uint64_t kEvery = 5;  ///< steps from one measurement to the next
  static constexpr double kMemory = 0.25;     ///< [s]

  bool isFirst(const State& state) const;
  void begin(const Model& model, const State& state);
  void addSprings(const Model& model, const State& state);
  double addInertia(const Model& model, const State& state, const Vec3& gravity, double dt);
  void exclude(const Controls& controls, const Contacts& contacts);
  double updateImbalance(double fraction);
  double findExcess(const Model& model, const State& state, double force) const;

  double largest_ = 0.0;
  double excess_ = 0.0;  ///< averaged [-]
  std::string warning_;
  double time_ = 0.0;               ///< of the last measurement [s]
  std::uint64_t revision_ = 0;      ///< of the mesh at the last measurement
  std::vector<Vec3f> velocity_;     ///< by particle, at the last measurement [m/s]
  std::vector<Vec3f> force_;        ///< by particle, springs and inertia [N]
  std::vector<Vec3f> imbalance_;    ///< by particle, averaged, over its stiffness [-]
  std::vector<float> stiffness_;    ///< by particle, largest stiffness times length [N]; 0: ignored
};

}  // namespace cloth_sim
