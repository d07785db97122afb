#pragma once
/// \file Closest points of parts of the cloth that may come into contact, four at a time.

#include <array>
#include <vector>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "linalg/vector_array.h"
#include "ridges.h"

namespace cloth_sim {

/// Closest points of a vertex and a face, or of two edges. The weighted sum of the positions of
/// four vertices points from the second part to the first.
struct ClosestPoints {
  std::array<VertexId, 4> v{};     ///< a vertex and the corners of a face, or the ends of two edges
  std::array<double, 4> weight{};  ///< those of each part sum to 1 and -1
  FaceId face = kNone;             ///< kNone for two edges
  double apart = 0.0;              ///< [m]

  bool areEdges() const { return face == kNone; }
  /// Tells whether they are inside the face, or inside both edges.
  bool areInside() const {
    return weight[0] != 0.0 && weight[1] != 0.0 && weight[2] != 0.0 && weight[3] != 0.0;
  }
};

/// A vertex and a face, or two edges (`Ridges::EdgeId`).
using CandidateIds = std::array<std::int32_t, 2>;

/// Candidates of a kind: vertices and faces, or edges.
struct CandidateList {
  std::vector<CandidateIds> ids;
  std::vector<double> due;  ///< sum of the travel of their vertices from which they may touch [m]

  void clear();
  /// Appends a candidate, which is due.
  void add(const CandidateIds& candidate);
};

/// Motion of the vertices of candidates.
struct CandidateMotion {
  ConstAxes x;                  ///< positions, by vertex [m]
  const double* travel;         ///< how far it has moved, by vertex [m]
  const double* outlook;        ///< how far it may have until the next time, by vertex [m]
  const double* halfThickness;  ///< by vertex [m]
  double farthest;              ///< largest outlook [m]
};

/// Finds the closest points of the vertices and faces that are due, and when they are due again;
/// appends those that may touch before the next time.
/// \param corners  by face.
void findClosest(CandidateList& list, const CandidateMotion& motion,
                 const std::vector<Face>& corners, std::vector<ClosestPoints>& found);
/// The same for edges along one of which the cloth may be folded.
void findClosest(CandidateList& list, const CandidateMotion& motion, const Ridges& ridges,
                 std::vector<ClosestPoints>& found);

}  // namespace cloth_sim
