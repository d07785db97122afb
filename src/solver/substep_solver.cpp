#include "substep_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloth_sim/contact/collider.h"
#include "linalg/vector_operations.h"
#include "sim/archive.h"
#include "step_count.h"

namespace cloth_sim {
namespace {

/// No cloth goes faster [m/s]: a method that diverges is noticed long before its numbers overflow.
constexpr double kFastest = 1e4;

}  // namespace

SubstepSolver::SubstepSolver(const Model& model, int substeps)
    : configured_(substeps), substeps_(substeps) {
  particles_.layOut(model);
  schedule_.build(model, particles_.slotOf);
}

void SubstepSolver::onModelChanged(const Model& model, const ModelChanges& changes) {
  particles_.follow(changes.mesh);
  followModel(model, changes.springs);
}

void SubstepSolver::followModel(const Model& model, const SpringChanges& changes) {
  schedule_.follow(model, changes, particles_.slotOf);
  substeps_ = substepsFor(model, configured_);
  layoutChanged_ = true;
  bendingChanged_ = true;
}

void SubstepSolver::save(StateWriter& archive) const {
  archive(particles_);
  saveMemory(archive);
}

/// The schedule follows from the undamaged model and the springs there are now.
void SubstepSolver::load(StateReader& archive, const Model& model) {
  archive(particles_);
  particles_.resize();
  followModel(model, model.springs.allModified());
  loadMemory(archive);
}

const StepReport& SubstepSolver::step(const Model& model, State& state, const Controls& controls,
                                      Contacts& contacts, const StepLength& length) {
  const Rest rest = restOf(length, state.t);
  particles_.load(state);
  begin(model, contacts, controls, rest);
  int done = 0;
  while (done < rest.substeps && !report_.passedLimit) {
    const double before = static_cast<double>(done) / rest.substeps;
    const double fraction = static_cast<double>(++done) / rest.substeps;
    substep({model, controls, contacts, rest.h, state.t + fraction * rest.dt, before, fraction});
    report_.passedLimit = passesLimit();
  }
  findVelocities(rest.h);
  layoutChanged_ = false;
  report_.status = particles_.areSlowerThan(kFastest) ? StepStatus::kOk : StepStatus::kDiverged;
  if (report_.status == StepStatus::kDiverged) return report_;
  particles_.store(state);
  for (const KinematicTarget& target : controls.kinematic) {
    state.v[target.vertex] = target.velocity;
  }
  const bool isWhole = done == rest.substeps;
  const double dt = isWhole ? rest.dt : done * rest.h;
  report_.substeps = static_cast<int>(std::lround(length.dt / rest.h));
  report_.fraction = isWhole ? 1.0 : length.done + dt / length.dt;
  state.t += dt;
  finishReactions(model, controls, dt);
  return report_;
}

SubstepSolver::Rest SubstepSolver::restOf(const StepLength& length, double time) const {
  constexpr double kRounding = 1e-9;
  const double share = 1.0 - length.done;
  const int substeps = stepCount(share * substeps_ * length.substepFactor);
  // As long as those before to the bit, where they are as long: matrices are made for a length.
  const double all = std::round(substeps / share);
  const bool goesOn = std::abs(all * share - substeps) < kRounding;
  const double h = goesOn ? length.dt / all : length.left() / substeps;
  return {length.left(), time + length.left(), substeps, h};
}

void SubstepSolver::begin(const Model& model, const Contacts& contacts, const Controls& controls,
                          const Rest& rest) {
  loadKinematics(model, controls);
  keepOutOf(contacts, controls, rest);
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    particles_.v.set(static_cast<std::size_t>(kinematicSlots_[k]),
                     (kinematicTo_.at(k) - kinematicFrom_.at(k)) / rest.dt);
  }
  loadLimits(controls);
  report_.passedLimit = false;
  report_.substep = rest.h;
  report_.iterations = 0;
  report_.residual = 0.0;
  if (bendingChanged_ && !model.bending.empty()) loadBending(model);
  bendingChanged_ = false;
  prepare(controls, rest.h);
}

void SubstepSolver::loadLimits(const Controls& controls) {
  limits_.clear();
  for (const LengthLimit& limit : controls.limits) {
    limits_.push_back({static_cast<std::size_t>(particles_.slotOf[limit.a]),
                       static_cast<std::size_t>(particles_.slotOf[limit.b]),
                       limit.length * limit.length});
  }
}

bool SubstepSolver::passesLimit() const {
  return std::any_of(limits_.begin(), limits_.end(), [this](const Limit& limit) {
    return (particles_.x.at(limit.b) - particles_.x.at(limit.a)).squaredNorm() > limit.square;
  });
}

void SubstepSolver::loadKinematics(const Model& model, const Controls& controls) {
  kinematicSlots_.clear();
  kinematicFrom_.resize(controls.kinematic.size());
  kinematicTo_.resize(controls.kinematic.size());
  kinematicStartVelocity_.clear();
  report_.reactions.assign(controls.kinematic.size(), Vec3::Zero());
  for (const KinematicTarget& target : controls.kinematic) {
    const std::int32_t slot = particles_.slotOf[target.vertex];
    kinematicFrom_.set(kinematicSlots_.size(), particles_.x.at(slot));
    kinematicTo_.set(kinematicSlots_.size(), target.position);
    kinematicSlots_.push_back(slot);
    kinematicStartVelocity_.push_back(particles_.v.at(slot));
  }
  if (kinematicSlots_ != previousKinematic_) {
    previousKinematic_ = kinematicSlots_;
    layoutChanged_ = true;
  }
  if (!layoutChanged_) return;
  particles_.loadMasses(model, controls.kinematic);
  targetOf_.assign(static_cast<std::size_t>(particles_.slots), kNone);
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    targetOf_[static_cast<std::size_t>(kinematicSlots_[k])] = static_cast<std::int32_t>(k);
  }
}

