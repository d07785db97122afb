#pragma once
/// \file Writes a run as a rosbag, without a node and a master. The header includes no ROS.

#include <memory>
#include <string>
#include <vector>

#include "cloth_sim/ros/observation.h"

namespace cloth_sim {

/// Period after which latched messages are repeated, so that every part of a split bag is complete
/// in itself [s].
constexpr double kRepeatPeriod = 5.0;

/// The form of the frames of a bag.
enum class FrameFormat {
  kFull,    ///< /cloth/frame: float32, not compressed
  kCompact  ///< /cloth/compact_frame: increments of 0.1 mm, and the whole bag compressed
};

/// Writes what the node "/cloth" would publish: /cloth/scene, /cloth/topology (latched, whenever a
/// frame has a new revision, and again every kRepeatPeriod), /cloth/frame or /cloth/compact_frame,
/// /cloth/state, /cloth/commands, /cloth/tear_events, /cloth/grasp_events, /cloth/broken_springs,
/// /cloth/phase, /cloth/scene_markers, /cloth/clamps/<name>/wrench, /cloth/obstacles/<name>/wrench
/// and /tf. Stamps are simulated time; time 0 is stamped 1 ns, since a stamp of 0 means "none" in
/// ROS.
///
/// The bag grows as "<file>.active" and takes its name when it is complete. rosbag seeks in its
/// file, so only a regular file, or nothing, may stand at the name; a link stays, and its target is
/// replaced.
class BagWriter {
 public:
  /// \param scene  text of the scene.
  /// \throws FileError if the file cannot be written.
  BagWriter(const std::string& file, const std::string& scene,
            FrameFormat format = FrameFormat::kFull);
  /// Leaves the ".active" file if `close` was not called.
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Writes an observation.
  /// \param events  springs that failed since the last call, in order.
  /// \param grips   events of grasps since the last call, in order.
  /// \throws FileError if the disk refuses it.
  void write(const Observation& observation, const std::vector<FailureEvent>& events,
             const std::vector<GripEvent>& grips);
  /// Writes a command. \throws FileError if the disk refuses it.
  void write(const CommandRecord& command);

  /// Completes the bag and gives it its name.
  /// \throws FileError
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cloth_sim
