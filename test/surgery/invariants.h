#pragma once
/// \file Invariants of operations on a cloth. Each function returns a message about the first
/// violation, empty if there is none.

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "cloth_sim/surgery/operation.h"
#include "mesh/quality.h"
#include "unit/core_support.h"

namespace cloth_sim::surgery_support {

using namespace testing_support;

/// Tolerance of conserved quantities, relative to the sum of the magnitudes of their terms.
constexpr double kConserved = 1e-12;

/// Concatenates the parts of a message.
template <typename... Parts>
std::string say(const Parts&... parts) {
  std::ostringstream text;
  text.precision(17);
  (text << ... << parts);
  return text.str();
}

/// Conserved quantities, and the scales of their rounding errors.
struct Totals {
  Totals(const Model& model, const State& state)
      : area(preciseArea(model.mesh)),
        mass(totalMass(model)),
        linear(linearMomentum(model, state)),
        angular(angularMomentum(model, state, Vec3::Zero())) {
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      const double p = model.mass[v] * state.v[v].norm();
      linearScale += p;
      angularScale += p * state.x[v].norm();
    }
  }
  double area, mass;
  Vec3 linear, angular;
  double linearScale = 0.0;
  double angularScale = 0.0;
};

/// Checks that mass, rest area and momentum are conserved.
inline std::string validateTotals(const Totals& before, const Totals& after) {
  const auto off = [](double a, double b, double scale) {
    return std::abs(a - b) > kConserved * scale;
  };
  if (off(before.area, after.area, before.area)) {
    return say("rest area ", before.area, " -> ", after.area);
  }
  if (off(before.mass, after.mass, before.mass)) {
    return say("mass ", before.mass, " -> ", after.mass);
  }
  const double linear = (after.linear - before.linear).norm();
  if (linear > kConserved * before.linearScale) {
    return say("linear momentum is off by ", linear / before.linearScale, " of sum m |v|");
  }
  const double angular = (after.angular - before.angular).norm();
  if (angular > kConserved * before.angularScale) {
    return say("angular momentum is off by ", angular / before.angularScale, " of sum m |x| |v|");
  }
  return "";
}

/// A set of faces by the material coordinates of their corners, independent of their numbers.
class Shapes {
 public:
  explicit Shapes(const TriangleMesh& mesh) {
    for (FaceId f = 0; f < mesh.faceCount(); ++f) known_.insert(keyOf(mesh, f));
  }
  bool has(const TriangleMesh& mesh, FaceId f) const { return known_.count(keyOf(mesh, f)) != 0; }

 private:
  using Key = std::array<std::array<double, 2>, 3>;
  static Key keyOf(const TriangleMesh& mesh, FaceId f) {
    Key key;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2& p = mesh.material(mesh.face(f)[k]);
      key[k] = {p.x(), p.y()};
    }
    std::sort(key.begin(), key.end());
    return key;
  }
  std::set<Key> known_;
};

/// Checks that angles and edges are within the limits. Faces of the original mesh may have smaller
/// angles.
inline std::string validateShapes(const TriangleMesh& mesh, const ShapeLimits& limits,
                                  const Shapes& original) {
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const double angle = minAngle(mesh, f);
    if (angle < limits.minAngle - 1e-9 && !original.has(mesh, f)) {
      return say("face ", f, " has an angle of ", angle * 180.0 / M_PI, " degrees");
    }
  }
  const double edge = shortestEdge(mesh);
  if (edge < limits.minEdge * (1.0 - 1e-12)) return say("an edge of ", edge, " m");
  return "";
}

/// Checks the sizes and revisions of all data per vertex, and that masses fit the rest areas.
inline std::string validateSizes(const Model& model, const State& state) {
  const auto n = static_cast<std::size_t>(model.particleCount());
  const std::uint64_t revision = model.mesh.revision();
  const auto fits = [&](const auto& data) {
    return data.size() == n && data.revision() == revision;
  };
  if (!fits(state.x) || !fits(state.v)) return "the state does not fit the mesh";
  if (!fits(model.mass)) return "the masses do not fit the mesh";
  if (!fits(model.arealDensity)) return "the areal densities do not fit the mesh";
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const double lumped = model.arealDensity[v] * areaAround(model.mesh, v) / 3.0;
    if (!(model.mass[v] > 0.0) || std::abs(model.mass[v] - lumped) > 1e-12 * lumped) {
      return say("particle ", v, " has mass ", model.mass[v], ", its area says ", lumped);
    }
  }
  return isFinite(state) ? "" : "the state is not finite";
}

/// Checks that springs have valid ends, supports and constants, and that each is listed and
/// counted.
inline std::string validateSprings(const Model& model) {
  const SpringNetwork& springs = model.springs;
  const auto exists = [&](VertexId v) { return v >= 0 && v < model.particleCount(); };
  std::array<int, kSpringKinds> count{};
  for (std::size_t slot = 0; slot < springs.slots().size(); ++slot) {
    const Spring& s = springs.slots()[slot];
    if (!s.exists()) continue;
    ++count[static_cast<std::size_t>(s.kind)];
    const bool bend = s.kind == SpringKind::kBend;
    if (!exists(s.a) || !exists(s.b) || s.a == s.b) return say("spring ", slot, " has no ends");
    if (!exists(s.support[0]) || (bend ? s.support[1] != kNone : !exists(s.support[1]))) {
      return say("spring ", slot, " has no support");
    }
    if (!bend && model.mesh.facesOnEdge(s.support[0], s.support[1])[0] == kNone) {
      return say("spring ", slot, " stands on an edge that there is not");
    }
    if (!(s.restLength > 0.0) || !(s.stiffness >= 0.0) || !std::isfinite(s.stiffness)) {
      return say("spring ", slot, " has constants ", s.restLength, ", ", s.stiffness);
    }
    for (VertexId v : s.support) {
      if (v == kNone) continue;
      const auto& standing = springs.springsOn(v);
      if (std::count(standing.begin(), standing.end(), static_cast<std::int32_t>(slot)) != 1) {
        return say("spring ", slot, " is not listed at ", v);
      }
    }
  }
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    if (springs.count(static_cast<SpringKind>(kind)) != count[kind]) return "springs miscounted";
  }
  return springs.validationError(model.mesh, SpringNetwork());  // what a saved state must pass
}

