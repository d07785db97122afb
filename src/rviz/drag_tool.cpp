#include "drag_tool.h"

#include <ros/message_traits.h>
#include <rviz/display_context.h>
#include <rviz/properties/ros_topic_property.h>

#include <pluginlib/class_list_macros.hpp>

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kResendPeriod{50};  ///< while the pointer rests

}  // namespace

DragTool::DragTool() { shortcut_key_ = 'd'; }

void DragTool::onInitialize() {
  setName("Drag");
  topic_ = new rviz::RosTopicProperty(
      "Topic", "/cloth/drag", QString::fromStdString(ros::message_traits::datatype<DragRay>()),
      "Topic of the pointer's ray.", getPropertyContainer());
  QObject::connect(topic_, &rviz::Property::changed, this, [this] { advertise(); });
  advertise();
}

void DragTool::advertise() { publisher_ = node_.advertise<DragRay>(topic_->getTopicStd(), 10); }

QString DragTool::hint() const {
  return "<b>Left-Click</b>: Pull the cloth. <b>Shift, other buttons</b>: Move the "
         "camera.";
}

void DragTool::begin(const Pointer& at) { move(at); }

void DragTool::move(const Pointer& to) {
  const Ogre::Vector3& origin = to.ray.getOrigin();
  const Ogre::Vector3& direction = to.ray.getDirection();
  message_.held = true;
  message_.origin.x = origin.x;
  message_.origin.y = origin.y;
  message_.origin.z = origin.z;
  message_.direction.x = direction.x;
  message_.direction.y = direction.y;
  message_.direction.z = direction.z;
  send();
}

void DragTool::end(const Pointer& /*at*/) { cancel(); }

void DragTool::cancel() {
  message_.held = false;
  send();
}

void DragTool::update(float /*wallDt*/, float /*rosDt*/) {
  if (pressed() && std::chrono::steady_clock::now() - sent_ > kResendPeriod) send();
}

void DragTool::send() {
  sent_ = std::chrono::steady_clock::now();
  message_.header.frame_id =
      context_->getFixedFrame().toStdString();  // stamp 0: the latest transform
  publisher_.publish(message_);
}

}  // namespace cloth_sim

PLUGINLIB_EXPORT_CLASS(cloth_sim::DragTool, rviz::Tool)
