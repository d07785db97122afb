#include "cloth_sim/surgery/tearing.h"

#include <algorithm>
#include <cmath>

#include "energy_release.h"
#include "mesh/quality.h"
#include "tear_line.h"

namespace cloth_sim {
namespace {

/// Distance from a tip within which an overloaded spring lets it advance [edges].
constexpr double kTipReach = 3.0;
/// Distance from an advancing tear within which it unloads the cloth, so that no other tear begins
/// [edges].
constexpr double kUnloadedReach = 12.0;
/// Time for which points of a tear are remembered [s].
constexpr double kMemory = 1.0;
/// Time from which the ends of cuts may advance: any [s].
constexpr double kLongAgo = -1e9;
/// Time from which a tip may advance where nothing opened.
constexpr double kNeverReady = std::numeric_limits<double>::infinity();
/// Strain over failure strain from which on a spring is monitored, as it may fail within a step.
/// The stress ahead of a tip falls with the square root of the distance, so this covers about four
/// edges ahead.
constexpr double kMonitoredLoad = 0.5;
/// Load of a tip below which its strain tells nothing about how it grows.
constexpr double kSlightLoad = 0.02;
/// Least factor by which the strain at a tip grows between two looks at its load: a tip advances at
/// most so much too late.
constexpr double kLeastGrowth = 1.01;
/// An edit that changes more than one in so many springs fills the monitor again.
constexpr std::size_t kLocalEdit = 8;

Vec2 middleOf(const TriangleMesh& mesh, const Spring& spring) {
  return 0.5 * (mesh.material(spring.a) + mesh.material(spring.b));
}

/// Returns whether a spring crosses a path.
bool straddles(const TriangleMesh& mesh, const Spring& spring, const MaterialPath& path) {
  return separates(path, mesh.material(spring.a), mesh.material(spring.b));
}

/// Returns the end of a spring that lies on a path, kNone if neither or both do.
VertexId endOn(const TriangleMesh& mesh, const Spring& spring, const MaterialPath& path) {
  const bool a = parameterOn(path, mesh.material(spring.a)).has_value();
  const bool b = parameterOn(path, mesh.material(spring.b)).has_value();
  return a == b ? kNone : (a ? spring.a : spring.b);
}

double lengthOf(const SurfacePath& path) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    length += (path.points[k + 1].material - path.points[k].material).norm();
  }
  return length;
}

std::vector<Vec2> materialOf(const SurfacePath& path) {
  std::vector<Vec2> points;
  for (const SurfacePoint& p : path.points) points.push_back(p.material);
  return points;
}

double longestEdgeOf(const TriangleMesh& mesh, const std::vector<FaceId>& faces) {
  double longest = 0.0;
  for (FaceId f : faces) longest = std::max(longest, longestEdge(mesh, f));
  return longest;
}

/// Returns the most strained spring that ends at a vertex or beside it; one that does not exist if
/// there is none.
Spring mostStrained(const Model& model, const State& state, VertexId v) {
  std::vector<VertexId> around = model.mesh.neighbours(v);
  around.push_back(v);
  std::sort(around.begin(), around.end());
  Spring most;
  double strain = -1.0;
  for (const std::int32_t slot : model.springs.springsOnAny(around)) {
    const Spring spring = model.springs[slot];
    const double here = stretch(spring, state) - 1.0;
    if (here <= strain) continue;
    most = spring;
    strain = here;
  }
  return most;
}

}  // namespace

/// An overloaded spring and its surroundings.
struct Tearing::OverloadedSpring {
  const Spring& spring;
  std::vector<FaceId> faces;  ///< that it represents
  Vec2 middle;                ///< its midpoint, material coordinates [m]
  double edge;                ///< longest edge of the faces [m]
  VertexId tip;               ///< the tip within reach, or kNone
};

/// A tip, and the advance that it is driven to.
struct Tearing::TipLoad {
  VertexId tip;
  TearAdvance advance;
};

Tearing::Tearing(TearingSettings settings, const Model& model) : settings_(std::move(settings)) {
  if (!settings_.seam) return;
  const auto slots = static_cast<std::int32_t>(model.springs.slots().size());
  for (std::int32_t slot = 0; slot < slots; ++slot) {
    if (mayOpenSeam(model, model.springs[slot])) seamSlots_.push_back(slot);
  }
}

