#include "cloth_sim/clamp/grip_event.h"

#include <algorithm>

namespace cloth_sim {

const char* toString(GripEvent::Kind kind) {
  switch (kind) {
    case GripEvent::Kind::kClosed:
      return "closed";
    case GripEvent::Kind::kSlipping:
      return "slipping";
    case GripEvent::Kind::kHolding:
      return "holding";
    case GripEvent::Kind::kLost:
      return "lost";
    case GripEvent::Kind::kReleased:
      return "released";
    case GripEvent::Kind::kBlocked:
      return "blocked";
    case GripEvent::Kind::kFreed:
      return "freed";
  }
  return "";
}

GripContents gripContents(const Clamp& clamp, const Model& model, const State& state,
                          const ColliderSet& colliders) {
  GripContents contents;
  for (const VertexId v : clamp.held()) {
    ++contents.held;
    contents.area += areaAround(model.mesh, v) / 3.0;
    const auto touches = [&](const Collider& c) { return c.gap(state.x[v], state.t) <= kTouching; };
    const std::vector<Collider>& all = colliders.all();
    if (std::any_of(all.begin(), all.end(), touches)) ++contents.onObstacle;
  }
  return contents;
}

bool isBlocked(const Clamp& clamp, const LayerContact* layers) {
  const std::vector<VertexId>& held = clamp.held();
  return layers != nullptr &&
         std::any_of(held.begin(), held.end(), [&](VertexId v) { return layers->isBlocked(v); });
}

GripWatch::Seen& GripWatch::find(const std::string& clamp) {
  const auto named = [&](const Seen& seen) { return seen.clamp == clamp; };
  const auto found = std::find_if(seen_.begin(), seen_.end(), named);
  if (found != seen_.end()) return *found;
  seen_.emplace_back().clamp = clamp;
  return seen_.back();
}

std::vector<GripEvent::Kind> GripWatch::update(const Clamp& clamp, bool blocked) {
  Seen& before = find(clamp.spec().name);
  std::vector<GripEvent::Kind> kinds;
  const Hold hold = clamp.held().empty() ? Hold::kNothing
                    : blocked            ? Hold::kBlocked
                                         : Hold::kFollows;
  const bool closed = clamp.state() == ClampState::kClosed;
  if (closed && before.state != ClampState::kClosed) kinds.push_back(GripEvent::Kind::kClosed);
  if (clamp.isSlipping() && !before.slipping) kinds.push_back(GripEvent::Kind::kSlipping);
  if (clamp.state() == ClampState::kOpen && before.state != ClampState::kOpen) {
    kinds.push_back(GripEvent::Kind::kReleased);
  } else if (before.hold != Hold::kNothing && hold == Hold::kNothing) {
    kinds.push_back(GripEvent::Kind::kLost);
  } else if (before.slipping && !clamp.isSlipping()) {
    kinds.push_back(GripEvent::Kind::kHolding);
  }
  if (hold == Hold::kBlocked && before.hold != Hold::kBlocked) {
    kinds.push_back(GripEvent::Kind::kBlocked);
  } else if (hold == Hold::kFollows && before.hold == Hold::kBlocked) {
    kinds.push_back(GripEvent::Kind::kFreed);
  }
  before.state = clamp.state();
  before.slipping = clamp.isSlipping();
  before.hold = hold;
  return kinds;
}

void GripWatch::forget(const std::string& clamp) {
  const auto named = [&](const Seen& seen) { return seen.clamp == clamp; };
  seen_.erase(std::remove_if(seen_.begin(), seen_.end(), named), seen_.end());
}

}  // namespace cloth_sim
