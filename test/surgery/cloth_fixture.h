#pragma once
/// \file A fixture for tests of surgery. Cloths and operations are small values of whole numbers,
/// so that RapidCheck can draw and shrink them, and regressions can be written down.

#include <iostream>
#include <memory>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/surgery/refine.h"
#include "cloth_sim/surgery/tearing.h"
#include "surgery/invariants.h"

namespace cloth_sim::surgery_support {

/// The description of a cloth.
struct ClothCase {
  int columns = 4;      ///< of vertices
  int rows = 4;         ///< of vertices
  int aspect = 10;      ///< height of a cell in tenths of its width
  int shake = 0;        ///< random displacement of inner vertices at rest [hundredths of a cell]
  int crumple = 0;      ///< 0: flat; 1: waves and noise; 2: random positions
  int heldRadius = -1;  ///< of the patch in the middle that a clamp holds; -1: no clamp
  bool shear = true;
  bool bend = true;
  bool raw = false;        ///< raw springs instead of a fabric
  bool ownMasses = false;  ///< all particles have the same mass
  int seed = 0;
};

/// The kinds of operations. A notch is a stroke in material coordinates.
enum class Kind { kStroke, kNotch, kRefine, kTear, kRemoveComponent };

/// The description of an operation. Points are in quarters of cells, so that many are vertices.
struct Operation {
  Kind kind = Kind::kStroke;
  std::vector<std::array<int, 2>> path;
  int skew = 0;             ///< displacement of all points [hundredths of a cell]
  bool onVertices = false;  ///< use the path as vertex numbers, modulo their count
  bool closed = false;      ///< append the first point to the path
  bool option = false;      ///< stroke: first layer only; tear: on a seam
  int size = 4;             ///< radius of a refinement [quarters of cells]; stretch of a tear
  int generations = 0;      ///< of a refinement, by itself or before a cut or tear
  int strip = 0;            ///< half-width of the strip that goes with a cut [quarters of cells]
};

inline std::ostream& operator<<(std::ostream& out, const ClothCase& c) {
  return out << "{" << c.columns << ", " << c.rows << ", " << c.aspect << ", " << c.shake << ", "
             << c.crumple << ", " << c.heldRadius << ", " << c.shear << ", " << c.bend << ", "
             << c.raw << ", " << c.ownMasses << ", " << c.seed << "}";
}

inline std::ostream& operator<<(std::ostream& out, const Operation& o) {
  constexpr std::array<const char*, 5> kNames{"Stroke", "Notch", "Refine", "Tear",
                                              "RemoveComponent"};
  out << "{Kind::k" << kNames[static_cast<std::size_t>(o.kind)] << ", {";
  for (const auto& p : o.path) out << "{" << p[0] << ", " << p[1] << "}, ";
  return out << "}, " << o.skew << ", " << o.onVertices << ", " << o.closed << ", " << o.option
             << ", " << o.size << ", " << o.generations << ", " << o.strip << "}";
}

/// A cloth with everything that is updated after its edits.
class ClothFixture {
 public:
  /// \param deep  also update an instance of every method, and compare the springs with those of a
  ///              network built from scratch.
  ClothFixture(const ClothCase& with, bool deep) : case_(with), random_(seedOf(with)), deep_(deep) {
    const double cell = 0.05;
    grid_ = Grid{with.columns, with.rows, cell * (with.columns - 1),
                 0.1 * with.aspect * cell * (with.rows - 1)};
    model_.cloths[0].grid = grid_;
    model_.cloths[0].vertices = grid_.columns * grid_.rows;
    model_.mesh = irregularMesh(grid_, 0.01 * with.shake, random_);
    model_.cloths[0].fabric = fabricPreset("interlock");
    model_.cloths[0].fabric.damping = with.seed % 2 == 0 ? 0.0 : 2e-5;
    const SpringSelection selection{with.shear, with.bend};
    model_.springs = with.raw ? SpringNetwork(model_.mesh, raw(), selection)
                              : SpringNetwork(model_.mesh, model_.cloths[0].fabric, selection);
    if (deep && with.bend && with.seed % 3 == 0) {
      model_.bending = PlateBending(model_.mesh, model_.cloths[0].fabric.bending,
                                    model_.cloths[0].fabric.tensileWeft);
    }
    lumpMasses(model_.cloths[0].fabric.arealDensity, model_);
    if (with.ownMasses) setParticleMasses(1e-3, 0, model_);
    original_ = std::make_unique<Shapes>(model_.mesh);
    limits_.shape.minEdge = 0.05 * shortestEdge(model_.mesh);
    dt_ = 0.5 * stableStep(model_);
    place();
    hold();
    if (!deep_) return;
    for (const SolverInfo& info : solverRegistry()) solvers_.push_back(makeSolver(info, model_));
  }