/// Returns whether the seam allows a spring to open the surface.
bool Tearing::mayOpenSeam(const Model& model, const Spring& spring) const {
  if (!spring.exists()) return false;
  const Seam& seam = *settings_.seam;
  if (straddles(model.mesh, spring, seam.path)) return true;
  if (endOn(model.mesh, spring, seam.path) != kNone) return true;
  return isInBand(model.mesh, spring);
}

void Tearing::setRatio(const TearRatios& ratio) {
  settings_.ratio = ratio;
  monitor_.clear();
}

void Tearing::applyChanges(const Model& model, const ModelChanges& changes) {
  updateMonitor(model, changes);
  for (std::int32_t slot : changes.springs.added) {
    if (settings_.seam && mayOpenSeam(model, model.springs[slot])) seamSlots_.push_back(slot);
  }
  for (std::int32_t slot : changes.springs.modified) ineffective_.erase(slot);
  for (const VertexEdit& edit : changes.mesh.vertices) {
    if (edit.kind != VertexEdit::Kind::kRemove) continue;
    tips_.erase(edit.id);
    auto moved = tips_.extract(edit.from[0]);
    if (moved.empty()) continue;
    moved.key() = edit.id;
    tips_.insert(std::move(moved));
  }
}

/// Updates the monitor after a local edit; otherwise clears it, so that it will be filled again.
void Tearing::updateMonitor(const Model& model, const ModelChanges& changes) {
  const SpringChanges& springs = changes.springs;
  const auto removes = [](const VertexEdit& edit) {
    return edit.kind == VertexEdit::Kind::kRemove;
  };
  const std::vector<VertexEdit>& edits = changes.mesh.vertices;
  const bool isLocal =
      springs.modified.size() + springs.added.size() < monitor_.size() / kLocalEdit &&
      std::none_of(edits.begin(), edits.end(), removes);
  if (settings_.seam || !isLocal) return monitor_.clear();
  monitorFrom(monitor_.size(), model);
  for (const std::int32_t slot : springs.removed) monitor_.remove(slot);
  for (const std::int32_t slot : springs.modified) {
    monitor_.replace(slot, model.springs[slot], monitoredLength(model.springs[slot]));
  }
  std::vector<VertexId> around;
  for (const VertexEdit& edit : edits) {
    monitor_.noteEdited(edit.id);
    const std::vector<VertexId> ring = model.mesh.neighbours(edit.id);
    around.push_back(edit.id);
    around.insert(around.end(), ring.begin(), ring.end());
  }
  for (const std::int32_t slot : model.springs.springsOnAny(around)) monitor_.addCandidate(slot);
}

void Tearing::fillMonitor(const Model& model) {
  if (monitor_.empty()) monitorFrom(0, model);
}

/// Appends the springs from the index `first` on to the monitor.
void Tearing::monitorFrom(std::size_t first, const Model& model) {
  const std::size_t count = settings_.seam ? seamSlots_.size() : model.springs.slots().size();
  monitor_.reserve(count);
  for (std::size_t k = first; k < count; ++k) {
    const Spring& spring = model.springs[monitoredSlot(k)];
    spring.exists() ? monitor_.add(spring, monitoredLength(spring)) : monitor_.addUnlimited();
  }
}

/// Returns the length from which on a spring is monitored [m].
double Tearing::monitoredLength(const Spring& spring) const {
  return (1.0 + kMonitoredLoad * (ratioOf(spring) - 1.0)) * spring.restLength;
}

/// Finds the springs beyond their limits, most overloaded first, and sets `worst_`.
std::vector<Tearing::Overload> Tearing::findOverloads(const Model& model, const State& state) {
  std::vector<Overload> found;
  worst_ = 0.0;
  fillMonitor(model);
  for (const std::int32_t k : monitor_.find(state.x)) {
    const std::int32_t slot = monitoredSlot(static_cast<std::size_t>(k));
    const Spring& spring = model.springs[slot];
    const double ratio = ratioOf(spring);
    const double stretched = stretch(spring, state);
    const double load = (stretched - 1.0) / (ratio - 1.0);
    if (load > worst_ && ineffective_.count(slot) == 0) worst_ = load;
    if (stretched > ratio) found.push_back({stretched / ratio, slot});
  }
  std::sort(found.begin(), found.end(), [](const Overload& p, const Overload& q) {
    return p.excess != q.excess ? p.excess > q.excess : p.slot < q.slot;
  });
  return found;
}

