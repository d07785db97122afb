#pragma once
/// \file Camera of rviz that shows the whole scene when it begins.

#include <OgreAxisAlignedBox.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <std_msgs/String.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

namespace Ogre {
class SceneNode;
}
namespace rviz {
class DisplayContext;
}

namespace cloth_sim {

/// Points the camera at the cloth and what is around it, once for each scene that a node starts
/// with; after that the camera is the user's. Its direction stays as it is. Only a camera of
/// the type Orbit is moved.
class SceneFraming {
 public:
  explicit SceneFraming(rviz::DisplayContext& context) : context_(context) {}

  /// Listens to the topics "scene" and "scene_markers" beside the frames of a cloth.
  void subscribe(ros::NodeHandle& node, const std::string& sceneTopic,
                 const std::string& markerTopic);
  void unsubscribe();

  /// Moves the camera if a scene has begun that it has not been moved for.
  /// \param cloth  box around the cloth [m], in the frame of the messages.
  /// \param place  the node of this frame in rviz.
  void update(const Ogre::AxisAlignedBox& cloth, const Ogre::SceneNode& place);

 private:
  void onScene(const std_msgs::String::ConstPtr& scene);
  void onMarkers(const visualization_msgs::MarkerArray::ConstPtr& markers);
  void frame(const Ogre::AxisAlignedBox& box, const Ogre::SceneNode& place);

  rviz::DisplayContext& context_;
  ros::NodeHandle* node_ = nullptr;  ///< of the display
  std::string markerTopic_;
  ros::Subscriber sceneSubscriber_;
  ros::Subscriber markerSubscriber_;  ///< only until the camera has been moved
  visualization_msgs::MarkerArray::ConstPtr markers_;
};

}  // namespace cloth_sim
