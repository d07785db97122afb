#pragma once
/// \file The topic ~camera_points: the cloth as a depth camera sees it.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <sensor_msgs/PointCloud2.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "depth_camera.h"
#include "world_frame.h"

namespace cloth_sim {

/// The parameter ~camera.
struct CameraSettings {
  std::string frame;   ///< tf frame of the camera, an optical one: z forward, x right, y down
  double rate = 10.0;  ///< largest rate of the topic, > 0 [Hz]
  CameraLens lens;
};

/// Fills a point cloud in the order of the pixels, in float32: x, y, z [m] in the frame of the
/// camera, and strain [-] of the face that is seen (see cloth/strain.h); all are NaN where no cloth
/// is. \param strains  of each vertex [-]. \param cloud  its buffer is reused; its header stays.
void fillCameraPoints(const DepthCamera& camera, const std::vector<Face>& faces,
                      const std::vector<float>& strains, sensor_msgs::PointCloud2& cloud);

/// Publishes what the camera sees, from where tf says that it is. Without a camera it advertises
/// nothing.
class CameraTopic {
 public:
  /// \param world  must outlive this.
  CameraTopic(ros::NodeHandle& privateNode, const std::optional<CameraSettings>& settings,
              const WorldFrame& world);

  /// Largest rate of the topic [Hz]; 0: there is no camera.
  double rate() const { return settings_ ? settings_->rate : 0.0; }
  std::uint32_t subscribers() const { return publisher_ ? publisher_.getNumSubscribers() : 0; }
  /// Sends an image; warns once instead if tf has not known the frame of the camera for a second.
  void send(const Snapshot& snapshot, const ros::Time& stamp);

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<Pose> findCamera();

  std::optional<CameraSettings> settings_;
  const WorldFrame& world_;
  DepthCamera camera_;
  ros::Publisher publisher_;
  sensor_msgs::PointCloud2 cloud_;
  std::vector<float> strains_;                     ///< of each vertex [-]
  std::optional<Clock::time_point> unknownSince_;  ///< absent: tf knew the frame at the last image
  bool warned_ = false;                            ///< since then
};

}  // namespace cloth_sim
