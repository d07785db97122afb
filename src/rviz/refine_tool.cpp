#include "refine_tool.h"

#include <ros/service.h>
#include <rviz/display_context.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/int_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/render_panel.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/view_controller.h>
#include <rviz/viewport_mouse_event.h>

#include <pluginlib/class_list_macros.hpp>

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kPeriod{100};  ///< between two calls, at least

const char* const kHint =
    "<b>Hover</b>: Refine the cloth under the pointer. <b>Buttons</b>: Move the camera.";

}  // namespace

RefineTool::RefineTool() { shortcut_key_ = 'r'; }

void RefineTool::onInitialize() {
  setName("Refine");
  service_ = new rviz::StringProperty("Service", "/cloth/refine", "Service that refines the cloth.",
                                      getPropertyContainer());
  radius_ = new rviz::FloatProperty("Radius", 0.03f, "Distance from the pointer up to which [m].",
                                    getPropertyContainer());
  radius_->setMin(0.001f);
  generations_ =
      new rviz::IntProperty("Generations", 3, "Largest number of bisections of an original face.",
                            getPropertyContainer());
  generations_->setMin(1);
  generations_->setMax(12);
}

void RefineTool::activate() { setStatus(kHint); }

int RefineTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  const bool hovers = event.type == QEvent::MouseMove && event.buttons_down == Qt::NoButton;
  if (hovers) {
    refineAt(event);
  } else if (event.panel->getViewController() != nullptr) {
    event.panel->getViewController()->handleMouseEvent(event);
    setStatus(kHint);
  }
  return Render;
}

/// Refines around the nearest thing that is drawn at the pointer. The node refines cloth only:
/// where an obstacle is in front of it, what lies within the radius.
void RefineTool::refineAt(rviz::ViewportMouseEvent& event) {
  const auto now = std::chrono::steady_clock::now();
  Ogre::Vector3 place;
  if (waiting_ || now - sent_ < kPeriod) return;
  if (!context_->getSelectionManager()->get3DPoint(event.viewport, event.x, event.y, place)) return;
  sent_ = now;
  Refine::Request request;
  request.header.frame_id =
      context_->getFixedFrame().toStdString();  // stamp 0: the latest transform
  request.points.resize(1);
  request.points[0].x = place.x;
  request.points[0].y = place.y;
  request.points[0].z = place.z;
  request.radius = radius_->getFloat();
  request.generations = static_cast<std::uint8_t>(generations_->getInt());
  send(request);
}

void RefineTool::send(const Refine::Request& request) {
  waiting_ = true;
  queue_.post([this, request, service = service_->getStdString()] {
    Refine exchange;
    exchange.request = request;
    const bool answered = ros::service::call(service, exchange);
    const std::string text = answered ? exchange.response.message : "no answer from " + service;
    runIn(&receiver_, [this, text] { showReply(QString::fromStdString(text)); });
  });
}

void RefineTool::showReply(const QString& text) {
  waiting_ = false;
  setStatus(text);
}

}  // namespace cloth_sim

PLUGINLIB_EXPORT_CLASS(cloth_sim::RefineTool, rviz::Tool)
