#include "publishers.h"

#include <ros/console.h>
#include <ros/this_node.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <utility>

#include "bag_writer.h"
#include "clock_publisher.h"
#include "cloth_sim/ros/surface_messages.h"
#include "compact_frame.h"
#include "thread_name.h"

namespace cloth_sim {
namespace {

using std::chrono::duration;

constexpr double kKeepAlive = 1.0;     ///< longest silence of a topic with subscribers [s]
constexpr double kMinWanted = 10.0;    ///< least rate of observations, for tf and diagnostics [Hz]
constexpr double kReadable = 3.0;      ///< rate of the figures in the text marker [Hz]
constexpr double kSeldom = 1.0;        ///< rate of the figures for diagnostics [Hz]
constexpr double kPatience = 1.5;      ///< longest wait for an observation, in periods
constexpr double kSlowFraction = 0.9;  ///< fraction of the requested pace that warns [-]
constexpr double kRecent = 2.0;        ///< simulated time for which a repeated step warns [s]

MarkerStyle markerStyle(const NodeParameters& parameters) {
  MarkerStyle style;
  style.frame = parameters.worldFrame;
  style.strainRange = parameters.strainRange;
  style.twoSided = parameters.twoSided;
  return style;
}

/// All warnings, as one text.
std::string joinTexts(const std::vector<ResultWarning>& warnings) {
  std::string all;
  for (const ResultWarning& warning : warnings) all += (all.empty() ? "" : "; ") + warning.text;
  return all;
}

/// Reports the worst of what is the matter.
void summarise(const Observation& observation,
               diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const Snapshot& snapshot = *observation.snapshot;
  const double asked = observation.realTimeFactorAsked;
  if (snapshot.failed) {
    status.summary(DiagnosticStatus::ERROR, "failed: " + snapshot.failure);
  } else if (observation.paused) {
    status.summary(DiagnosticStatus::OK, "paused");
  } else if (observation.realTimeFactor < kSlowFraction * asked && observation.stepTime > 0.0) {
    status.summary(DiagnosticStatus::WARN, "slower than the pace asked for");
  } else if (snapshot.guard.redone > 0 && snapshot.time - snapshot.guard.lastRedone < kRecent) {
    status.summary(DiagnosticStatus::WARN, "steps had to be redone with more substeps");
  } else if (snapshot.layers && snapshot.layers->blocked > 0) {
    status.summary(DiagnosticStatus::WARN, "layers of cloth keep held particles from following");
  } else if (!snapshot.warnings.empty()) {
    status.summary(DiagnosticStatus::WARN, joinTexts(snapshot.warnings));
  } else {
    status.summary(DiagnosticStatus::OK, "running");
  }
}

}  // namespace

Publishers::Publishers(ros::NodeHandle& node, ros::NodeHandle& privateNode,
                       const NodeParameters& parameters, const std::string& scene,
                       SimulationThread& simulation, const Trackers& trackers)
    : parameters_(parameters),
      simulation_(simulation),
      trackers_(trackers),
      nodeName_(ros::this_node::getName()),
      obstacleWrenches_(privateNode),
      updater_(node, privateNode, ros::this_node::getName()),
      markersSchedule_(parameters.rateMarkers),
      sceneMarkersSchedule_(parameters.rateMarkers),
      contactsSchedule_(parameters.rateMarkers),
      frameSchedule_(parameters.rateFrame),
      compactFrameSchedule_(parameters.rateFrame),
      transformsSchedule_(parameters.rateState),
      stateSchedule_(parameters.rateState),
      wrenchSchedule_(parameters.rateWrench),
      obstacleWrenchSchedule_(parameters.rateWrench),
      pointsSchedule_(parameters.rateSurface),
      meshSchedule_(parameters.rateSurface),
      cameraSchedule_(trackers.camera.rate()),
      builder_(markerStyle(parameters)),
      sceneBuilder_(markerStyle(parameters)) {
  ros::NodeHandle& own = privateNode;
  markers_ = own.advertise<visualization_msgs::MarkerArray>("markers", 1);
  sceneMarkers_ = own.advertise<visualization_msgs::MarkerArray>("scene_markers", 1);
  topology_ = own.advertise<ClothTopology>("topology", 10, true);
  frame_ = own.advertise<ClothFrame>("frame", 10);
  compactFrame_ = own.advertise<CompactFrame>("compact_frame", 10);
  state_ = own.advertise<ClothState>("state", 10);
  brokenSprings_ = own.advertise<BrokenSprings>("broken_springs", 10, true);
  tearEvents_ = own.advertise<TearEvents>("tear_events", 1000);
  phase_ = own.advertise<std_msgs::String>("phase", 10, true);
  commands_ = own.advertise<ClothCommand>("commands", 1000);
  scene_ = own.advertise<std_msgs::String>("scene", 1, true);
  points_ = own.advertise<sensor_msgs::PointCloud2>("points", 1);
  mesh_ = own.advertise<shape_msgs::Mesh>("mesh", 1);
  contacts_ = own.advertise<ClothContacts>("contacts", 1);
  graspEvents_ = own.advertise<GraspEvent>("grasp_events", 100);
  sceneText_.data = scene;
  updater_.setHardwareID("none");
  updater_.add("simulation", this, &Publishers::diagnose);
  updater_.add("followers", this, &Publishers::diagnoseTrackers);
  sendSceneFrame();
  thread_ = std::thread([this] { run(); });
}

Publishers::~Publishers() {
  stopping_ = true;
  thread_.join();
}

bool Publishers::Schedule::due(Clock::time_point now, std::uint64_t observation,
                               std::uint32_t subscribers) {
  if (rate <= 0.0 || subscribers == 0) {
    lastSubscribers = 0;
    return false;
  }
  const bool news = observation != lastObservation && pace.isDue(now, rate);
  const bool newcomer = subscribers > lastSubscribers;
  const bool silent = duration<double>(now - last).count() >= kKeepAlive;
  if (!news && !newcomer && !silent) return false;
  pace.take(now, rate);
  last = now;
  lastObservation = observation;
  lastSubscribers = subscribers;
  return true;
}

/// Returns the rate of observations for the present subscribers [Hz].
double Publishers::wantedRate() const {
  double rate = std::max(kMinWanted, parameters_.rateState);
  if (frame_.getNumSubscribers() + compactFrame_.getNumSubscribers() > 0) {
    rate = std::max(rate, parameters_.rateFrame);
  }
  if (sceneMarkers_.getNumSubscribers() > 0 || wantContacts()) {
    rate = std::max(rate, parameters_.rateMarkers);
  }
  if (points_.getNumSubscribers() + mesh_.getNumSubscribers() > 0) {
    rate = std::max(rate, parameters_.rateSurface);
  }
  if (trackers_.camera.subscribers() > 0) rate = std::max(rate, trackers_.camera.rate());
  if (trackers_.clamps.wrenchSubscribers() + obstacleWrenches_.subscribers() > 0) {
    rate = std::max(rate, parameters_.rateWrench);
  }
  return rate;
}

/// Returns the rate of observations with figures for the present subscribers [Hz].
double Publishers::wantedFigures() const {
  if (state_.getNumSubscribers() > 0) return std::max(kReadable, parameters_.rateState);
  return markers_.getNumSubscribers() + sceneMarkers_.getNumSubscribers() > 0 ? kReadable : kSeldom;
}

/// Tells whether somebody listens to a topic that shows the contacts between layers.
bool Publishers::wantContacts() const {
  return markers_.getNumSubscribers() + contacts_.getNumSubscribers() > 0;
}

void Publishers::run() {
  nameThisThread("cloth_publish");
  while (!stopping_) {
    const double rate = wantedRate();
    simulation_.setObservationRate(rate);
    simulation_.setFigureRate(wantedFigures());
    simulation_.setContactsWanted(wantContacts());
    tick();
    simulation_.waitForObservation(diagnosed_.number, duration<double>(kPatience / rate));
  }
}

void Publishers::tick() {
  const Observation observation = simulation_.observe();
  header_.stamp = stampOf(*observation.snapshot);
  header_.frame_id = parameters_.worldFrame;
  trackers_.clamps.update(observation);
  if (std::exchange(resetsFollowed_, observation.resets) != observation.resets) trackers_.repeat();
  repeatLatched();
  sendCommands();
  sendTopology(observation);
  sendEvents(observation);
  sendGraspEvents();
  sendPhase(observation);
  const Clock::time_point now = Clock::now();
  const std::uint64_t number = observation.number;
  if (transformsSchedule_.due(now, number, 1)) sendTransforms(*observation.snapshot);
  if (stateSchedule_.due(now, observation.wholeNumber, state_.getNumSubscribers())) {
    sendState(observation);
  }
  if (wrenchSchedule_.due(now, number, trackers_.clamps.wrenchSubscribers())) {
    trackers_.clamps.sendWrenches(*observation.snapshot, header_.stamp, nodeName_);
  }
  obstacleWrenches_.open(*observation.snapshot);
  if (obstacleWrenchSchedule_.due(now, number, obstacleWrenches_.subscribers())) {
    obstacleWrenches_.send(*observation.snapshot, header_.stamp, nodeName_);
  }
  if (frameSchedule_.due(now, number, frame_.getNumSubscribers())) sendFrame(observation);
  if (compactFrameSchedule_.due(now, number, compactFrame_.getNumSubscribers())) {
    sendCompactFrame(observation);
  }
  if (markersSchedule_.due(now, number, markers_.getNumSubscribers())) sendMarkers(observation);
  if (sceneMarkersSchedule_.due(now, number, sceneMarkers_.getNumSubscribers())) {
    sendSceneMarkers(observation);
  }
  sendContacts(observation, now);
  sendSurfaces(observation, now);
  logWarnings(observation.snapshot->warnings);
  diagnosed_ = observation;
  updater_.update();
}

/// Writes each warning about the result to the log once, from start or reset on.
void Publishers::logWarnings(const std::vector<ResultWarning>& warnings) {
  for (const ResultWarning& warning : warningLog_.takeNew(warnings)) {
    ROS_WARN_STREAM(warning.text);
  }
}

/// Returns the stamp of a snapshot: its simulated time if this node publishes /clock, else now.
ros::Time Publishers::stampOf(const Snapshot& snapshot) const {
  if (parameters_.publishClock && ros::Time::isSimTime()) {
    return clockTime(snapshot.time);
  }
  return ros::Time::now();
}

/// Repeats the latched topics, so that each part of a split recording is complete.
void Publishers::repeatLatched() {
  const Clock::time_point now = Clock::now();
  if (repeated_ && duration<double>(now - *repeated_).count() < kRepeatPeriod) return;
  repeated_ = now;
  scene_.publish(sceneText_);
  sentTopology_.reset();
  sentPhase_.reset();
  sentBroken_ = -1;
}

void Publishers::sendCommands() {
  for (const CommandRecord& record : simulation_.takeCommands()) {
    commands_.publish(toCommandMessage(record, header_));
  }
}

void Publishers::sendTopology(const Observation& observation) {
  const std::shared_ptr<const Topology>& topology = observation.snapshot->topology;
  if (topology == sentTopology_) return;
  topology_.publish(toTopologyMessage(*topology, header_));
  sentTopology_ = topology;
}

void Publishers::sendEvents(const Observation& observation) {
  const FailureBatch failures = simulation_.takeEvents();
  if (failures.resets != resetsSeen_) {
    resetsSeen_ = failures.resets;
    failures_.clear();
    failures_.add(failures.before);
    sentBroken_ = -1;
  }
  if (!failures.events.empty()) {
    failures_.add(failures.events);
    tearEvents_.publish(toEventsMessage(failures.events, header_));
  }
  if (observation.resets != failures.resets)
    return;  // its counts belong to the run before the reset
  const BrokenCounts& broken = observation.snapshot->broken;
  if (broken.total == sentBroken_) return;
  sentBroken_ = broken.total;
  brokenSprings_.publish(failures_.toMessage(broken, header_));
}

void Publishers::sendGraspEvents() {
  for (const GripEvent& event : simulation_.takeGripEvents()) {
    graspEvents_.publish(toGraspEventMessage(event, header_));
  }
}

void Publishers::sendPhase(const Observation& observation) {
  const std::string& phase = observation.snapshot->phase;
  if (sentPhase_ == phase) return;
  sentPhase_ = phase;
  std_msgs::String message;
  message.data = phase;
  phase_.publish(message);
}

void Publishers::sendState(const Observation& observation) {
  std_msgs::Header header = header_;
  header.stamp = stampOf(*observation.whole);
  state_.publish(toStateMessage(observation, header));
}

/// Sends the frame of the scene, at the world frame, so that tf knows the world without clamps too.
void Publishers::sendSceneFrame() {
  const std::string frame = sceneFrameId(nodeName_);
  if (frame == parameters_.worldFrame) return;
  staticBroadcaster_.sendTransform(
      toTransform(Pose(), ros::Time::now(), parameters_.worldFrame, frame));
}

/// Sends the frames of clamps and obstacles.
void Publishers::sendTransforms(const Snapshot& snapshot) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  const auto add = [&](const Pose& pose, const std::string& frame) {
    transforms.push_back(toTransform(pose, header_.stamp, parameters_.worldFrame, frame));
  };
  for (const ClampSnapshot& clamp : snapshot.clamps) {
    add(clamp.pose, clampFrameId(nodeName_, clamp.name));
  }
  for (const Obstacle& obstacle : snapshot.obstacles) {
    add(obstacle.pose, obstacleFrameId(nodeName_, obstacle.name));
  }
  // While simulated time stands still, the same stamp again would make every listener warn.
  if (transforms.empty() || header_.stamp == sentTransforms_) return;
  sentTransforms_ = header_.stamp;
  broadcaster_.sendTransform(transforms);
}

