#include "cloth_sim/ros/markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/shading.h"
#include "delete_if_empty.h"
#include "vertex_normals.h"

namespace cloth_sim {
namespace {

using visualization_msgs::Marker;
using Colour = std_msgs::ColorRGBA;

constexpr double kPlateThickness = 0.006;  ///< of the plates of a clamp [m]
constexpr double kTornWidth = 0.005;       ///< of a torn edge [m]
constexpr double kBoundsWidth = 0.004;     ///< of the lines of bounds [m]
constexpr double kTextHeight = 0.045;      ///< of a capital letter [m]
/// Number of faces from which each face has one colour instead of one for each corner. That makes
/// the message a quarter as large, and the faces are too small for the difference to show.
constexpr std::size_t kManyFaces = 10000;
/// Most triangles of an obstacle that a marker lists. More are read from their file by the viewer.
constexpr std::size_t kMostSentTriangles = 20000;
/// Distance of the sides of an open surface from it, so that neither hides the other [m].
constexpr double kSideOfSheet = 2e-4;
constexpr double kTextClearance = 0.20;  ///< of the text above the cloth [m]

Colour clampColour(ClampState state) {
  switch (state) {
    case ClampState::kClosing:
      return makeColour(1.0f, 0.75f, 0.20f);
    case ClampState::kClosed:
      return makeColour(1.0f, 0.32f, 0.28f);
    case ClampState::kOpen:
      break;
  }
  return makeColour(0.70f, 0.74f, 0.80f);
}

void setScale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

int markerType(DrawnPart::Kind kind) {
  switch (kind) {
    case DrawnPart::Kind::kBox:
      return Marker::CUBE;
    case DrawnPart::Kind::kSphere:
      return Marker::SPHERE;
    case DrawnPart::Kind::kCylinder:
      return Marker::CYLINDER;
    case DrawnPart::Kind::kBoxEdges:
      return Marker::LINE_LIST;
    case DrawnPart::Kind::kTriangles:
      return Marker::TRIANGLE_LIST;
  }
  throw std::invalid_argument("unknown kind of drawn part");
}

Colour toColour(const Rgba& colour) {
  return makeColour(colour.red, colour.green, colour.blue, colour.alpha);
}

/// Replaces `points` by the ends of the twelve edges of a box around the origin.
void addBoxEdges(const Vec3& size, std::vector<geometry_msgs::Point>& points) {
  points.clear();
  for (int from = 0; from < 8; ++from) {
    for (int axis = 0; axis < 3; ++axis) {
      const int to = from | (1 << axis);
      if (to == from) continue;
      for (const int corner : {from, to}) {
        const Vec3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
        points.push_back(toPoint(sign.cwiseProduct(size)));
      }
    }
  }
}

/// Appends a triangle, shifted along its normal.
/// \param shift  [m].
void addTriangle(const std::array<Vec3, 3>& corners, double shift, Marker& marker) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  for (const Vec3& corner : corners) marker.points.push_back(toPoint(corner + shift * normal));
}

/// Sends triangles one by one, or the name of their file if they are many. Those of an open surface
/// are sent for either side, because rviz leaves the back of a triangle black.
void addTriangles(const DrawnPart& part, Marker& marker) {
  const TriangleSurface& surface = *part.surface;
  if (surface.triangles().size() > kMostSentTriangles && !part.resource.empty()) {
    marker.type = Marker::MESH_RESOURCE;
    marker.mesh_resource = part.resource;
    return;
  }
  setScale(marker, 1.0, 1.0, 1.0);
  for (const TriangleSurface::Triangle& triangle : surface.triangles()) {
    const std::vector<Vec3>& at = surface.vertices();
    const std::array<Vec3, 3> corners{at[triangle[0]], at[triangle[1]], at[triangle[2]]};
    addTriangle(corners, surface.isClosed() ? 0.0 : kSideOfSheet, marker);
    if (surface.isClosed()) continue;
    addTriangle({corners[0], corners[2], corners[1]}, kSideOfSheet, marker);
  }
}

}  // namespace

