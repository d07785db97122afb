#pragma once
/// \file From the crossings of a strip with single faces to paths over the cloth.

#include <array>

#include "stroke_strip.h"

namespace cloth_sim {

/// What a point of a path is, so that faces and facets that share it can tell without looking at
/// coordinates: where the edge {a, b}, a < b, crosses a facet (a, b, facet), or where a border
/// pierces a face (-1 - border, face, 0).
using PathNode = std::array<std::int32_t, 3>;

/// A point of a path.
struct PathSample {
  PathNode node{kNone, kNone, kNone};
  Vec2 material = Vec2::Zero();  ///< [m]
  Vec3 position = Vec3::Zero();  ///< in the world [m]
  StripParameters at;
  Need need = Need::kAlways;
};

/// A straight part of a path, within one face.
struct PathPiece {
  PathSample from, to;
  FaceId face = kNone;
};

/// Pieces that follow on each other. The parameters of a point may differ between the piece that
/// ends and the one that starts there where a closed strip ends.
struct PathChain {
  std::vector<PathPiece> pieces;
  bool closed = false;
};

/// One piece per facet and face that cross, in the order of the facets, without direction.
std::vector<PathPiece> crossFaces(const Strip& strip, const TriangleMesh& mesh,
                                  const VertexData<Vec3>& positions);

/// Turns a chain around unless it goes as the blade moves; where the blade reaches all of it at
/// once, from heel to tip.
void direct(PathChain& chain);

/// Joins pieces that share nodes, directs the chains as the blade moves, and lets closed ones start
/// where the blade reaches them first. Pieces of no length are left out.
std::vector<PathChain> joinPieces(const std::vector<PathPiece>& pieces, const TriangleMesh& mesh);

/// Of all that the blade reaches at the same time, what is nearest to its heel; directed again.
std::vector<PathChain> nearestParts(const std::vector<PathChain>& chains);

/// The chains' points in the order in which the blade reaches them, without those that are not
/// needed to stay within `tolerance` [m] of the line.
std::vector<SurfacePath> toPaths(std::vector<PathChain> chains, double tolerance);

}  // namespace cloth_sim
