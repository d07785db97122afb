#include "camera_topic.h"

#include <ros/console.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <stdexcept>

namespace cloth_sim {
namespace {

/// Time for which tf may lack the camera without a warning: it needs a moment at the start.
constexpr std::chrono::seconds kCameraPatience{1};

}  // namespace

void fillCameraPoints(const DepthCamera& camera, const std::vector<Face>& faces,
                      const std::vector<float>& strains, sensor_msgs::PointCloud2& cloud) {
  using sensor_msgs::PointField;
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  const CameraLens& lens = camera.lens();
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2Fields(4, "x", 1, PointField::FLOAT32, "y", 1, PointField::FLOAT32, "z", 1,
                                PointField::FLOAT32, "strain", 1, PointField::FLOAT32);
  modifier.resize(camera.seen().size());
  cloud.width = static_cast<std::uint32_t>(lens.width);
  cloud.height = static_cast<std::uint32_t>(lens.height);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_dense = 0;
  sensor_msgs::PointCloud2Iterator<float> out(cloud, "x");
  auto seen = camera.seen().begin();
  for (int row = 0; row < lens.height; ++row) {
    for (int column = 0; column < lens.width; ++column, ++seen, ++out) {
      if (seen->face == kNone) {
        for (int k = 0; k < 4; ++k) out[k] = kNothing;
        continue;
      }
      const Eigen::Vector3f place = (seen->depth * camera.ray(column, row)).cast<float>();
      for (int k = 0; k < 3; ++k) out[k] = place[k];
      out[3] = faceStrain(faces[seen->face], strains);
    }
  }
}

CameraTopic::CameraTopic(ros::NodeHandle& privateNode,
                         const std::optional<CameraSettings>& settings, const WorldFrame& world)
    : settings_(settings), world_(world), camera_(settings ? settings->lens : CameraLens()) {
  if (!settings_) return;
  publisher_ = privateNode.advertise<sensor_msgs::PointCloud2>("camera_points", 1);
}

void CameraTopic::send(const Snapshot& snapshot, const ros::Time& stamp) {
  const std::optional<Pose> pose = findCamera();
  if (!pose) return;
  camera_.look(*pose, snapshot);
  vertexStrains(snapshot.topology->strainLines, snapshot.positions, strains_);
  cloud_.header.frame_id = settings_->frame;
  cloud_.header.stamp = stamp;
  fillCameraPoints(camera_, snapshot.topology->faces, strains_, cloud_);
  publisher_.publish(cloud_);
}

/// Returns the latest pose of the camera, or nothing if tf does not know it.
std::optional<Pose> CameraTopic::findCamera() {
  try {
    const Pose pose = world_.latest(settings_->frame).pose;
    unknownSince_.reset();
    warned_ = false;
    return pose;
  } catch (const std::runtime_error& error) {
    const Clock::time_point now = Clock::now();
    if (!unknownSince_) unknownSince_ = now;
    if (!warned_ && now - *unknownSince_ >= kCameraPatience) {
      warned_ = true;
      ROS_WARN_STREAM("the camera sends no points: " << error.what());
    }
    return std::nullopt;
  }
}

}  // namespace cloth_sim
