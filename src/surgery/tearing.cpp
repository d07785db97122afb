#include "cloth_sim/surgery/tearing.h"

#include <algorithm>

#include "mesh/quality.h"
#include "tear_line.h"

namespace cloth_sim {
namespace {

/// Springs this near to a tip make it go on [edges].
constexpr double kGrip = 3.0;
/// A running tear unloads what is this near to it: no other one begins there [edges].
constexpr double kShade = 12.0;
/// How long it is known where tears have run [s].
constexpr double kMemory = 1.0;
/// When cuts ended whose tips have not run yet [s].
constexpr double kLongAgo = -1e9;
/// From this strain over the strain that tears on, a spring may fail within a step. Ahead of a
/// tip, the fifth edge bears as much (the stress there goes by the root of the distance).
constexpr double kNear = 0.5;
/// Edits of more than one in so many springs are not followed one by one.
constexpr std::size_t kLocal = 8;

Vec2 middleOf(const TriangleMesh& mesh, const Spring& spring) {
  return 0.5 * (mesh.material(spring.a) + mesh.material(spring.b));
}

bool straddles(const TriangleMesh& mesh, const Spring& spring, const MaterialPath& path) {
  return separates(path, mesh.material(spring.a), mesh.material(spring.b));
}

/// The end of a spring that lies on the path, if the other end does not.
VertexId endOn(const TriangleMesh& mesh, const Spring& spring, const MaterialPath& path) {
  const bool a = placeOn(path, mesh.material(spring.a)).has_value();
  const bool b = placeOn(path, mesh.material(spring.b)).has_value();
  return a == b ? kNone : (a ? spring.a : spring.b);
}

double lengthOf(const SurfacePath& path) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    length += (path.points[k + 1].material - path.points[k].material).norm();
  }
  return length;
}

std::vector<Vec2> placesOf(const SurfacePath& path) {
  std::vector<Vec2> places;
  for (const SurfacePoint& p : path.points) places.push_back(p.material);
  return places;
}

double longestEdgeOf(const TriangleMesh& mesh, const std::vector<FaceId>& faces) {
  double longest = 0.0;
  for (FaceId f : faces) longest = std::max(longest, longestEdge(mesh, f));
  return longest;
}

}  // namespace

Tearing::Tearing(TearingSettings settings, const Model& model) : settings_(std::move(settings)) {
  if (!settings_.seam) return;
  const auto slots = static_cast<std::int32_t>(model.springs.slots().size());
  for (std::int32_t slot = 0; slot < slots; ++slot) {
    if (mayOpenSeam(model, model.springs[slot])) onSeam_.push_back(slot);
  }
}

bool Tearing::mayOpenSeam(const Model& model, const Spring& spring) const {
  if (!spring.exists()) return false;
  const Seam& seam = *settings_.seam;
  if (straddles(model.mesh, spring, seam.path)) return true;
  if (endOn(model.mesh, spring, seam.path) != kNone) return true;
  return isInBand(model.mesh, spring);
}

void Tearing::setRatio(const TearRatios& ratio) {
  settings_.ratio = ratio;
  near_.clear();
}

void Tearing::applyChanges(const Model& model, const ModelChanges& changes) {
  applyChangesNear(model, changes);
  for (std::int32_t slot : changes.springs.added) {
    if (settings_.seam && mayOpenSeam(model, model.springs[slot])) onSeam_.push_back(slot);
  }
  for (std::int32_t slot : changes.springs.modified) idle_.erase(slot);
  for (const VertexEdit& edit : changes.mesh.vertices) {
    if (edit.kind != VertexEdit::Kind::kRemove) continue;
    tips_.erase(edit.id);
    auto moved = tips_.extract(edit.from[0]);
    if (moved.empty()) continue;
    moved.key() = edit.id;
    tips_.insert(std::move(moved));
  }
}

