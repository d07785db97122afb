#include "cloth_sim/mesh/mesh_editor.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Sets a flag.
/// \return whether it was not set before.
bool raise(std::vector<bool>& flags, std::int32_t k) {
  if (flags.size() <= static_cast<std::size_t>(k)) flags.resize(static_cast<std::size_t>(k) + 1);
  if (flags[k]) return false;
  flags[k] = true;
  return true;
}

void lower(std::vector<bool>& flags, const std::vector<std::int32_t>& raised) {
  for (std::int32_t k : raised) flags[k] = false;
}

template <typename T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Returns the index of `v` among the corners of `face`.
int cornerOf(const Face& face, VertexId v) {
  return static_cast<int>(std::find(face.begin(), face.end(), v) - face.begin());
}

// Bit k of a face's boundary bits: see TriangleMesh::isOriginalBoundary.
bool hasBit(std::uint8_t bits, int k) { return ((bits >> k) & 1U) != 0; }
std::uint8_t bitIf(bool set, int k) { return static_cast<std::uint8_t>(set ? 1U << k : 0U); }

}  // namespace

MeshEditor::MeshEditor(TriangleMesh& mesh) : mesh_(mesh) {
  changes_.fromRevision = changes_.toRevision = mesh.revision();
}

bool MeshEditor::splitVertex(VertexId v, const std::vector<FaceId>& detach) {
  if (detach.empty() || detach.size() >= mesh_.facesAround(v).size()) return false;
  const std::vector<VertexId> reached = mesh_.neighbours(v);
  const VertexId copy = copyVertex(v);
  for (FaceId f : detach) replaceCorner(f, v, copy);
  separateFans(v);
  separateFans(copy);
  for (VertexId neighbour : reached) separateFans(neighbour);
  return true;
}

VertexId MeshEditor::splitEdge(VertexId a, VertexId b, double t) {
  VertexEdit edit;
  edit.kind = VertexEdit::Kind::kInsert;
  edit.from = {a, b, kNone};
  edit.weight = {1.0 - t, t, 0.0};
  const std::array<FaceId, 2> on = mesh_.facesOnEdge(a, b);
  const VertexId middle = addVertex(edit);
  for (FaceId f : on) {
    if (f != kNone) halveFace(f, a, b, middle);
  }
  return middle;
}

/// Replaces `f` by its two halves. It keeps its number for the half at the first end of the edge in
/// its own orientation.
void MeshEditor::halveFace(FaceId f, VertexId a, VertexId b, VertexId middle) {
  const Face face = mesh_.faces_[f];
  const std::uint8_t boundaryBits = mesh_.boundaryBits_[f];
  int k = cornerOf(face, a);
  if (face[(k + 1) % 3] != b) k = cornerOf(face, b);
  const VertexId first = face[k];
  const VertexId second = face[(k + 1) % 3];
  const VertexId apex = face[(k + 2) % 3];
  const bool onBoundary = hasBit(boundaryBits, k);
  setFace(f, {first, middle, apex},
          static_cast<std::uint8_t>(bitIf(onBoundary, 0) |
                                    bitIf(hasBit(boundaryBits, (k + 2) % 3), 2)));
  addFace(
      {middle, second, apex},
      static_cast<std::uint8_t>(bitIf(onBoundary, 0) | bitIf(hasBit(boundaryBits, (k + 1) % 3), 1)),
      f);
}

VertexId MeshEditor::splitFace(FaceId f, const std::array<double, 3>& weight) {
  const Face face = mesh_.faces_[f];
  const std::uint8_t boundaryBits = mesh_.boundaryBits_[f];
  VertexEdit edit;
  edit.kind = VertexEdit::Kind::kInsert;
  edit.from = face;
  edit.weight = weight;
  const VertexId middle = addVertex(edit);
  setFace(f, {face[0], face[1], middle}, bitIf(hasBit(boundaryBits, 0), 0));
  addFace({face[1], face[2], middle}, bitIf(hasBit(boundaryBits, 1), 0), f);
  addFace({face[2], face[0], middle}, bitIf(hasBit(boundaryBits, 2), 0), f);
  return middle;
}

