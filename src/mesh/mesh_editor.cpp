#include "cloth_sim/mesh/mesh_editor.h"

#include <algorithm>

namespace cloth_sim {
namespace {

template <typename T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

MeshEditor::MeshEditor(TriangleMesh& mesh) : mesh_(mesh) {
  changes_.fromRevision = changes_.toRevision = mesh.revision();
}

bool MeshEditor::splitVertex(VertexId v, const std::vector<FaceId>& detach) {
  if (detach.empty() || detach.size() >= mesh_.facesAround(v).size()) return false;
  const std::vector<VertexId> reached = mesh_.neighbours(v);
  const VertexId copy = copyVertex(v);
  for (FaceId f : detach) rename(f, v, copy);
  separateFans(v);
  separateFans(copy);
  for (VertexId neighbour : reached) separateFans(neighbour);
  return true;
}

MeshChanges MeshEditor::finish() {
  sortUnique(changes_.changedFaces);
  sortUnique(changes_.touched);
  if (!changes_.newVertices.empty()) changes_.toRevision = ++mesh_.revision_;
  MeshChanges done = std::move(changes_);
  changes_ = MeshChanges{};
  changes_.fromRevision = changes_.toRevision = mesh_.revision();
  return done;
}

VertexId MeshEditor::copyVertex(VertexId v) {
  const VertexId copy = mesh_.vertexCount();
  mesh_.material_.push_back(Vec2(mesh_.material_[v]));
  mesh_.incident_.emplace_back();
  changes_.newVertices.push_back({copy, {v, kNone}, {1.0, 0.0}});
  return copy;
}

void MeshEditor::rename(FaceId f, VertexId from, VertexId to) {
  Face& face = mesh_.faces_[f];
  changes_.touched.insert(changes_.touched.end(), face.begin(), face.end());
  changes_.touched.push_back(to);
  std::replace(face.begin(), face.end(), from, to);
  std::vector<FaceId>& old = mesh_.incident_[from];
  old.erase(std::find(old.begin(), old.end(), f));
  std::vector<FaceId>& now = mesh_.incident_[to];
  now.insert(std::upper_bound(now.begin(), now.end(), f), f);
  changes_.changedFaces.push_back(f);
}

void MeshEditor::separateFans(VertexId v) {
  const std::vector<std::vector<FaceId>> fans = fansAround(mesh_, v);
  for (std::size_t k = 1; k < fans.size(); ++k) {
    const VertexId copy = copyVertex(v);
    for (FaceId f : fans[k]) rename(f, v, copy);
  }
}

}  // namespace cloth_sim