/// Where all springs may fail, what the edit left alone stays as it is.
void Tearing::applyChangesNear(const Model& model, const ModelChanges& changes) {
  const SpringChanges& springs = changes.springs;
  const auto removes = [](const VertexEdit& edit) {
    return edit.kind == VertexEdit::Kind::kRemove;
  };
  const std::vector<VertexEdit>& edits = changes.mesh.vertices;
  const bool isLocal = springs.modified.size() + springs.added.size() < near_.size() / kLocal &&
                       std::none_of(edits.begin(), edits.end(), removes);
  if (settings_.seam || !isLocal) return near_.clear();
  watchFrom(near_.size(), model);
  for (const std::int32_t slot : springs.removed) near_.remove(slot);
  for (const std::int32_t slot : springs.modified) {
    near_.replace(slot, model.springs[slot], nearLength(model.springs[slot]));
  }
  std::vector<VertexId> around;
  for (const VertexEdit& edit : edits) {
    near_.put(edit.id);
    const std::vector<VertexId> ring = model.mesh.neighbours(edit.id);
    around.push_back(edit.id);
    around.insert(around.end(), ring.begin(), ring.end());
  }
  for (const std::int32_t slot : model.springs.springsOnAny(around)) near_.lookAt(slot);
}

void Tearing::watch(const Model& model) {
  if (near_.empty()) watchFrom(0, model);
}

void Tearing::watchFrom(std::size_t first, const Model& model) {
  const std::size_t candidates = settings_.seam ? onSeam_.size() : model.springs.slots().size();
  near_.reserve(candidates);
  for (std::size_t k = first; k < candidates; ++k) {
    const Spring& spring = model.springs[candidate(k)];
    spring.exists() ? near_.watch(spring, nearLength(spring)) : near_.watchNothing();
  }
}

/// From which on it may fail within a step [m].
double Tearing::nearLength(const Spring& spring) const {
  return (1.0 + kNear * (ratioOf(spring) - 1.0)) * spring.restLength;
}

