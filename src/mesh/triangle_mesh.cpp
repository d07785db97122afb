#include "cloth_sim/mesh/triangle_mesh.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "quality.h"

namespace cloth_sim {
namespace {

/// Returns the corners of `face` after and before `v`.
std::pair<VertexId, VertexId> around(const Face& face, VertexId v) {
  if (face[0] == v) return {face[1], face[2]};
  if (face[1] == v) return {face[2], face[0]};
  return {face[0], face[1]};
}

/// Returns one sentence about what is wrong with a face; empty if nothing is.
std::string faceError(const TriangleMesh& mesh, FaceId f) {
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

/// The one-ring of a vertex: the neighbours after and before it in each of its faces.
class OneRing {
 public:
  /// Reads the ring of `v`, reusing the memory of the last one.
  void read(const TriangleMesh& mesh, VertexId v) {
    next_.clear();
    previous_.clear();
    for (const FaceId f : mesh.facesAround(v)) {
      const auto [next, previous] = around(mesh.face(f), v);
      next_.push_back(next);
      previous_.push_back(previous);
    }
  }

  /// Tells whether the edge that leaves the vertex in its k-th face is on the border.
  bool isBorder(std::size_t k) const { return to(next_[k]) < 0; }

  /// Returns one sentence about an edge at `v` that two faces run along in the same direction;
  /// empty if there is none.
  std::string doubleEdgeError(VertexId v) const {
    const auto describe = [](VertexId from, VertexId to) {
      return "edge " + std::to_string(from) + " -> " + std::to_string(to) +
             " is run through twice in the same direction";
    };
    for (std::size_t k = 0; k < next_.size(); ++k) {
      if (from(next_[k]) != static_cast<int>(k)) return describe(v, next_[k]);
      if (to(previous_[k]) != static_cast<int>(k)) return describe(previous_[k], v);
    }
    return "";
  }

  /// Tells whether the faces form a single fan, provided that `doubleEdgeError` is empty. Walks
  /// from face to face across their common edges; unlike `fansAround` it allocates nothing.
  bool isOneFan() const {
    int first = 0;  // any face, if the fan is closed
    for (std::size_t k = 0; k < next_.size(); ++k) {
      if (isBorder(k)) first = static_cast<int>(k);
    }
    std::size_t count = 0;
    int at = first;
    do {
      ++count;
      at = from(previous_[static_cast<std::size_t>(at)]);
    } while (at >= 0 && at != first && count < next_.size());
    return count == next_.size();
  }

 private:
  /// Index of the face with the directed edge from the vertex to `w`, or -1.
  int from(VertexId w) const { return indexOf(next_, w); }
  /// Index of the face with the directed edge from `w` to the vertex, or -1.
  int to(VertexId w) const { return indexOf(previous_, w); }
  static int indexOf(const std::vector<VertexId>& list, VertexId w) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (list[k] == w) return static_cast<int>(k);
    }
    return -1;
  }

  std::vector<VertexId> next_, previous_;
};

/// Returns one sentence about what is wrong around a vertex; empty if nothing is.
/// \param ring  receives the one-ring of the vertex if its faces are valid.
std::string vertexError(const TriangleMesh& mesh, VertexId v, OneRing& ring) {
  const IndexSpan faces = mesh.facesAround(v);
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
  ring.read(mesh, v);
  const std::string edge = ring.doubleEdgeError(v);
  if (!edge.empty()) return edge;
  if (!ring.isOneFan()) {
    return "vertex " + std::to_string(v) + " joins faces at a single point";
  }
  return "";
}

}  // namespace

TriangleMesh::TriangleMesh(std::vector<Vec2> material, std::vector<Face> faces)
    : material_(std::move(material)), faces_(std::move(faces)) {
  listIncidentFaces();
  generation_.assign(faces_.size(), 0);
  boundaryBits_.assign(faces_.size(), 0);
  OneRing ring;
  for (VertexId v = 0; v < vertexCount(); ++v) {
    const std::string error = vertexError(*this, v, ring);
    if (!error.empty()) throw std::invalid_argument(error);
    const IndexSpan around = facesAround(v);
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Face& face = faces_[around[k]];
      const auto corner = std::find(face.begin(), face.end(), v) - face.begin();
      if (ring.isBorder(k)) boundaryBits_[around[k]] |= 1U << corner;
    }
  }
}

