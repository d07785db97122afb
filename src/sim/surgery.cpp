#include "cloth_sim/sim/surgery.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "cloth_sim/surgery/refine.h"
#include "contact/lips.h"
#include "mesh/quality.h"
#include "surgery/tip_joint.h"

namespace cloth_sim {
namespace {

/// Shortest edge that surgery makes, as a fraction of the shortest original edge, unless the scene
/// names a length.
constexpr double kMinEdgeFraction = 0.05;
/// Distance from a tip within which a cut continues from it, in shortest original edges: that by
/// which a cut may bend.
constexpr double kTipReach = 0.5;
/// The same for the tips of the last stroke if the stroke begins where that ended: the cloth may
/// have moved since.
constexpr double kContinuedReach = 8.0;
/// Distance up to which poses of a blade count as one [m].
constexpr double kSamePose = 1e-6;
/// Largest number of strides that the tip of a tear takes in a step.
constexpr int kMaxStrides = 16;

/// Mesh edges that a stroke may cross: finding and cutting them takes a second on a slow core.
constexpr double kMostCrossings = 20000.0;

/// Estimates how many mesh edges a stroke crosses, at most: the way of the blade past the box
/// around the cloth, over the mean length of an edge, and one for every move of the blade there.
double estimateCrossings(const Stroke& stroke, const Model& model, const State& state) {
  if (stroke.poses.empty() || model.mesh.faceCount() == 0) return 0.0;
  Eigen::AlignedBox3d box;
  for (const Vec3& x : state.x) box.extend(x);
  const double diagonal = box.diagonal().norm();
  const double edge = std::sqrt(model.mesh.totalRestArea() / model.mesh.faceCount());
  double crossings = 0.0;
  for (std::size_t k = 1; k < stroke.poses.size(); ++k) {
    const Blade& from = stroke.poses[k - 1];
    const Blade& to = stroke.poses[k];
    Eigen::AlignedBox3d swept(from.heel, from.heel);
    swept.extend(from.tip).extend(to.heel).extend(to.tip);
    if (!swept.intersects(box)) continue;
    const double way = std::max((to.tip - from.tip).norm(), (to.heel - from.heel).norm());
    crossings += 1.0 + std::min(way, diagonal) / edge;
  }
  return crossings;
}

SurgeryLimits limitsFor(const SurgerySettings& settings, const TriangleMesh& mesh) {
  SurgeryLimits limits;
  limits.shape.snap = settings.snap;
  limits.shape.minEdge = settings.minEdge.value_or(kMinEdgeFraction * shortestEdge(mesh));
  limits.maxParticles = settings.maxParticles;
  return limits;
}

/// Returns the paths over the surface that follow a path in material coordinates: those of a stroke
/// over the cloth laid flat.
std::vector<SurfacePath> pathsOver(const TriangleMesh& mesh, const MaterialPath& notch) {
  std::vector<Vec3> path;
  for (const Vec2& p : notch) path.push_back(inMaterialPlane(p));
  return findPaths(strokeAlong(path, Vec3::UnitZ(), 1.0), mesh, inMaterialPlane(mesh));
}

/// Limits of an edit. Where layers of cloth touch, it must not change the surface: a vertex that
/// moves along bent cloth, or an edge that flips, takes faces out of it, and into another layer.
SurgeryLimits limitsOf(SurgeryLimits limits, const EditedCloth& cloth) {
  limits.shape.keepsSurface = cloth.layers != nullptr;
  return limits;
}

/// Cuts cloth whose layers touch, and parts the lips.
/// \throws OperationRefused, and nothing has changed.
SurgeryResult cutBetweenLayers(const CutPlan& plan, const SurgeryLimits& limits,
                               const EditedCloth& cloth) {
  const Model model = cloth.model;
  const State state = cloth.state;
  SurgeryResult result =
      cut(plan, limitsOf(limits, cloth), cloth.holders.heldVertices(), cloth.model, cloth.state);
  cloth.layers->onModelChanged(cloth.model);
  if (partLips(result.changes.mesh, cloth.model, *cloth.layers, cloth.state)) return result;
  cloth.model = model;
  cloth.state = state;
  cloth.layers->onModelChanged(cloth.model);
  throw LayersInTheWay("layers of cloth lie too close on each other to be cut here");
}

}  // namespace

Surgery::Surgery(const SurgerySettings& settings, const TearingSettings& tearing,
                 const Model& model)
    : settings_(settings),
      limits_(limitsFor(settings, model.mesh)),
      edge_(shortestEdge(model.mesh)),
      tearing_(tearing, model),
      pieces_(connectedComponents(model.mesh)) {}

SurgeryResult Surgery::cutAlong(const Stroke& stroke, const EditedCloth& cloth) {
  const double crossings = estimateCrossings(stroke, cloth.model, cloth.state);
  if (crossings > kMostCrossings) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the stroke is too long for this mesh: expected at most %.0f edges in its way "
                  "(about %.3g)",
                  kMostCrossings, crossings);
    throw TooManyParticles(text);
  }
  CutPlan plan;
  plan.paths = findPaths(stroke, cloth.model.mesh, cloth.state.x);
  const bool continues = continuesLast(stroke);
  JoinedTips tips{kTipReach * edge_, {}, kContinuedReach * edge_};
  if (continues) tips.known = strokeTips_;
  joinTips(cloth.model.mesh, tips, plan.paths);
  plan.refine = settings_.refineCuts;
  if (settings_.clearStrip) plan.stripHalfWidth = stroke.halfWidth;
  SurgeryResult result = operate(plan, cloth);
  strokeEnd_ = stroke.poses.back();
  if (!continues && result.tips.empty()) strokeTips_.clear();
  return result;
}

