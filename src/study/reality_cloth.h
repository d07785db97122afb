#pragma once
/// \file A cloth with a method of its own and holders that the caller moves, for comparisons with
/// theory and measurement.

#include <memory>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// Gravitational acceleration of all comparisons [m/s^2].
constexpr double kRealityGravity = 9.81;

/// A method with its parameters and the step in which it is called.
struct HeldMethod {
  std::string name = "implicit_euler";
  SolverParameters parameters{{"substeps", 1.0}};
  double dt = 1.0 / 60.0;  ///< [s]
};

/// A cloth without obstacles.
class HeldCloth {
 public:
  explicit HeldCloth(const ClothSpec& spec, const HeldMethod& method = {});

  /// Holds a particle where it is; a second time, nothing changes.
  void hold(VertexId v);
  /// Moves everything that is held by `by` [m] within the next step.
  void moveHeld(const Vec3& by);
  /// Takes one step. \throws std::runtime_error if the method diverges.
  void step();
  /// Takes steps until no particle has been faster than `speed` [m/s] for `calm` [s], or until
  /// `most` [s] have passed. \return whether it came to rest.
  bool settle(double speed, double most, double calm = 0.1);

  const Model& model() const { return model_; }
  const StepReport& report() const { return report_; }
  double time() const { return time_; }  ///< [s]
  double fastest() const;                ///< speed of the fastest particle [m/s]

  State state;
  Controls controls;

 private:
  Model model_;
  HeldMethod method_;
  std::unique_ptr<Solver> solver_;
  StepReport report_;
  double time_ = 0.0;
};

/// A fabric that stretches little: equally stiff along warp and weft, with the shear stiffness and
/// bending rigidity given, without damping.
/// \param density  [kg/m^2]
/// \param bending  [N m]
/// \param tensile  [N/m]
/// \param shear    [N/m]
Fabric plainFabric(double density, double bending, double tensile, double shear);

/// A strip along x in the plane z = 0, with its bending energy that of a plate.
/// \param cells    along x
/// \param rows     of particles across
/// \param spacing  of the particles [m]
ClothSpec stripOf(const Fabric& fabric, int cells, int rows, double spacing);

}  // namespace cloth_sim
