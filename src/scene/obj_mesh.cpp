#include "obj_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "mesh/quality.h"
#include "support/input_file.h"

namespace cloth_sim {
namespace {

constexpr std::size_t kMaxVertices = 1100000;
constexpr std::uint64_t kMaxMeshSize = 256 << 20;  // [bytes]

/// A corner of a face: a vertex and a uv of the file, from 0.
struct Corner {
  VertexId vertex = kNone;
  std::int32_t uv = kNone;
};

/// The part of corners that is read.
enum class ObjCorners : std::uint8_t { kWithUv, kVerticesOnly };

/// The text of a file as lists, with line numbers for errors.
class ObjText {
 public:
  ObjText(const std::string& text, std::string path, ObjCorners corners = ObjCorners::kWithUv)
      : path_(std::move(path)), corners_(corners) {
    std::istringstream stream(text);
    std::string line;
    while (std::getline(stream, line)) {
      ++line_;
      readLine(line);
    }
    if (faces.empty()) refuse(0, "expected faces (got none)");
  }

  [[noreturn]] void refuse(int line, const std::string& message) const {
    throw SceneError(path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + message);
  }

  std::vector<Vec3> positions;
  std::vector<int> positionLines;
  std::vector<Vec2> uvs;
  std::vector<std::array<Corner, 3>> faces;
  std::vector<int> faceLines;

 private:
  void readLine(const std::string& line) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      positions.push_back(numbers<3>(words, "v x y z"));
      positionLines.push_back(line_);
      if (positions.size() > kMaxVertices) refuse(line_, "expected at most 1100000 vertices");
    } else if (kind == "vt" && corners_ == ObjCorners::kWithUv) {
      uvs.push_back(numbers<2>(words, "vt u v"));
    } else if (kind == "f") {
      readFace(words);
    }
  }

  template <int kSize>
  Eigen::Matrix<double, kSize, 1> numbers(std::istringstream& words, const char* form) const {
    Eigen::Matrix<double, kSize, 1> result;
    for (int k = 0; k < kSize; ++k) {
      if (!(words >> result[k]) || !std::isfinite(result[k])) {
        refuse(line_, std::string("expected \"") + form + "\" with finite numbers");
      }
    }
    return result;
  }

  void readFace(std::istringstream& words) {
    std::vector<Corner> corners;
    std::string word;
    while (words >> word) corners.push_back(readCorner(word));
    if (corners.size() < 3) refuse(line_, "expected a face of at least three corners");
    for (std::size_t k = 2; k < corners.size(); ++k) {
      faces.push_back({corners[0], corners[k - 1], corners[k]});
      faceLines.push_back(line_);
    }
    if (corners_ == ObjCorners::kVerticesOnly && faces.size() > kMostTriangles) {
      refuse(line_, "expected at most " + std::to_string(kMostTriangles) + " triangles");
    }
  }

  /// Reads "12/7" or "12/7/3". Negative numbers count from the last vertex or uv.
  Corner readCorner(const std::string& word) const {
    std::istringstream parts(word);
    long vertex = 0;
    long uv = 0;
    char slash = 0;
    if (corners_ == ObjCorners::kVerticesOnly) {
      if (!(parts >> vertex) || (parts >> slash && slash != '/')) {
        refuse(line_, "expected corners \"vertex\" or \"vertex/...\" (got \"" + word + "\")");
      }
      return {index(vertex, positions.size(), "vertex"), kNone};
    }
    if (!(parts >> vertex >> slash >> uv) || slash != '/') {
      refuse(line_, "expected corners \"vertex/uv\": material coordinates come from uv (got \"" +
                        word + "\")");
    }
    return {index(vertex, positions.size(), "vertex"), index(uv, uvs.size(), "uv")};
  }

  std::int32_t index(long number, std::size_t count, const char* what) const {
    const long size = static_cast<long>(count);
    const long from = number > 0 ? number - 1 : size + number;
    if (number == 0 || from < 0 || from >= size) {
      refuse(line_, std::string("there is no ") + what + " " + std::to_string(number));
    }
    return static_cast<std::int32_t>(from);
  }

  std::string path_;
  ObjCorners corners_;
  int line_ = 0;
};

double uvArea(const ClothMesh& mesh, const Face& face) {
  return 0.5 * doubleArea(mesh.material[face[0]], mesh.material[face[1]], mesh.material[face[2]]);
}

double spaceArea(const ClothMesh& mesh, const Face& face) {
  const Vec3& a = mesh.positions[face[0]];
  return 0.5 * (mesh.positions[face[1]] - a).cross(mesh.positions[face[2]] - a).norm();
}

