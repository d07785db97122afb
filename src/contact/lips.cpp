#include "lips.h"

#include <algorithm>
#include <map>
#include <vector>

#include "closest_points.h"

namespace cloth_sim {
namespace {

/// Distance between the copies of a vertex along each direction [m].
constexpr double kLipDistance = 2e-6;
/// Most motion of a copy [m].
constexpr double kFarthest = 10.0 * kLipDistance;

/// Two copies of a vertex that have to be apart along n.
struct Lip {
  VertexId a = kNone;
  VertexId b = kNone;
  Vec3 n = Vec3::Zero();  ///< from b to a
};

/// Vertices that were one, by the first of them.
std::map<VertexId, std::vector<VertexId>> groupCopies(const MeshChanges& changes,
                                                      std::int32_t vertices) {
  std::map<VertexId, VertexId> origin;
  std::map<VertexId, std::vector<VertexId>> groups;
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.kind != VertexEdit::Kind::kCopy || edit.id >= vertices || edit.from[0] >= vertices) {
      continue;
    }
    const auto found = origin.find(edit.from[0]);
    const VertexId first = found == origin.end() ? edit.from[0] : found->second;
    origin[edit.id] = first;
    std::vector<VertexId>& group = groups[first];
    if (group.empty()) group.push_back(first);
    group.push_back(edit.id);
  }
  return groups;
}

/// The direction that separates two faces that touch at `v` of f and `w` of g, and perhaps at one
/// more corner, but nowhere else.
SeparatingDirection directionAt(const Face& f, VertexId v, const Face& g, VertexId w,
                                const VertexData<Vec3>& x) {
  std::vector<Vec3> a;     // edges of f from v to corners that g does not have
  std::vector<Vec3> b;     // of g
  std::vector<Vec3> both;  // to common corners
  const auto isAmong = [&](VertexId p, const Face& face) {
    return std::any_of(face.begin(), face.end(), [&](VertexId q) { return x[p] == x[q]; });
  };
  for (const VertexId p : f) {
    if (p != v) (isAmong(p, g) ? both : a).push_back(x[p] - x[v]);
  }
  for (const VertexId p : g) {
    if (p != w && !isAmong(p, f)) b.push_back(x[p] - x[w]);
  }
  if (a.size() == 2 && b.size() == 2) return separateAtVertex({a[0], a[1]}, {b[0], b[1]});
  if (a.size() == 1 && b.size() == 1) return separateHinge(both[0], a[0], b[0]);
  return {};
}

std::vector<Lip> listLips(const MeshChanges& changes, const TriangleMesh& mesh,
                          const VertexData<Vec3>& x) {
  std::vector<Lip> lips;
  const auto add = [&](VertexId v, VertexId w) {
    if (x[v] != x[w]) return;
    for (const FaceId f : mesh.facesAround(v)) {
      for (const FaceId g : mesh.facesAround(w)) {
        const SeparatingDirection found = directionAt(mesh.face(f), v, mesh.face(g), w, x);
        if (found.distance > 0.0) lips.push_back({v, w, found.direction});
      }
    }
  };
  for (const auto& [first, group] : groupCopies(changes, mesh.vertexCount())) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = i + 1; j < group.size(); ++j) add(group[i], group[j]);
    }
  }
  return lips;
}

/// Returns the displacement of each copy, by vertex [m].
std::map<VertexId, Vec3> movesOf(const std::vector<Lip>& lips) {
  std::map<VertexId, Vec3> move;
  for (const Lip& lip : lips) move[lip.a] = move[lip.b] = Vec3::Zero();
  constexpr int kMostPasses = 200;
  bool areApart = false;
  for (int pass = 0; pass < kMostPasses && !areApart; ++pass) {
    areApart = true;
    for (const Lip& lip : lips) {
      const double missing = kLipDistance - lip.n.dot(move[lip.a] - move[lip.b]);
      if (missing <= 0.0) continue;
      move[lip.a] += 0.55 * missing * lip.n;
      move[lip.b] -= 0.55 * missing * lip.n;
      areApart = false;
    }
  }
  for (auto& [v, by] : move) by *= std::min(1.0, kFarthest / std::max(by.norm(), kLipDistance));
  return move;
}

/// The faces that an edit or moves of vertices have changed; some twice.
std::vector<FaceId> changedFaces(const MeshChanges& changes, const TriangleMesh& mesh,
                                 const std::map<VertexId, Vec3>& moves) {
  std::vector<FaceId> faces = changes.changedFaces;
  for (const auto& [v, by] : moves) {
    faces.insert(faces.end(), mesh.facesAround(v).begin(), mesh.facesAround(v).end());
  }
  return faces;
}

}  // namespace

bool partLips(const MeshChanges& changes, const Model& model, LayerContact& layers, State& state) {
  const TriangleMesh& mesh = model.mesh;
  const std::map<VertexId, Vec3> moves = movesOf(listLips(changes, mesh, state.x));
  if (moves.empty()) return true;
  const VertexData<Vec3> before = state.x;
  const std::vector<FaceId> changed = changedFaces(changes, mesh, moves);
  // Less than a tenth would be near what the certificate can resolve.
  for (const double scale : {1.0, 0.1}) {
    for (const auto& [v, by] : moves) state.x[v] = before[v] + scale * by;
    if (layers.findOverlap(model, state.x.values(), changed).pairs.empty()) return true;
  }
  return false;
}

}  // namespace cloth_sim
