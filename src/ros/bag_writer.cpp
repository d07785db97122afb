#include "bag_writer.h"

#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "clock_publisher.h"
#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/markers.h"
#include "compact_frame.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

constexpr const char* kNodeName = "/cloth";
constexpr const char* kWorldFrame = "world";
constexpr OutputRules kOnlyRegular{Links::kFollowed, true};  ///< rosbag seeks in its file

/// Returns a connection header that marks the topic as latched; rosbag play then latches it, too.
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

/// Returns the system's word for an error, or if it has none, that of rosbag.
std::string reason(int code, const std::exception& error) {
  return code == 0 ? error.what() : std::strerror(code);
}

}  // namespace

struct BagWriter::Impl {
  Impl(const std::string& path, std::string text, FrameFormat frames)
      : place(path, kOnlyRegular),
        active(place.target() + ".active"),
        scene(std::move(text)),
        format(frames) {
    // The only file that may stand there is a bag that was not completed.
    [[maybe_unused]] const OutputFile refusesOthers(active, {Links::kRefused, true});
    errno = 0;
    try {
      bag->open(active, rosbag::bagmode::Write);
      if (format == FrameFormat::kCompact) bag->setCompression(rosbag::compression::BZ2);
    } catch (const rosbag::BagException& error) {
      const int code = errno;
      static_cast<void>(bag.release());  // see close()
      unlink(active.c_str());
      throw FileError(path + ": cannot be written (" + reason(code, error) + ")", code);
    }
  }
  ~Impl() {
    try {
      close();
    } catch (const std::exception&) {  // the ".active" file says that it is not whole
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Closes the bag, or abandons it if that fails: on a full disk the destructor of a bag throws,
  /// too, which would end the program, and a second close would close the file twice.
  void close() {
    rosbag::Bag* const last = bag.release();
    if (last == nullptr) return;
    last->close();
    delete last;
  }

  /// Runs `action`. \throws std::runtime_error with the reason if the disk refuses its output.
  template <typename Action>
  void attempt(const Action& action) {
    errno = 0;
    try {
      action();
    } catch (const FileError&) {
      throw;
    } catch (const std::exception& error) {
      const int code = errno;
      throw FileError(active + ": cannot be written (" + reason(code, error) + ")", code);
    }
  }

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    bag->write(kNodeName + ("/" + topic), header.stamp, message);
  }
  template <typename Message>
  void writeLatched(const std::string& topic, const Message& message) {
    bag->write(kNodeName + ("/" + topic), header.stamp, message, latchedHeader<Message>());
  }

  void stamp(double time);
  void repeat(double time);
  void writeText(const std::string& topic, const std::string& text);
  void writeShape(const Snapshot& snapshot);
  void writePhase(const Snapshot& snapshot);
  void writeFailures(const Snapshot& snapshot, const std::vector<FailureEvent>& events);
  void writeWrenches(const Snapshot& snapshot);

  OutputFile place;
  std::string active;  ///< where it grows
  std::string scene;
  FrameFormat format;
  std::optional<double> repeated;  ///< time of the last latched messages [s]
  std::unique_ptr<rosbag::Bag> bag = std::make_unique<rosbag::Bag>();
  std_msgs::Header header;  ///< of all messages of one call
  std::shared_ptr<const Topology> topology;
  bool anyPhase = false;
  std::string phase;
  int broken = -1;  ///< springs; -1: nothing written yet
  FailureLog failures;
  ClothFrame frame;
  CompactFrame compactFrame;
  MarkerBuilder markers{MarkerStyle()};
};

BagWriter::BagWriter(const std::string& file, const std::string& scene, FrameFormat format)
    : impl_(std::make_unique<Impl>(file, scene, format)) {}

BagWriter::~BagWriter() = default;

void BagWriter::write(const Observation& observation, const std::vector<FailureEvent>& events,
                      const std::vector<GripEvent>& grips) {
  impl_->attempt([&] {
    const Snapshot& snapshot = *observation.whole;
    impl_->stamp(snapshot.time);
    impl_->repeat(snapshot.time);
    impl_->writeShape(snapshot);
    impl_->writePhase(snapshot);
    impl_->writeFailures(snapshot, events);
    for (const GripEvent& grip : grips) {
      impl_->write("grasp_events", toGraspEventMessage(grip, impl_->header));
    }
    impl_->writeWrenches(snapshot);
    impl_->write("state", toStateMessage(observation, impl_->header));
    impl_->write("scene_markers", impl_->markers.buildSurroundings(snapshot, *snapshot.figures,
                                                                   impl_->header.stamp));
  });
}

void BagWriter::write(const CommandRecord& command) {
  impl_->attempt([&] {
    impl_->stamp(command.time);
    impl_->write("commands", toCommandMessage(command, impl_->header));
  });
}

void BagWriter::close() {
  impl_->attempt([&] {
    impl_->close();
    impl_->place.take(impl_->active);
  });
}

void BagWriter::Impl::stamp(double time) {
  header.frame_id = kWorldFrame;
  header.stamp = clockTime(time);
}

/// Repeats the latched messages after kRepeatPeriod, or if time has jumped back.
void BagWriter::Impl::repeat(double time) {
  if (repeated && time >= *repeated && time < *repeated + kRepeatPeriod) return;
  repeated = time;
  topology.reset();
  anyPhase = false;
  broken = -1;
  writeText("scene", scene);
}

void BagWriter::Impl::writeText(const std::string& topic, const std::string& text) {
  std_msgs::String message;
  message.data = text;
  writeLatched(topic, message);
}

void BagWriter::Impl::writeShape(const Snapshot& snapshot) {
  if (snapshot.topology != topology) {
    topology = snapshot.topology;
    writeLatched("topology", toTopologyMessage(*topology, header));
  }
  if (format == FrameFormat::kCompact) {
    fillCompactFrame(snapshot, header, compactFrame);
    write("compact_frame", compactFrame);
  } else {
    fillFrame(snapshot, header, frame);
    write("frame", frame);
  }
}

void BagWriter::Impl::writePhase(const Snapshot& snapshot) {
  if (anyPhase && snapshot.phase == phase) return;
  anyPhase = true;
  phase = snapshot.phase;
  writeText("phase", phase);
}

void BagWriter::Impl::writeFailures(const Snapshot& snapshot,
                                    const std::vector<FailureEvent>& events) {
  failures.add(events);
  if (!events.empty()) write("tear_events", toEventsMessage(events, header));
  if (snapshot.broken.total == broken) return;
  broken = snapshot.broken.total;
  writeLatched("broken_springs", failures.toMessage(snapshot.broken, header));
}

void BagWriter::Impl::writeWrenches(const Snapshot& snapshot) {
  tf2_msgs::TFMessage transforms;
  for (const ClampSnapshot& clamp : snapshot.clamps) {
    const std::string clampFrame = clampFrameId(kNodeName, clamp.name);
    transforms.transforms.push_back(toTransform(clamp.pose, header.stamp, kWorldFrame, clampFrame));
    geometry_msgs::WrenchStamped message;
    message.header.stamp = header.stamp;
    message.header.frame_id = clampFrame;
    message.wrench = clampFrameWrench(clamp);
    write("clamps/" + clamp.name + "/wrench", message);
  }
  for (std::size_t k = 0; k < snapshot.obstacles.size(); ++k) {
    const Obstacle& obstacle = snapshot.obstacles[k];
    transforms.transforms.push_back(toTransform(obstacle.pose, header.stamp, kWorldFrame,
                                                obstacleFrameId(kNodeName, obstacle.name)));
    write("obstacles/" + obstacle.name + "/wrench",
          toWrenchMessage(obstacle, snapshot.obstacleWrenches[k], header.stamp, kNodeName));
  }
  if (!transforms.transforms.empty()) bag->write("/tf", header.stamp, transforms);
}

}  // namespace cloth_sim
