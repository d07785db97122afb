#include "surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "vertex_normals.h"

namespace cloth_sim {
namespace {

using Eigen::Vector3f;
using Map = Eigen::Map<const Vector3f>;

Surface::Packed packed(const std_msgs::ColorRGBA& colour, float factor) {
  const auto byte = [factor](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value * factor, 0.0f, 1.0f)));
  };
  return {byte(colour.r), byte(colour.g), byte(colour.b), 255};
}

bool allBelow(const std::vector<std::uint32_t>& numbers, std::size_t count) {
  return std::all_of(numbers.begin(), numbers.end(),
                     [count](std::uint32_t number) { return number < count; });
}

std::vector<Face> toFaces(const std::vector<std::uint32_t>& triangles) {
  std::vector<Face> faces(triangles.size() / 3);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    faces[k / 3][k % 3] = static_cast<VertexId>(triangles[k]);
  }
  return faces;
}

std::vector<Vec2> toMaterial(const std::vector<float>& uv) {
  std::vector<Vec2> material;
  material.reserve(uv.size() / 2);
  for (std::size_t k = 0; k < uv.size(); k += 2) material.emplace_back(uv[k], uv[k + 1]);
  return material;
}

/// Returns the vertices of the border edges that are not among the torn ones, two an edge.
std::vector<std::uint32_t> without(const std::vector<std::array<VertexId, 2>>& border,
                                   const std::vector<std::uint32_t>& torn) {
  std::set<std::array<std::uint32_t, 2>> excluded;
  for (std::size_t k = 0; k < torn.size(); k += 2) {
    const auto [lower, upper] = std::minmax(torn[k], torn[k + 1]);
    excluded.insert({lower, upper});
  }
  std::vector<std::uint32_t> rest;
  for (const auto& edge : border) {
    const std::array<std::uint32_t, 2> ends{static_cast<std::uint32_t>(edge[0]),
                                            static_cast<std::uint32_t>(edge[1])};
    if (excluded.count(ends) == 0) rest.insert(rest.end(), ends.begin(), ends.end());
  }
  return rest;
}

}  // namespace

std::string Surface::setTopology(const ClothTopology& topology) {
  if (topology.triangles.size() % 3 != 0) return "triangles: not three numbers a face";
  if (topology.torn_edges.size() % 2 != 0) return "torn_edges: not two numbers an edge";
  if (topology.uv.size() % 2 != 0) return "uv: not two numbers a vertex";
  const std::size_t count = topology.uv.size() / 2;
  if (!allBelow(topology.triangles, count)) return "triangles: a vertex that is not there";
  if (!allBelow(topology.torn_edges, count)) return "torn_edges: a vertex that is not there";
  revision_ = topology.revision;
  triangles_ = topology.triangles;
  vertexCount_ = count;
  faces_ = toFaces(triangles_);
  const FaceEdges edges = sortEdges(faces_, count);
  strainLines_ = strainLines(edges, toMaterial(topology.uv));
  torn_.setEdges(topology.torn_edges);
  border_.setEdges(without(borderEdges(edges), topology.torn_edges));
  positions_.clear();
  return "";
}

std::string Surface::setFrame(const ClothFrame& frame, const SurfaceStyle& style) {
  if (frame.revision != revision_) return "a frame of another revision";
  if (frame.positions.size() != 3 * vertexCount()) {
    return "positions: expected " + std::to_string(3 * vertexCount()) + " numbers (got " +
           std::to_string(frame.positions.size()) + ")";
  }
  if (!std::all_of(frame.positions.begin(), frame.positions.end(),
                   [](float x) { return std::isfinite(x); })) {
    return "positions: not finite";
  }
  positions_ = frame.positions;
  vertices_.clear();
  for (std::size_t k = 0; k < positions_.size(); k += 3) {
    vertices_.emplace_back(positions_[k], positions_[k + 1], positions_[k + 2]);
  }
  computeBox();
  vertexNormals(faces_, vertices_, normals_);
  vertexStrains(strainLines_, vertices_, strain_);
  paint(style);
  torn_.update(positions_, normals_, style.tornWidth);
  border_.update(positions_, normals_, style.borderWidth);
  return "";
}

void Surface::computeBox() {
  low_.setConstant(std::numeric_limits<float>::max());
  high_.setConstant(std::numeric_limits<float>::lowest());
  for (std::size_t v = 0; v < vertexCount(); ++v) {
    const Map position(&positions_[3 * v]);
    low_ = low_.cwiseMin(position);
    high_ = high_.cwiseMax(position);
  }
}

void Surface::paint(const SurfaceStyle& style) {
  front_.resize(vertexCount());
  back_.resize(vertexCount());
  const StrainColours colours(style.strainRange);
  for (std::size_t v = 0; v < vertexCount(); ++v) {
    const std_msgs::ColorRGBA& front = style.strain ? colours(strain_[v]) : style.front;
    front_[v] = packed(front, brightness(normals_[v]));
    back_[v] = packed(style.back, brightness(-normals_[v]));
  }
}

}  // namespace cloth_sim