  /// Performs one operation. \return the first invariant that it violates; empty if it keeps all.
  std::string operate(const Operation& operation) {
    switch (operation.kind) {
      case Kind::kStroke:
      case Kind::kNotch:
        return cutAndStrip(operation);
      case Kind::kRefine:
        return applyAndValidate([&] { return refineAt(operation); });
      case Kind::kTear:
        return tear(operation);
      case Kind::kRemoveComponent:
        return removeComponent(operation);
    }
    return "no such operation";
  }

  /// Takes three steps under gravity with every method, each from the present state.
  ///
  /// No spring gives off more than its energy. So with E = kinetic + elastic energy now, a particle
  /// of mass m is in exact time no faster than sqrt(2 E / m) + g t. A symplectic method at half of
  /// its longest stable step keeps an energy within a factor 1 / (1 - (h omega / 2)^2) <= 4/3 of
  /// it, and the bound on omega is not attained. Twice the speed (four times the energy) is
  /// generous, and far below what a dangling index or an unstable step would give. \param
  /// continueWith  index of the method whose result replaces the state; absent: none. \return the
  /// first violation; empty if there is none.
  std::string step(std::optional<int> continueWith = std::nullopt) {
    if (!std::isfinite(dt_)) return "";  // no springs at all
    Controls controls;
    if (clamp_) clamp_->appendTargets(controls.kinematic);
    for (KinematicTarget& target : controls.kinematic) target.position = state_.x[target.vertex];
    const double bound = speedBound(controls);
    const State start = state_;
    for (std::size_t k = 0; k < solvers_.size(); ++k) {
      State own = start;
      const std::string error = stepWith(k, start, controls, bound, own);
      if (!error.empty()) return error;
      if (continueWith && k == static_cast<std::size_t>(*continueWith) % solvers_.size()) {
        state_ = own;
      }
    }
    return "";
  }

  const Model& model() const { return model_; }
  const State& state() const { return state_; }

 private:
  static std::uint64_t seedOf(const ClothCase& c) { return 7919U * static_cast<unsigned>(c.seed); }

  /// Bound on the speeds after three steps [m/s], see `step`.
  double speedBound(const Controls& controls) const {
    const Energies energy = energies(model_, state_, Vec3::Zero());
    const double lightest = *std::min_element(model_.mass.begin(), model_.mass.end());
    return 2.0 * std::sqrt(2.0 * (energy.kinetic + energy.elastic) / lightest) +
           controls.gravity.norm() * 3.0 * dt_;
  }

  /// Takes three steps with the k-th method. \return the first violation; empty if there is none.
  std::string stepWith(std::size_t k, const State& start, const Controls& controls, double bound,
                       State& own) {
    constexpr double kFastest = 1e4;  // speed above which any method may diverge [m/s]
    const SolverInfo& info = solverRegistry()[k];
    Contacts contacts;
    for (int n = 0; n < 3; ++n) {
      const StepReport& report = solvers_[k]->step(model_, own, controls, contacts, {dt_});
      if (report.status != StepStatus::kOk) {
        // Undamped forward Euler grows by up to 1.4 in each of many substeps and may overflow. And
        // where a tear has stretched the cloth very far, any method may fail.
        const bool mayDiverge = info.stabilityLimit <= 0.0 || bound > kFastest;
        if (!mayDiverge) return say(info.name, " diverged, below ", bound, " m/s");
        own = start;
        break;
      }
      if (report.reactions.size() != controls.kinematic.size()) return "reactions are missing";
    }
    const bool keepsEnergy = info.followsFabric && info.stabilityLimit > 0.0;
    for (const Vec3& v : own.v) {
      if (keepsEnergy && !(v.norm() <= bound)) {
        return say(info.name, " throws a particle: ", v.norm(), " > ", bound);
      }
    }
    return "";
  }

