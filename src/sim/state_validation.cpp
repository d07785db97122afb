#include "state_validation.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "archive.h"
#include "cloth_sim/validation.h"

namespace cloth_sim {
namespace {

constexpr double kLongest = 1e9;     ///< latest time of a state [s]
constexpr double kFarthest = 1e9;    ///< position [m]
constexpr double kFastest = 1e5;     ///< of a particle: ten times what ends a step [m/s]
constexpr double kMostCurved = 1e9;  ///< where a slider of bending friction is [1/m]
constexpr double kRounding = 1e-6;   ///< of sums of masses [-]
constexpr std::size_t kLongestText = 1000;
/// Largest distance of material coordinates from those of the undamaged cloth, over its size [-].
constexpr double kOutside = 1e-6;
/// Least area of a face, over that of the undamaged cloth [-]: edits leave far more.
constexpr double kLeastArea = 1e-15;

bool isVertexOf(const Model& model, VertexId v) { return v >= 0 && v < model.particleCount(); }

/// Tells whether data per vertex belong to the mesh as it is.
template <typename T>
bool fits(const VertexData<T>& data, const TriangleMesh& mesh) {
  return data.size() == static_cast<std::size_t>(mesh.vertexCount()) &&
         data.revision() == mesh.revision();
}

/// Tells whether all material coordinates lie within those of the undamaged cloths: edits add
/// vertices between others, and move them along lines between others.
bool liesWithin(const TriangleMesh& mesh, const TriangleMesh& undamaged) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : undamaged.material()) box.extend(p);
  const Vec2 slack = Vec2::Constant(kOutside * box.diagonal().norm());
  const Eigen::AlignedBox2d wider(Vec2(box.min() - slack), Vec2(box.max() + slack));
  return std::all_of(mesh.material().begin(), mesh.material().end(),
                     [&](const Vec2& p) { return wider.contains(p); });
}

/// Tells whether all faces have an area: edits leave no slivers.
bool haveAreas(const TriangleMesh& mesh, const TriangleMesh& undamaged) {
  const double least = kLeastArea * undamaged.totalRestArea();
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (!(mesh.restArea(f) >= least)) return false;
  }
  return true;
}

bool isElementOf(const Model& model, const PlateElement& element) {
  if (element.count != 0 && (element.count < 3 || element.count > PlateElement::kMostVertices)) {
    return false;
  }
  if (!isNotNegative(element.stiffness) || (element.count == 0 && element.stiffness != 0.0)) {
    return false;
  }
  const auto count = static_cast<std::size_t>(element.count);
  for (std::size_t k = 0; k < count; ++k) {
    if (!isVertexOf(model, element.vertex[k]) || !std::isfinite(element.weight[k])) return false;
    if (k > 0 && element.vertex[k] <= element.vertex[k - 1]) return false;
  }
  return true;
}

/// Tells whether the elements of a face have no more vertices together, with its corners, than one
/// may have: those of the patch around the face. Friction in bending takes them together.
bool areOfOnePatch(const Model& model, FaceId f) {
  constexpr std::size_t kPerFace = PlateBending::kPerFace;
  std::array<VertexId, 3 + kPerFace * PlateElement::kMostVertices> vertices;
  const Face& corners = model.mesh.face(f);
  auto end = std::copy(corners.begin(), corners.end(), vertices.begin());
  for (std::size_t k = 0; k < kPerFace; ++k) {
    const PlateElement& element =
        model.bending.elements()[kPerFace * static_cast<std::size_t>(f) + k];
    end = std::copy_n(element.vertex.begin(), element.count, end);
  }
  std::sort(vertices.begin(), end);
  return std::unique(vertices.begin(), end) - vertices.begin() <= PlateElement::kMostVertices;
}

std::string bendingError(const Model& model, const Model& undamaged) {
  const std::vector<PlateElement>& elements = model.bending.elements();
  if (model.bending.empty() != undamaged.bending.empty()) return "bending is not as in the scene";
  const std::string slipError = model.bending.slipError(model.mesh.faceCount());
  if (model.bending.empty() || !slipError.empty()) return slipError;
  if (elements.size() !=
      PlateBending::kPerFace * static_cast<std::size_t>(model.mesh.faceCount())) {
    return "bending elements are not three for each face";
  }
  const bool isWhole = std::all_of(elements.begin(), elements.end(),
                                   [&](const PlateElement& it) { return isElementOf(model, it); });
  if (!isWhole) return "a bending element is not one of the mesh";
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    if (!areOfOnePatch(model, f)) return "the bending elements of a face are of different faces";
  }
  return "";
}

/// Edits divide masses and areal densities, and average them: none leaves the range of the scene.
std::string massError(const Model& model, const Model& undamaged) {
  if (!fits(model.mass, model.mesh) || !fits(model.arealDensity, model.mesh)) {
    return "masses are not one for each particle";
  }
  const double whole = (1.0 + kRounding) * totalMass(undamaged);
  const double densest = (1.0 + kRounding) * *std::max_element(undamaged.arealDensity.begin(),
                                                               undamaged.arealDensity.end());
  const auto exceeds = [](double limit) { return [limit](double it) { return it > limit; }; };
  if (std::any_of(model.mass.begin(), model.mass.end(), exceeds(whole)) ||
      std::any_of(model.arealDensity.begin(), model.arealDensity.end(), exceeds(densest))) {
    return "a particle is heavier than in the scene";
  }
  const bool areMasses =
      std::all_of(model.mass.begin(), model.mass.end(), isPositive) &&
      std::all_of(model.arealDensity.begin(), model.arealDensity.end(), isPositive);
  return areMasses ? "" : "a mass is not positive";
}

