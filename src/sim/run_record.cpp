#include "cloth_sim/sim/run_record.h"

#include <algorithm>

namespace cloth_sim {
namespace {

Separation separationNow(const Simulation& simulation) {
  const std::vector<PhaseRecord>& phases = simulation.script().history();
  if (phases.empty()) return {simulation.time(), "", 0.0};
  return {simulation.time(), phases.back().name, phases.back().start};
}

PeakForce& peakOf(const std::string& clamp, std::vector<PeakForce>& peaks) {
  const auto found = std::find_if(peaks.begin(), peaks.end(),
                                  [&](const PeakForce& peak) { return peak.clamp == clamp; });
  return found != peaks.end() ? *found : peaks.emplace_back(PeakForce{clamp, 0.0, 0.0});
}

}  // namespace

RunRecord startRecord(const Simulation& simulation) {
  RunRecord record;
  record.initialMass = totalMass(simulation.model());
  record.initialRestArea = simulation.model().mesh.totalRestArea();
  record.piecesAtStart = simulation.pieces();
  return record;
}

void observe(const Simulation& simulation, RunRecord& record) {
  if (simulation.pieces() <= record.piecesAtStart) {
    record.separation.reset();  // also after a reset
  } else if (!record.separation) {
    record.separation = separationNow(simulation);
  }
  for (const Clamp& clamp : simulation.clamps()) {
    PeakForce& peak = peakOf(clamp.spec().name, record.peaks);
    const double force = clamp.wrench().force.norm();
    if (force > peak.force) peak = {peak.clamp, force, simulation.time()};
  }
}

}  // namespace cloth_sim