  RawSprings raw() const { return RawSprings{{80.0, 40.0, 5.0}, case_.seed % 3 == 0, 1e-3}; }

  void place() {
    state_ = shakenState(model_, 0.0, 1.0, random_());
    const double cell = grid_.spacingU();
    for (Vec3& x : state_.x) {
      if (case_.crumple == 1) {
        x.z() = 2.0 * cell * std::sin(20.0 * x.x() + 13.0 * x.y());
        x += randomVector(random_, 0.2 * cell);
      } else if (case_.crumple == 2) {
        x = 0.5 * Vec3(grid_.width, grid_.height, 0.0) + randomVector(random_, 4.0 * cell);
      }
    }
  }

  void hold() {
    if (case_.heldRadius < 0) return;
    ClampSpec spec;
    spec.name = "clamp";
    spec.closingSpeed = 1e3;
    spec.patch = ClampPatch{case_.columns / 2, case_.rows / 2, case_.heldRadius};
    clamp_.emplace(spec);
    clamp_->close();
    clamp_->advance(model_, state_, 1.0);
  }

  std::vector<VertexId> held() const { return clamp_ ? clamp_->held() : std::vector<VertexId>{}; }

  Vec2 materialAt(const std::array<int, 2>& p, int skew) const {
    const Vec2 cell(grid_.spacingU(), grid_.spacingV());
    const Vec2 shift = 0.01 * skew * Vec2(0.7133, -0.4817);
    return cell.cwiseProduct(Vec2(0.25 * p[0], 0.25 * p[1]) + shift);
  }

  VertexId vertexAt(const std::array<int, 2>& p) const {
    return static_cast<VertexId>(std::abs(37 * p[0] + p[1]) % model_.particleCount());
  }

  /// Returns the points of an operation, in the world or in material coordinates with z = 0.
  std::vector<Vec3> pathOf(const Operation& o, const VertexData<Vec3>& coordinates) const {
    std::vector<Vec3> path;
    for (const auto& p : o.path) {
      const Vec2 at = materialAt(p, o.skew);
      path.push_back(o.onVertices ? coordinates[vertexAt(p)] : Vec3(at.x(), at.y(), 0.0));
    }
    if (o.closed && path.size() > 2) path.push_back(path.front());
    return path;
  }

  Refinement refinementOf(const Operation& o) const {
    return {0.25 * std::max(o.size, 1) * grid_.spacingU(), o.generations, 0.0};
  }

  SurgeryResult cutAlong(const Operation& o) {
    const VertexData<Vec3> coordinates =
        o.kind == Kind::kNotch ? inMaterialPlane(model_.mesh) : state_.x;
    Stroke stroke = strokeAlong(pathOf(o, coordinates), Vec3(0.0, 0.0, 1.0), 1.0);
    stroke.firstLayerOnly = o.option;
    if (!validationError(stroke).empty()) return {};
    CutPlan plan;
    plan.paths = findPaths(stroke, model_.mesh, coordinates);
    if (o.generations > 0) plan.refine = refinementOf(o);
    plan.stripHalfWidth = stripOf(o);
    try {
      return cut(plan, limits_, held(), model_, state_);
    } catch (const OperationRefused&) {
      return {};  // the strip is all of the cloth
    }
  }

  double stripOf(const Operation& o) const { return 0.25 * o.strip * grid_.spacingU(); }

  /// Cuts, and removes the strip along the cut if the operation has one.
  std::string cutAndStrip(const Operation& o) {
    SurgeryResult result;
    std::string error = applyAndValidate([&] { return result = cutAlong(o); });
    if (o.strip == 0 || !error.empty()) return error;
    const std::vector<FaceId> strip = facesOfStrip(result.lines, stripOf(o), held(), model_.mesh);
    if (strip.empty()) return "";
    error = applyAndValidate([&] { return cutOut(strip, model_, state_); });
    return error.empty() ? removeFaces(strip) : error;
  }

  SurgeryResult refineAt(const Operation& o) {
    const RefineNear request{pathOf(o, state_.x), refinementOf(o)};
    if (!validationError(request).empty()) return {};
    return refine(request, limits_, held(), model_, state_);
  }

