#include "cloth_sim/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloth_sim/sim/build.h"

namespace cloth_sim {
namespace {

/// How far a particle may be pulled in one step beyond its own speed times dt and still be among
/// the contact candidates, at least [m].
constexpr double kContactReach = 0.05;

/// A particle that rests may be pulled along by the fastest one.
double contactReach(const State& state, double dt) {
  double fastest = 0.0;
  for (const Vec3& v : state.v) fastest = std::max(fastest, v.squaredNorm());
  return std::max(kContactReach, std::sqrt(fastest) * dt);
}

VertexData<VertexId> identity(const Model& model) {
  std::vector<VertexId> ids(static_cast<std::size_t>(model.particleCount()));
  std::iota(ids.begin(), ids.end(), 0);
  return VertexData<VertexId>(std::move(ids));
}

std::vector<Clamp> makeClamps(const std::vector<ClampSpec>& specs) {
  return std::vector<Clamp>(specs.begin(), specs.end());
}

std::unique_ptr<Solver> makeSolver(const SolverSpec& spec, const Model& model) {
  const SolverInfo& info = findSolver(spec.method);
  return info.create(model, completeParameters(info, spec.parameters));
}

/// Copies of pinned particles stay pinned where they are.
void followPins(const MeshChanges& changes, std::vector<KinematicTarget>& pins) {
  for (const NewVertex& added : changes.newVertices) {
    const auto source = std::find_if(pins.begin(), pins.end(), [&](const KinematicTarget& pin) {
      return pin.vertex == added.from[0];
    });
    if (source == pins.end() || added.from[1] != kNone) continue;
    KinematicTarget copy = *source;
    copy.vertex = added.id;
    pins.push_back(copy);  // new ids are the largest: the order holds
  }
}

}  // namespace

Simulation::Simulation(Scene scene)
    : scene_(std::move(scene)),
      model_(buildModel(scene_.cloth)),
      state_(initialState(scene_.cloth, model_, scene_.seed)),
      lastGood_(state_),
      pins_(pinTargets(scene_.cloth, model_, state_)),
      clamps_(makeClamps(scene_.clamps)),
      colliders_(buildColliders(scene_)),
      solver_(makeSolver(scene_.solver, model_)),
      script_(scene_.phases),
      tearing_(scene_.tearing, model_),
      origin_(identity(model_)),
      originalBoundary_(boundaryEdges(model_.mesh)) {
  controls_.gravity = scene_.gravity;
  controls_.drag = scene_.drag;
  controls_.wind = scene_.wind;
}

void Simulation::step() {
  if (failed()) return;
  runScript();
  moveClamps();
  detectContacts();
  solve();
  if (failed()) return;
  readClamps();
  tear();
  ++stepCount_;
}

void Simulation::runScript() {
  if (script_.status() == ScriptStatus::kIdle && stepCount_ == 0) {
    if (const PhaseSpec* first = script_.start(time())) beginPhase(*first);
    return;
  }
  if (script_.status() != ScriptStatus::kRunning) return;
  if (const PhaseSpec* next = script_.update(observe())) beginPhase(*next);
  if (script_.status() == ScriptStatus::kFailed) {
    fail("phase '" + script_.history().back().name + "' did not end within its time-out");
  }
}

PhaseObservation Simulation::observe() const {
  PhaseObservation now;
  now.time = time();
  now.meanSpeed = meanSpeed(state_);
  now.pieces = pieces_;
  now.broken = broken_.total;
  now.inContact =
      std::any_of(contacts_.candidates.begin(), contacts_.candidates.end(),
                  [](const ContactCandidates& c) { return c.impulse.squaredNorm() > 0.0; });
  now.clampsAtTarget = std::all_of(clamps_.begin(), clamps_.end(),
                                   [](const Clamp& clamp) { return clamp.atTarget(); });
  now.clampsClosed = std::all_of(clamps_.begin(), clamps_.end(), [](const Clamp& clamp) {
    return clamp.state() != ClampState::kClosing;
  });
  return now;
}

void Simulation::beginPhase(const PhaseSpec& phase) {
  for (Clamp& clamp : clamps_) clamp.setSpeedLimit(std::nullopt);
  for (const ClampAction& action : phase.clamps) {
    if (Clamp* clamp = findClamp(action.clamp)) act(action, *clamp);
  }
  for (const ObstacleAction& action : phase.obstacles) {
    Collider* collider = colliders_.find(action.obstacle);
    if (collider != nullptr) collider->place(collider->poseAt(time()), action.velocity, time());
  }
  if (phase.tearing) tearing_.setEnabled(*phase.tearing);
  if (phase.ratio) tearing_.setRatio(*phase.ratio);
  for (const MaterialPath& notch : phase.notches) {
    operate(planNotch(model_, notch), FailureCause::kCut);
  }
}

void Simulation::act(const ClampAction& action, Clamp& clamp) {
  Pose target = action.hold ? clamp.stoppingPose() : clamp.target();
  if (action.attach && clamp.spec().patch) {
    const std::vector<VertexId> patch = patchParticles(model_, *clamp.spec().patch);
    Vec3 middle = Vec3::Zero();
    for (VertexId v : patch) middle += state_.x[v];
    target.position = middle / static_cast<double>(patch.size());
  }
  if (action.moveBy) target.position += *action.moveBy;
  if (action.moveTo) target.position = *action.moveTo;
  if (action.orientation) target.orientation = *action.orientation;
  clamp.setTarget(target);
  clamp.setSpeedLimit(action.speed);
  if (action.grasp) *action.grasp ? clamp.close() : clamp.release();
}

void Simulation::moveClamps() {
  controls_.kinematic = pins_;
  for (Clamp& clamp : clamps_) {
    clamp.advance(model_, state_, scene_.solver.dt);
    clamp.appendTargets(controls_.kinematic);
  }
  // Pins come first, then clamps in order: the first to hold a particle keeps it.
  std::vector<KinematicTarget>& targets = controls_.kinematic;
  std::stable_sort(targets.begin(), targets.end(),
                   [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
  targets.erase(std::unique(targets.begin(), targets.end(),
                            [](const auto& a, const auto& b) { return a.vertex == b.vertex; }),
                targets.end());
}

void Simulation::detectContacts() {
  if (colliders_.all().empty()) return;
  const double dt = scene_.solver.dt;
  colliders_.detect(state_, dt, contactReach(state_, dt), contacts_);
}

void Simulation::solve() {
  lastGood_ = state_;
  report_ = solver_->step(model_, state_, controls_, contacts_, scene_.solver.dt);
  if (report_.status == StepStatus::kOk) return;
  state_ = lastGood_;
  fail(scene_.solver.method + " diverged in the step from t = " + std::to_string(time()) +
       " s: take more substeps or a softer fabric");
}

void Simulation::readClamps() {
  for (Clamp& clamp : clamps_) clamp.readReactions(controls_.kinematic, report_.reactions);
}

void Simulation::tear() { operate(tearing_.plan(model_, state_), FailureCause::kTear); }

void Simulation::operate(const std::vector<Opening>& openings, FailureCause cause) {
  if (openings.empty()) return;
  const SurgeryResult result = openSurface(model_, state_, openings, cause);
  if (result.changes.mesh.empty()) return;
  for (const FailureEvent& event : result.events) count(event);
  for (Clamp& clamp : clamps_) clamp.follow(result.changes.mesh);
  followPins(result.changes.mesh, pins_);
  origin_.follow(result.changes.mesh);
  solver_->onModelChanged(model_, result.changes);
  tearing_.follow(model_, result.changes);
  pieces_ = findPieces(model_.mesh).count;
  topology_.reset();
}

void Simulation::count(const FailureEvent& event) {
  events_.push_back(event);
  ++broken_.total;
  ++broken_.byKind[static_cast<std::size_t>(event.kind)];
  ++(event.cause == FailureCause::kTear ? broken_.torn : broken_.cut);
}

void Simulation::fail(const std::string& why) { failure_ = why; }

double Simulation::observeMaxStretch() {
  const double now = maxStretch(model_, state_);
  maxStretchSeen_ = std::max(maxStretchSeen_, now);
  return now;
}

std::vector<FailureEvent> Simulation::takeEvents() {
  std::vector<FailureEvent> events;
  events.swap(events_);
  return events;
}

}  // namespace cloth_sim
