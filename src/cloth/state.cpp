#include "cloth_sim/cloth/state.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace cloth_sim {
namespace {

bool allFinite(const VertexData<Vec3>& data) {
  // A sum is finite only if every term is, and costs no branch per term.
  double sum = 0.0;
  for (const Vec3& p : data) sum += std::abs(p.x()) + std::abs(p.y()) + std::abs(p.z());
  return std::isfinite(sum);
}

class Fnv1a {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < bytes; ++k) {
      hash_ ^= p[k];
      hash_ *= 0x100000001b3ULL;
    }
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

bool isFinite(const State& state) { return allFinite(state.x) && allFinite(state.v); }

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
    if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
    const double squared = (state.x[spring.b] - state.x[spring.a]).squaredNorm();
    largest = std::max(largest, squared / (spring.restLength * spring.restLength));
  }
  return std::sqrt(largest);
}

std::uint64_t stateHash(const Model& model, const State& state) {
  Fnv1a hash;
  hash.add(&state.t, sizeof state.t);
  hash.add(state.x.values());
  hash.add(state.v.values());
  hash.add(model.mesh.faces());
  return hash.value();
}

}  // namespace cloth_sim
