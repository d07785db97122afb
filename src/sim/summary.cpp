#include "cloth_sim/sim/summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/cloth/strain.h"
#include "mesh/quality.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json phasesJson(const PhaseScript& script) {
  Json phases = Json::array();
  for (const PhaseRecord& record : script.history()) {
    phases.push_back({{"name", record.name},
                      {"start_s", number(record.start)},
                      {"end_s", record.end ? number(*record.end) : Json(nullptr)},
                      {"timed_out", record.timedOut}});
  }
  return phases;
}

Json brokenJson(const BrokenCounts& broken) {
  Json json;
  json["total"] = broken.total;
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    json[toString(static_cast<SpringKind>(kind))] = broken.byKind[static_cast<std::size_t>(kind)];
  }
  json["torn"] = broken.torn;
  json["cut"] = broken.cut;
  return json;
}

Json springsJson(const SpringNetwork& springs) {
  Json json;
  json["active"] = springs.count();
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    json[toString(static_cast<SpringKind>(kind))] = springs.count(static_cast<SpringKind>(kind));
  }
  return json;
}

Json piecesJson(const Simulation& simulation) {
  Json pieces = Json::array();
  for (const PieceSnapshot& piece : simulation.describePieces()) {
    const Vec3& centre = piece.centreOfMass;
    pieces.push_back(
        {{"faces", piece.faces},
         {"mass_kg", number(piece.mass)},
         {"rest_area_m2", number(piece.restArea)},
         {"centre_of_mass_m", {number(centre.x()), number(centre.y()), number(centre.z())}}});
  }
  return pieces;
}

/// Returns null while the cloth has not come apart.
Json separationJson(const std::optional<Separation>& separation) {
  if (!separation) return nullptr;
  return {{"time_s", number(separation->time)},
          {"phase", separation->phase},
          {"in_phase_s", number(separation->time - separation->phaseStart)}};
}

Json clampsJson(const RunRecord& record) {
  Json clamps = Json::object();
  for (const PeakForce& peak : record.peaks) {
    clamps[peak.clamp] = {{"peak_force_n", number(peak.force)},
                          {"peak_force_at_s", number(peak.time)}};
  }
  return clamps;
}

double peakForce(const RunRecord& record) {
  double largest = 0.0;
  for (const PeakForce& peak : record.peaks) largest = std::max(largest, peak.force);
  return largest;
}

Json clothsJson(const Model& model) {
  std::vector<double> mass(model.cloths.size(), 0.0);
  for (VertexId v = 0; v < model.particleCount(); ++v) mass[model.clothOf(v)] += model.mass[v];
  Json cloths = Json::array();
  for (std::size_t k = 0; k < model.cloths.size(); ++k) {
    const ClothPart& cloth = model.cloths[k];
    cloths.push_back({{"name", cloth.name},
                      {"fabric", cloth.fabric.name},
                      {"first_particle", cloth.firstVertex},
                      {"particles", cloth.vertices},
                      {"material_offset_m", number(cloth.materialOffset)},
                      {"mass_kg", number(mass[k])}});
  }
  return cloths;
}

std::string statusOf(const Simulation& simulation, bool interrupted) {
  if (simulation.failed()) return "failed";
  return interrupted ? "interrupted" : "done";
}

Json droppedJson(const DroppedScraps& dropped) {
  return {{"count", dropped.count},
          {"mass_kg", number(dropped.mass)},
          {"rest_area_m2", number(dropped.restArea)}};
}

Json guardJson(const Simulation& simulation) {
  const GuardRecord& guard = simulation.guard();
  return {{"substeps", simulation.lastReport().substeps},
          {"configured_substeps", guard.configuredSubsteps},
          {"chosen_substeps", guard.chosenSubsteps},
          {"redone_steps", guard.redone},
          {"finest_redo", guard.finest}};
}