void MeshEditor::flipEdge(VertexId a, VertexId b) {
  const auto [f, g] = mesh_.facesOnEdge(a, b);
  // Exchange the ends if necessary, so that f runs from a to b.
  if (mesh_.faces_[f][(cornerOf(mesh_.faces_[f], a) + 1) % 3] != b) std::swap(a, b);
  const Face left = mesh_.faces_[f];
  const Face right = mesh_.faces_[g];
  const int inLeft = cornerOf(left, a);
  const int inRight = cornerOf(right, b);
  const VertexId c = left[(inLeft + 2) % 3];
  const VertexId d = right[(inRight + 2) % 3];
  const std::uint8_t leftBits = mesh_.boundaryBits_[f];
  const std::uint8_t rightBits = mesh_.boundaryBits_[g];
  const std::uint8_t generation = std::max(mesh_.generation_[f], mesh_.generation_[g]);
  setFace(f, {a, d, c},
          static_cast<std::uint8_t>(bitIf(hasBit(rightBits, (inRight + 1) % 3), 0) |
                                    bitIf(hasBit(leftBits, (inLeft + 2) % 3), 2)));
  setFace(g, {d, b, c},
          static_cast<std::uint8_t>(bitIf(hasBit(rightBits, (inRight + 2) % 3), 0) |
                                    bitIf(hasBit(leftBits, (inLeft + 1) % 3), 1)));
  mesh_.generation_[f] = mesh_.generation_[g] = generation;
  // The edge is gone: its ends are touched, though they are in one of the faces still.
  for (VertexId v : {a, b, c, d}) touch(v);
}

void MeshEditor::moveVertex(VertexId v, FaceId f, const std::array<double, 3>& weight) {
  VertexEdit edit;
  edit.kind = VertexEdit::Kind::kMove;
  edit.id = v;
  edit.from = mesh_.faces_[f];
  edit.weight = weight;
  changes_.movedFrom.emplace_back(v, mesh_.material_[v]);
  mesh_.material_[v] = blendMaterial(edit);
  changes_.vertices.push_back(edit);
  for (FaceId around : mesh_.incident_[v]) recordReshaped(around);
}

void MeshEditor::raiseGeneration(FaceId f) {
  if (mesh_.generation_[f] < 255) ++mesh_.generation_[f];
}

void MeshEditor::removeComponents(const std::vector<FaceId>& faces) {
  std::vector<VertexId> vertices;
  for (FaceId f : faces) {
    const Face& face = mesh_.faces_[f];
    vertices.insert(vertices.end(), face.begin(), face.end());
  }
  sortUnique(vertices);
  // From the last one, so that no face or vertex that fills a gap is to be removed itself.
  for (auto f = faces.rbegin(); f != faces.rend(); ++f) removeFace(*f);
  for (auto v = vertices.rbegin(); v != vertices.rend(); ++v) removeVertex(*v);
}

/// Removes a face; the last face takes its place.
void MeshEditor::removeFace(FaceId f) {
  for (VertexId v : mesh_.faces_[f]) unlink(f, v);
  const FaceId last = mesh_.faceCount() - 1;
  if (f != last) {
    for (VertexId v : mesh_.faces_[last]) {
      unlink(last, v);
      link(f, v);
    }
    mesh_.faces_[f] = mesh_.faces_[last];
    mesh_.boundaryBits_[f] = mesh_.boundaryBits_[last];
    mesh_.generation_[f] = mesh_.generation_[last];
  }
  mesh_.faces_.pop_back();
  mesh_.boundaryBits_.pop_back();
  mesh_.generation_.pop_back();
  changes_.removedFaces.push_back(f);
}

/// Removes a vertex without faces; the last vertex takes its place.
void MeshEditor::removeVertex(VertexId v) {
  const VertexId last = mesh_.vertexCount() - 1;
  for (FaceId f : mesh_.incident_[last]) {
    Face& face = mesh_.faces_[f];
    std::replace(face.begin(), face.end(), last, v);
  }
  if (v != last) {
    mesh_.material_[v] = Vec2(mesh_.material_[last]);
  }
  mesh_.material_.pop_back();
  mesh_.incident_.replaceByLast(v);
  VertexEdit edit;
  edit.kind = VertexEdit::Kind::kRemove;
  edit.id = v;
  edit.from = {last, kNone, kNone};
  changes_.vertices.push_back(edit);
}

