/// \file Texts about phases, for messages and diagnostics.

#include <vector>

#include "cloth_sim/scene/phase_script.h"
#include "support/short_number.h"

namespace cloth_sim {

std::string PhaseConditions::text() const {
  std::vector<std::string> parts;
  if (elapsed) parts.push_back(shortNumber(*elapsed) + " s of it have passed");
  if (meanSpeedBelow) {
    parts.push_back("the mean speed has stayed below " + shortNumber(*meanSpeedBelow) +
                    " m/s for " + shortNumber(meanSpeedFor) + " s");
  }
  if (contact) parts.emplace_back("the cloth has touched an obstacle");
  if (clampsAtTarget) parts.emplace_back("every clamp is at its target");
  if (clampsClosed) parts.emplace_back("the clamps have closed");
  if (piecesAtLeast) {
    parts.push_back("the cloth is in " + std::to_string(*piecesAtLeast) + " pieces");
  }
  if (brokenAtLeast) parts.push_back(std::to_string(*brokenAtLeast) + " springs are broken");
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : " and ") + part;
  return text;
}

std::string PhaseScript::progressText() const {
  if (phases_.empty()) return "the scene has no phases";
  if (status_ == ScriptStatus::kIdle) return "no phase has begun";
  if (status_ == ScriptStatus::kDone) return "all phases have ended";
  if (status_ == ScriptStatus::kFailed) return failureText();
  const PhaseSpec& phase = phases_[index_];
  std::string text = "'" + phase.name + "' (" + std::to_string(index_ + 1) + " of " +
                     std::to_string(phases_.size()) + ") lasts until ";
  if (phase.until.none() && !phase.timeout) return text + "another phase is begun";
  if (!phase.until.none()) text += phase.until.text();
  if (!phase.until.none() && phase.timeout) text += ", or until ";
  if (phase.timeout) text += "t = " + shortNumber(phaseStart_ + *phase.timeout) + " s";
  const bool fails = !phase.until.none() && phase.timeout && phase.onTimeout == OnTimeout::kFail;
  return text + (fails ? ", when the run fails" : "");
}

std::string PhaseScript::failureText() const {
  if (status_ != ScriptStatus::kFailed) return "";
  const PhaseSpec& phase = phases_[index_];
  std::string text = "phase '" + phase.name + "' did not end within its time-out";
  if (phase.timeout) text += " of " + shortNumber(*phase.timeout) + " s";
  return text + "; it lasts until " + phase.until.text();
}

}  // namespace cloth_sim
