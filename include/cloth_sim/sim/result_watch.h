#pragma once
/// \file Says in words when the result of a simulation that goes on is doubtful.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// Measures from outside whether a method does what it should, whatever the method. Each measure is
/// an average over `kMemory`, so that a shock of one step does not count.
///
/// Unexplained strain [-] is the larger one of two quantities:
///   - imbalance: f + m (g - a), with f the springs and dashpots of a particle and a its mean
///     acceleration, over the stiffness times length of its stiffest spring. The average is one of
///     vectors, so that vibrations cancel. Of free particles away from obstacles;
///   - excess: the strain of a spring less the strain at which it alone would bear everything that
///     acts on the cloth (weight, inertia, wind, holders and obstacles).
/// Springs with raw constants do not count: their strain is nobody's fabric. Added mass [-] and
/// residual [m/s^2] are those of the step report.
///
/// It measures every few steps, reads only, and keeps nothing in saved states: after one is loaded,
/// the averages begin anew.
class ResultWatch {
 public:
  /// A quantity that is watched.
  enum class Measure { kStrain, kAddedMass, kResidual };
  static constexpr std::size_t kMeasures = 3;
  /// Averages above which there is a warning, by measure: [-], [-], [m/s^2].
  static constexpr std::array<double, kMeasures> kBounds{0.05, 0.25, 50.0};

  /// Measures the cloth at the end of a step, if it is time.
  /// \param step    number of the step.
  /// \param report  of the step.
  void observe(std::uint64_t step, const Model& model, const State& state, const Controls& controls,
               const Contacts& contacts, const StepReport& report);

  /// The largest average of a measure so far.
  double largest(Measure measure) const { return largest_[static_cast<std::size_t>(measure)]; }
  /// One sentence for each measure that has passed its bound.
  std::vector<std::string> warnings() const;

 private:
  using Vec3f = Eigen::Vector3f;

  static constexpr std::uint64_t kEvery = 5;  ///< steps from one measurement to the next
  static constexpr double kMemory = 0.25;     ///< [s]

  bool isFirst(const State& state) const;
  void begin(const Model& model, const State& state);
  double unexplainedStrain(const Model& model, const State& state, const Controls& controls,
                           const Contacts& contacts, const StepReport& report, double dt);
  void addSprings(const Model& model, const State& state);
  double addInertia(const Model& model, const State& state, const Vec3& gravity, double dt);
  void ignoreTouched(const Controls& controls, const Contacts& contacts);
  double updateImbalance(double weight);
  double findExcess(const Model& model, const State& state, double force) const;
  void note(Measure measure, double average, double time);

  std::array<double, kMeasures> largest_{};
  std::array<std::optional<double>, kMeasures> since_;  ///< when the bound was first passed [s]
  double excess_ = 0.0;                                 ///< averaged [-]
  double addedMass_ = 0.0;                              ///< averaged [-]
  double residual_ = 0.0;                               ///< averaged [m/s^2]
  double time_ = 0.0;                                   ///< of the last measurement [s]
  std::uint64_t revision_ = 0;    ///< of the state's arrays at the last measurement
  std::vector<Vec3f> velocity_;   ///< by particle, at the last measurement [m/s]
  std::vector<Vec3f> force_;      ///< by particle, springs and inertia [N]
  std::vector<Vec3f> imbalance_;  ///< by particle, averaged [-]
  std::vector<float> stiffness_;  ///< by particle, largest stiffness times length [N]; 0: ignored
};

}  // namespace cloth_sim
