#pragma once
/// \file rviz tool that refines the cloth where the mouse hovers over it.

#include <ros/node_handle.h>
#include <rviz/tool.h>

#include <QObject>
#include <chrono>

#include "cloth_sim/Refine.h"
#include "service_queue.h"

namespace rviz {
class FloatProperty;
class IntProperty;
class StringProperty;
}  // namespace rviz

namespace cloth_sim {

/// Calls ~refine for the place under the pointer while no button is down, ten times a second at
/// most. A call waits for the one before it. All buttons and the wheel move the camera.
class RefineTool : public rviz::Tool {
 public:
  RefineTool();

  void activate() override;
  void deactivate() override {}
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 protected:
  void onInitialize() override;

 private:
  void refineAt(rviz::ViewportMouseEvent& event);
  void send(const Refine::Request& request);
  void showReply(const QString& text);

  ros::NodeHandle node_;
  rviz::StringProperty* service_ = nullptr;  ///< owned by rviz, as are the other properties
  rviz::FloatProperty* radius_ = nullptr;
  rviz::IntProperty* generations_ = nullptr;
  std::chrono::steady_clock::time_point sent_;
  bool waiting_ = false;  ///< for a reply
  QObject receiver_;      ///< of replies: they are dropped once the tool is gone
  ServiceQueue queue_;    // last: its thread uses what is above
};

}  // namespace cloth_sim
