#include "pointer_tool.h"

#include <OgreCamera.h>
#include <OgreViewport.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/viewport_mouse_event.h>

namespace cloth_sim {
namespace {

Ogre::Ray rayThrough(const rviz::ViewportMouseEvent& event, int x) {
  const auto across = static_cast<float>(x) / static_cast<float>(event.panel->width());
  const auto down = static_cast<float>(event.y) / static_cast<float>(event.panel->height());
  return event.viewport->getCamera()->getCameraToViewportRay(across, down);
}

}  // namespace

PointerTool::~PointerTool() = default;

void PointerTool::activate() {
  pressed_ = false;
  setStatus(hint());
}

void PointerTool::deactivate() {
  if (pressed_) cancel();
  pressed_ = false;
}

int PointerTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  Pointer pointer;
  pointer.ray = rayThrough(event, event.x);
  pointer.pixel =
      pointer.ray.getPoint(1.0f).distance(rayThrough(event, event.x + 1).getPoint(1.0f));
  pointer.x = event.x;
  pointer.y = event.y;
  if (event.leftDown() && !event.shift()) {
    pressed_ = true;
    begin(pointer);
  } else if (pressed_ && event.rightDown()) {
    pressed_ = false;
    cancel();
  } else if (pressed_ && event.leftUp()) {
    pressed_ = false;
    end(pointer);
  } else if (pressed_ && event.type == QEvent::MouseMove) {
    move(pointer);
  } else if (event.panel->getViewController() != nullptr) {
    event.panel->getViewController()->handleMouseEvent(event);
    setStatus(hint());
  }
  return Render;
}

}  // namespace cloth_sim
