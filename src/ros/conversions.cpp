#include "cloth_sim/ros/conversions.h"

#include <cmath>
#include <limits>

#include "sim/command_text.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

ErrorInfo toErrorInfo(const ErrorEstimate& error) {
  ErrorInfo message;
  message.known = true;
  message.strain = error.strain;
  message.position = error.position;
  message.largest_strain = error.largestStrain;
  message.largest_position = error.largestPosition;
  message.asked = error.asked;
  message.budget_sufficed = error.sufficed;
  return message;
}

ContactInfo toContactInfo(const LayerReport& layers) {
  ContactInfo message;
  message.on = true;
  message.pairs = layers.pairs;
  message.contacts = layers.contacts;
  message.truncated = layers.truncatedShare();
  if (std::isfinite(layers.leastDistance)) message.smallest_distance = layers.leastDistance;
  message.blocked = layers.blocked;
  return message;
}

SpringCounts toCounts(const std::array<int, kSpringKinds>& byKind) {
  SpringCounts counts;
  counts.structural = byKind[static_cast<int>(SpringKind::kStructural)];
  counts.shear = byKind[static_cast<int>(SpringKind::kShear)];
  counts.bend = byKind[static_cast<int>(SpringKind::kBend)];
  counts.total = counts.structural + counts.shear + counts.bend;
  return counts;
}

std::uint8_t toScriptCode(ScriptStatus status) {
  switch (status) {
    case ScriptStatus::kRunning:
      return ClothState::SCRIPT_RUNNING;
    case ScriptStatus::kDone:
      return ClothState::SCRIPT_DONE;
    case ScriptStatus::kFailed:
      return ClothState::SCRIPT_FAILED;
    case ScriptStatus::kIdle:
      break;
  }
  return ClothState::SCRIPT_IDLE;
}

std::uint8_t toStateCode(ClampState state) {
  switch (state) {
    case ClampState::kClosing:
      return ClampStatus::CLOSING;
    case ClampState::kClosed:
      return ClampStatus::CLOSED;
    case ClampState::kOpen:
      break;
  }
  return ClampStatus::OPEN;
}

ClothInfo toClothInfo(const ClothPlace& cloth) {
  ClothInfo info;
  info.name = cloth.name;
  info.first_particle = static_cast<std::uint32_t>(cloth.firstParticle);
  info.particles = static_cast<std::uint32_t>(cloth.particles);
  info.material_offset = cloth.materialOffset;
  return info;
}

PieceInfo toPieceInfo(const PieceSnapshot& piece) {
  PieceInfo info;
  info.faces = piece.faces;
  info.mass = piece.mass;
  info.rest_area = piece.restArea;
  info.centre_of_mass = toPoint(piece.centreOfMass);
  return info;
}

ClampStatus toClampStatus(const ClampSnapshot& clamp) {
  ClampStatus status;
  status.name = clamp.name;
  status.pose = toPoseMessage(clamp.pose);
  status.state = toStateCode(clamp.state);
  status.gap = clamp.gap;
  status.held = clamp.contents.held;
  status.held_area = clamp.contents.area;
  status.held_on_obstacle = clamp.contents.onObstacle;
  status.slipping = clamp.slipping;
  status.blocked = clamp.blocked;
  status.slipped = clamp.slipped;
  status.grip_force = clamp.gripForce.value_or(std::numeric_limits<double>::infinity());
  status.wrench = clampFrameWrench(clamp);
  return status;
}

TearEvent toEvent(const FailureEvent& event) {
  TearEvent message;
  message.time = event.time;
  message.position = toPoint(event.position);
  message.material = {event.material.x(), event.material.y()};
  message.kind = static_cast<std::uint8_t>(event.kind);
  message.cause = event.cause == FailureCause::kCut ? TearEvent::CUT : TearEvent::TORN;
  message.strain = event.stretch - 1.0;
  message.overloaded = event.overloaded;
  return message;
}

static_assert(static_cast<int>(SpringKind::kStructural) == int{TearEvent::STRUCTURAL} &&
                  static_cast<int>(SpringKind::kShear) == int{TearEvent::SHEAR} &&
                  static_cast<int>(SpringKind::kBend) == int{TearEvent::BEND},
              "TearEvent numbers the kinds as the core does");
static_assert(static_cast<int>(GripEvent::Kind::kClosed) == int{GraspEvent::CLOSED} &&
                  static_cast<int>(GripEvent::Kind::kSlipping) == int{GraspEvent::SLIPPING} &&
                  static_cast<int>(GripEvent::Kind::kHolding) == int{GraspEvent::HOLDING} &&
                  static_cast<int>(GripEvent::Kind::kLost) == int{GraspEvent::LOST} &&
                  static_cast<int>(GripEvent::Kind::kReleased) == int{GraspEvent::RELEASED} &&
                  static_cast<int>(GripEvent::Kind::kBlocked) == int{GraspEvent::BLOCKED} &&
                  static_cast<int>(GripEvent::Kind::kFreed) == int{GraspEvent::FREED},
              "GraspEvent numbers the kinds as the core does");