  /// Pulls the cloth apart and lets it tear, a few advances long.
  std::string tear(const Operation& o) {
    for (Vec3& x : state_.x) x += 0.1 * o.size * Vec3(x.x(), 0.3 * x.y(), 0.0);
    TearingSettings settings;
    settings.enabled = true;
    settings.ratio = {1.1, 1.15, 1.2};
    settings.tipSpeed = o.skew == 0 ? 100.0 : 5.0;
    if (o.generations > 0) settings.refineTip = refinementOf(o);
    settings.seam = seamOf(o);
    Tearing tearing(settings, model_);
    for (int advance = 0; advance < 4; ++advance) {
      SurgeryResult result;
      const CutPlan plan = tearing.plan(model_, state_, 0.01);
      if (plan.paths.empty()) break;
      const std::string error =
          applyAndValidate([&] { return result = cut(plan, limits_, held(), model_, state_); });
      if (!error.empty()) return error;
      tearing.noteOpened(result);
      tearing.applyChanges(model_, result.changes);
    }
    return "";
  }

  /// The seam of an operation, if it has one.
  std::optional<Seam> seamOf(const Operation& o) const {
    if (!o.option || o.path.size() < 2) return std::nullopt;
    Seam seam;
    for (const auto& p : o.path) seam.path.push_back(materialAt(p, o.skew));
    seam.path.erase(std::unique(seam.path.begin(), seam.path.end()), seam.path.end());
    if (seam.path.size() < 2) return std::nullopt;
    if (o.closed) seam.halfWidth = grid_.spacingU();
    return seam;
  }

  /// Removes a connected component, if there are several.
  std::string removeComponent(const Operation& o) {
    const ConnectedComponents components = connectedComponents(model_.mesh);
    if (components.count < 2) return "";
    const int gone = std::abs(o.size) % components.count;
    std::vector<FaceId> faces;
    for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
      if (components.ofFace[f] == gone) faces.push_back(f);
    }
    return removeFaces(faces);
  }

  /// Removes all faces of some connected components.
  std::string removeFaces(const std::vector<FaceId>& faces) {
    std::set<VertexId> vertices;
    for (const FaceId f : faces) {
      vertices.insert(model_.mesh.face(f).begin(), model_.mesh.face(f).end());
    }
    renumbered_ = true;
    removed_ = {faces, {vertices.begin(), vertices.end()}};
    const std::string error =
        applyAndValidate([&] { return removeComponents(faces, model_, state_); });
    removed_ = {};
    return error;
  }

  template <typename Edit>
  std::string applyAndValidate(const Edit& edit);
  std::string validateConserved(const Totals& totals, const Model& before,
                                const State& stateBefore) const;
  std::string validateHeld(const std::vector<VertexId>& before, const std::vector<Vec3>& where,
                           const MeshChanges& changes) const;

  /// The components that the present operation removes.
  struct Removed {
    std::vector<FaceId> faces;
    std::vector<VertexId> vertices;
  };

  ClothCase case_;
  Generator random_;
  bool deep_ = false;
  Grid grid_;
  Model model_;
  State state_;
  SurgeryLimits limits_;
  std::unique_ptr<Shapes> original_;
  std::optional<Clamp> clamp_;
  std::vector<std::unique_ptr<Solver>> solvers_;
  Removed removed_;
  bool renumbered_ = false;  ///< an operation has removed a component
  double dt_ = 0.0;
};

/// Checks that held particles and their copies have not moved by a single bit, in the world and at
/// rest, and that the clamp still holds them.
inline std::string ClothFixture::validateHeld(const std::vector<VertexId>& before,
                                              const std::vector<Vec3>& where,
                                              const MeshChanges& changes) const {
  if (!clamp_) return "";
  const std::vector<VertexId> now = clamp_->held();
  if (!std::is_sorted(now.begin(), now.end())) return "held particles are out of order";
  if (std::adjacent_find(now.begin(), now.end()) != now.end()) return "held twice";
  for (VertexId v : now) {
    if (v < 0 || v >= model_.particleCount()) return say("the clamp holds ", v);
  }
  std::map<VertexId, Vec3> place;
  for (std::size_t k = 0; k < before.size(); ++k) place[before[k]] = where[k];
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.kind == VertexEdit::Kind::kCopy && place.count(edit.from[0]) != 0) {
      place[edit.id] = Vec3(place[edit.from[0]]);
    } else if (edit.kind == VertexEdit::Kind::kMove && place.count(edit.id) != 0) {
      return say("held particle ", edit.id, " was moved");
    } else if (edit.kind == VertexEdit::Kind::kRemove) {
      place.erase(edit.id);
      auto last = place.extract(edit.from[0]);
      if (last.empty()) continue;
      last.key() = edit.id;
      place.insert(std::move(last));
    }
  }
  for (const auto& [v, x] : place) {
    if (state_.x[v] != x) return say("held particle ", v, " is elsewhere");
    if (!std::binary_search(now.begin(), now.end(), v)) return say("the clamp lost ", v);
  }
  return "";
}