/// Fills `incident_`.
/// \throws std::invalid_argument if a face is not valid.
void TriangleMesh::listIncidentFaces() {
  std::vector<std::int32_t> facesOf(material_.size(), 0);
  for (FaceId f = 0; f < faceCount(); ++f) {
    const std::string error = faceError(*this, f);
    if (!error.empty()) throw std::invalid_argument(error);
    for (VertexId v : faces_[f]) ++facesOf[v];
  }
  incident_ = IndexLists(facesOf);
  for (FaceId f = 0; f < faceCount(); ++f) {
    for (VertexId v : faces_[f]) incident_.append(v, f);
  }
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
  found.reserve(2 * facesAround(v).size());
  neighbours(v, found);
  return found;
}

void TriangleMesh::neighbours(VertexId v, std::vector<VertexId>& out) const {
  out.clear();
  for (FaceId f : incident_[v]) {
    const auto [next, previous] = around(faces_[f], v);
    out.push_back(next);
    out.push_back(previous);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

bool TriangleMesh::isBoundary(VertexId v) const {
  return neighbours(v).size() != facesAround(v).size();
}

double TriangleMesh::restArea(FaceId f) const {
  const Face& face = faces_[f];
  return 0.5 * doubleArea(material_[face[0]], material_[face[1]], material_[face[2]]);
}

double TriangleMesh::totalRestArea() const {
  double total = 0.0;
  for (FaceId f = 0; f < faceCount(); ++f) total += restArea(f);
  return total;
}

std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v) {
  return fansAround(mesh, v, [](VertexId) { return false; });
}

std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v,
                                            const std::function<bool(VertexId)>& isCut) {
  const IndexSpan faces = mesh.facesAround(v);
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
        if (taken[other]) continue;
        const bool joined = (contains(candidate, next) && !isCut(next)) ||
                            (contains(candidate, previous) && !isCut(previous));
        if (joined) {
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

double areaAround(const TriangleMesh& mesh, VertexId v) {
  double area = 0.0;
  for (FaceId f : mesh.facesAround(v)) area += mesh.restArea(f);
  return area;
}

ConnectedComponents connectedComponents(const TriangleMesh& mesh) {
  // Union-find over the vertices: on a manifold, faces that share a vertex are connected by edges.
  std::vector<VertexId> parent(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto rootOf = [&parent](VertexId v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Face& face : mesh.faces()) {
    const VertexId a = rootOf(face[0]);
    const VertexId b = rootOf(face[1]);
    const VertexId c = rootOf(face[2]);
    const VertexId root = std::min({a, b, c});
    parent[a] = parent[b] = parent[c] = root;
  }
  ConnectedComponents components;
  components.ofFace.reserve(mesh.faces().size());
  std::vector<std::int32_t> ofRoot(parent.size(), kNone);
  for (const Face& face : mesh.faces()) {
    std::int32_t& component = ofRoot[rootOf(face[0])];
    if (component == kNone) component = components.count++;
    components.ofFace.push_back(component);
  }
  return components;
}

bool TriangleMesh::hasCompleteTables() const {
  if (boundaryBits_.size() != faces_.size() || generation_.size() != faces_.size()) return false;
  if (incident_.size() != material_.size()) return false;
  std::size_t listed = 0;
  for (VertexId v = 0; v < vertexCount(); ++v) listed += facesAround(v).size();
  return listed == 3 * faces_.size();
}

std::string validationError(const TriangleMesh& mesh) {
  if (!mesh.hasCompleteTables()) return "its tables of faces and vertices do not fit each other";
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const std::string error = faceError(mesh, f);
    if (!error.empty()) return error;
  }
  OneRing ring;
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    const std::string error = vertexError(mesh, v, ring);
    if (!error.empty()) return error;
  }
  return "";
}

}  // namespace cloth_sim
