#pragma once
/// \file Parameters of a scene for cutting, tearing and refinement.

#include <optional>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Largest number of bisections between a face of the original mesh and its parts.
constexpr int kMostGenerations = 12;

/// Extent and limits of a refinement.
struct Refinement {
  double radius = 0.0;   ///< distance from the path within which faces are bisected [m], > 0
  int generations = 3;   ///< bisections between a face of the original mesh and its parts, 0 ... 12
  double minEdge = 0.0;  ///< length below which no edge is created [m], >= 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(radius, generations, minEdge);
  }
};

/// A request to refine the mesh near a polyline or a single point in the world.
struct RefineNear {
  std::vector<Vec3> path;  ///< at least one point, in the world [m]
  Refinement refinement;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(path, refinement);
  }
};

/// The surgery parameters of a scene.
struct SurgerySettings {
  /// Snapping distance as a fraction of the crossed edge, in [0.05, 0.45]: at a crossing nearer to
  /// a vertex than this, the vertex moves onto the cut. Where it may not move (at a corner of the
  /// cloth, on an earlier cut, or held), the cut bends to it. The bend is at most this fraction of
  /// the edge, or 0.18 if that is more: nearer to its end than 0.18, an edge of a grid cannot be
  /// split without an angle below 5 degrees.
  double snap = 0.2;
  /// Length below which no edge is created [m]; absent: a twentieth of the shortest edge of the
  /// original mesh.
  std::optional<double> minEdge;
  std::int32_t maxParticles = 1 << 20;  ///< operations that would exceed it are refused
  double dropBelow = 0.0;   ///< area below which loose pieces are removed [m^2]; 0: none
  bool clearStrip = false;  ///< remove the strip within the half-width of a stroke
  std::optional<Refinement> refineCuts;  ///< refinement along strokes, before they cut
};

}  // namespace cloth_sim
