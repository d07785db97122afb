#pragma once
/// \file The definition of strain for figures, summaries, messages, markers, colours and pictures.
///
/// The strain of a spring of length l and rest length L is l / L - 1 [-], or zero if it is shorter
/// than at rest (cloth buckles instead of being compressed). From it follow
///   - the strain of a vertex: the largest of the structural and shear springs that end there,
///   - the strain of a face: the largest of its three corners,
///   - the strain of a cloth (`max_strain`): the largest of all its structural and shear springs.
/// A receiver of ~topology has no springs; it derives the same vertex pairs from the triangles and
/// the material coordinates (`strainLines`). scripts/picture.py does so, too, in Python;
/// test/tools/picture_test.py compares it with `max_strain`.

#include <algorithm>
#include <cmath>
#include <vector>

#include "cloth_sim/mesh/face_edges.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Returns the strain [-] of a spring.
/// \param squaredStretch  square of length over rest length [-], >= 0. The square, because the
///                        largest of many strains then takes a single root.
template <typename Real>
Real strainOf(Real squaredStretch) {
  return std::sqrt(std::max(Real(1), squaredStretch)) - Real(1);
}

/// The same from a stretch that is not squared: length over rest length [-].
inline double strainOfStretch(double stretch) { return std::max(1.0, stretch) - 1.0; }

/// The ends and the rest length of a structural or shear spring.
struct StrainLine {
  VertexId a = kNone;
  VertexId b = kNone;
  double restLength = 0.0;  ///< [m]
};

/// Derives the structural and shear springs of a mesh: every edge, and across every inner bias edge
/// the other diagonal, if that is a bias direction, too. A cloth of a scene that leaves out shear
/// springs has fewer.
/// \param sorted    the edges of its faces.
/// \param material  coordinates of each vertex [m].
std::vector<StrainLine> strainLines(const FaceEdges& sorted, const std::vector<Vec2>& material);

/// Computes the strain of each vertex.
/// \param positions  of each vertex [m].
/// \param strains    the result [-], >= 0; resized to the number of positions.
void vertexStrains(const std::vector<StrainLine>& lines, const std::vector<Vec3>& positions,
                   std::vector<float>& strains);

/// Returns the strain of a face [-].
inline float faceStrain(const Face& face, const std::vector<float>& vertexStrains) {
  return std::max({vertexStrains[face[0]], vertexStrains[face[1]], vertexStrains[face[2]]});
}

}  // namespace cloth_sim