/// Nobody can hold a particle inside an obstacle: the target is then where it leaves it again.
void SubstepSolver::keepOutOf(const Contacts& contacts, const Controls& controls,
                              const Rest& rest) {
  ParticleView view;
  view.x = kinematicTo_.x.data();
  view.y = kinematicTo_.y.data();
  view.z = kinematicTo_.z.data();
  view.startX = kinematicFrom_.x.data();
  view.startY = kinematicFrom_.y.data();
  view.startZ = kinematicFrom_.z.data();
  kinematicMass_.assign(kinematicSlots_.size(), 0.0);
  view.mass = kinematicMass_.data();
  for (const ContactCandidates& near : contacts.candidates) {
    touching_.clear();
    for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
      const VertexId v = controls.kinematic[k].vertex;
      const bool listed = std::binary_search(near.vertices.begin(), near.vertices.end(), v);
      if (listed) touching_.push_back(static_cast<VertexId>(k));
    }
    Vec3 none = Vec3::Zero();
    near.collider->project(touching_, view, rest.end, rest.dt, none, near.cloth);
  }
}

void SubstepSolver::finishReactions(const Model& model, const Controls& controls, double dt) {
  for (std::size_t k = 0; k < controls.kinematic.size(); ++k) {
    const KinematicTarget& target = controls.kinematic[k];
    const double mass = model.mass[target.vertex];
    const Vec3 acceleration = (target.velocity - kinematicStartVelocity_[k]) / dt;
    report_.reactions[k] = report_.reactions[k] / dt + mass * (controls.gravity - acceleration);
  }
}

void SubstepSolver::markStart() { copy(particles_.x, particles_.start); }

void SubstepSolver::placeKinematic(double fraction) {
  placeKinematic(fraction, 0, particles_.mass.size());
}

void SubstepSolver::placeKinematic(double fraction, std::size_t first, std::size_t last) {
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    const auto slot = static_cast<std::size_t>(kinematicSlots_[k]);
    if (slot < first || slot >= last) continue;
    const Vec3 from = kinematicFrom_.at(k);
    particles_.x.set(slot, from + fraction * (kinematicTo_.at(k) - from));
  }
}

void SubstepSolver::addForcesToReactions(double h) {
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    addReaction(k, h * force_.at(static_cast<std::size_t>(kinematicSlots_[k])));
  }
}

void SubstepSolver::addLoads(const Model& model, const Controls& controls) {
  if (controls.wind) addWind(model, *controls.wind);
  for (const PointForce& load : controls.forces) {
    const auto k = static_cast<std::size_t>(particles_.slotOf[load.vertex]);
    force_.set(k, force_.at(k) + load.force);
  }
}

void SubstepSolver::addWind(const Model& model, const Wind& wind) {
  const VectorArray& x = particles_.x;
  const VectorArray& v = particles_.v;
  for (const Face& face : model.mesh.faces()) {
    std::array<std::size_t, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = static_cast<std::size_t>(particles_.slotOf[face[k]]);
    // Twice the area times the normal.
    const Vec3 normal = (x.at(p[1]) - x.at(p[0])).cross(x.at(p[2]) - x.at(p[0]));
    const double length = normal.norm();
    if (length == 0.0) continue;
    const Vec3 relative = wind.velocity - (v.at(p[0]) + v.at(p[1]) + v.at(p[2])) / 3.0;
    const double along = relative.dot(normal) / length;
    const Vec3 third =
        wind.density * wind.dragCoefficient * std::abs(along) * along / 12.0 * normal;
    for (std::size_t k : p) force_.set(k, force_.at(k) + third);
  }
}

void SubstepSolver::enforceContacts(const Substep& now) {
  if (now.contacts.empty()) return;
  Particles& p = particles_;
  before_.resize(p.mass.size());
  forFreeCandidates(now.contacts, [&](std::size_t k) { before_.set(k, p.x.at(k)); });
  now.contacts.project(p.view(), now.time, now.h);
  // A particle near two obstacles comes by twice: what has been taken up is not left to take.
  forFreeCandidates(now.contacts, [&](std::size_t k) {
    p.v.set(k, p.v.at(k) + (p.x.at(k) - before_.at(k)) / now.h);
    before_.set(k, p.x.at(k));
  });
}

void SubstepSolver::enforceContactVelocities(const Substep& now) {
  if (now.contacts.empty()) return;
  Particles& p = particles_;
  before_.resize(p.mass.size());
  forFreeCandidates(now.contacts, [&](std::size_t k) {
    p.start.set(k, p.x.at(k));
    before_.set(k, p.x.at(k) + now.h * p.v.at(k));
  });
  forFreeCandidates(now.contacts, [&](std::size_t k) { p.x.set(k, before_.at(k)); });
  now.contacts.project(p.view(), now.time, now.h);
  forFreeCandidates(now.contacts,
                    [&](std::size_t k) { before_.set(k, (p.x.at(k) - p.start.at(k)) / now.h); });
  forFreeCandidates(now.contacts, [&](std::size_t k) {
    p.v.set(k, before_.at(k));
    p.x.set(k, p.start.at(k));
  });
}

template <typename Visit>
void SubstepSolver::forFreeCandidates(const Contacts& contacts, const Visit& visit) const {
  for (const ContactCandidates& touching : contacts.candidates) {
    for (VertexId v : touching.vertices) {
      const auto k = static_cast<std::size_t>(particles_.slotOf[v]);
      if (particles_.mass[k] > 0.0) visit(k);
    }
  }
}

}  // namespace cloth_sim
