#include "cloth_sim/mesh/triangle_mesh.h"

#include <algorithm>
#include <stdexcept>

namespace cloth_sim {
namespace {

double signedArea(const Vec2& a, const Vec2& b, const Vec2& c) {
  return 0.5 * ((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y()));
}

bool contains(const Face& face, VertexId v) { return face[0] == v || face[1] == v || face[2] == v; }

/// The vertices of `face` after and before `v` in its orientation.
std::pair<VertexId, VertexId> around(const Face& face, VertexId v) {
  if (face[0] == v) return {face[1], face[2]};
  if (face[1] == v) return {face[2], face[0]};
  return {face[0], face[1]};
}

std::string describeFaceDefect(const TriangleMesh& mesh, FaceId f) {
  const Face& face = mesh.face(f);
  for (VertexId v : face) {
    if (v < 0 || v >= mesh.vertexCount()) {
      return "face " + std::to_string(f) + " names vertex " + std::to_string(v) +
             ", which does not exist";
    }
  }
  if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
    return "face " + std::to_string(f) + " has a vertex twice";
  }
  if (!(mesh.restArea(f) > 0.0)) {
    return "face " + std::to_string(f) + " has no positive rest area";
  }
  return "";
}

std::string describeVertexEdgeDefect(const TriangleMesh& mesh, VertexId v) {
  std::vector<VertexId> out;
  for (FaceId f : mesh.facesAround(v)) out.push_back(around(mesh.face(f), v).first);
  std::sort(out.begin(), out.end());
  const auto twice = std::adjacent_find(out.begin(), out.end());
  if (twice == out.end()) return "";
  return "edge " + std::to_string(v) + " -> " + std::to_string(*twice) +
         " is run through twice in the same direction";
}

std::string describeVertexDefect(const TriangleMesh& mesh, VertexId v) {
  const std::vector<FaceId>& faces = mesh.facesAround(v);
  if (faces.empty()) return "vertex " + std::to_string(v) + " has no face";
  if (!std::is_sorted(faces.begin(), faces.end())) {
    return "faces around vertex " + std::to_string(v) + " are not in order";
  }
  for (FaceId f : faces) {
    if (f < 0 || f >= mesh.faceCount() || !contains(mesh.face(f), v)) {
      return "vertex " + std::to_string(v) + " lists face " + std::to_string(f) +
             ", which does not have it";
    }
  }
  const std::string edge = describeVertexEdgeDefect(mesh, v);
  if (!edge.empty()) return edge;
  if (fansAround(mesh, v).size() != 1) {
    return "vertex " + std::to_string(v) + " joins faces at a single point";
  }
  return "";
}

}  // namespace

TriangleMesh::TriangleMesh(std::vector<Vec2> material, std::vector<Face> faces)
    : material_(std::move(material)), faces_(std::move(faces)), incident_(material_.size()) {
  for (FaceId f = 0; f < faceCount(); ++f) {
    const std::string defect = describeFaceDefect(*this, f);
    if (!defect.empty()) throw std::invalid_argument(defect);
    for (VertexId v : faces_[f]) incident_[v].push_back(f);
  }
  const std::string defect = describeDefect(*this);
  if (!defect.empty()) throw std::invalid_argument(defect);
}

std::array<FaceId, 2> TriangleMesh::facesOnEdge(VertexId a, VertexId b) const {
  std::array<FaceId, 2> found{kNone, kNone};
  int n = 0;
  for (FaceId f : incident_[a]) {
    if (contains(faces_[f], b) && n < 2) found[n++] = f;
  }
  return found;
}

VertexId TriangleMesh::oppositeVertex(FaceId f, VertexId a, VertexId b) const {
  for (VertexId v : faces_[f]) {
    if (v != a && v != b) return v;
  }
  return kNone;
}

std::vector<VertexId> TriangleMesh::neighbours(VertexId v) const {
  std::vector<VertexId> found;
  found.reserve(2 * incident_[v].size());
  for (FaceId f : incident_[v]) {
    const auto [next, previous] = around(faces_[f], v);
    found.push_back(next);
    found.push_back(previous);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

bool TriangleMesh::isBoundary(VertexId v) const {
  return neighbours(v).size() != incident_[v].size();
}

double TriangleMesh::restArea(FaceId f) const {
  const Face& face = faces_[f];
  return signedArea(material_[face[0]], material_[face[1]], material_[face[2]]);
}

double TriangleMesh::totalRestArea() const {
  double total = 0.0;
  for (FaceId f = 0; f < faceCount(); ++f) total += restArea(f);
  return total;
}

std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v) {
  const std::vector<FaceId>& faces = mesh.facesAround(v);
  std::vector<std::vector<FaceId>> fans;
  std::vector<bool> taken(faces.size(), false);
  for (std::size_t seed = 0; seed < faces.size(); ++seed) {
    if (taken[seed]) continue;
    taken[seed] = true;
    std::vector<std::size_t> open{seed};
    std::vector<FaceId> fan;
    while (!open.empty()) {
      const std::size_t k = open.back();
      open.pop_back();
      fan.push_back(faces[k]);
      const auto [next, previous] = around(mesh.face(faces[k]), v);
      for (std::size_t other = 0; other < faces.size(); ++other) {
        const Face& candidate = mesh.face(faces[other]);
        if (!taken[other] && (contains(candidate, next) || contains(candidate, previous))) {
          taken[other] = true;
          open.push_back(other);
        }
      }
    }
    std::sort(fan.begin(), fan.end());
    fans.push_back(std::move(fan));
  }
  return fans;
}

Pieces findPieces(const TriangleMesh& mesh) {
  // On a manifold, faces that share a vertex are joined by edges around it: walk over vertices.
  Pieces pieces;
  pieces.ofFace.assign(mesh.faceCount(), kNone);
  std::vector<FaceId> open;
  for (FaceId seed = 0; seed < mesh.faceCount(); ++seed) {
    if (pieces.ofFace[seed] != kNone) continue;
    const std::int32_t piece = pieces.count++;
    pieces.ofFace[seed] = piece;
    open.push_back(seed);
    while (!open.empty()) {
      const FaceId f = open.back();
      open.pop_back();
      for (VertexId v : mesh.face(f)) {
        for (FaceId other : mesh.facesAround(v)) {
          if (pieces.ofFace[other] != kNone) continue;
          pieces.ofFace[other] = piece;
          open.push_back(other);
        }
      }
    }
  }
  return pieces;
}

std::string describeDefect(const TriangleMesh& mesh) {
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const std::string defect = describeFaceDefect(mesh, f);
    if (!defect.empty()) return defect;
  }
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    const std::string defect = describeVertexDefect(mesh, v);
    if (!defect.empty()) return defect;
  }
  return "";
}

}  // namespace cloth_sim
