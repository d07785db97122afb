#include "cloth_sim/scene/phase_script.h"

#include <algorithm>
#include <utility>

namespace cloth_sim {

namespace {

/// Round-off of a sum of many time steps against the time in the scene [s].
constexpr double kTimeTolerance = 1e-9;

bool reached(double time, double limit) { return time >= limit - kTimeTolerance; }

}  // namespace

bool PhaseConditions::none() const {
  return !elapsed && !meanSpeedBelow && !contact && !clampsAtTarget && !clampsClosed &&
         !piecesAtLeast && !brokenAtLeast;
}

PhaseScript::PhaseScript(std::vector<PhaseSpec> phases) : phases_(std::move(phases)) {}

const PhaseSpec* PhaseScript::start(double time) {
  return phases_.empty() ? nullptr : begin(0, time);
}

const PhaseSpec* PhaseScript::update(const PhaseObservation& now) {
  const PhaseSpec* phase = current();
  if (phase == nullptr) return nullptr;
  watch(now);
  const bool waits = !phase->until.none();
  if (waits && conditionsHold(phase->until, now)) {
    finish(now.time, false);
    return beginNext(now.time);
  }
  if (!phase->timeout || !reached(now.time - phaseStart_, *phase->timeout)) return nullptr;
  finish(now.time, waits);
  if (!waits || phase->onTimeout == OnTimeout::kContinue) return beginNext(now.time);
  status_ = ScriptStatus::kFailed;
  return nullptr;
}

const PhaseSpec* PhaseScript::jump(const std::string& name, double time) {
  for (std::size_t k = 0; k < phases_.size(); ++k) {
    if (phases_[k].name != name) continue;
    if (status_ == ScriptStatus::kRunning) finish(time, false);
    return begin(k, time);
  }
  return nullptr;
}

void PhaseScript::shiftTime(double by) {
  phaseStart_ += by;
  if (slowSince_) *slowSince_ += by;
  for (PhaseRecord& record : history_) {
    record.start += by;
    if (record.end) *record.end += by;
  }
}

const PhaseSpec* PhaseScript::current() const {
  return status_ == ScriptStatus::kRunning ? &phases_[index_] : nullptr;
}

bool PhaseScript::wantsMeanSpeed() const {
  const PhaseSpec* phase = current();
  return phase != nullptr && phase->until.meanSpeedBelow.has_value();
}

std::vector<std::string> PhaseScript::names() const {
  std::vector<std::string> names;
  for (const PhaseSpec& phase : phases_) names.push_back(phase.name);
  return names;
}

const PhaseSpec* PhaseScript::begin(std::size_t index, double time) {
  index_ = index;
  status_ = ScriptStatus::kRunning;
  phaseStart_ = time;
  slowSince_.reset();
  touched_ = false;
  PhaseRecord record;
  record.name = phases_[index].name;
  record.start = time;
  history_.push_back(std::move(record));
  return &phases_[index];
}

const PhaseSpec* PhaseScript::beginNext(double time) {
  if (index_ + 1 < phases_.size()) return begin(index_ + 1, time);
  status_ = ScriptStatus::kDone;
  return nullptr;
}

void PhaseScript::finish(double time, bool timedOut) {
  history_.back().end = time;
  history_.back().timedOut = timedOut;
}

void PhaseScript::watch(const PhaseObservation& now) {
  touched_ = touched_ || now.inContact;
  const std::optional<double>& limit = phases_[index_].until.meanSpeedBelow;
  if (!limit || now.meanSpeed >= *limit) {
    slowSince_.reset();
  } else if (!slowSince_) {
    slowSince_ = now.time;
  }
}

bool PhaseScript::conditionsHold(const PhaseConditions& until, const PhaseObservation& now) const {
  if (until.elapsed && !reached(now.time - phaseStart_, *until.elapsed)) return false;
  if (until.meanSpeedBelow && !slowSince_) return false;
  if (until.meanSpeedBelow && !reached(now.time - *slowSince_, until.meanSpeedFor)) return false;
  if (until.contact && !touched_) return false;
  if (until.clampsAtTarget && !now.clampsAtTarget) return false;
  if (until.clampsClosed && !now.clampsClosed) return false;
  if (until.piecesAtLeast && now.pieces < *until.piecesAtLeast) return false;
  return !until.brokenAtLeast || now.broken >= *until.brokenAtLeast;
}

std::string PhaseScript::validationError() const {
  if (status_ < ScriptStatus::kIdle || status_ > ScriptStatus::kFailed) return "it has no status";
  if (status_ == ScriptStatus::kIdle) return "";
  if (index_ >= phases_.size() || history_.empty()) return "it is in a phase that does not exist";
  const std::vector<std::string> known = names();
  for (const PhaseRecord& record : history_) {
    if (std::find(known.begin(), known.end(), record.name) == known.end()) {
      return "it has been in a phase that does not exist";
    }
  }
  return "";
}

}  // namespace cloth_sim
