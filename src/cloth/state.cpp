#include "cloth_sim/cloth/state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "cloth_sim/cloth/bend_friction.h"
#include "support/hash.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "coordinates are contiguous");

/// Returns whether all values are finite. A sum is finite only if every term is, and needs no
/// branch per term; several independent sums hide the latency of the additions.
bool allFinite(const VertexData<Vec3>& data) {
  constexpr std::size_t kSums = 12;
  static_assert(kSums % 3 == 0, "each block has whole particles");
  std::array<double, kSums> sums{};
  const std::vector<Vec3>& values = data.values();
  std::size_t k = 0;
  for (; k + kSums / 3 <= values.size(); k += kSums / 3) {
    const double* const p = values[k].data();
    for (std::size_t lane = 0; lane < kSums; ++lane) sums[lane] += std::abs(p[lane]);
  }
  for (; k < values.size(); ++k) sums[0] += values[k].cwiseAbs().sum();
  return std::isfinite(std::accumulate(sums.begin(), sums.end(), 0.0));
}

void copyData(const VertexData<Vec3>& from, VertexData<Vec3>& to) {
  constexpr std::int32_t kGrain = 8192;  // particles for which a second thread pays
  if (to.size() != from.size() || to.revision() != from.revision()) {
    to = from;
    return;
  }
  parallelFor(static_cast<std::int32_t>(from.size()), kGrain, [&](VertexId first, VertexId last) {
    std::memcpy(to[first].data(), from[first].data(),
                static_cast<std::size_t>(last - first) * sizeof(Vec3));
  });
}

}  // namespace

void State::applyChanges(const MeshChanges& changes, const TriangleMesh& mesh) {
  x.applyChanges(changes);
  v.applyChanges(changes);
  if (bendOffset.empty()) return;
  const auto faces = static_cast<std::size_t>(mesh.faceCount());
  bendOffset.resize(faces + changes.removedFaces.size(), Vec3::Zero());
  for (const FaceId f : changes.removedFaces) {
    bendOffset[static_cast<std::size_t>(f)] = Vec3(bendOffset.back());
    bendOffset.pop_back();
  }
  for (const FaceId f : changes.reshapedFaces) bendOffset[static_cast<std::size_t>(f)].setZero();
}

bool isFinite(const State& state) { return allFinite(state.x) && allFinite(state.v); }

void copyState(const State& from, State& to) {
  copyData(from.x, to.x);
  copyData(from.v, to.v);
  to.t = from.t;
  to.bendOffset = from.bendOffset;
}

Energies energies(const Model& model, const State& state, const Vec3& gravity) {
  Energies e;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    e.kinetic += 0.5 * model.mass[v] * state.v[v].squaredNorm();
    e.gravity -= model.mass[v] * gravity.dot(state.x[v]);
  }
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const double extension = (state.x[spring.b] - state.x[spring.a]).norm() - spring.restLength;
    e.elastic += 0.5 * spring.stiffness * extension * extension;
  }
  e.elastic += model.bending.energy(state.x.values());
  if (!state.bendOffset.empty()) {
    e.elastic += slipEnergy(model.bending, model.mesh, state.x.values(), state.bendOffset);
  }
  return e;
}

Vec3 linearMomentum(const Model& model, const State& state) {
  Vec3 p = Vec3::Zero();
  for (VertexId v = 0; v < model.particleCount(); ++v) p += model.mass[v] * state.v[v];
  return p;
}

Vec3 angularMomentum(const Model& model, const State& state, const Vec3& about) {
  Vec3 l = Vec3::Zero();
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    l += (state.x[v] - about).cross(model.mass[v] * state.v[v]);
  }
  return l;
}

Vec3 centreOfMass(const Model& model, const State& state) {
  Vec3 moment = Vec3::Zero();
  for (VertexId v = 0; v < model.particleCount(); ++v) moment += model.mass[v] * state.x[v];
  return moment / totalMass(model);
}

double meanSpeed(const State& state) {
  double sum = 0.0;
  for (const Vec3& v : state.v) sum += v.norm();
  return sum / static_cast<double>(state.v.size());
}

double stretch(const Spring& spring, const State& state) {
  return (state.x[spring.b] - state.x[spring.a]).norm() / spring.restLength;
}

double maxStretch(const Model& model, const State& state) {
  double largest = 0.0;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists() || !traitsOf(spring.kind).isMembrane) continue;
    const double squared = (state.x[spring.b] - state.x[spring.a]).squaredNorm();
    largest = std::max(largest, squared / (spring.restLength * spring.restLength));
  }
  return std::sqrt(largest);
}

std::uint64_t stateHash(const Model& model, const State& state) {
  Hash hash;
  hash.add(&state.t, sizeof state.t);
  hash.add(state.x.values());
  hash.add(state.v.values());
  hash.add(model.mesh.faces());
  hash.add(state.bendOffset);
  return hash.value();
}

}  // namespace cloth_sim
