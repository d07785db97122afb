#pragma once
/// \file Snapshots and figures of the components of a simulation.

#include "cloth_sim/sim/simulation_parts.h"

namespace cloth_sim {

/// Returns the connected pieces of cloth, the largest first.
std::vector<PieceSnapshot> describePieces(const Model& model, const State& state,
                                          const ConnectedComponents& pieces);

/// Returns a copy of everything that others may see.
/// \param parts  measurements in there remember what they measure.
std::shared_ptr<const Snapshot> takeSnapshot(SimulationParts& parts, Detail detail,
                                             ContactDetail contacts);

}  // namespace cloth_sim
