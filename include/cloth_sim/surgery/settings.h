#pragma once
/// \file What a scene says about cutting, tearing and refining.

#include <optional>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Most bisections between a face of the original mesh and its parts.
constexpr int kMostGenerations = 12;

/// Where and how far the mesh is made finer.
struct Refinement {
  double radius = 0.0;   ///< around the stroke or point [m], > 0
  int generations = 3;   ///< bisections between a face of the original mesh and its parts, 0 ... 12
  double minEdge = 0.0;  ///< no edge shorter than this is made [m], >= 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(radius, generations, minEdge);
  }
};

/// To refine the mesh around a polyline in the world, or around a single point.
struct RefineNear {
  std::vector<Vec3> path;  ///< at least one point [m]
  Refinement refinement;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(path, refinement);
  }
};

struct SurgerySettings {
  /// A crossing nearer to a vertex than this part of the crossed edge is made at the vertex: the
  /// vertex moves onto the cut, or, where it may not move (a corner of the cloth, an earlier cut, a
  /// held particle), the cut bends to it, by no more than this part of the edge, or the 0.18 nearer
  /// to its end than which an edge of a grid cannot be split without an angle under 5 degrees.
  /// [0.05, 0.45]
  double snap = 0.2;
  /// No edge shorter than this is made [m]; absent: a twentieth of the shortest edge of the
  /// original mesh.
  std::optional<double> minEdge;
  std::int32_t maxParticles = 1 << 20;  ///< edits that would pass it are refused
  double dropBelow = 0.0;               ///< loose pieces of less area are taken away [m^2]; 0: none
  bool clearStrip = false;              ///< clear the springs within a stroke's half-width
  std::optional<Refinement> refineCuts;  ///< along strokes, before they cut
};

}  // namespace cloth_sim
