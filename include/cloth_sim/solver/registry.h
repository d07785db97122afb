#pragma once
/// \file The methods there are. A new one is a file in src/solver and a row in registry.cpp.

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

/// Options by name. Complete (every parameter of the method) after `completeParameters`.
using SolverParameters = std::map<std::string, double>;

struct SolverInfo {
  std::string name;         ///< as scenes write it: "xpbd"
  std::string title;        ///< "Extended position-based dynamics with small steps"
  std::string reference;    ///< paper
  std::string limitations;  ///< one line
  int order = 1;            ///< of convergence in the time step on smooth problems; 0: none
  /// Whether the stiffness of springs is what the fabric says. If not, the method's own parameters
  /// set it, it changes with the step, and a bending energy is refused.
  bool followsFabric = true;
  /// Largest omega h, h the length of a substep, at which an undamped oscillator of the angular
  /// frequency omega stays bounded. Infinity: there is no such limit; 0: it never does.
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

/// Fills in defaults.
/// \throws std::invalid_argument naming the parameter, its range or the known names.
SolverParameters completeParameters(const SolverInfo& info, const SolverParameters& given);

}  // namespace cloth_sim