void Publishers::sendFrame(const Observation& observation) {
  fillFrame(*observation.snapshot, header_, frameMessage_);
  frame_.publish(frameMessage_);
}

void Publishers::sendCompactFrame(const Observation& observation) {
  fillCompactFrame(*observation.snapshot, header_, compactFrameMessage_);
  compactFrame_.publish(compactFrameMessage_);
}

void Publishers::sendSurfaces(const Observation& observation, Clock::time_point now) {
  const Snapshot& snapshot = *observation.snapshot;
  if (pointsSchedule_.due(now, observation.number, points_.getNumSubscribers())) {
    points_.publish(toPointCloud(snapshot, header_));
  }
  if (meshSchedule_.due(now, observation.number, mesh_.getNumSubscribers())) {
    mesh_.publish(toMeshMessage(snapshot));
  }
  if (cameraSchedule_.due(now, observation.number, trackers_.camera.subscribers())) {
    trackers_.camera.send(snapshot, header_.stamp);
  }
}

void Publishers::sendMarkers(const Observation& observation) {
  markers_.publish(
      builder_.build(*observation.snapshot, *observation.whole->figures, header_.stamp));
}

void Publishers::sendContacts(const Observation& observation, Clock::time_point now) {
  const Snapshot& snapshot = *observation.snapshot;
  // The observations from before someone subscribed lack the points.
  if (snapshot.layers && !snapshot.contactPoints) return;
  if (!contactsSchedule_.due(now, observation.number, contacts_.getNumSubscribers())) return;
  contacts_.publish(toContactsMessage(snapshot, header_));
}

