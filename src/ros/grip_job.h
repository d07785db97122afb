#pragma once
/// \file The goal of a clamp to close or to open. No ROS in here.

#include "clamp_job.h"

namespace cloth_sim {

/// Closes or opens a clamp as a width says (SetGapWidth). Over when the plates have arrived.
class GripJob : public ClampJob {
 public:
  /// \param width  between the plates [m].
  /// \param force  of the grip from now on [N], > 0; absent: no change.
  GripJob(const std::string& clamp, double width, std::optional<double> force,
          ClampJobListener listener)
      : ClampJob(clamp, Part::kPlates, std::move(listener)), width_(width), force_(force) {}

  Turn begin(const Clamp& clamp, const Simulation& simulation) override;
  Turn proceed(const Clamp& clamp, const Simulation& simulation) override;
  /// Returns nothing: plates that close or open cannot stop between.
  std::optional<Command> hold(const Clamp& /*clamp*/) const override { return std::nullopt; }

 private:
  double width_;
  std::optional<double> force_;
  bool closes_ = false;
};

/// Returns why a width [m] and a force [N] cannot be a goal, where a force of 0 is none; empty if
/// they can.
std::string gripError(double width, double force);

}  // namespace cloth_sim
