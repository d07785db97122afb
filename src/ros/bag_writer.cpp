#include "cloth_sim/ros/bag_writer.h"

#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {
namespace {

constexpr const char* kNodeName = "/cloth";
constexpr const char* kWorldFrame = "world";

/// "Latched" is said in the header of a bag's connection: rosbag play then latches too.
template <typename Message>
boost::shared_ptr<ros::M_string> latchedHeader() {
  auto header = boost::make_shared<ros::M_string>();
  (*header)["type"] = ros::message_traits::DataType<Message>::value();
  (*header)["md5sum"] = ros::message_traits::MD5Sum<Message>::value();
  (*header)["message_definition"] = ros::message_traits::Definition<Message>::value();
  (*header)["callerid"] = kNodeName;
  (*header)["latching"] = "1";
  return header;
}

}  // namespace

struct BagWriter::Impl {
  explicit Impl(const std::string& path) : file(path), active(path + ".active") {
    bag.open(active, rosbag::bagmode::Write);
  }

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    bag.write(kNodeName + ("/" + topic), header.stamp, message);
  }
  template <typename Message>
  void writeLatched(const std::string& topic, const Message& message) {
    bag.write(kNodeName + ("/" + topic), header.stamp, message, latchedHeader<Message>());
  }

  void writeShape(const Snapshot& snapshot);
  void writePhase(const Snapshot& snapshot);
  void writeFailures(const Snapshot& snapshot, const std::vector<FailureEvent>& events);
  void writeClamps(const Snapshot& snapshot);

  std::string file;
  std::string active;
  rosbag::Bag bag;
  std_msgs::Header header;  ///< of everything written in this call
  std::shared_ptr<const Topology> topology;
  bool anyPhase = false;
  std::string phase;
  int broken = -1;  ///< springs; -1: nothing written yet
  FailureLog failures;
  ClothFrame frame;
};

BagWriter::BagWriter(const std::string& file) {
  try {
    impl_ = std::make_unique<Impl>(file);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(file + ": cannot be written (" + error.what() + ")");
  }
}

BagWriter::~BagWriter() = default;

void BagWriter::write(const Observation& observation, const std::vector<FailureEvent>& events) {
  const Snapshot& snapshot = *observation.snapshot;
  try {
    impl_->header.frame_id = kWorldFrame;
    impl_->header.stamp = std::max(ros::Time(snapshot.time), ros::TIME_MIN);
    impl_->writeShape(snapshot);
    impl_->writePhase(snapshot);
    impl_->writeFailures(snapshot, events);
    impl_->writeClamps(snapshot);
    impl_->write("state", toStateMessage(observation, impl_->header));
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(impl_->active + ": cannot be written (" + error.what() + ")");
  }
}

void BagWriter::close() {
  try {
    impl_->bag.close();
    std::filesystem::rename(impl_->active, impl_->file);
  } catch (const std::exception& error) {
    throw std::runtime_error(impl_->file + ": cannot be written (" + error.what() + ")");
  }
}

void BagWriter::Impl::writeShape(const Snapshot& snapshot) {
  if (snapshot.topology != topology) {
    topology = snapshot.topology;
    writeLatched("topology", toTopologyMessage(*topology, header));
  }
  fillFrame(snapshot, header, frame);
  write("frame", frame);
}

void BagWriter::Impl::writePhase(const Snapshot& snapshot) {
  if (anyPhase && snapshot.phase == phase) return;
  anyPhase = true;
  phase = snapshot.phase;
  std_msgs::String message;
  message.data = phase;
  writeLatched("phase", message);
}

void BagWriter::Impl::writeFailures(const Snapshot& snapshot,
                                    const std::vector<FailureEvent>& events) {
  failures.add(events);
  if (!events.empty()) write("tear_events", toEventsMessage(events, header));
  if (snapshot.broken.total == broken) return;
  broken = snapshot.broken.total;
  writeLatched("broken_springs", failures.toMessage(snapshot.broken, header));
}

void BagWriter::Impl::writeClamps(const Snapshot& snapshot) {
  tf2_msgs::TFMessage transforms;
  for (const ClampSnapshot& clamp : snapshot.clamps) {
    const std::string clampFrame = clampFrameId(kNodeName, clamp.name);
    transforms.transforms.push_back(toTransform(clamp, header.stamp, kWorldFrame, clampFrame));
    geometry_msgs::WrenchStamped message;
    message.header.stamp = header.stamp;
    message.header.frame_id = clampFrame;
    message.wrench = clampFrameWrench(clamp);
    write("clamps/" + clamp.name + "/wrench", message);
  }
  if (!transforms.transforms.empty()) bag.write("/tf", header.stamp, transforms);
}

}  // namespace cloth_sim
