#include "cloth_sim/cloth/raw_spring_fractions.h"

#include <map>

namespace cloth_sim {
namespace {

/// Index k of the corner or of the edge (k, k+1) of `face` that starts at one of {a, b}.
int edgeIndex(const Face& face, VertexId a, VertexId b) {
  for (int k = 0; k < 3; ++k) {
    const VertexId from = face[k];
    const VertexId to = face[(k + 1) % 3];
    if ((from == a && to == b) || (from == b && to == a)) return k;
  }
  return 0;
}

int cornerIndex(const Face& face, VertexId v) { return face[0] == v ? 0 : (face[1] == v ? 1 : 2); }

/// An edge as a face runs along it.
using Directed = std::pair<VertexId, VertexId>;

/// What the faces that an edit reshaped had before it.
struct Inheritance {
  std::map<Directed, RawSpringFraction> edges;
  std::map<VertexId, double> corners;  ///< all together

  /// Both parts of an edge that was split have the share of the whole.
  void split(const VertexEdit& edit) {
    const VertexId a = edit.from[0];
    const VertexId b = edit.from[1];
    for (const auto& [from, to] : {Directed{a, b}, Directed{b, a}}) {
      const auto whole = edges.find({from, to});
      if (whole == edges.end()) continue;
      const RawSpringFraction share = whole->second;
      edges[{from, edit.id}] = edges[{edit.id, to}] = share;
    }
  }
};

}  // namespace

RawSpringFractions::RawSpringFractions(const TriangleMesh& mesh) {
  for (FaceId f = 0; f < mesh.faceCount(); ++f) shares_.push_back(fresh(mesh, f));
}

RawSpringFractions::Shares RawSpringFractions::fresh(const TriangleMesh& mesh, FaceId f) {
  Shares shares;
  shares.face = mesh.face(f);
  for (int k = 0; k < 3; ++k) {
    const VertexId a = shares.face[k];
    const VertexId b = shares.face[(k + 1) % 3];
    double onEdge = 0.0;
    for (FaceId other : mesh.facesOnEdge(a, b)) {
      if (other != kNone) onEdge += mesh.restArea(other);
    }
    shares.edge[k] = mesh.restArea(f) / onEdge;
    shares.length[k] = (mesh.material(b) - mesh.material(a)).norm();
    shares.corner[k] = mesh.restArea(f) / areaAround(mesh, a);
  }
  return shares;
}

void RawSpringFractions::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (!changes.removedFaces.empty()) return applyRemoval(mesh, changes);
  Inheritance old;
  const auto known = static_cast<FaceId>(shares_.size());
  for (FaceId f : changes.reshapedFaces) {
    if (f >= known) break;
    const Shares& s = shares_[f];
    for (int k = 0; k < 3; ++k) {
      old.edges[{s.face[k], s.face[(k + 1) % 3]}] = {s.edge[k], s.length[k]};
      old.corners[s.face[k]] += s.corner[k];
    }
  }
  for (const VertexEdit& edit : changes.vertices) {
    const bool onEdge = edit.kind == VertexEdit::Kind::kInsert && edit.from[2] == kNone;
    if (onEdge) old.split(edit);
  }
  std::map<VertexId, double> areas;  // of reshaped faces at their corners
  for (FaceId f : changes.reshapedFaces) {
    for (VertexId v : mesh.face(f)) areas[v] += mesh.restArea(f);
  }
  shares_.resize(mesh.faceCount());
  for (FaceId f : changes.reshapedFaces) {
    Shares s = fresh(mesh, f);
    s.remade = true;
    for (int k = 0; k < 3; ++k) {
      const auto edge = old.edges.find({s.face[k], s.face[(k + 1) % 3]});
      if (edge != old.edges.end()) {
        s.edge[k] = edge->second.part;
        s.length[k] = edge->second.length;
      }
      const auto corner = old.corners.find(s.face[k]);
      if (corner != old.corners.end()) {
        s.corner[k] = corner->second * mesh.restArea(f) / areas[s.face[k]];
      }
    }
    shares_[f] = s;
  }
  for (FaceId f : changes.changedFaces) shares_[f].face = mesh.face(f);
}

void RawSpringFractions::applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes) {
  for (FaceId f : changes.removedFaces) {
    shares_[f] = shares_.back();
    shares_.pop_back();
  }
  for (FaceId f = 0; f < mesh.faceCount(); ++f) shares_[f].face = mesh.face(f);
}

RawSpringFraction RawSpringFractions::ofEdge(const TriangleMesh& mesh, const IndexSpan& on,
                                             VertexId a, VertexId b) const {
  RawSpringFraction sum;
  for (FaceId f : on) {
    const int k = edgeIndex(mesh.face(f), a, b);
    sum.part += shares_[f].edge[k];
    sum.length += shares_[f].edge[k] * shares_[f].length[k];
  }
  sum.length /= sum.part;
  return sum;
}

RawSpringFraction RawSpringFractions::ofCorners(const TriangleMesh& mesh, const IndexSpan& around,
                                                VertexId v) const {
  RawSpringFraction sum{0.0, 1.0};
  for (FaceId f : around) {
    sum.part += shares_[f].corner[cornerIndex(mesh.face(f), v)];
    if (shares_[f].remade) sum.length = 0.0;
  }
  return sum;
}

}  // namespace cloth_sim
