#include "cloth_sim/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cloth_sim/scene/build.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// How far a particle may be pulled in one step beyond its own speed times dt and still be among
/// the contact candidates, at least [m].
constexpr double kContactReach = 0.05;
/// Shortest edge that surgery makes, if the scene says nothing: this part of the original ones.
constexpr double kMinEdgePart = 0.05;
/// An obstacle that moves less than this in a step stands still: its guide rounds [m].
constexpr double kStill = 1e-12;
/// Strides that the tip of a tear takes in a step at most.
constexpr int kMostStrides = 16;

std::vector<Clamp> makeClamps(const std::vector<ClampSpec>& specs) {
  return std::vector<Clamp>(specs.begin(), specs.end());
}

std::unique_ptr<Solver> makeSolver(const SolverSpec& spec, const Model& model, const State& state) {
  const SolverInfo& info = findSolver(spec.method);
  checkFeatures(info, !model.bending.empty());
  const SolverParameters complete = completeParameters(info, spec.parameters);
  if (spec.guard == StepGuard::kAllow) return info.create(model, complete);
  const FastestMode mode = estimateFastestMode(model, state);
  return info.create(model, guardStep(spec.guard, info, mode, spec.dt, complete));
}

SurgeryLimits limitsFor(const SurgerySettings& settings, const TriangleMesh& mesh) {
  SurgeryLimits limits;
  limits.shape.snap = settings.snap;
  limits.shape.minEdge = settings.minEdge.value_or(kMinEdgePart * shortestEdge(mesh));
  limits.maxParticles = settings.maxParticles;
  return limits;
}

}  // namespace

Simulation::Simulation(Scene scene)
    : scene_(std::move(scene)),
      model_(buildModel(scene_.cloths)),
      state_(initialState(scene_.cloths, model_, scene_.seed)),
      pins_(pinTargets(scene_.cloths, model_, state_)),
      clamps_(makeClamps(scene_.clamps)),
      colliders_(buildColliders(scene_)),
      solver_(makeSolver(scene_.solver, model_, state_)),
      watch_(scene_.solver, solver_->substeps()),
      sleep_(scene_.solver.sleep),
      script_(scene_.phases),
      tearing_(scene_.tearing, model_),
      limits_(limitsFor(scene_.surgery, model_.mesh)),
      pieces_(connectedComponents(model_.mesh)) {
  controls_.gravity = scene_.gravity;
  controls_.drag = scene_.drag;
  controls_.wind = scene_.wind;
  startHash_ = stateHash(model_, state_);
}

void Simulation::step() {
  if (failed()) return;
  runScript();
  if (failed()) return;
  if (isAsleep()) return sleepOn();
  const ThreadPool::ParallelRegion region(pool_);
  const int brokenBefore = broken_.total;
  moveClamps(scene_.solver.dt);
  guides_.steer(time(), scene_.solver.dt, colliders_);
  for (double done = 0.0; done < 1.0 && !failed(); done = report_.fraction) advance(done);
  if (failed()) return;
  watchGrips();
  ++stepCount_;
  watchRest(brokenBefore);
}

/// What nobody touches stays as it is: only time goes on.
void Simulation::sleepOn() {
  state_.t += scene_.solver.dt;
  sleep_.sleepOn(scene_.solver.dt);
  ++stepCount_;
}

void Simulation::watchRest(int brokenBefore) {
  const bool rests = sleep_.isSlow(state_) && isStill() && broken_.total == brokenBefore;
  if (!sleep_.endStep(rests, scene_.solver.dt)) return;
  for (Vec3& v : state_.v) v.setZero();
  stretchAsleep_.reset();
}

/// Whether nothing but the cloth itself moves it, and nothing is about to.
bool Simulation::isStill() const {
  const auto stands = [this](const Collider& collider) {
    return collider.obstacle().velocity.norm() * scene_.solver.dt <= kStill;
  };
  const std::vector<Collider>& obstacles = colliders_.all();
  return drag_.vertex() == kNone && !tearing_.isOverloaded() &&
         std::all_of(obstacles.begin(), obstacles.end(), stands) &&
         guides_.areIdle(time(), colliders_) &&
         std::all_of(clamps_.begin(), clamps_.end(),
                     [](const Clamp& clamp) { return clamp.isStill(); });
}