void Publishers::sendSceneMarkers(const Observation& observation) {
  sceneMarkers_.publish(sceneBuilder_.buildSurroundings(
      *observation.snapshot, *observation.whole->figures, header_.stamp));
}

/// Reports the state of all trackers; a lost source is a warning.
void Publishers::diagnoseTrackers(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  std::vector<TrackingStatus> all = trackers_.clamps.statuses();
  for (const TrackingStatus& obstacle : trackers_.obstacles.statuses()) all.push_back(obstacle);
  for (const TrackingStatus& link : trackers_.robot.statuses()) all.push_back(link);
  std::string lost;
  for (const TrackingStatus& it : all) {
    status.add(it.name, std::string(toString(it.state)) + " " + it.source +
                            (it.reason.empty() ? "" : ": " + it.reason));
    if (it.state == TrackingStatus::State::kLost) lost += (lost.empty() ? "" : ", ") + it.name;
  }
  if (!lost.empty()) {
    status.summary(DiagnosticStatus::WARN, "lost what it follows: " + lost);
  } else {
    status.summary(DiagnosticStatus::OK, all.empty() ? "nothing follows" : "following");
  }
}

void Publishers::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const Snapshot& snapshot = *diagnosed_.snapshot;
  const Figures& figures = *diagnosed_.whole->figures;
  summarise(diagnosed_, status);
  status.add("real-time factor", diagnosed_.realTimeFactor);
  status.add("real-time factor asked for", diagnosed_.realTimeFactorAsked);
  status.add("step time [s]", diagnosed_.stepTime);
  status.add("CPU time of steps [s]", diagnosed_.stepCpuTime);
  status.add("simulated time [s]", snapshot.time);
  status.add("max strain", strainOfStretch(figures.maxStretch));
  const double substep = diagnosed_.substep;
  status.add("substep [s]", substep);
  status.add("substep over the limit of explicit methods", substep / snapshot.topology->stableStep);
  if (snapshot.error) {
    status.add("estimated error of strain", snapshot.error->strain);
    status.add("estimated error of positions over the side", snapshot.error->position);
    status.add("error asked for", snapshot.error->asked);
    status.add("budget sufficed", snapshot.error->sufficed);
  }
  if (snapshot.layers) {
    status.add("contacts between layers", snapshot.layers->contacts);
    status.add("share of shortened motions", snapshot.layers->truncatedShare());
    status.add("held particles blocked by layers", snapshot.layers->blocked);
  }
  status.add("phase", snapshot.phase);
  status.add("end of the phase", snapshot.phaseProgress);
  status.add("pieces", figures.pieces.size());
  status.add("broken springs", snapshot.broken.total);
  status.add("dropped commands", diagnosed_.droppedCommands);
  status.add("substeps", snapshot.substeps);
  status.add("substeps in the scene", snapshot.guard.configuredSubsteps);
  status.add("steps redone finer", snapshot.guard.redone);
}

}  // namespace cloth_sim