void Tearing::listLimits(const Model& model, const State& state, std::vector<LengthLimit>& limits) {
  limits.clear();
  if (!settings_.enabled) return;
  if (isByEnergy()) return listTipLimits(model, state, limits);
  fillMonitor(model);
  for (const std::int32_t k : monitor_.find(state.x)) {
    const std::int32_t slot = monitoredSlot(static_cast<std::size_t>(k));
    if (ineffective_.count(slot) != 0) continue;
    const Spring& spring = model.springs[slot];
    limits.push_back({spring.a, spring.b, ratioOf(spring) * spring.restLength});
  }
}

/// Lists for each tip the length of the most strained spring at which the load of the tip may reach
/// 1. It grows with the square of that strain at most, so a step that ends there is not too late.
void Tearing::listTipLimits(const Model& model, const State& state,
                            std::vector<LengthLimit>& limits) const {
  for (const TipLoad& at : tipLoads(model, state)) {
    if (std::isinf(tips_.at(at.tip))) continue;
    const Spring spring = mostStrained(model, state, at.tip);
    if (!spring.exists()) continue;
    const double strain = std::max(0.0, stretch(spring, state) - 1.0);
    const double growth =
        std::max(kLeastGrowth, 1.0 / std::sqrt(std::max(at.advance.load, kSlightLoad)));
    const TearEnergy& energy = settings_.energy[model.clothOf(at.tip)];
    const double slight =
        std::sqrt(2.0 * kSlightLoad * std::min({energy.warp, energy.weft, energy.bias}) /
                  (spring.stiffness * spring.restLength));
    limits.push_back(
        {spring.a, spring.b, spring.restLength * (1.0 + std::max(slight, growth * strain))});
  }
}

CutPlan Tearing::plan(const Model& model, const State& state, double dt) {
  CutPlan plan;
  plan.cause = FailureCause::kTear;
  plan.refine = settings_.refineTip;
  advances_.clear();
  plannedAt_ = state.t;
  if (!settings_.enabled) return plan;
  forgetOld(model.mesh, state.t);
  isByEnergy() ? planByEnergy(model, state, dt, plan) : planByStretch(model, state, dt, plan);
  return plan;
}

void Tearing::planByStretch(const Model& model, const State& state, double dt, CutPlan& plan) {
  std::vector<Vec2> begun;  // start points of the advances of this plan
  for (const Overload& overload : findOverloads(model, state)) {
    if (ineffective_.count(overload.slot) != 0) continue;
    plan.overloaded.push_back(overload.slot);
    const Spring& spring = model.springs[overload.slot];
    OverloadedSpring at{spring, facesUnder(model.mesh, spring), middleOf(model.mesh, spring), 0.0,
                        kNone};
    at.edge = longestEdgeOf(model.mesh, at.faces);
    const double reach = kTipReach * at.edge;
    const auto isNear = [&](const Vec2& p) { return (p - at.middle).norm() < reach; };
    if (std::any_of(begun.begin(), begun.end(), isNear)) continue;
    at.tip = nearestTip(model.mesh, at.middle, reach);
    std::optional<SurfacePath> line = planLine(model, state, at);
    if (!line) continue;
    const double ready = at.tip == kNone ? 0.0 : tips_.at(at.tip);
    advances_.push_back(
        {std::max(ready, state.t - dt), lengthOf(*line), overload.slot, at.tip, materialOf(*line)});
    begun.push_back(at.tip == kNone ? at.middle : model.mesh.material(at.tip));
    plan.paths.push_back(std::move(*line));
  }
  std::sort(plan.overloaded.begin(), plan.overloaded.end());
}