/// Until the step ends, or a spring fails.
/// \param done  share of the step that has passed.
void Simulation::advance(double done) {
  const double dt = scene_.solver.dt;
  gatherControls();
  solve({dt, 1.0, done});
  if (failed()) return;
  const double share = report_.fraction - done;
  readClamps(share);
  tear(report_.passedLimit ? report_.substep : share * dt);
}

void Simulation::runScript() {
  if (script_.status() == ScriptStatus::kIdle && script_.history().empty()) {
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
  if (script_.wantsMeanSpeed() && !isAsleep()) now.meanSpeed = meanSpeed(state_);
  now.pieces = pieces();
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
  sleep_.wake();
  for (Clamp& clamp : clamps_) clamp.setSpeedLimit(std::nullopt);
  for (const ClampAction& action : phase.clamps) {
    if (Clamp* clamp = findClamp(action.clamp)) act(action, *clamp);
  }
  for (const ObstacleAction& action : phase.obstacles) {
    Collider* collider = colliders_.find(action.obstacle);
    if (collider == nullptr) continue;
    guides_.drop(action.obstacle);
    collider->place(collider->poseAt(time()), action.velocity, time());
  }
  if (phase.wind) controls_.wind = phase.wind;
  if (phase.tearing) tearing_.setEnabled(*phase.tearing);
  if (phase.ratio) tearing_.setRatio(*phase.ratio);
  operateFor(phase);
}

void Simulation::operateFor(const PhaseSpec& phase) {
  try {
    for (const RefineNear& request : phase.refinements) refineMesh(request);
    for (const MaterialPath& notch : phase.notches) cutNotch(notch);
    for (const Stroke& stroke : phase.strokes) cutStroke(stroke);
  } catch (const TooManyParticles& error) {
    fail("phase '" + phase.name + "': " + error.what());
  }
}

void Simulation::act(const ClampAction& action, Clamp& clamp) {
  clamp.setSpeedLimit(action.speed);
  if (action.grasp) *action.grasp ? clamp.close() : clamp.release();
  const bool moves =
      action.hold || action.attach || action.moveBy || action.moveTo || action.orientation;
  if (!moves) return;  // what it was told or follows goes on
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
}

void Simulation::moveClamps(double dt) {
  for (Clamp& clamp : clamps_) {
    clamp.clearWrench();
    clamp.advance(model_, state_, dt);
  }
  drag_.advance(state_, dt);
}

/// What pins and clamps do in the rest of the step, and where it ends early. Pins come first, then
/// clamps in order, then what is dragged: the first to hold a particle keeps it.
void Simulation::gatherControls() {
  holders_ = pins_;
  controls_.forces.clear();
  for (const Clamp& clamp : clamps_) {
    clamp.appendTargets(holders_);
    clamp.appendForces(model_, controls_.forces);
  }
  drag_.appendTargets(holders_);
  // By vertex, then by who comes first (std::stable_sort would allocate).
  const auto key = [this](std::size_t k) { return std::pair(holders_[k].vertex, k); };
  holderOrder_.resize(holders_.size());
  std::iota(holderOrder_.begin(), holderOrder_.end(), std::size_t{0});
  std::sort(holderOrder_.begin(), holderOrder_.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<KinematicTarget>& targets = controls_.kinematic;
  targets.clear();
  for (const std::size_t k : holderOrder_) {
    if (targets.empty() || targets.back().vertex != holders_[k].vertex) {
      targets.push_back(holders_[k]);
    }
  }
  tearing_.listLimits(model_, state_, controls_.limits);
}

void Simulation::detectContacts(double dt) {
  if (colliders_.all().empty()) return;
  const MotionBounds bounds = motionBounds(state_);
  // A particle that rests may be pulled along by the fastest one.
  colliders_.detect(state_, bounds, dt, std::max(kContactReach, bounds.speed * dt), contacts_);
  if (model_.cloths.size() == 1) return;
  contacts_.divide(model_.cloths.size(), [this](VertexId v) { return model_.clothOf(v); });
}

/// A step that diverges leaves the state alone. One that does not is taken back where its energy
/// jumped, or where a grip of limited force gives way.
bool Simulation::mayTakeBack() const {
  return watch_.weighs() || std::any_of(clamps_.begin(), clamps_.end(), [](const Clamp& clamp) {
           return clamp.spec().gripForce.has_value();
         });
}

void Simulation::takeBack() {
  if (mayTakeBack()) copyState(start_, state_);
}

void Simulation::solve(const StepLength& length) {
  if (mayTakeBack()) copyState(state_, start_);
  watch_.begin(model_, state_, controls_, colliders_, length.left());
  for (int times = 1; times <= watch_.mostTimes(); times *= 2) {
    if (times > 1) watch_.noteRedone(time(), times);
    if (attempt({length.dt, times * length.substepFactor, length.done})) return watch_.accept();
    takeBack();
  }
  fail(scene_.solver.method + " diverged in the step from t = " + std::to_string(time()) +
       " s: take more substeps or a softer fabric");
}

/// Where a clamp cannot bear what the step would put on it, the step is taken back and solved with
/// that clamp slipping: each time one clamp more at least, so it ends.
bool Simulation::attempt(const StepLength& length) {
  while (true) {
    detectContacts(length.left());
    report_ = solver_->step(model_, state_, controls_, contacts_, length);
    if (!watch_.isSound(model_, state_, report_.status)) return false;
    if (!letSlip()) return true;
    takeBack();
    gatherControls();
  }
}

bool Simulation::letSlip() {
  bool any = false;
  for (Clamp& clamp : clamps_) {
    if (clamp.yield(controls_.kinematic, report_.reactions)) any = true;
  }
  return any;
}

void Simulation::readClamps(double share) {
  for (Clamp& clamp : clamps_) {
    clamp.addReactions(controls_.kinematic, report_.reactions, share);
    clamp.addSlipWrench(model_, state_, share);
  }
}

void Simulation::watchGrips() {
  for (const Clamp& clamp : clamps_) {
    for (const GripEvent::Kind kind : grips_.update(clamp)) {
      gripEvents_.push_back({time(), clamp.spec().name, kind,
                             gripContents(clamp, model_, state_, colliders_), clamp.wrench().force,
                             clamp.slipped()});
    }
  }
}

void Simulation::tear(double dt) {
  for (int stride = 0; stride < kMostStrides && !failed(); ++stride) {
    const CutPlan plan = tearing_.plan(model_, state_, dt);
    if (plan.paths.empty()) return;
    try {
      operate(plan);
    } catch (const TooManyParticles& error) {
      fail(std::string("tearing: ") + error.what());
    }
  }
}

void Simulation::count(const FailureEvent& event) {
  failures_.push_back(event);
  ++broken_.total;
  ++broken_.byKind[static_cast<std::size_t>(event.kind)];
  ++(event.cause == FailureCause::kTear ? broken_.torn : broken_.cut);
}

void Simulation::fail(const std::string& why) { failure_ = why; }

double Simulation::observeMaxStretch() {
  const double now = stretchAsleep_ && isAsleep() ? *stretchAsleep_ : maxStretch(model_, state_);
  stretchAsleep_ = now;
  maxStretchSeen_ = std::max(maxStretchSeen_, now);
  return now;
}

std::vector<FailureEvent> Simulation::takeEvents() {
  const auto first = failures_.begin() + static_cast<std::ptrdiff_t>(told_);
  told_ = failures_.size();
  return {first, failures_.end()};
}

std::vector<GripEvent> Simulation::takeGripEvents() { return std::exchange(gripEvents_, {}); }

}  // namespace cloth_sim