/// Checks that an operation conserves mass, rest area and momentum, less those of the component
/// that it removes.
inline std::string ClothFixture::validateConserved(const Totals& totals, const Model& before,
                                                   const State& stateBefore) const {
  const Totals now(model_, state_);
  if (removed_.faces.empty()) return validateTotals(totals, now);
  Totals rest = totals;
  long double area = rest.area;
  for (FaceId f : removed_.faces) area -= before.mesh.restArea(f);
  rest.area = static_cast<double>(area);
  for (VertexId v : removed_.vertices) {
    const Vec3 p = before.mass[v] * stateBefore.v[v];
    rest.mass -= before.mass[v];
    rest.linear -= p;
    rest.angular -= stateBefore.x[v].cross(p);
  }
  // Little may be left, so rounding errors are relative to the whole.
  const bool kept = std::abs(now.area - rest.area) <= kConserved * totals.area &&
                    std::abs(now.mass - rest.mass) <= kConserved * totals.mass &&
                    (now.linear - rest.linear).norm() <= kConserved * totals.linearScale &&
                    (now.angular - rest.angular).norm() <= kConserved * totals.angularScale;
  return kept ? "" : "more was removed than the component";
}

/// Performs an operation, updates clamp and methods, and checks all invariants.
/// \param edit  performs the operation on `model_` and `state_`, and returns its result.
template <typename Edit>
std::string ClothFixture::applyAndValidate(const Edit& edit) {
  const Model before = model_;
  const State stateBefore = state_;
  const std::vector<VertexId> heldBefore = held();
  std::vector<Vec3> heldWhere;
  for (VertexId v : heldBefore) heldWhere.push_back(state_.x[v]);
  const Totals totals(model_, state_);
  const SurgeryResult result = edit();
  std::string error = validationError(model_.mesh);
  const auto check = [&error](const auto& next) {
    if (error.empty()) error = next();
  };
  check([&] { return validateSizes(model_, state_); });
  check([&] { return validateResult(result, before, stateBefore, model_, state_); });
  check([&] { return validateShapes(model_.mesh, limits_.shape, *original_); });
  check([&] { return validateSprings(model_); });
  check([&] { return validateConserved(totals, before, stateBefore); });
  if (!error.empty()) return error;
  if (clamp_) clamp_->applyChanges(result.changes.mesh);
  check([&] { return validateHeld(heldBefore, heldWhere, result.changes.mesh); });
  const bool changed = !result.changes.mesh.empty() || !result.changes.springs.removed.empty();
  for (auto& solver : solvers_) {
    if (changed) solver->onModelChanged(model_, result.changes);
  }
  if (!deep_ || case_.raw) return error;
  const SpringNetwork fromScratch(model_.mesh, model_.cloths[0].fabric, {case_.shear, case_.bend});
  check([&] { return validateNetwork(model_.springs, fromScratch, renumbered_); });
  return error;
}

/// Performs a sequence of operations. \return the first violation and its operation; empty if there
/// is none.
inline std::string operateAll(const ClothCase& cloth, const std::vector<Operation>& operations,
                              bool deep = true) {
  ClothFixture fixture(cloth, deep);
  for (std::size_t k = 0; k < operations.size(); ++k) {
    const std::string error = fixture.operate(operations[k]);
    if (!error.empty()) return say("operation ", k, ": ", error);
  }
  return deep ? fixture.step() : "";
}

}  // namespace cloth_sim::surgery_support
