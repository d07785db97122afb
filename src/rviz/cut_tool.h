#pragma once
/// \file rviz tool that cuts the cloth where the mouse is dragged over it.

#include <memory>
#include <vector>

#include "cloth_sim/CutStroke.h"
#include "pointer_tool.h"

namespace rviz {
class BillboardLine;
class BoolProperty;
class FloatProperty;
}  // namespace rviz

namespace cloth_sim {

/// Draws the stroke while the button is down, and sends it as a ~cut_stroke when it is released.
/// The blade lies along the line of sight, so that the cloth is cut along the line drawn on the
/// screen.
class CutTool : public PointerTool {
 public:
  CutTool();
  ~CutTool() override;

 protected:
  void onInitialize() override;
  void begin(const Pointer& at) override;
  void move(const Pointer& to) override;
  void end(const Pointer& at) override;
  void cancel() override;
  QString hint() const override;
  void advertise() override;

 private:
  void add(const Pointer& point);
  void send();

  CutStroke stroke_;
  std::unique_ptr<rviz::BillboardLine> line_;
  int lastX_ = 0;  ///< of the last point of the stroke [px]
  int lastY_ = 0;
  rviz::FloatProperty* reach_ = nullptr;
  rviz::BoolProperty* firstLayerOnly_ = nullptr;
};

}  // namespace cloth_sim
