#pragma once
/// \file Frames with 16-bit increments, for bags: half the size, and a sixth after compression.

#include <string>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/CompactFrame.h"
#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// Rounds the positions of a snapshot to whole units: 0.1 mm, or where particles that follow each
/// other are farther apart than 16 bits tell, as much as their distance needs. No position is off
/// by more than half a unit. \param message  keeps its buffers from call to call.
void fillCompactFrame(const Snapshot& snapshot, const std_msgs::Header& header,
                      CompactFrame& message);

/// Makes the frame that a compact one stands for. \return the validation error, after which `frame`
/// has not changed; empty on success.
std::string expandFrame(const CompactFrame& compact, ClothFrame& frame);

}  // namespace cloth_sim