/// Returns whether a stroke begins where the last one ended.
bool Surgery::continuesLast(const Stroke& stroke) const {
  const Blade& first = stroke.poses.front();
  return (first.heel - strokeEnd_.heel).norm() <= kSamePose &&
         (first.tip - strokeEnd_.tip).norm() <= kSamePose;
}

SurgeryResult Surgery::cutNotch(const MaterialPath& notch, const EditedCloth& cloth) {
  CutPlan plan;
  plan.paths = pathsOver(cloth.model.mesh, notch);
  joinTips(cloth.model.mesh, {kTipReach * edge_, {}, 0.0}, plan.paths);
  plan.refine = settings_.refineCuts;
  return operate(plan, cloth);
}

void Surgery::refine(const RefineNear& request, const EditedCloth& cloth) {
  const SurgeryResult result = cloth_sim::refine(
      request, limitsOf(limits_, cloth), cloth.holders.heldVertices(), cloth.model, cloth.state);
  if (result.changes.mesh.empty()) return;
  if (cloth.layers != nullptr) cloth.layers->onModelChanged(cloth.model);
  applyChanges(result, cloth);
  dropScraps(cloth);
}

void Surgery::tear(double dt, const EditedCloth& cloth) {
  for (int stride = 0; stride < kMaxStrides; ++stride) {
    const CutPlan plan = tearing_.plan(cloth.model, cloth.state, dt);
    if (plan.paths.empty()) return;
    try {
      operate(plan, cloth);
    } catch (const LayersInTheWay&) {
      return;
    }
  }
}

SurgeryResult Surgery::operate(const CutPlan& plan, const EditedCloth& cloth) {
  SurgeryResult result = cloth.layers != nullptr ? cutBetweenLayers(plan, limits_, cloth)
                                                 : cut(plan, limits_, cloth.holders.heldVertices(),
                                                       cloth.model, cloth.state);
  // Before anything is renumbered.
  if (plan.cause == FailureCause::kTear) {
    tearing_.noteOpened(result);
  } else {
    noteTips(result, cloth.model.mesh);
  }
  if (result.changes.mesh.empty()) return result;
  applyChanges(result, cloth);
  if (plan.stripHalfWidth > 0.0) removeStrip(plan.stripHalfWidth, cloth, result);
  dropScraps(cloth);
  return result;
}

