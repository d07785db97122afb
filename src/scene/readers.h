#pragma once
/// \file One reader for each part of a scene file. Each throws SceneError.

#include "cloth_sim/scene/scene.h"
#include "scene_node.h"

namespace cloth_sim {

// Shared by several parts (read_common.cpp).

/// `position` and `rpy` or `orientation` of a map; what is not there is left as it is.
void readPose(const SceneNode& map, Pose& pose);
/// `rpy` or `orientation` of a map, if it has one.
std::optional<Quat> readOrientation(const SceneNode& map);
/// [column, row] of a particle of the cloth.
PinSpec readParticle(const SceneNode& node, const ClothSpec& cloth);
/// A polyline of at least two points on the cloth. It may end up to one cell outside of it.
MaterialPath readPath(const SceneNode& node, const ClothSpec& cloth);
/// A number for all kinds of springs, or a map by kind; kinds not named never fail.
TearRatios readRatios(const SceneNode& node);
/// Where and how far to refine (read_surgery.cpp).
Refinement readRefinement(const SceneNode& node);

// The parts.

void readCloth(const SceneNode& node, ClothSpec& cloth);
void readSolver(const SceneNode& node, SolverSpec& solver);
/// \param gridParticles  how many the cloth has at the start.
void readSurgery(const SceneNode& node, int gridParticles, SurgerySettings& surgery);
Wind readWind(const SceneNode& node);
void readObstacles(const SceneNode& node, double friction, std::vector<Obstacle>& obstacles);
void readClamps(const SceneNode& node, const ClothSpec& cloth, std::vector<ClampSpec>& clamps);
void readTearing(const SceneNode& node, const ClothSpec& cloth, TearingSettings& tearing);
/// One stroke of a blade or a list of strokes.
void readStrokes(const SceneNode& node, std::vector<Stroke>& strokes);
/// One refinement around a path or point, or a list of them.
void readRefinements(const SceneNode& node, std::vector<RefineNear>& refinements);
/// \param scene  the rest of it, complete.
void readPhases(const SceneNode& node, const Scene& scene, std::vector<PhaseSpec>& phases);

}  // namespace cloth_sim