/// Checks that a network has the springs that one built from scratch on its mesh has, with the same
/// ends and supports.
/// \param renumbered  vertices were renumbered since the springs were made. Of two neighbours in
///        equally straight directions (the lips of a slit, or mirror images), a bend spring joins
///        the one with the lower number. So only the bridged vertices of bend springs are compared
///        then.
inline std::string validateNetwork(const SpringNetwork& have, const SpringNetwork& want,
                                   bool renumbered) {
  using Key = std::array<VertexId, 5>;
  const auto keyed = [renumbered](const SpringNetwork& network) {
    std::map<Key, Spring> map;
    for (const Spring& s : network.slots()) {
      if (!s.exists()) continue;
      if (renumbered && s.kind == SpringKind::kBend) {
        map[{2, static_cast<VertexId>(s.direction), 0, 0, s.support[0]}];
        continue;
      }
      map[{static_cast<VertexId>(s.kind), std::min(s.a, s.b), std::max(s.a, s.b),
           std::min(s.support[0], s.support[1]), std::max(s.support[0], s.support[1])}] = s;
    }
    return map;
  };
  const std::map<Key, Spring> ours = keyed(have);
  const std::map<Key, Spring> theirs = keyed(want);
  if (have.count() != want.count() || ours.size() != theirs.size()) {
    return say(have.count(), " springs, from scratch there are ", want.count());
  }
  for (const auto& [key, spring] : theirs) {
    const auto at = ours.find(key);
    const auto name = [&k = key] {
      return say(k[0], ": ", k[1], "-", k[2], " on ", k[3], "-", k[4]);
    };
    if (at == ours.end()) return "no spring " + name();
    const auto off = [](double a, double b) { return std::abs(a - b) > 1e-9 * std::abs(b); };
    if (off(at->second.stiffness, spring.stiffness) || off(at->second.damping, spring.damping) ||
        off(at->second.restLength, spring.restLength)) {
      return say("stiffness ", at->second.stiffness, ", from scratch ", spring.stiffness, " of ",
                 name());
    }
  }
  return "";
}

/// Checks the result of an operation: it reports springs that existed, each once; vertices that are
/// not touched have not changed by a single bit; and its edits lead from the old mesh to the new
/// one.
inline std::string validateResult(const SurgeryResult& result, const Model& before,
                                  const State& stateBefore, const Model& after,
                                  const State& state) {
  const ModelChanges& changes = result.changes;
  std::set<std::int32_t> removed(changes.springs.removed.begin(), changes.springs.removed.end());
  if (removed.size() != changes.springs.removed.size()) return "a slot was removed twice";
  if (changes.springs.removedSprings.size() != removed.size()) return "removed springs are missing";
  // Springs may join the same ends: over the two sides of a slit, over two spokes of a vertex.
  std::multiset<std::pair<VertexId, VertexId>> there;
  for (const Spring& spring : before.springs.slots()) there.emplace(spring.a, spring.b);
  for (const FailureEvent& event : result.events) {
    if (!event.position.allFinite() || !event.material.allFinite() ||
        !std::isfinite(event.stretch) || event.stretch < 0.0) {
      return "an event is not finite";
    }
    const auto found = there.find({event.a, event.b});
    if (found == there.end()) return say("no spring ", event.a, "-", event.b, " that could fail");
    there.erase(found);
  }
  if (!std::isfinite(result.length) || !std::isfinite(result.deviation)) return "length not finite";
  for (VertexId tip : result.tips) {
    if (tip < 0 || tip >= after.particleCount()) return say("no vertex ", tip, " for a tip");
  }
  if (changes.mesh.empty()) {
    return stateHash(before, stateBefore) == stateHash(after, state) ? "" : "changed in silence";
  }
  VertexData<Vec2> material(before.mesh.material(), before.mesh.revision());
  material.applyChanges(changes.mesh);
  if (material.values() != after.mesh.material()) return "the edits lead to another mesh";
  if (!changes.mesh.removedFaces.empty()) return "";  // vertices have other numbers now
  const std::vector<VertexId>& touched = changes.mesh.touched;
  for (VertexId v = 0; v < before.particleCount(); ++v) {
    if (std::binary_search(touched.begin(), touched.end(), v)) continue;
    if (state.x[v] != stateBefore.x[v] || state.v[v] != stateBefore.v[v] ||
        after.mass[v] != before.mass[v] || after.arealDensity[v] != before.arealDensity[v]) {
      return say("vertex ", v, " changed without being touched");
    }
  }
  return "";
}

}  // namespace cloth_sim::surgery_support
