#include "cloth_sim/solver/registry.h"

#include <cmath>
#include <stdexcept>

#include "methods.h"

namespace cloth_sim {
namespace {

template <typename Range>
std::string joinNames(const Range& rows) {
  std::string names;
  for (const auto& row : rows) names += (names.empty() ? "" : ", ") + row.name;
  return names;
}

std::string number(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

void checkRange(const SolverParameter& parameter, double value) {
  const bool whole = !parameter.integer || value == std::floor(value);
  if (whole && value >= parameter.minimum && value <= parameter.maximum) return;
  throw std::invalid_argument(parameter.name + ": expected " +
                              (parameter.integer ? "a whole number" : "a number") + " from " +
                              number(parameter.minimum) + " to " + number(parameter.maximum));
}

}  // namespace

const std::vector<SolverInfo>& solverRegistry() {
#define CLOTH_SIM_CALL(name) name(),
  static const std::vector<SolverInfo> rows = {CLOTH_SIM_METHODS(CLOTH_SIM_CALL)};
#undef CLOTH_SIM_CALL
  return rows;
}

const SolverInfo& findSolver(const std::string& name) {
  for (const SolverInfo& info : solverRegistry()) {
    if (info.name == name) return info;
  }
  throw std::invalid_argument("method: expected one of " + joinNames(solverRegistry()) + " (got '" +
                              name + "')");
}

const SolverParameter* findParameter(const SolverInfo& info, const std::string& name) {
  for (const SolverParameter& parameter : info.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

void checkFeatures(const SolverInfo& info, bool bendingEnergy) {
  if (!bendingEnergy || info.followsFabric) return;
  throw std::invalid_argument(info.name + " has no bending energy (its stiffness is not the " +
                              "fabric's): take springs or none, or another method");
}

void checkBendFriction(const SolverInfo& info) {
  if (info.hasBendFriction) return;
  std::string able;
  for (const SolverInfo& other : solverRegistry()) {
    if (other.hasBendFriction) able += (able.empty() ? "" : ", ") + other.name;
  }
  throw std::invalid_argument(info.name + " has no friction in bending; take one of " + able +
                              ", or no bending_hysteresis");
}

void checkLayers(const SolverInfo& info) {
  if (info.noLayers.empty()) return;
  throw std::invalid_argument(info.name + " cannot hold layers of cloth apart: " + info.noLayers +
                              "; take another method, such as line_xpbd, or self_contact: false");
}

void checkTearEnergy(const SolverInfo& info) {
  if (info.noTearEnergy.empty()) return;
  throw std::invalid_argument(info.name + " cannot tear by energy: " + info.noTearEnergy +
                              "; take another method, such as projective, or tear by stretch");
}

SolverParameters completeParameters(const SolverInfo& info, const SolverParameters& given) {
  for (const auto& [name, value] : given) {
    const SolverParameter* parameter = findParameter(info, name);
    if (parameter == nullptr) {
      throw std::invalid_argument(name + ": " + info.name + " has no such parameter (it has " +
                                  joinNames(info.parameters) + ")");
    }
    checkRange(*parameter, value);
  }
  SolverParameters complete = given;
  for (const SolverParameter& parameter : info.parameters) {
    complete.emplace(parameter.name, parameter.defaultValue);
  }
  return complete;
}

SolverParameter substepsParameter(int defaultValue) {
  SolverParameter parameter;
  parameter.name = "substeps";
  parameter.defaultValue = defaultValue;
  parameter.minimum = 1;
  parameter.maximum = 100000;
  parameter.integer = true;
  parameter.description = "parts that a simulation step is divided into";
  return parameter;
}

int substepsOf(const SolverParameters& parameters) {
  return static_cast<int>(parameters.at("substeps"));
}

}  // namespace cloth_sim
