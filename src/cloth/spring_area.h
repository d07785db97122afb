#pragma once
/// \file The area of cloth that a spring represents.

#include "cloth_sim/cloth/spring.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Returns the rest area that a spring represents [m^2].
/// \param faces  those on its edge, or those around the vertex that it bridges.
double representedArea(const TriangleMesh& mesh, const IndexSpan& faces, const Spring& spring);

}  // namespace cloth_sim