/// Tells whether targets are those of existing vertices, ascending, once each.
bool areTargetsOf(const Model& model, const std::vector<KinematicTarget>& targets) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (!isVertexOf(model, targets[k].vertex)) return false;
    if (k > 0 && targets[k].vertex <= targets[k - 1].vertex) return false;
  }
  return true;
}

template <typename T>
std::string bytesOf(const T& value) {
  std::ostringstream out(std::ios::binary);
  StateWriter archive(out);
  archive(value);
  return out.str();
}

}  // namespace

bool isOneLine(const std::string& text) {
  return text.size() <= kLongestText && std::none_of(text.begin(), text.end(), [](char c) {
           return static_cast<unsigned char>(c) < 0x20;
         });
}

std::string validationError(const Model& model, const Model& undamaged) {
  if (model.mesh.faceCount() == 0) return "the cloth has no face";
  std::string error = validationError(model.mesh);
  if (!error.empty()) return error;
  if (!liesWithin(model.mesh, undamaged.mesh)) return "the cloth is larger than that of the scene";
  if (!haveAreas(model.mesh, undamaged.mesh)) return "a face has no area";
  error = massError(model, undamaged);
  if (error.empty()) error = model.springs.validationError(model.mesh, undamaged.springs);
  return error.empty() ? bendingError(model, undamaged) : error;
}

std::string validationError(const State& state, const Model& model) {
  if (!fits(state.x, model.mesh) || !fits(state.v, model.mesh)) {
    return "positions are not one for each particle";
  }
  const auto isIn = [](double limit) {
    return [limit](const Vec3& it) { return it.cwiseAbs().maxCoeff() <= limit; };
  };
  if (!std::all_of(state.x.begin(), state.x.end(), isIn(kFarthest)) ||
      !std::all_of(state.v.begin(), state.v.end(), isIn(kFastest))) {
    return "a particle is farther away or faster than any cloth";
  }
  const auto sliders =
      model.bending.hasFriction() ? static_cast<std::size_t>(model.mesh.faceCount()) : 0U;
  if (state.bendOffset.size() != sliders ||
      !std::all_of(state.bendOffset.begin(), state.bendOffset.end(), isIn(kMostCurved))) {
    return "the sliders of bending friction are not one for each face";
  }
  return std::abs(state.t) <= kLongest ? "" : "its time is not one of a simulation";
}

std::string validationError(const Controls& controls, const Model& model) {
  const bool areForces =
      std::all_of(controls.forces.begin(), controls.forces.end(),
                  [&](const PointForce& it) { return isVertexOf(model, it.vertex); });
  if (!areTargetsOf(model, controls.kinematic) || !areForces) {
    return "a particle is held or pulled that does not exist";
  }
  if (!isNotNegative(controls.drag)) return "the drag is negative";
  const std::optional<Wind>& wind = controls.wind;
  if (wind && (!isNotNegative(wind->density) || !isNotNegative(wind->dragCoefficient))) {
    return "the wind has a negative density or drag";
  }
  return "";
}

std::string validationError(const Drag& drag, const std::vector<KinematicTarget>& pins,
                            const Model& model) {
  const bool isHeld = drag.vertex() == kNone || isVertexOf(model, drag.vertex());
  return isHeld && areTargetsOf(model, pins) ? "" : "a pin holds a particle that does not exist";
}

std::string validationError(const std::vector<Clamp>& clamps, const Model& model) {
  std::set<std::string> names;
  for (const Clamp& clamp : clamps) {
    const ClampSpec& spec = clamp.spec();
    if (!isOneLine(spec.name) || !names.insert(spec.name).second) {
      return "two clamps have one name, or one has none";
    }
    try {
      const Clamp trial(spec);  // checks the specification
      if (spec.patch) patchParticles(model, *spec.patch);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    const std::string error = clamp.validationError(model.particleCount());
    if (!error.empty()) return "clamp '" + spec.name + "': " + error;
  }
  return "";
}

std::string validationError(const ColliderSet& colliders, const ColliderSet& ofScene) {
  if (colliders.all().size() != ofScene.all().size()) return "obstacles are not those of the scene";
  for (std::size_t k = 0; k < ofScene.all().size(); ++k) {
    const Collider& one = colliders.all()[k];
    const Obstacle& now = one.obstacle();
    Obstacle before = ofScene.all()[k].obstacle();
    before.pose = now.pose;
    before.velocity = now.velocity;
    before.angularVelocity = now.angularVelocity;
    const bool isSame = bytesOf(now) == bytesOf(before) &&
                        bytesOf(one.properties()) == bytesOf(ofScene.all()[k].properties());
    if (!isSame) return "obstacle " + std::to_string(k) + " is not that of the scene";
    const std::string error = validationError(now.pose);
    if (!error.empty()) return "obstacle '" + now.name + "': " + error;
  }
  return "";
}

std::string validationError(const std::vector<GripEvent>& events) {
  const bool areEvents = std::all_of(events.begin(), events.end(), [](const GripEvent& event) {
    return isOneLine(event.clamp) && event.kind >= GripEvent::Kind::kClosed &&
           event.kind <= GripEvent::Kind::kFreed;
  });
  return areEvents ? "" : "an event of a grasp is of no kind";
}

}  // namespace cloth_sim
