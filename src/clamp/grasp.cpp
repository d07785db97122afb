/// \file Grasping: which particles a clamp holds, and where in its frame.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cloth_sim/clamp/clamp.h"

namespace cloth_sim {
namespace {

/// Tells whether `p` is inside the box from `low` to `high`, or on its border up to round-off.
bool isWithin(const Vec2& p, const Vec2& low, const Vec2& high) {
  constexpr double kRoundOff = 1e-9;  // of the box's own size
  const Vec2 slack = kRoundOff * (high - low).cwiseAbs();
  return ((p - low + slack).array() >= 0.0).all() && ((high + slack - p).array() >= 0.0).all();
}

}  // namespace

std::vector<VertexId> patchParticles(const Model& model, const ClampPatch& patch) {
  if (patch.cloth >= model.cloths.size()) {
    throw std::invalid_argument("the patch is on a cloth that does not exist");
  }
  const ClothPart& cloth = model.cloths[patch.cloth];
  if (!cloth.grid) throw std::invalid_argument("a patch needs a cloth that is a grid");
  const Grid& grid = *cloth.grid;
  if (patch.column < 0 || patch.column >= grid.columns || patch.row < 0 || patch.row >= grid.rows ||
      patch.radius < 0) {
    throw std::invalid_argument("the patch's centre is outside of the grid");
  }
  const int radius = std::min(patch.radius, std::max(grid.columns, grid.rows));
  const int left = std::max(patch.column - radius, 0);
  const int right = std::min(patch.column + radius, grid.columns - 1);
  const int bottom = std::max(patch.row - radius, 0);
  const int top = std::min(patch.row + radius, grid.rows - 1);

  const auto vertex = [&](int i, int j) { return cloth.firstVertex + grid.vertex(i, j); };
  std::vector<VertexId> particles;
  for (int j = bottom; j <= top; ++j) {
    for (int i = left; i <= right; ++i) particles.push_back(vertex(i, j));
  }
  // Later vertices were made by edits; their material coordinates tell where they belong.
  const ClothPart& last = model.cloths.back();
  for (VertexId v = last.firstVertex + last.vertices; v < model.mesh.vertexCount(); ++v) {
    const Vec2& low = model.mesh.material(vertex(left, bottom));
    const Vec2& high = model.mesh.material(vertex(right, top));
    if (isWithin(model.mesh.material(v), low, high)) particles.push_back(v);
  }
  return particles;
}

/// Takes the particles that the plates have met in this step; all between them once the gap has
/// closed.
void Clamp::grasp(const Model& model, const State& state, double gapBefore, double dt) {
  if (gap_ <= spec_.gapClosed) state_ = ClampState::kClosed;
  if (spec_.patch) {
    graspPatch(model, state);
  } else {
    graspRegion(state, gapBefore, dt);
  }
  updateHeld();
}

void Clamp::graspPatch(const Model& model, const State& state) {
  for (const VertexId v : patchParticles(model, *spec_.patch)) take(v, pose_.toLocal(state.x[v]));
}

/// Takes particles that are between the plates now, or were a step ago and have outrun a plate.
void Clamp::graspRegion(const State& state, double gapBefore, double dt) {
  const Eigen::Matrix3d toLocal = pose_.orientation.conjugate().toRotationMatrix();
  const Vec2 halfPlate = 0.5 * spec_.plateSize;
  const VertexId count = static_cast<VertexId>(state.x.size());
  for (VertexId v = 0; v < count; ++v) {
    const Vec3 arm = state.x[v] - pose_.position;
    const Vec3 local = toLocal * arm;
    if (std::abs(local.x()) > halfPlate.x() || std::abs(local.y()) > halfPlate.y()) continue;
    const Vec3 velocity = state.v[v] - linearVelocity_ - angularVelocity_.cross(arm);
    const double before = local.z() - dt * toLocal.row(2).dot(velocity);
    if (std::min(std::abs(local.z()), std::abs(before)) <= 0.5 * gapBefore) take(v, local);
  }
}

/// Holds a particle if a plate has reached it or the clamp has closed.
void Clamp::take(VertexId vertex, const Vec3& local) {
  const bool reached = std::abs(local.z()) >= 0.5 * gap_;
  if (!reached && state_ != ClampState::kClosed) return;
  if (findGrip(vertex)) return;
  grips_.push_back({vertex, local, 0.0});
}

/// Moves held particles from beyond a plate towards it, no faster than a plate closes.
void Clamp::squeeze(Squeeze how, double dt) {
  const double travel = 0.5 * spec_.closingSpeed * dt;
  const auto squeezed = [&](double height) {
    return std::min(height, std::max(0.5 * gap_, height - travel));
  };
  double highest = 0.0;
  for (const Grip& grip : grips_) highest = std::max(highest, std::abs(grip.local.z()));
  const double top = squeezed(highest);
  const double factor = highest > 0.0 ? top / highest : 1.0;
  for (Grip& grip : grips_) {
    const double before = grip.local.z();
    const double height = std::abs(before);
    // Not above the top by round-off, or the squeezing would not end.
    const double after = how == Squeeze::kEach ? squeezed(height) : std::min(top, factor * height);
    grip.local.z() = std::copysign(after, before);
    grip.squeeze = (grip.local.z() - before) / dt;
  }
}

/// Searches the first held_.size() grips, which are sorted; later ones are new in this step.
const Clamp::Grip* Clamp::findGrip(VertexId vertex) const {
  const auto it = std::lower_bound(held_.begin(), held_.end(), vertex);
  if (it == held_.end() || *it != vertex) return nullptr;
  return &grips_[static_cast<std::size_t>(it - held_.begin())];
}

void Clamp::updateHeld() {
  std::sort(grips_.begin(), grips_.end(),
            [](const Grip& a, const Grip& b) { return a.vertex < b.vertex; });
  held_.clear();
  for (const Grip& grip : grips_) held_.push_back(grip.vertex);
}

void Clamp::applyChanges(const MeshChanges& changes) {
  if (grips_.empty()) return;
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.kind == VertexEdit::Kind::kRemove) {
      replaceHeld(edit);
    } else if (edit.isNew()) {
      holdNew(edit);
    }
  }
}

void Clamp::holdNew(const VertexEdit& edit) {
  Grip blend;
  blend.vertex = edit.id;
  for (std::size_t k = 0; k < edit.from.size() && edit.from[k] != kNone; ++k) {
    const Grip* source = findGrip(edit.from[k]);
    if (source == nullptr) return;
    blend.local += edit.weight[k] * source->local;
    blend.squeeze += edit.weight[k] * source->squeeze;
  }
  // New ids are the highest, so what is appended keeps the order and is found at once.
  grips_.push_back(blend);
  held_.push_back(edit.id);
}

void Clamp::replaceHeld(const VertexEdit& edit) {
  const auto gone = [&](const Grip& grip) { return grip.vertex == edit.id; };
  grips_.erase(std::remove_if(grips_.begin(), grips_.end(), gone), grips_.end());
  for (Grip& grip : grips_) {
    if (grip.vertex == edit.from[0]) grip.vertex = edit.id;
  }
  updateHeld();
}

}  // namespace cloth_sim