std::vector<Tearing::Overload> Tearing::findOverloads(const Model& model, const State& state) {
  std::vector<Overload> found;
  worst_ = 0.0;
  watch(model);
  for (const std::int32_t k : near_.find(state.x)) {
    const std::int32_t slot = candidate(static_cast<std::size_t>(k));
    const Spring& spring = model.springs[slot];
    const double ratio = ratioOf(spring);
    const double stretched = stretch(spring, state);
    const double load = (stretched - 1.0) / (ratio - 1.0);
    if (load > worst_ && idle_.count(slot) == 0) worst_ = load;
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
  watch(model);
  for (const std::int32_t k : near_.find(state.x)) {
    const std::int32_t slot = candidate(static_cast<std::size_t>(k));
    if (idle_.count(slot) != 0) continue;
    const Spring& spring = model.springs[slot];
    limits.push_back({spring.a, spring.b, ratioOf(spring) * spring.restLength});
  }
}

CutPlan Tearing::plan(const Model& model, const State& state, double dt) {
  CutPlan plan;
  plan.cause = FailureCause::kTear;
  plan.refine = settings_.refineTip;
  strides_.clear();
  plannedAt_ = state.t;
  if (!settings_.enabled) return plan;
  forget(model.mesh, state.t);
  std::vector<Vec2> begun;  // where strides of this plan are
  for (const Overload& overload : findOverloads(model, state)) {
    if (idle_.count(overload.slot) != 0) continue;
    plan.overloaded.push_back(overload.slot);
    const Spring& spring = model.springs[overload.slot];
    const std::vector<FaceId> faces = facesUnder(model.mesh, spring);
    const Vec2 middle = middleOf(model.mesh, spring);
    const double edge = longestEdgeOf(model.mesh, faces);
    const auto isNear = [&](const Vec2& p) { return (p - middle).norm() < kGrip * edge; };
    if (std::any_of(begun.begin(), begun.end(), isNear)) continue;
    const VertexId tip = nearestTip(model.mesh, middle, kGrip * edge);
    if (tip != kNone && tips_.at(tip) > state.t) continue;
    // A spring may have crossed the seam before an edit moved it.
    if (settings_.seam && !mayOpenSeam(model, spring)) continue;
    std::optional<SurfacePath> line = seamLine(model.mesh, spring, faces);
    const bool begins = tip == kNone && !line;
    if (begins && isShaded(middle, edge, state.t)) continue;
    if (!line && isInBand(model.mesh, spring)) line = lineFor(model, state, spring, faces, tip);
    if (!line) continue;
    const double ready = tip == kNone ? 0.0 : tips_.at(tip);
    strides_.push_back(
        {std::max(ready, state.t - dt), lengthOf(*line), overload.slot, placesOf(*line)});
    begun.push_back(tip == kNone ? middle : model.mesh.material(tip));
    plan.paths.push_back(std::move(*line));
  }
  std::sort(plan.overloaded.begin(), plan.overloaded.end());
  return plan;
}

/// Along the seam, for a spring that crosses it or ends on it.
std::optional<SurfacePath> Tearing::seamLine(const TriangleMesh& mesh, const Spring& spring,
                                             const std::vector<FaceId>& faces) const {
  if (!settings_.seam) return std::nullopt;
  const MaterialPath& seam = settings_.seam->path;
  const auto at = crossingOf(seam, mesh.material(spring.a), mesh.material(spring.b));
  if (at) return seamOver(mesh, faces, seam, *at);
  const VertexId end = endOn(mesh, spring, seam);
  return end == kNone ? std::nullopt : seamFrom(mesh, end, seam);
}

/// Whether a spring may tear elsewhere than along the seam.
bool Tearing::isInBand(const TriangleMesh& mesh, const Spring& spring) const {
  if (!settings_.seam) return true;
  const Seam& seam = *settings_.seam;
  return seam.halfWidth > 0.0 && distanceTo(seam.path, middleOf(mesh, spring)) <= seam.halfWidth;
}

std::optional<SurfacePath> Tearing::lineFor(const Model& model, const State& state,
                                            const Spring& spring, const std::vector<FaceId>& faces,
                                            VertexId tip) const {
  const TriangleMesh& mesh = model.mesh;
  const VertexId origin = tip == kNone ? borderVertex(mesh, faces) : tip;
  const Vec2 tension = tensionDirection(model, state, origin == kNone ? spring.a : origin);
  const Vec2 along(-tension.y(), tension.x());
  const Vec2 middle = middleOf(mesh, spring);
  return origin == kNone ? lineThrough(mesh, faces, middle, along)
                         : rayFrom(mesh, origin, along, middle);
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

bool Tearing::isShaded(const Vec2& p, double edge, double time) const {
  const double reach = kShade * edge;
  const auto isNear = [&](const Vec2& place) { return (place - p).norm() < reach; };
  const auto shades = [&](const Run& run) {
    return run.time >= time - reach / settings_.tipSpeed && isNear(run.at);
  };
  const auto willShade = [&](const Stride& stride) {
    return std::any_of(stride.places.begin(), stride.places.end(), isNear);
  };
  return std::any_of(runs_.begin(), runs_.end(), shades) ||
         std::any_of(strides_.begin(), strides_.end(), willShade);
}

void Tearing::forget(const TriangleMesh& mesh, double time) {
  const auto old = [time](const Run& run) { return run.time < time - kMemory; };
  runs_.erase(std::remove_if(runs_.begin(), runs_.end(), old), runs_.end());
  for (auto tip = tips_.begin(); tip != tips_.end();) {
    tip = isTip(mesh, tip->first) ? std::next(tip) : tips_.erase(tip);
  }
}

void Tearing::shiftTime(double by) {
  plannedAt_ += by;
  for (auto& [tip, ready] : tips_) ready += by;
  for (Run& run : runs_) run.time += by;
  for (Stride& stride : strides_) stride.start += by;
}

void Tearing::noteOpened(const SurgeryResult& result) {
  if (result.changes.mesh.empty()) {
    for (const Stride& stride : strides_) idle_.insert(stride.slot);
  }
  for (std::size_t k = 0; k < strides_.size(); ++k) {
    for (const Vec2& place : strides_[k].places) runs_.push_back({place, plannedAt_});
    const double ready = strides_[k].start + strides_[k].length / settings_.tipSpeed;
    for (VertexId tip : {result.tips[2 * k], result.tips[2 * k + 1]}) tips_[tip] = ready;
  }
}

void Tearing::noteTips(const SurgeryResult& result) {
  for (VertexId tip : result.tips) tips_.emplace(tip, kLongAgo);
}

}  // namespace cloth_sim
