#include "cloth_sim/sim/holders.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "clamp/find_clamp.h"

namespace cloth_sim {
namespace {

const KinematicTarget* findPin(const std::vector<KinematicTarget>& pins, VertexId v) {
  const auto pin = std::lower_bound(
      pins.begin(), pins.end(), v,
      [](const KinematicTarget& target, VertexId vertex) { return target.vertex < vertex; });
  return pin != pins.end() && pin->vertex == v ? &*pin : nullptr;
}

/// Pins a new particle if all particles that it was made from are pinned: a copy stays where the
/// original is, a particle between pinned ones stays between them.
void pinNew(const VertexEdit& edit, std::vector<KinematicTarget>& pins) {
  KinematicTarget blend;
  blend.vertex = edit.id;
  for (std::size_t k = 0; k < edit.from.size() && edit.from[k] != kNone; ++k) {
    const KinematicTarget* source = findPin(pins, edit.from[k]);
    if (source == nullptr) return;
    blend.position += edit.weight[k] * source->position;
  }
  pins.push_back(blend);  // new ids are the largest: the order holds
}

void applyChangesToPins(const MeshChanges& changes, std::vector<KinematicTarget>& pins) {
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.isNew()) pinNew(edit, pins);
    if (edit.kind != VertexEdit::Kind::kRemove) continue;
    for (KinematicTarget& pin : pins) {
      if (pin.vertex == edit.from[0]) pin.vertex = edit.id;
    }
    std::sort(pins.begin(), pins.end(), [](const KinematicTarget& p, const KinematicTarget& q) {
      return p.vertex < q.vertex;
    });
  }
}

}  // namespace

Holders::Holders(std::vector<KinematicTarget> pins, const std::vector<ClampSpec>& clamps)
    : pins_(std::move(pins)), clamps_(clamps.begin(), clamps.end()) {}

Clamp* Holders::find(const std::string& clamp) { return findClamp(clamps_, clamp); }

std::vector<std::string> Holders::clampNames() const { return namesOf(clamps_); }

void Holders::add(const ClampSpec& spec, const Model& model) {
  if (spec.patch) patchParticles(model, *spec.patch);  // throws if there is no such patch
  clamps_.emplace_back(spec);
}

bool Holders::remove(const std::string& clamp) {
  const Clamp* found = find(clamp);
  if (found == nullptr) return false;
  clamps_.erase(clamps_.begin() + (found - clamps_.data()));
  gripWatch_.forget(clamp);
  return true;
}

void Holders::remember() {
  clampsBefore_ = clamps_;
  dragBefore_ = drag_;
}

void Holders::takeBack() {
  clamps_ = clampsBefore_;
  drag_ = dragBefore_;
}

void Holders::advance(const Model& model, const State& state, double dt,
                      const LayerContact* layers) {
  for (Clamp& clamp : clamps_) {
    clamp.clearWrench();
    // A patch may be folded. Of what is between plates, one bulge would press all layers together.
    const bool keepsOrder = layers != nullptr && clamp.spec().patch.has_value();
    clamp.advance(model, state, dt, keepsOrder ? Squeeze::kTogether : Squeeze::kEach);
  }
  drag_.advance(state, dt);
}

void Holders::gatherControls(const Model& model, Controls& controls) {
  targets_ = pins_;
  controls.forces.clear();
  for (const Clamp& clamp : clamps_) {
    clamp.appendTargets(targets_);
    clamp.appendForces(model, controls.forces);
  }
  drag_.appendTargets(targets_);
  // By vertex, then by precedence (std::stable_sort would allocate).
  const auto key = [this](std::size_t k) { return std::pair(targets_[k].vertex, k); };
  order_.resize(targets_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<KinematicTarget>& unique = controls.kinematic;
  unique.clear();
  for (const std::size_t k : order_) {
    if (unique.empty() || unique.back().vertex != targets_[k].vertex) {
      unique.push_back(targets_[k]);
    }
  }
}

bool Holders::mayYield() const {
  return std::any_of(clamps_.begin(), clamps_.end(),
                     [](const Clamp& clamp) { return clamp.spec().gripForce.has_value(); });
}

bool Holders::yield(const Controls& controls, const StepReport& report) {
  bool any = false;
  for (Clamp& clamp : clamps_) {
    if (clamp.yield(controls.kinematic, report.reactions)) any = true;
  }
  return any;
}

void Holders::addReactions(const Controls& controls, const StepReport& report, const Model& model,
                           const State& state, double fraction) {
  for (Clamp& clamp : clamps_) {
    clamp.addReactions(controls.kinematic, report.reactions, fraction);
    clamp.addSlipWrench(model, state, fraction);
  }
}

void Holders::holdBack(const State& state, double dt, const LayerContact* layers) {
  for (Clamp& clamp : clamps_) {
    if (isBlocked(clamp, layers)) clamp.holdBack(state, dt);
  }
}

void Holders::recordGripEvents(const Model& model, const State& state, const ColliderSet& colliders,
                               const LayerContact* layers) {
  for (const Clamp& clamp : clamps_) {
    for (const GripEvent::Kind kind : gripWatch_.update(clamp, isBlocked(clamp, layers))) {
      gripEvents_.push_back({state.t, clamp.spec().name, kind,
                             gripContents(clamp, model, state, colliders), clamp.wrench().force,
                             clamp.slipped()});
    }
  }
}

std::vector<GripEvent> Holders::takeGripEvents() { return std::exchange(gripEvents_, {}); }

std::vector<VertexId> Holders::heldVertices() const {
  std::vector<VertexId> held;
  for (const KinematicTarget& pin : pins_) held.push_back(pin.vertex);
  for (const Clamp& clamp : clamps_) {
    held.insert(held.end(), clamp.held().begin(), clamp.held().end());
  }
  if (drag_.vertex() != kNone) held.push_back(drag_.vertex());
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());
  return held;
}

bool Holders::areStill() const {
  return drag_.vertex() == kNone &&
         std::all_of(clamps_.begin(), clamps_.end(), [](const Clamp& it) { return it.isStill(); });
}

bool Holders::areAtTarget() const {
  return std::all_of(clamps_.begin(), clamps_.end(), [](const Clamp& it) { return it.atTarget(); });
}

bool Holders::haveClosed() const {
  return std::none_of(clamps_.begin(), clamps_.end(),
                      [](const Clamp& it) { return it.state() == ClampState::kClosing; });
}

void Holders::applyChanges(const MeshChanges& changes) {
  for (Clamp& clamp : clamps_) clamp.applyChanges(changes);
  drag_.applyChanges(changes);
  applyChangesToPins(changes, pins_);
}

}  // namespace cloth_sim