std::string statusLine(const Snapshot& snapshot, const Figures& figures) {
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "%s  t = %.2f s\n%d particles, pieces %d\nbroken %d (torn %d, cut %d)  strain %.2f%s",
      snapshot.phase.empty() ? "no script" : snapshot.phase.c_str(), snapshot.time,
      snapshot.particles, static_cast<int>(figures.pieces.size()), snapshot.broken.total,
      snapshot.broken.torn, snapshot.broken.cut, strainOfStretch(figures.maxStretch),
      snapshot.failed ? "\nFAILED" : "");
  return text.data();
}

MarkerBuilder::MarkerBuilder(MarkerStyle style)
    : style_(std::move(style)),
      frontColours_(style_.strainRange),
      backColours_(style_.strainRange, makeColour(0.86f, 0.74f, 0.62f), 0.7f) {}

const ClothMarkers& MarkerBuilder::build(const Snapshot& snapshot, const Figures& figures,
                                         const ros::Time& stamp) {
  begin(stamp);
  addCloth(snapshot);
  addTornEdges(snapshot);
  if (snapshot.layers) addContacts(snapshot);
  addSurroundings(snapshot, figures);
  markers_.array.markers.resize(used_);
  return markers_;
}

const visualization_msgs::MarkerArray& MarkerBuilder::buildSurroundings(const Snapshot& snapshot,
                                                                        const Figures& figures,
                                                                        const ros::Time& stamp) {
  begin(stamp);
  addSurroundings(snapshot, figures);
  markers_.array.markers.resize(used_);
  return markers_.array;
}

void MarkerBuilder::begin(const ros::Time& stamp) {
  stamp_ = stamp;
  used_ = 0;
}

void MarkerBuilder::addSurroundings(const Snapshot& snapshot, const Figures& figures) {
  for (const Obstacle& obstacle : snapshot.obstacles) addObstacle(obstacle);
  addText(snapshot, figures);
  // Clamps are last, because only they come and go: the markers of removed clamps are deleted.
  for (const ClampSnapshot& clamp : snapshot.clamps) addClamp(clamp);
  mostUsed_ = std::max(mostUsed_, used_);
  while (used_ < mostUsed_) next("clamps", Marker::CUBE).action = Marker::DELETE;
}

/// Returns the next marker of the array, which keeps its buffers from the last call. Only clamps
/// come and go in a scene, so the place in the array serves as the id.
Marker& MarkerBuilder::next(const char* space, int type) {
  std::vector<Marker>& markers = markers_.array.markers;
  if (used_ == markers.size()) markers.emplace_back();
  Marker& marker = markers[used_];
  marker.header.frame_id = style_.frame;
  marker.header.stamp = stamp_;
  marker.ns = space;
  marker.id = static_cast<int>(used_++);
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose = toPoseMessage(Pose());
  setScale(marker, 1.0, 1.0, 1.0);
  marker.color = makeColour(1.0f, 1.0f, 1.0f);
  return marker;
}

void MarkerBuilder::addCloth(const Snapshot& snapshot) {
  const std::vector<Face>& faces = snapshot.topology->faces;
  const bool byFace = faces.size() >= kManyFaces;
  if (!byFace || style_.twoSided) vertexNormals(faces, snapshot.positions, normals_);
  vertexStrains(snapshot.topology->strainLines, snapshot.positions, strains_);
  markers_.topology = snapshot.topology;
  markers_.sides.resize(style_.twoSided ? 2 : 1);
  for (std::size_t k = 0; k < markers_.sides.size(); ++k) {
    MarkerSide& side = markers_.sides[k];
    side.byFace = byFace;
    side.colours.resize(byFace ? faces.size() : snapshot.positions.size());
    placeCorners(snapshot, k == 0, side.corners);
    Marker& marker = next(k == 0 ? "cloth" : "cloth_back", Marker::TRIANGLE_LIST);
    if (faces.empty()) marker.action = Marker::DELETE;
  }
  byFace ? paintFaces(snapshot) : paintVertices();
}

void MarkerBuilder::paintVertices() {
  for (std::size_t v = 0; v < strains_.size(); ++v) paint(v, normals_[v], strains_[v]);
}

void MarkerBuilder::paintFaces(const Snapshot& snapshot) {
  const std::vector<Face>& faces = snapshot.topology->faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Eigen::Vector3f normal = unitNormal(areaNormal(faces[f], snapshot.positions));
    paint(f, normal, faceStrain(faces[f], strains_));
  }
}

