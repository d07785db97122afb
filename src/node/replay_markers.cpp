/// \file replay_markers: markers of a cloth in a bag, for rviz without the plugin of this package.
/// See replay.launch.

#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/ClothTopology.h"
#include "ros/delete_if_empty.h"
#include "ros/surface.h"

namespace cloth_sim {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

geometry_msgs::Point toPoint(const std::vector<float>& places, std::uint32_t vertex) {
  geometry_msgs::Point point;
  point.x = places[3 * vertex];
  point.y = places[3 * vertex + 1];
  point.z = places[3 * vertex + 2];
  return point;
}

Marker makeMarker(const char* space, const std_msgs::Header& header) {
  Marker marker;
  marker.header = header;
  marker.ns = space;
  marker.type = Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = makeColour(0.90f, 0.05f, 0.25f);
  return marker;
}

Marker clothMarker(const Surface& surface, const std_msgs::Header& header) {
  Marker marker = makeMarker("cloth", header);
  marker.points.reserve(surface.triangles().size());
  marker.colors.reserve(surface.triangles().size());
  for (const std::uint32_t vertex : surface.triangles()) {
    const Surface::Packed& colour = surface.frontColours()[vertex];
    marker.points.push_back(toPoint(surface.positions(), vertex));
    marker.colors.push_back(makeColour(colour[0] / 255.0f, colour[1] / 255.0f, colour[2] / 255.0f));
  }
  deleteIfEmpty(marker);
  return marker;
}

Marker tornMarker(const Surface& surface, const std_msgs::Header& header) {
  Marker marker = makeMarker("torn_edges", header);
  for (const std::uint32_t vertex : surface.torn().triangles()) {
    marker.points.push_back(toPoint(surface.torn().positions(), vertex));
  }
  deleteIfEmpty(marker);
  return marker;
}

/// Draws frames as soon as they come, and passes on the markers of what is around the cloth.
class ReplayMarkers {
 public:
  ReplayMarkers()
      : markers_(node_.advertise<MarkerArray>("markers", 2)),
        topology_(node_.subscribe("topology", 10, &ReplayMarkers::onTopology, this)),
        frames_(node_.subscribe("frame", 1, &ReplayMarkers::onFrame, this)),
        surroundings_(node_.subscribe("scene_markers", 2, &ReplayMarkers::onSurroundings, this)) {}

 private:
  void onTopology(const ClothTopology& topology) { complain(surface_.setTopology(topology)); }

  void onFrame(const ClothFrame& frame) {
    if (markers_.getNumSubscribers() == 0 || !surface_.fits(frame)) return;
    const std::string error = surface_.setFrame(frame, {});
    complain(error);
    if (!error.empty()) return;
    MarkerArray array;
    array.markers = {clothMarker(surface_, frame.header), tornMarker(surface_, frame.header)};
    markers_.publish(array);
  }

  void onSurroundings(const MarkerArray& array) { markers_.publish(array); }

  static void complain(const std::string& error) {
    if (!error.empty()) ROS_WARN_STREAM_THROTTLE(10.0, "not drawn: " << error);
  }

  ros::NodeHandle node_;
  Surface surface_;
  ros::Publisher markers_;
  ros::Subscriber topology_;
  ros::Subscriber frames_;
  ros::Subscriber surroundings_;
};

}  // namespace
}  // namespace cloth_sim

int main(int argc, char** argv) {
  ros::init(argc, argv, "replay_markers");
  const cloth_sim::ReplayMarkers replay;
  ros::spin();
  return 0;
}
