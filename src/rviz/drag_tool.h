#pragma once
/// \file rviz tool that pulls a particle of the cloth with the mouse.

#include <chrono>

#include "cloth_sim/DragRay.h"
#include "pointer_tool.h"

namespace cloth_sim {

/// Sends the pointer's ray as ~drag while the button is down, and a release when it comes up.
class DragTool : public PointerTool {
 public:
  DragTool();

  /// Sends the ray again while the pointer rests; the node releases a particle without news.
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
  void send();

  DragRay message_;
  std::chrono::steady_clock::time_point sent_;
};

}  // namespace cloth_sim