/// Lets the tips advance that release enough energy, most loaded first (then by number).
void Tearing::planByEnergy(const Model& model, const State& state, double dt, CutPlan& plan) {
  worst_ = 0.0;
  for (const TipLoad& at : tipLoads(model, state)) {
    if (std::isinf(tips_.at(at.tip))) continue;
    worst_ = std::max(worst_, at.advance.load);
    if (at.advance.load < 1.0 || tips_.at(at.tip) > state.t) continue;
    std::optional<SurfacePath> line = lineFrom(model.mesh, at);
    if (!line) continue;
    const double start = std::max(tips_.at(at.tip), state.t - dt);
    advances_.push_back({start, lengthOf(*line), kNone, at.tip, materialOf(*line)});
    plan.paths.push_back(std::move(*line));
  }
}

std::vector<Tearing::TipLoad> Tearing::tipLoads(const Model& model, const State& state) const {
  std::vector<TipLoad> loads;
  for (const auto& [tip, ready] : tips_) {
    if (!isTip(model.mesh, tip)) continue;
    const TearEnergy& energy = settings_.energy[model.clothOf(tip)];
    if (!energy.isKnown()) continue;
    const Vec2 force = materialForce(model, state, tip);
    const Vec2 ahead = directionAhead(model.mesh, tip);
    const TearAdvance onSeam{ahead, force.dot(ahead) / energy.along(ahead)};
    loads.push_back({tip, settings_.seam ? onSeam : mostDrivenAdvance(force, energy)});
  }
  std::sort(loads.begin(), loads.end(), [](const TipLoad& p, const TipLoad& q) {
    return p.advance.load != q.advance.load ? p.advance.load > q.advance.load : p.tip < q.tip;
  });
  return loads;
}

/// Returns the line along which a tip advances: on the seam, if there is one.
std::optional<SurfacePath> Tearing::lineFrom(const TriangleMesh& mesh, const TipLoad& at) const {
  if (settings_.seam) return seamFrom(mesh, at.tip, settings_.seam->path);
  return rayFrom(mesh, at.tip, at.advance.direction, mesh.material(at.tip) + at.advance.direction);
}

/// Returns the line along which the surface opens for an overloaded spring now, if it does.
std::optional<SurfacePath> Tearing::planLine(const Model& model, const State& state,
                                             const OverloadedSpring& at) const {
  if (at.tip != kNone && tips_.at(at.tip) > state.t) return std::nullopt;
  // An edit may have moved the spring away from the seam.
  if (settings_.seam && !mayOpenSeam(model, at.spring)) return std::nullopt;
  std::optional<SurfacePath> line = seamLine(model.mesh, at);
  const bool begins = at.tip == kNone && !line;
  if (begins && isUnloaded(at.middle, at.edge, state.t)) return std::nullopt;
  if (!line && isInBand(model.mesh, at.spring)) line = freeLine(model, state, at);
  return line;
}

/// Returns the part of the seam that a spring opens, if it crosses the seam or ends on it.
std::optional<SurfacePath> Tearing::seamLine(const TriangleMesh& mesh,
                                             const OverloadedSpring& at) const {
  if (!settings_.seam) return std::nullopt;
  const MaterialPath& seam = settings_.seam->path;
  const auto crossing = crossingOf(seam, mesh.material(at.spring.a), mesh.material(at.spring.b));
  if (crossing) return seamOver(mesh, at.faces, seam, *crossing);
  const VertexId end = endOn(mesh, at.spring, seam);
  return end == kNone ? std::nullopt : seamFrom(mesh, end, seam);
}

/// Returns whether a spring may open the surface elsewhere than along the seam.
bool Tearing::isInBand(const TriangleMesh& mesh, const Spring& spring) const {
  if (!settings_.seam) return true;
  const Seam& seam = *settings_.seam;
  return seam.halfWidth > 0.0 && distanceTo(seam.path, middleOf(mesh, spring)) <= seam.halfWidth;
}

/// Returns a line at right angles to the largest tension: from the tip, from the border, or through
/// the midpoint of the spring.
std::optional<SurfacePath> Tearing::freeLine(const Model& model, const State& state,
                                             const OverloadedSpring& at) const {
  const TriangleMesh& mesh = model.mesh;
  const VertexId origin = at.tip == kNone ? borderVertex(mesh, at.faces) : at.tip;
  const Vec2 tension = tensionDirection(model, state, origin == kNone ? at.spring.a : origin);
  const Vec2 along(-tension.y(), tension.x());
  return origin == kNone ? lineThrough(mesh, at.faces, at.middle, along)
                         : rayFrom(mesh, origin, along, at.middle);
}

