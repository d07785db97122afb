#pragma once
/// \file Checks that the parts of a simulation fit each other after they were read from a file. A
/// function returns one sentence about the first error; empty if there is none. Indices are checked
/// first, so that later checks may follow them.

#include <string>

#include "cloth_sim/sim/holders.h"
#include "cloth_sim/sim/obstacles.h"

namespace cloth_sim {

/// \param undamaged  the model of the same scene before any edit.
std::string validationError(const Model& model, const Model& undamaged);
/// \param model  valid.
std::string validationError(const State& state, const Model& model);
std::string validationError(const Controls& controls, const Model& model);
/// \param model  valid.
std::string validationError(const Drag& drag, const std::vector<KinematicTarget>& pins,
                            const Model& model);
std::string validationError(const std::vector<Clamp>& clamps, const Model& model);
/// \param ofScene  the obstacles of the same scene at its start: they may only have moved.
std::string validationError(const ColliderSet& colliders, const ColliderSet& ofScene);
std::string validationError(const std::vector<GripEvent>& events);

/// Tells whether a text is short, and has no control characters: it will be printed and published.
bool isOneLine(const std::string& text);

}  // namespace cloth_sim