std::string frameBelow(const std::string& scene, const std::string& name) {
  return scene.empty() ? name : scene + "/" + name;
}

/// Converts a wrench in the axes of the world to those of a body.
geometry_msgs::Wrench turnedBack(const Wrench& wrench, const Quat& orientation) {
  const Quat toBody = orientation.conjugate();
  geometry_msgs::Wrench message;
  message.force = toVector(toBody * wrench.force);
  message.torque = toVector(toBody * wrench.torque);
  return message;
}

}  // namespace

geometry_msgs::Vector3 toVector(const Vec3& value) {
  geometry_msgs::Vector3 vector;
  vector.x = value.x();
  vector.y = value.y();
  vector.z = value.z();
  return vector;
}

geometry_msgs::Quaternion toQuaternion(const Quat& value) {
  geometry_msgs::Quaternion quaternion;
  quaternion.x = value.x();
  quaternion.y = value.y();
  quaternion.z = value.z();
  quaternion.w = value.w();
  return quaternion;
}

geometry_msgs::Pose toPoseMessage(const Pose& value) {
  geometry_msgs::Pose pose;
  pose.position = toPoint(value.position);
  pose.orientation = toQuaternion(value.orientation);
  return pose;
}

Vec3 fromPoint(const geometry_msgs::Point& value) { return {value.x, value.y, value.z}; }

Vec3 fromVector(const geometry_msgs::Vector3& value) { return {value.x, value.y, value.z}; }

Quat fromQuaternion(const geometry_msgs::Quaternion& value) {
  return {value.w, value.x, value.y, value.z};
}

geometry_msgs::Wrench clampFrameWrench(const ClampSnapshot& clamp) {
  return clampFrameWrench(clamp, clamp.wrench);
}

geometry_msgs::Wrench clampFrameWrench(const ClampSnapshot& clamp, const Wrench& worldAxes) {
  return turnedBack(worldAxes, clamp.pose.orientation);
}

std::string sceneFrameId(const std::string& nodeName) {
  const std::size_t start = nodeName.find_first_not_of('/');
  return start == std::string::npos ? "" : nodeName.substr(start);
}

std::string clampFrameId(const std::string& nodeName, const std::string& clamp) {
  return frameBelow(sceneFrameId(nodeName), "clamp_" + clamp);
}

std::string obstacleFrameId(const std::string& nodeName, const std::string& obstacle) {
  return frameBelow(sceneFrameId(nodeName), "obstacle_" + obstacle);
}

geometry_msgs::WrenchStamped toWrenchMessage(const Obstacle& obstacle, const Wrench& worldAxes,
                                             const ros::Time& stamp, const std::string& nodeName) {
  geometry_msgs::WrenchStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = obstacleFrameId(nodeName, obstacle.name);
  message.wrench = turnedBack(worldAxes, obstacle.pose.orientation);
  return message;
}

ClothTopology toTopologyMessage(const Topology& topology, const std_msgs::Header& header) {
  ClothTopology message;
  message.header = header;
  message.revision = topology.revision;
  for (const ClothPlace& cloth : topology.cloths) message.cloths.push_back(toClothInfo(cloth));
  message.triangles.reserve(3 * topology.faces.size());
  for (const Face& face : topology.faces) {
    message.triangles.insert(message.triangles.end(), face.begin(), face.end());
  }
  message.uv.reserve(2 * topology.material.size());
  for (const Vec2& uv : topology.material) {
    message.uv.push_back(static_cast<float>(uv.x()));
    message.uv.push_back(static_cast<float>(uv.y()));
  }
  for (const auto& edge : topology.tornEdges) {
    message.torn_edges.insert(message.torn_edges.end(), edge.begin(), edge.end());
  }
  return message;
}

void fillFrame(const Snapshot& snapshot, const std_msgs::Header& header, ClothFrame& message) {
  message.header = header;
  message.revision = snapshot.topology->revision;
  message.step = snapshot.step;
  message.time = snapshot.time;
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  message.positions.resize(3 * snapshot.positions.size());
  if (snapshot.positions.empty()) return;
  const auto count = static_cast<Eigen::Index>(message.positions.size());
  Eigen::Map<Eigen::VectorXf>(message.positions.data(), count) =
      Eigen::Map<const Eigen::VectorXd>(snapshot.positions.front().data(), count).cast<float>();
}

