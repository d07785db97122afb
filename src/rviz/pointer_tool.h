#pragma once
/// \file Base class of the tools that act on the cloth with the left mouse button.

#include <OgreRay.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <rviz/tool.h>

namespace rviz {
class RosTopicProperty;
}

namespace cloth_sim {

/// Turns presses, moves and releases of the left button into rays. The other buttons, the wheel,
/// and the left button with Shift move the camera as usual.
class PointerTool : public rviz::Tool {
 public:
  ~PointerTool() override;

  void activate() override;
  void deactivate() override;
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 protected:
  /// Position of the pointer.
  struct Pointer {
    Ogre::Ray ray;       ///< from the camera through the pixel, in the fixed frame
    double pixel = 0.0;  ///< width of a pixel at 1 m along the ray [m]
    int x = 0;           ///< [px]
    int y = 0;           ///< [px]
  };

  virtual void begin(const Pointer& at) = 0;
  virtual void move(const Pointer& to) = 0;
  virtual void end(const Pointer& at) = 0;
  /// Abandons the gesture: another tool was chosen, or the right button pressed.
  virtual void cancel() = 0;
  virtual QString hint() const = 0;
  /// Advertises `topic_`, which derived classes create.
  virtual void advertise() = 0;

  bool pressed() const { return pressed_; }

  ros::NodeHandle node_;
  ros::Publisher publisher_;
  rviz::RosTopicProperty* topic_ = nullptr;  ///< owned by rviz

 private:
  bool pressed_ = false;
};

}  // namespace cloth_sim
