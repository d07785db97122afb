#pragma once
/// \file Lines along which the surface opens for a failed spring.

#include <optional>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// Returns the faces that a spring represents (see Spring::support), ascending.
std::vector<FaceId> facesUnder(const TriangleMesh& mesh, const Spring& spring);

/// Returns whether a cut or tear ends at `v`: it is on the border, and the angles around it sum to
/// more than 270 degrees.
bool isTip(const TriangleMesh& mesh, VertexId v);

/// Returns the direction in which a tear continues straight on from its tip, material coordinates:
/// opposite to the mean of its two border edges there. Unit length, or zero where these oppose.
Vec2 directionAhead(const TriangleMesh& mesh, VertexId tip);

/// Returns the border vertex of `faces` at which a tear begins: the one with the largest sum of
/// angles; kNone if none is on the border.
VertexId borderVertex(const TriangleMesh& mesh, const std::vector<FaceId>& faces);

/// Returns the direction, in material coordinates, that is normal to the line with the largest
/// traction: the eigenvector of the largest eigenvalue of P^T P. P = (sum of f (x) D) / A is the
/// mean first Piola-Kirchhoff stress of the springs around `v`, with the force f of a spring and
/// its rest vector D. Unit length.
Vec2 tensionDirection(const Model& model, const State& state, VertexId v);

// A parameter of a seam is the index of one of its segments plus the fraction of that segment.

/// Returns the parameter at which the segment p-q crosses a seam.
std::optional<double> crossingOf(const MaterialPath& seam, const Vec2& p, const Vec2& q);
/// Returns the parameter of a point on a seam, if it is within 1e-9 m of the seam.
std::optional<double> parameterOn(const MaterialPath& seam, const Vec2& p);

/// Returns the connected part of a seam over `faces` that contains the parameter `at`.
std::optional<SurfacePath> seamOver(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                    const MaterialPath& seam, double at);

/// Returns the part of a seam over the faces around `v`, a vertex on it. If `v` is a tip, it is
/// only the part ahead of it.
std::optional<SurfacePath> seamFrom(const TriangleMesh& mesh, VertexId v, const MaterialPath& seam);

/// Returns the segment from `origin` across one of its faces, along `direction` or against it:
/// whichever leads away from the tear that ends there or, if none does, towards `ahead`.
std::optional<SurfacePath> rayFrom(const TriangleMesh& mesh, VertexId origin, const Vec2& direction,
                                   const Vec2& ahead);

/// Returns the connected part over `faces` of the line through `middle` along `direction`.
std::optional<SurfacePath> lineThrough(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                       const Vec2& middle, const Vec2& direction);

}  // namespace cloth_sim
