#pragma once
/// \file An unstructured mesh of a disc, and the shadow that a mesh casts.

#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// Makes a disc of concentric rings about h apart. Each ring has about as many vertices as spacings
/// h fit into its circumference, so that their number changes from ring to ring, and begins at an
/// angle of its own. No direction in the plane is one of the mesh, and two rings that are zipped
/// together have triangles of about the same side h.
/// \param radius  of the outermost ring [m]
/// \param inner   a ring lies on this radius, too [m], < radius
/// \param h       [m]
/// \param turn    changes the angles at which the rings begin [-]
ClothMesh makeDisc(double radius, double inner, double h, double turn);

/// The area of the shadow of a mesh on the plane z = 0, by a raster [m^2].
/// \param positions  by vertex [m]
/// \param half       half the side of the raster, which is centred on the origin [m]
/// \param cells      of the raster, a side
double shadowArea(const std::vector<Face>& faces, const std::vector<Vec3>& positions, double half,
                  int cells);

}  // namespace cloth_sim
