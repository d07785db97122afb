#include "scene_framing.h"

#include <OgreCamera.h>
#include <OgreSceneNode.h>
#include <OgreVector3.h>
#include <rviz/display_context.h>
#include <rviz/properties/property.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace cloth_sim {
namespace {

using Box = Ogre::AxisAlignedBox;
using visualization_msgs::Marker;

constexpr int kCorners = 8;       ///< of a box
constexpr float kAround = 0.6f;   ///< part of the surroundings that is shown, over the cloth's size
constexpr float kBeneath = 0.1f;  ///< the same of a floor
constexpr float kBelow = 1.5f;    ///< the same below the cloth, where it falls
constexpr float kMargin = 1.1f;   ///< distance of the camera over the least that shows everything

Ogre::Vector3 toVector(const geometry_msgs::Point& point) {
  return {static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z)};
}

Ogre::Vector3 cornerOf(const Box& box, int k) {
  return {(k & 1) != 0 ? box.getMaximum().x : box.getMinimum().x,
          (k & 2) != 0 ? box.getMaximum().y : box.getMinimum().y,
          (k & 4) != 0 ? box.getMaximum().z : box.getMinimum().z};
}

/// Returns the box around a marker in its frame; a null box for types without a size of their own.
Box boxAround(const Marker& marker) {
  Box box;
  if (marker.type == Marker::CUBE || marker.type == Marker::SPHERE ||
      marker.type == Marker::CYLINDER) {
    const Ogre::Vector3 half(static_cast<float>(0.5 * marker.scale.x),
                             static_cast<float>(0.5 * marker.scale.y),
                             static_cast<float>(0.5 * marker.scale.z));
    box.setExtents(-half, half);
  }
  for (const geometry_msgs::Point& point : marker.points) box.merge(toVector(point));
  const auto& turn = marker.pose.orientation;
  const Ogre::Quaternion orientation(static_cast<float>(turn.w), static_cast<float>(turn.x),
                                     static_cast<float>(turn.y), static_cast<float>(turn.z));
  Box placed;
  for (int k = 0; k < kCorners && box.isFinite(); ++k) {
    placed.merge(toVector(marker.pose.position) + orientation * cornerOf(box, k));
  }
  return placed;
}

/// Returns the box of the cloth with what is around it, and below it.
/// \param around  over the size of the cloth.
Box grown(const Box& cloth, float around) {
  const float size = cloth.getSize().length();
  return {cloth.getMinimum() - Ogre::Vector3(around, around, kBelow) * size,
          cloth.getMaximum() + Ogre::Vector3(around * size)};
}

/// Adds to the box of the cloth what is near it and below it; of a floor only what is beneath.
Box withSurroundings(const Box& cloth, const visualization_msgs::MarkerArray& markers) {
  const Box near = grown(cloth, kAround);
  const Box beneath = grown(cloth, kBeneath);
  const auto isFloor = [&](const Box& box) {
    return box.getSize().x > near.getSize().x && box.getSize().y > near.getSize().y;
  };
  Box all = cloth;
  for (const Marker& marker : markers.markers) {
    if (marker.action != Marker::ADD || (marker.ns != "obstacles" && marker.ns != "clamps"))
      continue;
    const Box box = boxAround(marker);
    all.merge(box.intersection(!box.isNull() && isFloor(box) ? beneath : near));
  }
  return all;
}

/// Least distance from a focal point at which a camera shows a point.
/// \param point  relative to the focal point, with the axes of the camera: right, up, backwards
/// [m].
float distanceToShow(const Ogre::Vector3& point, const Ogre::Camera& camera) {
  const float up = std::tan(0.5f * camera.getFOVy().valueRadians());
  const float right = up * camera.getAspectRatio();
  return point.z + std::max(std::abs(point.x) / right, std::abs(point.y) / up);
}

}  // namespace

void SceneFraming::subscribe(ros::NodeHandle& node, const std::string& sceneTopic,
                             const std::string& markerTopic) {
  node_ = &node;
  markerTopic_ = markerTopic;
  sceneSubscriber_ = node.subscribe(sceneTopic, 1, &SceneFraming::onScene, this);
}

void SceneFraming::unsubscribe() {
  sceneSubscriber_.shutdown();
  markerSubscriber_.shutdown();
  markers_.reset();
}

void SceneFraming::onScene(const std_msgs::String::ConstPtr& /*scene*/) {
  markerSubscriber_ = node_->subscribe(markerTopic_, 1, &SceneFraming::onMarkers, this);
}

void SceneFraming::onMarkers(const visualization_msgs::MarkerArray::ConstPtr& markers) {
  markers_ = markers;
  markerSubscriber_.shutdown();
}

void SceneFraming::update(const Box& cloth, const Ogre::SceneNode& place) {
  if (!markers_) return;
  frame(withSurroundings(cloth, *markers_), place);
  markers_.reset();
}

void SceneFraming::frame(const Box& box, const Ogre::SceneNode& place) {
  rviz::ViewController* view = context_.getViewManager()->getCurrent();
  if (view == nullptr || view->getClassId() != "rviz/Orbit") return;
  rviz::Property* focus = view->subProp("Focal Point");
  const Ogre::Camera& camera = *view->getCamera();
  const Ogre::Quaternion toCamera = camera.getDerivedOrientation().Inverse();
  const Ogre::Quaternion& turn = place._getDerivedOrientation();
  float distance = 0.0f;
  for (int k = 0; k < kCorners; ++k) {
    const Ogre::Vector3 arm = cornerOf(box, k) - box.getCenter();
    distance = std::max(distance, distanceToShow(toCamera * (turn * arm), camera));
  }
  const Ogre::Vector3 centre = place._getDerivedPosition() + turn * box.getCenter();
  focus->subProp("X")->setValue(centre.x);
  focus->subProp("Y")->setValue(centre.y);
  focus->subProp("Z")->setValue(centre.z);
  view->subProp("Distance")->setValue(kMargin * distance);
}

}  // namespace cloth_sim
