#pragma once
/// \file rviz tool that cuts the cloth where the mouse is dragged over it.

#include <chrono>
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

/// Draws the stroke while the button is down, and sends it as ~cut_stroke: piece by piece while the
/// button is down, each from the last point of the one before, or whole when it is released. What
/// is drawn has not been sent yet. The blade lies along the line of sight, so that the cloth is cut
/// along the line drawn on the screen.
class CutTool : public PointerTool {
 public:
  CutTool();
  ~CutTool() override;

  void update(float wallDt, float rosDt) override;

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
  void clear();
  bool isPieceDue() const;
  void send();

  CutStroke stroke_;                             ///< what has not been sent
  Pointer last_;                                 ///< of its points
  double length_ = 0.0;                          ///< on the screen [px]
  std::chrono::steady_clock::time_point begun_;  ///< when its first point was added
  std::unique_ptr<rviz::BillboardLine> line_;
  rviz::FloatProperty* reach_ = nullptr;
  rviz::BoolProperty* firstLayerOnly_ = nullptr;
  rviz::BoolProperty* whilePressed_ = nullptr;
};

}  // namespace cloth_sim