/// Copies the faces, and the uv of each vertex, which must be unique.
void takeFaces(const ObjText& text, ClothMesh& mesh) {
  std::vector<std::int32_t> uvOf(text.positions.size(), kNone);
  for (std::size_t f = 0; f < text.faces.size(); ++f) {
    Face face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner& corner = text.faces[f][k];
      face[k] = corner.vertex;
      std::int32_t& uv = uvOf[corner.vertex];
      if (uv != kNone && text.uvs[uv] != text.uvs[corner.uv]) {
        text.refuse(text.faceLines[f], "vertex " + std::to_string(corner.vertex + 1) +
                                           " has two uv: seams are not sewn; give it one, or cut "
                                           "the mesh there");
      }
      uv = corner.uv;
    }
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      text.refuse(text.faceLines[f], "the face has a vertex twice");
    }
    mesh.faces.push_back(face);
  }
  for (std::size_t v = 0; v < uvOf.size(); ++v) {
    if (uvOf[v] == kNone) text.refuse(text.positionLines[v], "the vertex has no face");
    mesh.material.push_back(text.uvs[uvOf[v]]);
  }
}

/// Makes all faces counter-clockwise in uv. A file whose faces are all clockwise is a mirror image.
void orient(const ObjText& text, ClothMesh& mesh) {
  const bool mirrored = uvArea(mesh, mesh.faces[0]) < 0.0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    Face& face = mesh.faces[f];
    if (mirrored) std::swap(face[1], face[2]);
    const double area = uvArea(mesh, face);
    if (area > 0.0) continue;
    text.refuse(text.faceLines[f], area < 0.0
                                       ? "the face is turned the other way in uv than the first one"
                                       : "the face has no area in uv");
  }
}

/// Refuses a directed edge with two faces, and a vertex whose faces are more than one fan.
void checkManifold(const ObjText& text, const ClothMesh& mesh) {
  std::map<std::array<VertexId, 2>, std::size_t> faceOf;  // by directed edge
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = mesh.faces[f][k];
      const VertexId b = mesh.faces[f][(k + 1) % 3];
      const auto [other, isNew] = faceOf.emplace(std::array<VertexId, 2>{a, b}, f);
      if (isNew) continue;
      text.refuse(text.faceLines[f], "the edge from vertex " + std::to_string(a + 1) + " to " +
                                         std::to_string(b + 1) + " is also of the face of line " +
                                         std::to_string(text.faceLines[other->second]) +
                                         ": more than two faces, or one turned round");
    }
  }
  // A vertex with one fan of faces has at most one border edge that starts at it.
  std::vector<bool> leaves(mesh.material.size(), false);
  for (const auto& [edge, f] : faceOf) {
    if (faceOf.count({edge[1], edge[0]}) != 0) continue;
    if (leaves[edge[0]]) {
      text.refuse(text.positionLines[edge[0]], "the vertex joins faces at a single point");
    }
    leaves[edge[0]] = true;
  }
}

/// Converts to metres, and shifts uv to a minimum of 0.
void scale(const ObjText& text, const ObjUnits& units, ClothMesh& mesh) {
  for (const Vec3& position : text.positions) mesh.positions.push_back(units.scale * position);
  double inSpace = 0.0;
  double inUv = 0.0;
  Vec2 least = mesh.material[0];
  for (const Face& face : mesh.faces) {
    inSpace += spaceArea(mesh, face);
    inUv += uvArea(mesh, face);
  }
  for (const Vec2& uv : mesh.material) least = least.cwiseMin(uv);
  if (!(inSpace > 0.0)) text.refuse(0, "the faces have no area");
  const double metres = units.uvScale.value_or(std::sqrt(inSpace / inUv));
  for (Vec2& uv : mesh.material) uv = metres * (uv - least);
}

}  // namespace

ClothMesh parseObj(const std::string& text, const std::string& path, const ObjUnits& units) {
  const ObjText obj(text, path);
  ClothMesh mesh;
  takeFaces(obj, mesh);
  orient(obj, mesh);
  checkManifold(obj, mesh);
  scale(obj, units, mesh);
  try {
    TriangleMesh(mesh.material, mesh.faces);
  } catch (const std::invalid_argument& error) {
    obj.refuse(0, error.what());
  }
  return mesh;
}

Triangles parseObjTriangles(const std::string& text, const std::string& path) {
  ObjText obj(text, path, ObjCorners::kVerticesOnly);
  Triangles result;
  result.vertices = std::move(obj.positions);
  for (const std::array<Corner, 3>& face : obj.faces) {
    result.corners.push_back({face[0].vertex, face[1].vertex, face[2].vertex});
  }
  return result;
}

ClothMesh readObj(const std::string& path, const ObjUnits& units) {
  try {
    return parseObj(readInputFile(path, {kMaxMeshSize, Links::kFollowed}), path, units);
  } catch (const FileError& error) {
    throw SceneError(error.what());
  }
}

}  // namespace cloth_sim
