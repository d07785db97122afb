#pragma once
/// \file Says in words when the result of a simulation that goes on is doubtful.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/sim/result_warning.h"
#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// Measures from outside whether a method does what it should, whatever the method. Each measure is
/// an average over `kMemory`, so that a shock of one step does not count.
///
/// - Unexplained strain [-] is the larger one of two quantities. Excess is the strain of a spring
///   less the strain at which it alone would bear everything that acts on the cloth (weight,
///   inertia, wind, holders and obstacles); springs with raw constants do not count, for they may
///   be as soft as they like. Softness is the part s / (1 + s), s = k h^2 (w_a + w_b), of the
///   strain of a spring, if the method projects each spring by itself (docs/model.md).
/// - Imbalance [-] is f + m (g - a), with f the springs and dashpots of a free particle and a its
///   mean acceleration, less what a contact can bear where an obstacle is near (a push along the
///   normal, and Coulomb's friction), over the stiffness times length of its stiffest spring. The
///   average is one of vectors, so that vibrations cancel.
/// - Stretch [-] is the largest strain of a spring, raw ones aside. Beyond its bound no fabric is
///   what the model takes it for: woven ones have broken, and knits have become many times stiffer
///   (docs/limits.md).
/// - Added mass [-] and residual [m/s^2] are those of the step report; mass does not count while
///   motion is declared to be quasi-static. A budget that does not keep the error that the scene
///   asks for is of the report, too.
///
/// It measures every step at first, then every few steps; it reads only, and keeps nothing in saved
/// states: after one is loaded, the averages begin anew.
class ResultWatch {
 public:
  /// A quantity that is watched.
  enum class Measure { kStrain, kImbalance, kAddedMass, kResidual, kStretch };
  static constexpr std::size_t kMeasures = 5;
  /// Averages above which there is a warning, by measure: [-], [-], [-], [m/s^2], [-].
  static constexpr std::array<double, kMeasures> kBounds{0.04, 0.085, 0.25, 50.0, 0.5};

  explicit ResultWatch(const SolverInfo& method)
      : isSoft_(method.projectsSpringsAlone), usesQuasiStatic_(method.usesQuasiStatic) {}

  /// Measures the cloth at the end of a step, if it is time.
  /// \param step    number of the step.
  /// \param report  of the step.
  void observe(std::uint64_t step, const Model& model, const State& state, const Controls& controls,
               const Contacts& contacts, const StepReport& report);

  /// The largest average of a measure so far.
  double largest(Measure measure) const { return largest_[static_cast<std::size_t>(measure)]; }
  /// One sentence for each measure that has passed its bound, and for a budget that fell short.
  /// Where strains are unexplained, forces are out of balance and stretch is large too: that needs
  /// no second sentence. A sentence ends with a hint at `quasi_static` if that would help the
  /// method, and clamps were pulling slowly at a slow cloth when the bound was passed.
  std::vector<ResultWarning> warnings() const;

 private:
  using Vec3f = Eigen::Vector3f;

  static constexpr std::uint64_t kEvery = 5;     ///< steps from one measurement to the next
  static constexpr std::uint64_t kAtFirst = 10;  ///< steps that are all measured after a beginning
  static constexpr double kMemory = 0.25;        ///< [s]

  /// Input of a measurement besides the model and the state.
  struct Surroundings {
    const Controls& controls;
    const Contacts& contacts;
    const StepReport& report;
    double dt = 0.0;  ///< since the last measurement [s]
  };

  /// The largest strains [-]: those that forces do not explain, and of all.
  struct Strains {
    double excess = 0.0;
    double softness = 0.0;
    double stretch = 0.0;
  };

  bool isFirst(const State& state) const;
  void begin(std::uint64_t step, const Model& model, const State& state);
  void measureStrains(const Model& model, const State& state, const Surroundings& around);
  double findInertia(const Model& model, const State& state, const Vec3& gravity, double dt);
  Strains addSprings(const Model& model, const State& state, double force, double h);
  void addSpring(const Spring& spring, const Vec3& d, double length, double tension);
  void addInertia();
  void ignoreHeld(const Controls& controls);
  void takeContacts(const State& state, const Contacts& contacts);
  void updateImbalance(double weight);
  void note(Measure measure, double average, const State& state, const Controls& controls);

  bool isSoft_;           ///< whether the method projects each spring by itself
  bool usesQuasiStatic_;  ///< whether declared quasi-static motion would help the method
  std::array<double, kMeasures> largest_{};
  std::array<std::optional<double>, kMeasures> since_;  ///< when the bound was first passed [s]
  std::array<bool, kMeasures> isSlowPull_{};            ///< whether clamps pulled slowly then
  std::optional<ErrorEstimate> shortfall_;  ///< of a budget that does not keep the error asked for
  double excess_ = 0.0;                     ///< averaged [-]
  double softness_ = 0.0;                   ///< averaged [-]
  double stretch_ = 0.0;                    ///< averaged [-]
  double largestImbalance_ = 0.0;           ///< of the averages, by particle [-]
  double addedMass_ = 0.0;                  ///< averaged [-]
  double residual_ = 0.0;                   ///< averaged [m/s^2]
  double time_ = 0.0;                       ///< of the last measurement [s]
  std::uint64_t began_ = 0;                 ///< step at which the averages began
  std::uint64_t revision_ = 0;              ///< of the state's arrays at the last measurement
  std::vector<Vec3f> velocity_;             ///< by particle, at the last measurement [m/s]
  std::vector<Vec3f> inertia_;              ///< by particle, m (g - a) [N]
  std::vector<Vec3f> force_;                ///< by particle, springs and inertia [N]
  std::vector<Vec3f> imbalance_;            ///< by particle, averaged [-]
  /// By particle, largest stiffness times length [N]; 0: ignored.
  std::vector<float> stiffness_;
};

}  // namespace cloth_sim