/// Sets colour number k of each side.
void MarkerBuilder::paint(std::size_t k, const Eigen::Vector3f& normal, float strain) {
  markers_.sides[0].colours[k] = shaded(frontColours_(strain), brightness(normal));
  if (!style_.twoSided) return;
  markers_.sides[1].colours[k] = shaded(backColours_(strain), brightness(-normal));
}

/// Places the corners at the particles. Of two sides, each is offset along the normals.
void MarkerBuilder::placeCorners(const Snapshot& snapshot, bool front,
                                 std::vector<geometry_msgs::Point>& out) {
  out.resize(snapshot.positions.size());
  const auto offset = static_cast<float>(front ? style_.surfaceOffset : -style_.surfaceOffset);
  for (std::size_t v = 0; v < out.size(); ++v) {
    const Vec3& place = snapshot.positions[v];
    out[v] = toPoint(style_.twoSided ? place + (offset * normals_[v]).cast<double>() : place);
  }
}

void MarkerBuilder::addTornEdges(const Snapshot& snapshot) {
  Marker& marker = next("torn_edges", Marker::LINE_LIST);
  marker.scale.x = kTornWidth;
  marker.color = makeColour(0.90f, 0.05f, 0.25f);
  marker.points.clear();
  for (const auto& edge : snapshot.topology->tornEdges) {
    for (const VertexId v : edge) marker.points.push_back(toPoint(snapshot.positions[v]));
  }
  deleteIfEmpty(marker);
}

/// Draws a line across the layers for each contact, in the colour of its force.
void MarkerBuilder::addContacts(const Snapshot& snapshot) {
  Marker& marker = next("contacts", Marker::LINE_LIST);
  marker.scale.x = kContactWidth;
  marker.points.clear();
  marker.colors.clear();
  if (snapshot.contactPoints) {
    for (const LayerContactPoint& contact : *snapshot.contactPoints) {
      for (const double side : {-kContactReach, kContactReach}) {
        marker.points.push_back(toPoint(contact.place + side * contact.normal));
        marker.colors.push_back(contactColour(contact.force));
      }
    }
  }
  deleteIfEmpty(marker);
}

/// One marker for each primitive of the shape's drawing.
void MarkerBuilder::addObstacle(const Obstacle& obstacle) {
  for (const DrawnPart& part : drawing(obstacle.shape)) {
    const bool lines = part.kind == DrawnPart::Kind::kBoxEdges;
    Marker& marker = next(lines ? "bounds" : "obstacles", markerType(part.kind));
    Pose pose = obstacle.pose;
    pose.position = obstacle.pose.toWorld(part.centre);
    marker.pose = toPoseMessage(pose);
    marker.color = toColour(part.colour);
    marker.points.clear();
    marker.mesh_resource.clear();
    if (lines) {
      marker.scale.x = kBoundsWidth;
      addBoxEdges(part.size, marker.points);
    } else {
      setScale(marker, part.size.x(), part.size.y(), part.size.z());
      if (part.surface) addTriangles(part, marker);
    }
  }
}

/// Draws two plates at their gap, in the colour of the clamp's state.
void MarkerBuilder::addClamp(const ClampSnapshot& clamp) {
  for (const double side : {-1.0, 1.0}) {
    Marker& marker = next("clamps", Marker::CUBE);
    Pose plate = clamp.pose;
    const double height = side * 0.5 * (clamp.gap + kPlateThickness);
    plate.position = clamp.pose.toWorld(Vec3(0.0, 0.0, height));
    marker.pose = toPoseMessage(plate);
    setScale(marker, clamp.plateSize.x(), clamp.plateSize.y(), kPlateThickness);
    marker.color = clampColour(clamp.state);
  }
}

void MarkerBuilder::addText(const Snapshot& snapshot, const Figures& figures) {
  Marker& marker = next("text", Marker::TEXT_VIEW_FACING);
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  if (!snapshot.positions.empty()) low = high = snapshot.positions.front();
  for (const Vec3& position : snapshot.positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  Vec3 place = 0.5 * (low + high);
  place.z() = high.z() + kTextClearance;
  marker.pose.position = toPoint(place);
  marker.scale.z = kTextHeight;
  marker.color =
      snapshot.failed ? makeColour(0.85f, 0.10f, 0.10f) : makeColour(0.12f, 0.14f, 0.18f);
  marker.text = statusLine(snapshot, figures);
}

}  // namespace cloth_sim
