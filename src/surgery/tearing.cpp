#include "cloth_sim/surgery/tearing.h"

#include <algorithm>
#include <unordered_map>

namespace cloth_sim {
namespace {

/// The faces around `v` that reach to the left of the crack.
template <typename Side>
std::vector<FaceId> facesReachingLeft(const TriangleMesh& mesh, VertexId v, const Side& side) {
  std::vector<FaceId> faces;
  for (FaceId f : mesh.facesAround(v)) {
    const Face& face = mesh.face(f);
    const bool left = std::any_of(face.begin(), face.end(),
                                  [&](VertexId w) { return side(mesh.material(w)) < 0.0; });
    if (left) faces.push_back(f);
  }
  return faces;
}

/// Opens the surface at the first of a spring's vertices that lies to the right of the crack and
/// has faces on both sides.
template <typename Side>
std::optional<Opening> openingFor(const Model& model, std::int32_t slot, const Side& side) {
  const Spring& spring = model.springs[slot];
  const bool bend = spring.kind == SpringKind::kBend;
  for (VertexId v : {spring.a, spring.b, bend ? spring.support[0] : kNone}) {
    if (v == kNone || side(model.mesh.material(v)) < 0.0) continue;
    std::vector<FaceId> detach = facesReachingLeft(model.mesh, v, side);
    if (!detach.empty() && detach.size() < model.mesh.facesAround(v).size()) {
      return Opening{v, std::move(detach), {slot}};
    }
  }
  return std::nullopt;
}

bool straddles(const Model& model, const Spring& spring, const MaterialPath& path) {
  const Vec2& p = model.mesh.material(spring.a);
  const Vec2& q = model.mesh.material(spring.b);
  return (sideOf(path, p) < 0.0) != (sideOf(path, q) < 0.0) && crosses(path, p, q);
}

std::optional<Opening> openAlong(const Model& model, std::int32_t slot, const MaterialPath& path) {
  return openingFor(model, slot, [&](const Vec2& p) { return sideOf(path, p); });
}

/// Opens across the spring itself: the crack is its perpendicular bisector, with the right side
/// where the surface has opened already, so that a crack goes on from its tip.
std::optional<Opening> openAcross(const Model& model, std::int32_t slot) {
  const Spring& spring = model.springs[slot];
  const Vec2& p = model.mesh.material(spring.a);
  const Vec2& q = model.mesh.material(spring.b);
  const Vec2 middle = 0.5 * (p + q);
  const Vec2 across = (q - p).normalized();
  const auto towards = [&](double sign) {
    return openingFor(model, slot, [&, sign](const Vec2& r) {
      // The end itself is right of the bisector, its neighbours along the crack are too.
      return sign * across.dot(r - middle);
    });
  };
  const bool openAtA = model.mesh.isBoundary(spring.a) && !model.mesh.isBoundary(spring.b);
  std::optional<Opening> first = towards(openAtA ? -1.0 : 1.0);
  return first ? first : towards(openAtA ? 1.0 : -1.0);
}

/// Openings in the order of the first spring that asked for each; later ones join it.
class OpeningList {
 public:
  void add(std::optional<Opening> opening) {
    if (!opening) return;
    const auto [known, isNew] = byVertex_.try_emplace(opening->vertex, openings_.size());
    if (isNew) {
      openings_.push_back(std::move(*opening));
    } else {
      openings_[known->second].springs.push_back(opening->springs.front());
    }
  }
  std::vector<Opening> take() { return std::move(openings_); }

 private:
  std::vector<Opening> openings_;
  std::unordered_map<VertexId, std::size_t> byVertex_;
};

}  // namespace

const char* toString(FailureCause cause) { return cause == FailureCause::kTear ? "torn" : "cut"; }

Tearing::Tearing(TearingSettings settings, const Model& model) : settings_(std::move(settings)) {
  const auto slots = static_cast<std::int32_t>(model.springs.slots().size());
  for (std::int32_t slot = 0; slot < slots; ++slot) {
    if (allowed(model, model.springs[slot])) candidates_.push_back(slot);
  }
}

bool Tearing::allowed(const Model& model, const Spring& spring) const {
  if (!spring.exists()) return false;
  if (!settings_.seam) return true;
  const Seam& seam = *settings_.seam;
  if (straddles(model, spring, seam.path)) return true;
  const Vec2 middle = 0.5 * (model.mesh.material(spring.a) + model.mesh.material(spring.b));
  return seam.halfWidth > 0.0 && distanceTo(seam.path, middle) <= seam.halfWidth;
}

void Tearing::follow(const Model& model, const ModelChanges& changes) {
  for (std::int32_t slot : changes.springs.added) {
    if (allowed(model, model.springs[slot])) candidates_.push_back(slot);
  }
}

std::vector<Opening> Tearing::plan(const Model& model, const State& state) const {
  std::vector<Opening> openings;
  if (!settings_.enabled) return openings;
  std::vector<std::pair<double, std::int32_t>> overloaded;
  for (std::int32_t slot : candidates_) {
    const Spring& spring = model.springs[slot];
    if (!spring.exists()) continue;
    const double overload =
        stretch(spring, state) / settings_.ratio[static_cast<std::size_t>(spring.kind)];
    if (overload > 1.0) overloaded.emplace_back(-overload, slot);
  }
  std::sort(overloaded.begin(), overloaded.end());
  OpeningList list;
  for (const auto& [overload, slot] : overloaded) {
    const bool onSeam =
        settings_.seam && straddles(model, model.springs[slot], settings_.seam->path);
    list.add(onSeam ? openAlong(model, slot, settings_.seam->path) : openAcross(model, slot));
  }
  return list.take();
}

std::vector<Opening> planNotch(const Model& model, const MaterialPath& path) {
  OpeningList list;
  const auto slots = static_cast<std::int32_t>(model.springs.slots().size());
  for (std::int32_t slot = 0; slot < slots; ++slot) {
    const Spring& spring = model.springs[slot];
    if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
    if (straddles(model, spring, path)) list.add(openAlong(model, slot, path));
  }
  return list.take();
}

}  // namespace cloth_sim
