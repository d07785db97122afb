#include "cloth_sim/cloth/raw_spring_fractions.h"

#include <map>

namespace cloth_sim {
namespace {

/// Index k of the edge (k, k + 1) of `face` that joins a and b.
int edgeIndex(const Face& face, VertexId a, VertexId b) {
  for (int k = 0; k < 3; ++k) {
    const VertexId from = face[k];
    const VertexId to = face[(k + 1) % 3];
    if ((from == a && to == b) || (from == b && to == a)) return k;
  }
  return 0;
}

int cornerIndex(const Face& face, VertexId v) { return face[0] == v ? 0 : (face[1] == v ? 1 : 2); }

/// An edge in the orientation of a face, so that the two sides of an edge are told apart.
using DirectedEdge = std::pair<VertexId, VertexId>;

}  // namespace

/// Fractions that the reshaped faces held before an edit, and pass on to those after it.
struct RawSpringFractions::Inheritance {
  std::map<DirectedEdge, RawSpringFraction> edges;
  std::map<VertexId, double> corners;  ///< sum over all reshaped faces at the vertex

  /// Gives both parts of a split edge the fraction of the whole.
  void split(const VertexEdit& edit) {
    const VertexId a = edit.from[0];
    const VertexId b = edit.from[1];
    for (const auto& [from, to] : {DirectedEdge{a, b}, DirectedEdge{b, a}}) {
      const auto whole = edges.find({from, to});
      if (whole == edges.end()) continue;
      const RawSpringFraction fraction = whole->second;
      edges[{from, edit.id}] = edges[{edit.id, to}] = fraction;
    }
  }
};

RawSpringFractions::RawSpringFractions(const TriangleMesh& mesh) {
  for (FaceId f = 0; f < mesh.faceCount(); ++f) fractions_.push_back(fractionsOf(mesh, f));
}

/// Fractions of a face in proportion to its rest area, as if the mesh had never been edited.
RawSpringFractions::FaceFractions RawSpringFractions::fractionsOf(const TriangleMesh& mesh,
                                                                  FaceId f) {
  FaceFractions result;
  result.face = mesh.face(f);
  for (int k = 0; k < 3; ++k) {
    const VertexId a = result.face[k];
    const VertexId b = result.face[(k + 1) % 3];
    double onEdge = 0.0;
    for (FaceId other : mesh.facesOnEdge(a, b)) {
      if (other != kNone) onEdge += mesh.restArea(other);
    }
    result.edge[k] = mesh.restArea(f) / onEdge;
    result.restLength[k] = (mesh.material(b) - mesh.material(a)).norm();
    result.corner[k] = mesh.restArea(f) / areaAround(mesh, a);
  }
  return result;
}

RawSpringFractions::Inheritance RawSpringFractions::inheritanceOf(
    const MeshChanges& changes) const {
  Inheritance old;
  const auto known = static_cast<FaceId>(fractions_.size());
  for (FaceId f : changes.reshapedFaces) {
    if (f >= known) break;  // new, and so are all that come after it
    const FaceFractions& held = fractions_[f];
    for (int k = 0; k < 3; ++k) {
      old.edges[{held.face[k], held.face[(k + 1) % 3]}] = {held.edge[k], held.restLength[k]};
      old.corners[held.face[k]] += held.corner[k];
    }
  }
  for (const VertexEdit& edit : changes.vertices) {
    const bool onEdge = edit.kind == VertexEdit::Kind::kInsert && edit.from[2] == kNone;
    if (onEdge) old.split(edit);
  }
  return old;
}

void RawSpringFractions::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (!changes.removedFaces.empty()) return applyRemoval(mesh, changes);
  const Inheritance old = inheritanceOf(changes);
  std::map<VertexId, double> areas;  // of the reshaped faces around a vertex [m^2]
  for (FaceId f : changes.reshapedFaces) {
    for (VertexId v : mesh.face(f)) areas[v] += mesh.restArea(f);
  }
  fractions_.resize(mesh.faceCount());
  for (FaceId f : changes.reshapedFaces) {
    FaceFractions held = fractionsOf(mesh, f);
    held.reshaped = true;
    for (int k = 0; k < 3; ++k) {
      const auto edge = old.edges.find({held.face[k], held.face[(k + 1) % 3]});
      if (edge != old.edges.end()) {
        held.edge[k] = edge->second.fraction;
        held.restLength[k] = edge->second.restLength;
      }
      const auto corner = old.corners.find(held.face[k]);
      if (corner != old.corners.end()) {
        held.corner[k] = corner->second * mesh.restArea(f) / areas[held.face[k]];
      }
    }
    fractions_[f] = held;
  }
  for (FaceId f : changes.changedFaces) fractions_[f].face = mesh.face(f);
}

/// Moves the fractions of the faces that took the places of removed ones.
void RawSpringFractions::applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes) {
  for (FaceId f : changes.removedFaces) {
    fractions_[f] = fractions_.back();
    fractions_.pop_back();
  }
  for (FaceId f = 0; f < mesh.faceCount(); ++f) fractions_[f].face = mesh.face(f);
}

RawSpringFraction RawSpringFractions::ofEdge(const TriangleMesh& mesh, const IndexSpan& on,
                                             VertexId a, VertexId b) const {
  RawSpringFraction sum;
  for (FaceId f : on) {
    const int k = edgeIndex(mesh.face(f), a, b);
    sum.fraction += fractions_[f].edge[k];
    sum.restLength += fractions_[f].edge[k] * fractions_[f].restLength[k];
  }
  sum.restLength /= sum.fraction;
  return sum;
}

RawSpringFraction RawSpringFractions::ofCorners(const TriangleMesh& mesh, const IndexSpan& around,
                                                VertexId v) const {
  RawSpringFraction sum{0.0, 1.0};
  for (FaceId f : around) {
    sum.fraction += fractions_[f].corner[cornerIndex(mesh.face(f), v)];
    if (fractions_[f].reshaped) sum.restLength = 0.0;
  }
  return sum;
}

}  // namespace cloth_sim