ClothState toStateMessage(const Observation& observation, const std_msgs::Header& header) {
  const Snapshot& snapshot = *observation.whole;
  const Figures& figures = *snapshot.figures;
  ClothState message;
  message.header = header;
  message.step = snapshot.step;
  message.time = snapshot.time;
  message.revision = snapshot.topology->revision;
  message.phase = snapshot.phase;
  message.script = toScriptCode(snapshot.script);
  message.particles = snapshot.particles;
  message.faces = snapshot.faces;
  message.pieces = static_cast<std::uint32_t>(figures.pieces.size());
  for (const PieceSnapshot& piece : figures.pieces) message.piece.push_back(toPieceInfo(piece));
  message.dropped_pieces = snapshot.dropped.count;
  message.dropped_mass = snapshot.dropped.mass;
  message.dropped_area = snapshot.dropped.restArea;
  message.springs = toCounts(snapshot.springs);
  message.broken = toCounts(snapshot.broken.byKind);
  message.broken_torn = snapshot.broken.torn;
  message.broken_cut = snapshot.broken.cut;
  message.mass = figures.mass;
  message.rest_area = figures.restArea;
  message.shortest_edge = snapshot.topology->shortestEdge;
  message.stable_step = snapshot.topology->stableStep;
  message.kinetic_energy = figures.energies.kinetic;
  message.elastic_energy = figures.energies.elastic;
  message.gravity_energy = figures.energies.gravity;
  message.mean_speed = figures.meanSpeed;
  message.max_strain = strainOfStretch(figures.maxStretch);
  if (snapshot.error) message.error_estimate = toErrorInfo(*snapshot.error);
  if (snapshot.layers) message.contact = toContactInfo(*snapshot.layers);
  message.state_hash = hashText(figures.hash);
  message.paused = observation.paused;
  message.failed = snapshot.failed;
  message.failure = snapshot.failure;
  for (const ResultWarning& warning : snapshot.warnings) message.warnings.push_back(warning.text);
  message.real_time_factor = observation.realTimeFactor;
  message.step_time = observation.stepTime;
  for (const ClampSnapshot& clamp : snapshot.clamps) {
    message.clamps.push_back(toClampStatus(clamp));
  }
  return message;
}

ClothContacts toContactsMessage(const Snapshot& snapshot, const std_msgs::Header& header) {
  ClothContacts message;
  message.header = header;
  message.time = snapshot.time;
  if (!snapshot.contactPoints) return message;
  for (const LayerContactPoint& contact : *snapshot.contactPoints) {
    for (int axis = 0; axis < 3; ++axis) {
      message.positions.push_back(static_cast<float>(contact.place[axis]));
      message.normals.push_back(static_cast<float>(contact.normal[axis]));
    }
    message.forces.push_back(static_cast<float>(contact.force));
  }
  return message;
}

ClothCommand toCommandMessage(const CommandRecord& record, const std_msgs::Header& header) {
  ClothCommand message;
  message.header = header;
  message.number = record.number;
  message.step = record.step;
  message.time = record.time;
  message.kind = commandKind(record.command);
  message.text = describeCommand(record.command);
  const std::string data = packCommand(record.command);
  message.data.assign(data.begin(), data.end());
  return message;
}

PhaseInfo toPhaseInfo(const PhaseRecord& record) {
  PhaseInfo info;
  info.name = record.name;
  info.start = record.start;
  info.end = record.end.value_or(std::numeric_limits<double>::quiet_NaN());
  info.timed_out = record.timedOut;
  return info;
}

GraspEvent toGraspEventMessage(const GripEvent& event, const std_msgs::Header& header) {
  GraspEvent message;
  message.header = header;
  message.time = event.time;
  message.clamp = event.clamp;
  message.kind = static_cast<std::uint8_t>(event.kind);
  message.held = event.contents.held;
  message.held_area = event.contents.area;
  message.held_on_obstacle = event.contents.onObstacle;
  message.force = toVector(event.force);
  message.slipped = event.slipped;
  return message;
}

TearEvents toEventsMessage(const std::vector<FailureEvent>& events,
                           const std_msgs::Header& header) {
  TearEvents message;
  message.header = header;
  message.events.reserve(events.size());
  for (const FailureEvent& event : events) message.events.push_back(toEvent(event));
  return message;
}

geometry_msgs::TransformStamped toTransform(const Pose& pose, const ros::Time& stamp,
                                            const std::string& world, const std::string& frame) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = world;
  transform.child_frame_id = frame;
  transform.transform.translation = toVector(pose.position);
  transform.transform.rotation = toQuaternion(pose.orientation);
  return transform;
}

void FailureLog::add(const std::vector<FailureEvent>& events) {
  for (const FailureEvent& event : events) {
    for (int axis = 0; axis < 3; ++axis) {
      positions_.push_back(static_cast<float>(event.position[axis]));
    }
  }
}

BrokenSprings FailureLog::toMessage(const BrokenCounts& counts,
                                    const std_msgs::Header& header) const {
  BrokenSprings message;
  message.header = header;
  message.counts = toCounts(counts.byKind);
  message.torn = counts.torn;
  message.cut = counts.cut;
  message.positions = positions_;
  return message;
}

}  // namespace cloth_sim
