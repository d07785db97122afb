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
/// Which of the cloths a map means: `cloth`, or else the first.
std::size_t readClothName(const SceneNode& map, const std::vector<ClothSpec>& cloths);
/// A polyline of at least two points [u, v] of one of the cloths, which may end up to one cell
/// outside of it; as a path of the material plane.
MaterialPath readPath(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                      std::size_t cloth);
/// A number for all kinds of springs, or a map by kind; kinds not named never fail.
TearRatios readRatios(const SceneNode& node);
/// Where and how far to refine (read_surgery.cpp).
Refinement readRefinement(const SceneNode& node);

// The parts.

/// The cloths of a scene, and its surgery.
void readCloths(const SceneNode& node, Scene& scene);
void readSolver(const SceneNode& node, SolverSpec& solver);
/// \param particles  how many there are at the start.
void readSurgery(const SceneNode& node, int particles, SurgerySettings& surgery);
Wind readWind(const SceneNode& node);
void readObstacles(const SceneNode& node, std::vector<Obstacle>& obstacles);
/// The keys of an obstacle of this shape.
std::vector<std::string> obstacleKeys(const Shape& shape);
void readClamps(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                std::vector<ClampSpec>& clamps);
void readTearing(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                 TearingSettings& tearing);
/// One stroke of a blade or a list of strokes.
void readStrokes(const SceneNode& node, std::vector<Stroke>& strokes);
/// One refinement around a path or point, or a list of them.
void readRefinements(const SceneNode& node, std::vector<RefineNear>& refinements);
/// \param scene  the rest of it, complete.
void readPhases(const SceneNode& node, const Scene& scene, std::vector<PhaseSpec>& phases);

}  // namespace cloth_sim
