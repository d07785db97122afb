#pragma once
/// \file Readers of the parts of a scene file. Each throws SceneError.

#include "cloth_sim/scene/scene.h"
#include "scene_node.h"
#include "section.h"

namespace cloth_sim {

// Shared by several parts (read_common.cpp).

/// Reads `position` and `rpy` or `orientation` of a map that may have other keys. An absent key
/// leaves its part of the pose as it is.
void readPose(const SceneNode& map, Pose& pose);
/// Returns the path of a file that the scene names relative to its own folder; not empty.
std::string besideScene(const SceneNode& node, const std::string& file);
/// Reads a map that is a pose and nothing else.
void readPoseMap(const SceneNode& map, Pose& pose);
/// Reads `rpy` or `orientation` of a map, if it has one of them.
std::optional<Quat> readOrientation(const SceneNode& map);
/// Reads [column, row] of a particle of the cloth.
PinSpec readParticle(const SceneNode& node, const ClothSpec& cloth);
/// Returns the index of the cloth that the key `cloth` of a map names; 0 if it is absent.
std::size_t readClothName(const SceneNode& map, const std::vector<ClothSpec>& cloths);
/// Reads a polyline of at least two points [u, v] of one cloth, which may end up to one cell
/// outside of it. Returns it in the material plane of the model [m].
MaterialPath readPath(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                      std::size_t cloth);
/// Reads a number for all kinds of springs, or a map by kind; a kind without a number never fails.
TearRatios readRatios(const SceneNode& node);
/// Reads where and how far to refine (read_surgery.cpp).
Refinement readRefinement(const SceneNode& node);

// The parts.

/// Returns the maps of the cloths: one, or those of a list.
/// \param node  the key `cloth` of a scene.
std::vector<SceneNode> clothNodes(const SceneNode& node);
/// Reads the cloths of a scene, and its surgery settings.
void readCloths(const SceneNode& node, Scene& scene);
void readSolver(const SceneNode& node, SolverSpec& solver);
/// Drops the parameters of other methods from `solver` if an override names its method, so that
/// `solver.method=verlet` works on every scene. Parameters that are overridden themselves stay.
void dropOtherParameters(YamlValue& root);
/// The solver of scenes that say nothing about it.
SolverSpec defaultSolver();
/// \param particles  number of particles of all cloths at the start.
void readSurgery(const SceneNode& node, int particles, SurgerySettings& surgery);
Wind readWind(const SceneNode& node);
void readObstacles(const SceneNode& node, std::vector<Obstacle>& obstacles);
void readClamps(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                std::vector<ClampSpec>& clamps);
void readTearing(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                 TearingSettings& tearing);
/// Reads one stroke of a blade or a list of strokes.
void readStrokes(const SceneNode& node, std::vector<Stroke>& strokes);
/// Reads one refinement around a path or point, or a list of them.
void readRefinements(const SceneNode& node, std::vector<RefineNear>& refinements);
/// \param scene  complete except for its phases.
void readPhases(const SceneNode& node, const Scene& scene, std::vector<PhaseSpec>& phases);

// The tables of keys of each file, for `sceneKeys`.

void listCommonKeys(std::vector<KeyTable>& tables);
void listClothKeys(std::vector<KeyTable>& tables);
void listSurgeryKeys(std::vector<KeyTable>& tables);
void listSolverKeys(std::vector<KeyTable>& tables);
void listObstacleKeys(std::vector<KeyTable>& tables);
void listClampKeys(std::vector<KeyTable>& tables);
void listTearingKeys(std::vector<KeyTable>& tables);
void listPhaseKeys(std::vector<KeyTable>& tables);

}  // namespace cloth_sim