VertexId Tearing::nearestTip(const TriangleMesh& mesh, const Vec2& p, double within) const {
  VertexId nearest = kNone;
  double least = within;
  for (const auto& [tip, ready] : tips_) {
    const double distance = (mesh.material(tip) - p).norm();
    if (distance < least) {
      least = distance;
      nearest = tip;
    }
  }
  return nearest;
}

/// Returns whether a tear that has advanced recently, or advances in this plan, unloads a point.
bool Tearing::isUnloaded(const Vec2& p, double edge, double time) const {
  const double reach = kUnloadedReach * edge;
  const auto isNear = [&](const Vec2& point) { return (point - p).norm() < reach; };
  const auto hasUnloaded = [&](const TornPoint& torn) {
    return torn.time >= time - reach / settings_.tipSpeed && isNear(torn.at);
  };
  const auto unloads = [&](const Advance& advance) {
    return std::any_of(advance.points.begin(), advance.points.end(), isNear);
  };
  return std::any_of(recent_.begin(), recent_.end(), hasUnloaded) ||
         std::any_of(advances_.begin(), advances_.end(), unloads);
}

/// Drops old points of tears, and vertices that are no tips any more.
void Tearing::forgetOld(const TriangleMesh& mesh, double time) {
  const auto isOld = [time](const TornPoint& torn) { return torn.time < time - kMemory; };
  recent_.erase(std::remove_if(recent_.begin(), recent_.end(), isOld), recent_.end());
  for (auto tip = tips_.begin(); tip != tips_.end();) {
    tip = isTip(mesh, tip->first) ? std::next(tip) : tips_.erase(tip);
  }
}

void Tearing::shiftTime(double by) {
  plannedAt_ += by;
  for (auto& [tip, ready] : tips_) ready += by;
  for (TornPoint& torn : recent_) torn.time += by;
  for (Advance& advance : advances_) advance.start += by;
}

void Tearing::noteOpened(const SurgeryResult& result) {
  if (result.changes.mesh.empty()) {
    for (const Advance& advance : advances_) {
      if (advance.slot != kNone) ineffective_.insert(advance.slot);
    }
  }
  for (std::size_t k = 0; k < advances_.size(); ++k) {
    const Advance& advance = advances_[k];
    for (const Vec2& point : advance.points) recent_.push_back({point, plannedAt_});
    const double ready = advance.start + advance.length / settings_.tipSpeed;
    for (VertexId tip : {result.tips[2 * k], result.tips[2 * k + 1]}) tips_[tip] = ready;
    if (isByEnergy() && result.changes.mesh.empty()) tips_[advance.tip] = kNeverReady;
  }
}

void Tearing::noteTips(const SurgeryResult& result) {
  for (VertexId tip : result.tips) tips_.emplace(tip, kLongAgo);
}

std::string Tearing::validationError(const Model& model) const {
  const auto slots = static_cast<std::int32_t>(model.springs.slots().size());
  const auto isSlot = [slots](std::int32_t slot) { return slot >= 0 && slot < slots; };
  if (!settings_.seam && !seamSlots_.empty()) return "there are springs of a seam without a seam";
  if (!std::all_of(seamSlots_.begin(), seamSlots_.end(), isSlot) ||
      !std::all_of(ineffective_.begin(), ineffective_.end(), isSlot)) {
    return "a spring is to tear that does not exist";
  }
  for (const auto& [tip, time] : tips_) {
    if (tip < 0 || tip >= model.particleCount()) return "a tip is at no particle";
  }
  for (const Advance& advance : advances_) {
    if (!isSlot(advance.slot)) return "an advance is that of no spring";
  }
  const bool areRatios = std::all_of(settings_.ratio.begin(), settings_.ratio.end(),
                                     [](double ratio) { return ratio > 1.0; });
  return areRatios ? "" : "springs are to fail that are not stretched";
}

}  // namespace cloth_sim