MeshChanges MeshEditor::finish() {
  lower(isChanged_, changes_.changedFaces);
  lower(isReshaped_, changes_.reshapedFaces);
  lower(isTouched_, changes_.touched);
  std::sort(changes_.changedFaces.begin(), changes_.changedFaces.end());
  std::sort(changes_.reshapedFaces.begin(), changes_.reshapedFaces.end());
  std::sort(changes_.touched.begin(), changes_.touched.end());
  const bool changed = !changes_.vertices.empty() || !changes_.changedFaces.empty();
  if (changed) changes_.toRevision = ++mesh_.revision_;
  MeshChanges done = std::move(changes_);
  changes_ = MeshChanges{};
  changes_.fromRevision = changes_.toRevision = mesh_.revision();
  return done;
}

Vec2 MeshEditor::blendMaterial(const VertexEdit& edit) const {
  Vec2 sum = mesh_.material_[edit.from[0]] * edit.weight[0];
  for (std::size_t k = 1; k < edit.from.size() && edit.from[k] != kNone; ++k) {
    sum += mesh_.material_[edit.from[k]] * edit.weight[k];
  }
  return sum;
}

VertexId MeshEditor::addVertex(const VertexEdit& edit) {
  VertexEdit added = edit;
  added.id = mesh_.vertexCount();
  mesh_.material_.push_back(blendMaterial(edit));
  mesh_.incident_.addList();
  changes_.vertices.push_back(added);
  return added.id;
}

VertexId MeshEditor::copyVertex(VertexId v) {
  VertexEdit edit;
  edit.from = {v, kNone, kNone};
  return addVertex(edit);
}

void MeshEditor::replaceCorner(FaceId f, VertexId from, VertexId to) {
  Face& face = mesh_.faces_[f];
  touch(face);
  touch(to);
  std::replace(face.begin(), face.end(), from, to);
  unlink(f, from);
  link(f, to);
  recordChanged(f);
}

/// Copies a vertex until each copy has a single fan of faces.
void MeshEditor::separateFans(VertexId v) {
  const std::vector<std::vector<FaceId>> fans = fansAround(mesh_, v);
  for (std::size_t k = 1; k < fans.size(); ++k) {
    const VertexId copy = copyVertex(v);
    for (FaceId f : fans[k]) replaceCorner(f, v, copy);
  }
}

FaceId MeshEditor::addFace(const Face& face, std::uint8_t boundaryBits, FaceId parent) {
  const FaceId f = mesh_.faceCount();
  mesh_.faces_.push_back(face);
  mesh_.boundaryBits_.push_back(boundaryBits);
  mesh_.generation_.push_back(std::uint8_t{mesh_.generation_[parent]});
  for (VertexId v : face) link(f, v);
  recordChanged(f);
  recordReshaped(f);
  return f;
}

void MeshEditor::setFace(FaceId f, const Face& face, std::uint8_t boundaryBits) {
  const Face before = mesh_.faces_[f];
  for (VertexId v : before) {
    if (std::find(face.begin(), face.end(), v) == face.end()) unlink(f, v);
  }
  for (VertexId v : face) {
    if (std::find(before.begin(), before.end(), v) == before.end()) link(f, v);
  }
  touch(before);
  mesh_.faces_[f] = face;
  mesh_.boundaryBits_[f] = boundaryBits;
  recordChanged(f);
  recordReshaped(f);
}

void MeshEditor::link(FaceId f, VertexId v) { mesh_.incident_.insertSorted(v, f); }

void MeshEditor::unlink(FaceId f, VertexId v) { mesh_.incident_.erase(v, f); }

void MeshEditor::recordReshaped(FaceId f) {
  touch(mesh_.faces_[f]);
  if (raise(isReshaped_, f)) changes_.reshapedFaces.push_back(f);
}

void MeshEditor::recordChanged(FaceId f) {
  if (raise(isChanged_, f)) changes_.changedFaces.push_back(f);
}

void MeshEditor::touch(const Face& face) {
  for (VertexId v : face) touch(v);
}

void MeshEditor::touch(VertexId v) {
  if (raise(isTouched_, v)) changes_.touched.push_back(v);
}

}  // namespace cloth_sim
