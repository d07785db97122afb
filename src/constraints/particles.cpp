#include "particles.h"

#include <atomic>
#include <numeric>

#include "linalg/vector_operations.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// See Particles: spans of one and two columns both map to contiguous stretches.
constexpr int kInterleave = 4;

/// Place of column i within a stored row.
int packedColumn(int i, int columns) {
  int place = i / kInterleave;
  for (int residue = 0; residue < i % kInterleave; ++residue) {
    place += (columns - residue + kInterleave - 1) / kInterleave;
  }
  return place;
}

/// Slots that may be empty because their particles were taken away: more than any run leaves.
constexpr std::int32_t kMostEmpty = 1 << 22;

/// Counts instead of leaving early, so that it can be vectorised.
CLOTH_SIM_VECTOR_CLONES
bool partIsSlower(std::size_t first, std::size_t count, const VectorArray& x, const VectorArray& v,
                  double square) {
  const double* const px = x.x.data() + first;
  const double* const py = x.y.data() + first;
  const double* const pz = x.z.data() + first;
  const double* const vx = v.x.data() + first;
  const double* const vy = v.y.data() + first;
  const double* const vz = v.z.data() + first;
  std::int64_t good = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double none = 0.0 * px[k] + 0.0 * py[k] + 0.0 * pz[k];  // or NaN
    const double speed = vx[k] * vx[k] + vy[k] * vy[k] + vz[k] * vz[k];
    good += speed + none <= square ? 1 : 0;
  }
  return good == static_cast<std::int64_t>(count);
}

}  // namespace

void Particles::layOut(const Model& model) {
  slotOf.resize(static_cast<std::size_t>(model.particleCount()));
  std::iota(slotOf.begin(), slotOf.end(), 0);
  for (const ClothPart& cloth : model.cloths) {
    if (!cloth.grid) continue;
    const Grid& grid = *cloth.grid;
    for (int j = 0; j < grid.rows; ++j) {
      const VertexId row = cloth.firstVertex + grid.vertex(0, j);
      for (int i = 0; i < grid.columns; ++i) slotOf[row + i] = row + packedColumn(i, grid.columns);
    }
  }
  slots = count();
  resize();
}

void Particles::applyChanges(const MeshChanges& changes) {
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.isNew()) {
      slotOf.push_back(slots++);
    } else if (edit.kind == VertexEdit::Kind::kRemove) {
      slotOf[edit.id] = std::int32_t{slotOf[edit.from[0]]};
      slotOf.pop_back();
    }
  }
  resize();
}

void Particles::resize() {
  const auto n = static_cast<std::size_t>(slots);
  for (VectorArray* vectors : {&x, &start, &v}) vectors->resize(n);
  mass.assign(n, 0.0);
  inverseMass.assign(n, 0.0);
}

void Particles::load(const State& state) {
  bendOffset = state.bendOffset;
  forParts(slotOf.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      x.set(slotOf[k], state.x[k]);
      v.set(slotOf[k], state.v[k]);
    }
  });
}

void Particles::store(State& state) const {
  state.bendOffset = bendOffset;
  forParts(slotOf.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      state.x[k] = x.at(slotOf[k]);
      state.v[k] = v.at(slotOf[k]);
    }
  });
}

bool Particles::areSlowerThan(double speed) const {
  std::atomic<bool> all = true;
  forParts(static_cast<std::size_t>(slots), [&](std::size_t first, std::size_t count) {
    if (!partIsSlower(first, count, x, v, speed * speed)) all = false;
  });
  return all;
}

void Particles::loadMasses(const Model& model, const std::vector<KinematicTarget>& kinematic) {
  // Slots of particles that were taken away keep a mass of zero.
  for (VertexId k = 0; k < count(); ++k) mass[slotOf[k]] = model.mass[k];
  for (const KinematicTarget& target : kinematic) mass[slotOf[target.vertex]] = 0.0;
  for (std::size_t k = 0; k < mass.size(); ++k) {
    inverseMass[k] = mass[k] > 0.0 ? 1.0 / mass[k] : 0.0;
  }
}

ParticleView Particles::view() {
  ParticleView view = particleView(x, start, mass.data());
  view.slotOf = slotOf.data();
  return view;
}

ParticleView particleView(VectorArray& x, const VectorArray& start, const double* mass) {
  ParticleView view;
  view.x = x.x.data();
  view.y = x.y.data();
  view.z = x.z.data();
  view.startX = start.x.data();
  view.startY = start.y.data();
  view.startZ = start.z.data();
  view.mass = mass;
  return view;
}

std::string Particles::validationError(std::int32_t vertices) const {
  if (count() != vertices) return "the layout is that of another number of particles";
  if (slots < vertices || slots - vertices > kMostEmpty) return "the layout has no such slots";
  std::vector<bool> isTaken(static_cast<std::size_t>(slots), false);
  for (const std::int32_t slot : slotOf) {
    if (slot < 0 || slot >= slots) return "a particle has a slot that does not exist";
    if (isTaken[static_cast<std::size_t>(slot)]) return "two particles have one slot";
    isTaken[static_cast<std::size_t>(slot)] = true;
  }
  return "";
}

}  // namespace cloth_sim