/// Returns null if the method estimates none.
Json errorJson(const std::optional<ErrorEstimate>& error) {
  if (!error) return nullptr;
  return {{"strain", number(error->strain)},
          {"position", number(error->position)},
          {"largest_strain", number(error->largestStrain)},
          {"largest_position", number(error->largestPosition)},
          {"asked", error->asked > 0.0 ? Json(error->asked) : Json(nullptr)},
          {"budget", error->budget > 0 ? Json(error->budget) : Json(nullptr)},
          {"budget_sufficed", error->sufficed}};
}

/// Returns null if layers of cloth do not touch each other.
Json contactJson(const std::optional<LayerReport>& layers) {
  if (!layers) return nullptr;
  return {{"pairs", layers->pairs},
          {"contacts", layers->contacts},
          {"truncated", layers->truncatedShare()},
          {"smallest_distance_m", number(layers->leastDistance)},
          {"blocked", layers->blocked},
          {"detections", layers->detections}};
}

Json energyJson(const Energies& energy) {
  return {{"kinetic", number(energy.kinetic)},
          {"elastic", number(energy.elastic)},
          {"gravity", number(energy.gravity)}};
}

void addScene(const Scene& scene, Json& json) {
  json["scene"] = scene.name;
  json["solver"] = scene.solver.method;
  json["method_params"] = scene.solver.parameters;
  json["method_params"]["dt"] = number(scene.solver.dt);
}

void addCloth(const Simulation& simulation, Json& json) {
  const Model& model = simulation.model();
  json["particles"] = model.particleCount();
  json["faces"] = model.mesh.faceCount();
  json["cloths"] = clothsJson(model);
  json["springs"] = springsJson(model.springs);
  json["broken"] = brokenJson(simulation.broken());
  json["pieces"] = simulation.pieces();
  json["piece_list"] = piecesJson(simulation);
  json["dropped"] = droppedJson(simulation.dropped());
  json["shortest_edge_m"] = number(shortestEdge(model.mesh));
  json["stable_step_s"] = number(stableStep(model));
  json["guard"] = guardJson(simulation);
  json["contact"] = contactJson(simulation.layerReport());
  json["error_estimate"] = errorJson(simulation.lastReport().error);
  json["mass_kg"] = number(totalMass(model));
  json["rest_area_m2"] = number(model.mesh.totalRestArea());
}

Json warningsJson(const Simulation& simulation) {
  Json list = Json::array();
  for (const ResultWarning& warning : simulation.warnings()) list.push_back(warning.text);
  return list;
}

void addRecord(const RunRecord& record, Json& json) {
  json["initial_mass_kg"] = number(record.initialMass);
  json["initial_rest_area_m2"] = number(record.initialRestArea);
  json["separation"] = separationJson(record.separation);
  json["peak_force_n"] = number(peakForce(record));
  json["clamps"] = clampsJson(record);
}

void addTimes(const Simulation& simulation, double wallTime, Json& json) {
  json["sim_time_s"] = number(simulation.time());
  json["asleep_s"] = number(simulation.timeAsleep());
  json["wall_time_s"] = number(wallTime);
  json["real_time_factor"] = number(simulation.time() / wallTime);
}

}  // namespace

std::string summaryJson(const Simulation& simulation, const RunRecord& record, double wallTime,
                        bool interrupted) {
  const Model& model = simulation.model();
  const State& state = simulation.state();
  Json json;
  addScene(simulation.scene(), json);
  json["status"] = statusOf(simulation, interrupted);
  json["failure"] = simulation.failure();
  json["warnings"] = warningsJson(simulation);
  addCloth(simulation, json);
  addRecord(record, json);
  json["phases"] = phasesJson(simulation.script());
  addTimes(simulation, wallTime, json);
  json["max_strain"] = number(strainOfStretch(simulation.maxStretchSeen()));
  json["energy_j"] = energyJson(energies(model, state, simulation.scene().gravity));
  json["state_hash"] = hashText(stateHash(model, state));
  json["finite"] = isFinite(state);
  json["seed"] = simulation.scene().seed;
  return json.dump(2);
}

}  // namespace cloth_sim
