#pragma once
/// \file The registry of methods. A new method is a file in src/solver and a row in
/// src/solver/methods.h.

#include <functional>
#include <limits>
#include <map>

#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// One numeric option of a method.
struct SolverParameter {
  std::string name;
  double defaultValue = 0.0;
  double minimum = 0.0;
  double maximum = 0.0;
  bool integer = false;
  std::string unit;         ///< "" for a pure number
  std::string description;  ///< one line
};

/// Values by parameter name. After `completeParameters` every parameter of the method is there.
using SolverParameters = std::map<std::string, double>;

/// A row of the registry: facts about a method that users, tests and the study need.
struct SolverInfo {
  std::string name;         ///< as scenes write it: "xpbd"
  std::string title;        ///< "Extended position-based dynamics with small steps"
  std::string reference;    ///< paper or book, with the year
  std::string limitations;  ///< where the method is wrong or fails; one line
  int order = 1;            ///< order of convergence in the time step on smooth problems; 0: none
  /// Tells whether the cloth is as stiff as the fabric. If not, stiffness follows from the method's
  /// own parameters and the step, and a bending energy is refused.
  bool followsFabric = true;
  /// Tells whether it follows the friction of bending (SlipElement).
  bool hasBendFriction = false;
  /// Why layers of cloth cannot touch each other with this method; "" if they can.
  std::string noLayers;
  /// Why tears cannot be decided by energy with this method; "" if they can. The energy at a tip
  /// follows from the strain there.
  std::string noTearEnergy;
  /// Tells whether each spring is projected by itself, once in a substep of length h. A spring of
  /// tension T at rest is then longer by T h^2 (w_a + w_b), with w the inverse masses of its ends.
  bool projectsSpringsAlone = false;
  /// Tells whether faces and edges of cloth meet sharp corners and edges of meshes; if not, only
  /// particles do.
  bool meetsSharpFeatures = true;
  /// Tells whether its forces are more accurate where a scene declares quasi-static motion.
  bool usesQuasiStatic = false;
  /// Stability limit: the largest omega h at which an undamped oscillator of angular frequency
  /// omega stays bounded in substeps of length h. Infinity: unconditionally stable; 0: never
  /// stable.
  double stabilityLimit = std::numeric_limits<double>::infinity();
  std::vector<SolverParameter> parameters;
  std::function<std::unique_ptr<Solver>(const Model&, const SolverParameters&)> create;
};

/// All methods, sorted by name.
const std::vector<SolverInfo>& solverRegistry();

/// \throws std::invalid_argument naming the known methods if there is none of that name.
const SolverInfo& findSolver(const std::string& name);

/// Returns the parameter of that name, or nullptr if the method has none.
const SolverParameter* findParameter(const SolverInfo& info, const std::string& name);

/// \throws std::invalid_argument if the model has what the method cannot follow: a bending energy.
void checkFeatures(const SolverInfo& info, bool bendingEnergy);

/// \throws std::invalid_argument if the method has no friction in bending.
void checkBendFriction(const SolverInfo& info);

/// \throws std::invalid_argument if layers of cloth cannot touch each other with the method.
void checkLayers(const SolverInfo& info);

/// \throws std::invalid_argument if tears cannot be decided by energy with the method.
void checkTearEnergy(const SolverInfo& info);

/// Fills in defaults.
/// \throws std::invalid_argument naming the parameter, its range or the known names.
SolverParameters completeParameters(const SolverInfo& info, const SolverParameters& given);

}  // namespace cloth_sim
