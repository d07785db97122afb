#include "viewer.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/param.h>

#include <algorithm>
#include <set>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

/// The edges of all faces, each once.
std::vector<Topology::Link> linksOf(const Topology& topology) {
  std::set<std::pair<VertexId, VertexId>> edges;
  for (const Face& face : topology.faces) {
    for (int k = 0; k < 3; ++k) edges.insert(std::minmax(face[k], face[(k + 1) % 3]));
  }
  std::vector<Topology::Link> links;
  links.reserve(edges.size());
  for (const auto& [a, b] : edges) {
    links.push_back({a, b, (topology.material[b] - topology.material[a]).norm()});
  }
  return links;
}

bool isSound(const ClothTopology& message) {
  const std::size_t vertices = message.uv.size() / 2;
  const auto known = [vertices](std::uint32_t v) { return v < vertices; };
  return message.uv.size() % 2 == 0 && message.triangles.size() % 3 == 0 &&
         message.torn_edges.size() % 2 == 0 &&
         std::all_of(message.triangles.begin(), message.triangles.end(), known) &&
         std::all_of(message.torn_edges.begin(), message.torn_edges.end(), known);
}

ClampSnapshot toClamp(const ClampStatus& message, const Scene& scene) {
  ClampSnapshot clamp;
  clamp.name = message.name;
  clamp.pose = {fromPoint(message.pose.position), fromQuaternion(message.pose.orientation)};
  clamp.gap = message.gap;
  clamp.state = static_cast<ClampState>(message.state);
  clamp.contents.held = static_cast<int>(message.held);
  clamp.plateSize = ClampSpec().plateSize;
  for (const ClampSpec& spec : scene.clamps) {
    if (spec.name == message.name) clamp.plateSize = spec.plateSize;
  }
  return clamp;
}

}  // namespace

std::shared_ptr<const Topology> fromTopologyMessage(const ClothTopology& message) {
  if (!isSound(message)) return nullptr;
  auto topology = std::make_shared<Topology>();
  topology->revision = message.revision;
  for (std::size_t k = 0; k < message.uv.size(); k += 2) {
    topology->material.emplace_back(message.uv[k], message.uv[k + 1]);
  }
  const auto id = [](std::uint32_t v) { return static_cast<VertexId>(v); };
  const auto& t = message.triangles;
  for (std::size_t k = 0; k < t.size(); k += 3) {
    topology->faces.push_back({id(t[k]), id(t[k + 1]), id(t[k + 2])});
  }
  const auto& torn = message.torn_edges;
  for (std::size_t k = 0; k < torn.size(); k += 2) {
    topology->tornEdges.push_back({id(torn[k]), id(torn[k + 1])});
  }
  topology->links = linksOf(*topology);
  return topology;
}

bool fromFrameMessage(const ClothFrame& message, Snapshot& snapshot) {
  const Topology* topology = snapshot.topology.get();
  if (topology == nullptr || topology->revision != message.revision) return false;
  if (message.positions.size() != 3 * topology->material.size()) return false;
  snapshot.time = message.time;
  snapshot.step = message.step;
  snapshot.positions.clear();
  for (std::size_t k = 0; k < message.positions.size(); k += 3) {
    snapshot.positions.emplace_back(message.positions[k], message.positions[k + 1],
                                    message.positions[k + 2]);
  }
  return true;
}

void fromStateMessage(const ClothState& message, const Scene& scene, Snapshot& snapshot) {
  snapshot.phase = message.phase;
  snapshot.particles = static_cast<int>(message.particles);
  snapshot.faces = static_cast<int>(message.faces);
  if (!snapshot.figures) snapshot.figures.emplace();
  snapshot.figures->pieces.resize(message.pieces);
  snapshot.broken.total = static_cast<int>(message.broken.total);
  snapshot.broken.torn = static_cast<int>(message.broken_torn);
  snapshot.broken.cut = static_cast<int>(message.broken_cut);
  snapshot.figures->maxStretch = message.max_strain + 1.0;
  snapshot.failed = message.failed != 0;
  snapshot.clamps.clear();
  for (const ClampStatus& clamp : message.clamps) {
    snapshot.clamps.push_back(toClamp(clamp, scene));
  }
}

Viewer::Viewer(ros::NodeHandle& node, const MarkerStyle& style)
    : builder_(style), markers_(node.advertise<visualization_msgs::MarkerArray>("markers", 1)) {
  // Frames wait for their topology: it comes first, on another connection.
  subscribers_.push_back(node.subscribe("topology", 10, &Viewer::onTopology, this));
  subscribers_.push_back(node.subscribe("frame", 10, &Viewer::onFrame, this));
  subscribers_.push_back(node.subscribe("state", 10, &Viewer::onState, this));
  subscribers_.push_back(node.subscribe("scene", 1, &Viewer::onScene, this));
}

void Viewer::onTopology(const ClothTopology& message) {
  const std::shared_ptr<const Topology> topology = fromTopologyMessage(message);
  if (topology) {
    snapshot_.topology = topology;
  } else {
    ROS_WARN_STREAM("refused a topology that contradicts itself");
  }
}

void Viewer::onFrame(const ClothFrame& message) {
  if (!fromFrameMessage(message, snapshot_)) return;
  for (std::size_t k = 0; k < snapshot_.obstacles.size(); ++k) {
    const Obstacle& start = scene_.obstacles[k];
    snapshot_.obstacles[k].pose.position = start.pose.position + message.time * start.velocity;
  }
  const Figures figures = snapshot_.figures.value_or(Figures{});
  markers_.publish(builder_.build(snapshot_, figures, message.header.stamp));
}

void Viewer::onState(const ClothState& message) { fromStateMessage(message, scene_, snapshot_); }

void Viewer::onScene(const std_msgs::String& message) {
  try {
    scene_ = parseScene(message.data, "scene");
    snapshot_.obstacles = scene_.obstacles;
  } catch (const SceneError& error) {
    ROS_WARN_STREAM("obstacles are not shown: " << error.what());
  }
}

int runViewer(int argc, char** argv) {
  ros::init(argc, argv, "cloth_view");
  ros::NodeHandle node("cloth");
  MarkerStyle style;
  style.frame = ros::param::param<std::string>("~world_frame", style.frame);
  style.strainRange = ros::param::param("~strain_range", style.strainRange);
  style.twoSided = ros::param::param("~two_sided", style.twoSided);
  const Viewer viewer(node, style);
  ros::spin();
  return 0;
}

}  // namespace cloth_sim
