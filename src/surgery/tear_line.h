#pragma once
/// \file Along which line the surface opens for a failed spring.

#include <optional>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// The faces that a spring stands on, ascending.
std::vector<FaceId> facesUnder(const TriangleMesh& mesh, const Spring& spring);

/// Whether a cut or tear ends at `v`: a vertex on the border with more than three right angles of
/// material around it.
bool isTip(const TriangleMesh& mesh, VertexId v);

/// The vertex of `faces` on the border at which a tear begins: the one with the most material
/// around it. kNone if none is on the border.
VertexId borderVertex(const TriangleMesh& mesh, const std::vector<FaceId>& faces);

/// Direction, in material coordinates, in which the traction across a line normal to it is
/// largest: of the mean first Piola-Kirchhoff stress of the springs around `v`,
/// P = (sum of f (x) D) / A, with f the force of a spring and D its rest vector. Unit length.
Vec2 tensionDirection(const Model& model, const State& state, VertexId v);

/// Where on a seam the segment p-q crosses it: the number of a segment, plus the part of it.
std::optional<double> crossingOf(const MaterialPath& seam, const Vec2& p, const Vec2& q);
/// Where on a seam a point is, if it is on it (within 1e-9 m).
std::optional<double> placeOn(const MaterialPath& seam, const Vec2& p);

/// The connected part of `seam` over `faces` that has the place `at`.
std::optional<SurfacePath> seamOver(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                    const MaterialPath& seam, double at);

/// The part of `seam` over the faces around `v`, a vertex on it; from a tip only what is ahead.
std::optional<SurfacePath> seamFrom(const TriangleMesh& mesh, VertexId v, const MaterialPath& seam);

/// From `origin` across the faces around it, along `direction` or against it: away from the tear
/// that ends there, or towards `ahead`.
std::optional<SurfacePath> rayFrom(const TriangleMesh& mesh, VertexId origin, const Vec2& direction,
                                   const Vec2& ahead);

/// The part over `faces` of the line through `middle` along `direction`.
std::optional<SurfacePath> lineThrough(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                       const Vec2& middle, const Vec2& direction);

}  // namespace cloth_sim