/// Notes where the paths of a cut end.
void Surgery::noteTips(const SurgeryResult& result, const TriangleMesh& mesh) {
  tearing_.noteTips(result);
  if (result.tips.empty()) return;
  strokeTips_.clear();
  for (std::size_t k = 1; k < result.tips.size(); k += 2) {
    strokeTips_.push_back(mesh.material(result.tips[k]));
  }
}

/// Passes the changes of an operation on to everything that keeps data about the mesh.
void Surgery::applyChanges(const SurgeryResult& result, const EditedCloth& cloth) {
  for (const FailureEvent& event : result.events) failures_.add(event);
  cloth.holders.applyChanges(result.changes.mesh);
  cloth.solver.onModelChanged(cloth.model, result.changes);
  tearing_.applyChanges(cloth.model, result.changes);
  pieces_ = connectedComponents(cloth.model.mesh);
  ++edits_;
}

/// Removes the strip along a cut that was made, and adds the springs that went to its events.
void Surgery::removeStrip(double halfWidth, const EditedCloth& cloth, SurgeryResult& result) {
  const std::vector<FaceId> faces =
      facesOfStrip(result.lines, halfWidth, cloth.holders.heldVertices(), cloth.model.mesh);
  if (faces.empty()) return;
  const SurgeryResult out = cutOut(faces, cloth.model, cloth.state);
  applyChanges(out, cloth);
  drop(faces, cloth);
  result.events.insert(result.events.end(), out.events.begin(), out.events.end());
}

/// Removes loose pieces that are smaller than the scene keeps.
void Surgery::dropScraps(const EditedCloth& cloth) {
  if (settings_.dropBelow <= 0.0 || pieces_.count < 2) return;
  const TriangleMesh& mesh = cloth.model.mesh;
  const std::vector<double> area = areaUnlessKept(cloth);
  std::vector<FaceId> faces;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (area[pieces_.ofFace[f]] < settings_.dropBelow) faces.push_back(f);
  }
  if (!faces.empty()) drop(faces, cloth);
}

/// Removes pieces, and counts them.
/// \param faces  all of their faces, ascending.
void Surgery::drop(const std::vector<FaceId>& faces, const EditedCloth& cloth) {
  const TriangleMesh& mesh = cloth.model.mesh;
  const int piecesBefore = pieces_.count;
  const double massBefore = totalMass(cloth.model);
  const double areaBefore = mesh.totalRestArea();
  const SurgeryResult result = removeComponents(faces, cloth.model, cloth.state);
  if (cloth.layers != nullptr) cloth.layers->onModelChanged(cloth.model);
  applyChanges(result, cloth);
  dropped_.count += piecesBefore - pieces_.count;
  dropped_.mass += massBefore - totalMass(cloth.model);
  dropped_.restArea += areaBefore - mesh.totalRestArea();
}

/// Returns the rest area of each piece [m^2], at least `dropBelow` for pieces that are kept
/// whatever their size: those that are held, and the largest one of each cloth.
std::vector<double> Surgery::areaUnlessKept(const EditedCloth& cloth) const {
  const TriangleMesh& mesh = cloth.model.mesh;
  std::vector<double> area(static_cast<std::size_t>(pieces_.count), 0.0);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) area[pieces_.ofFace[f]] += mesh.restArea(f);
  const std::vector<std::int32_t> largest = largestPieces(cloth.model, area);
  for (const VertexId v : cloth.holders.heldVertices()) {
    area[pieces_.ofFace[mesh.facesAround(v).front()]] = settings_.dropBelow;
  }
  for (const std::int32_t piece : largest) area[piece] = settings_.dropBelow;
  return area;
}

/// Returns the largest piece of each cloth; of equal ones the first.
std::vector<std::int32_t> Surgery::largestPieces(const Model& model,
                                                 const std::vector<double>& area) const {
  std::vector<std::int32_t> largest(model.cloths.size(), kNone);
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const std::int32_t piece = pieces_.ofFace[f];
    std::int32_t& best = largest[model.clothOf(model.mesh.face(f)[0])];
    if (best == kNone || area[piece] > area[best]) best = piece;
  }
  return largest;
}

}  // namespace cloth_sim
