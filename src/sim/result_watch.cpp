#include "cloth_sim/sim/result_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {
namespace {

/// Tells whether the strain of a spring is not that of a fabric.
bool isRaw(const Model& model, const Spring& spring) {
  return model.springs.isRaw(model.mesh, spring.a);
}

/// Returns the strain of a spring beyond the one at which it bears `force` [-].
double excessOf(const Spring& spring, double length, double force) {
  if (spring.stiffness <= 0.0 || length <= spring.restLength) return 0.0;
  return (length - spring.restLength - force / spring.stiffness) / spring.restLength;
}

/// Raises `largest` to the strain of a spring by the softness of a method that projects it alone.
/// \param h  length of a substep [s].
void takeSoftness(const Spring& spring, double length, double h, const Model& model,
                  double& largest) {
  if (length <= spring.restLength) return;
  const double strain = length / spring.restLength - 1.0;
  if (strain <= largest) return;
  const double compliance = h * h * (1.0 / model.mass[spring.a] + 1.0 / model.mass[spring.b]);
  const double s = spring.stiffness * compliance;
  largest = std::max(largest, strain * s / (1.0 + s));
}

/// Tells whether clamps pull slowly at a cloth that moves slowly, and nobody has said so:
/// quasi-static motion, as far as one can tell.
bool isSlowPull(const State& state, const Controls& controls) {
  constexpr double kStill = 1e-3;  // [m/s]
  constexpr double kSlow = 0.5;    // [m/s]
  double fastest = 0.0;
  for (const KinematicTarget& target : controls.kinematic) {
    fastest = std::max(fastest, target.velocity.norm());
  }
  if (controls.quasiStatic || fastest < kStill || fastest > kSlow) return false;
  double sum = 0.0;
  for (const Vec3& v : state.v) sum += v.squaredNorm();
  return sum <= kSlow * kSlow * static_cast<double>(state.v.size());
}

/// Takes from a force on a particle what a contact can bear: its push along the normal, and of the
/// rest what friction stops.
void takeContact(const Vec3& normal, double friction, Vec3& force) {
  const double push = -normal.dot(force);
  if (push <= 0.0) return;
  const Vec3 slip = force + push * normal;
  const double size = slip.norm();
  force = size <= friction * push ? Vec3::Zero() : Vec3((1.0 - friction * push / size) * slip);
}

/// Returns the force of everything but gravity and springs on the cloth, as the step reports it
/// [N].
double outerForce(const Model& model, const Controls& controls, const Contacts& contacts,
                  const StepReport& report) {
  double sum = 0.0;
  for (const Vec3& reaction : report.reactions) sum += reaction.norm();
  for (const PointForce& point : controls.forces) sum += point.force.norm();
  const double step = report.substep * report.substeps;
  for (const ContactCandidates& near : contacts.candidates)
    sum += near.impulse.linear.norm() / step;
  if (controls.wind) {
    const Wind& wind = *controls.wind;
    sum += 0.5 * wind.density * wind.dragCoefficient * wind.velocity.squaredNorm() *
           model.mesh.totalRestArea();
  }
  return sum;
}

/// The words before and after the value of a measure above its bound.
struct Meaning {
  const char* before;
  const char* after;
};
constexpr std::array<Meaning, ResultWatch::kMeasures> kMeanings{{
    {"springs are stretched by ",
     " more than the forces on them explain, so the cloth is softer than its fabric: take more "
     "substeps or another method"},
    {"forces on particles are out of balance by ",
     " of the force that doubles the length of a spring, so the method does not follow the "
     "springs: take more substeps or another method"},
    {"the method makes the cloth heavier by ",
     " times its mass, so it moves too slowly: take more substeps or another method"},
    {"steps end unsolved, with a residual of ",
     " m/s^2: take more iterations, more substeps or another method"},
    {"the cloth is stretched by ",
     " of its length, which no fabric bears as it does here: a woven one has torn before, a knit "
     "has stiffened; pull less, or let it tear (docs/limits.md)"},
}};

const char* const kHint = "; if clamps pull slowly, declare quasi_static (docs/scene.md)";

std::string describe(const Meaning& meaning, double time, double value) {
  char text[60];
  std::snprintf(text, sizeof text, "from t = %.2f s on, ", time);
  std::string sentence = std::string(text) + meaning.before;
  std::snprintf(text, sizeof text, "%.2g", value);
  return sentence + text + meaning.after;
}

/// Moves an average towards a new value.
void approach(double value, double weight, double& average) {
  average += weight * (value - average);
}

}  // namespace

void ResultWatch::observe(std::uint64_t step, const Model& model, const State& state,
                          const Controls& controls, const Contacts& contacts,
                          const StepReport& report) {
  if (report.error && !report.error->sufficed) shortfall_ = report.error;
  if (isFirst(state)) return begin(step, model, state);
  if (step % kEvery != 0 && step > began_ + kAtFirst) return;
  const double dt = state.t - time_;
  const double weight = std::min(1.0, dt / kMemory);
  approach(controls.quasiStatic ? 0.0 : report.addedMass, weight, addedMass_);
  approach(report.residual, weight, residual_);
  measureStrains(model, state, {controls, contacts, report, dt});
  note(Measure::kStrain, std::max(excess_, softness_), state, controls);
  note(Measure::kImbalance, largestImbalance_, state, controls);
  note(Measure::kAddedMass, addedMass_, state, controls);
  note(Measure::kResidual, residual_, state, controls);
  note(Measure::kStretch, stretch_, state, controls);
  time_ = state.t;
}

void ResultWatch::note(Measure measure, double average, const State& state,
                       const Controls& controls) {
  const auto k = static_cast<std::size_t>(measure);
  largest_[k] = std::max(largest_[k], average);
  if (since_[k] || average <= kBounds[k]) return;
  since_[k] = state.t;
  isSlowPull_[k] = isSlowPull(state, controls);
}

std::vector<ResultWarning> ResultWatch::warnings() const {
  std::vector<ResultWarning> all;
  const bool isStrained = since_[static_cast<std::size_t>(Measure::kStrain)].has_value();
  for (std::size_t k = 0; k < kMeasures; ++k) {
    const auto measure = static_cast<Measure>(k);
    const bool isEffect = measure == Measure::kImbalance || measure == Measure::kStretch;
    if (!since_[k] || (isStrained && isEffect)) continue;
    const bool hints = usesQuasiStatic_ && isSlowPull_[k] && measure != Measure::kStretch;
    all.push_back({k, describe(kMeanings[k], *since_[k], largest_[k]) + (hints ? kHint : "")});
  }
  if (shortfall_) all.push_back({kMeasures, shortfallText(*shortfall_)});
  return all;
}

void ResultWatch::measureStrains(const Model& model, const State& state,
                                 const Surroundings& around) {
  std::fill(force_.begin(), force_.end(), Vec3f::Zero());
  std::fill(stiffness_.begin(), stiffness_.end(), 0.0f);
  const double inertia = findInertia(model, state, around.controls.gravity, around.dt);
  const double force = inertia + outerForce(model, around.controls, around.contacts, around.report);
  const Strains strains = addSprings(model, state, force, around.report.substep);
  addInertia();
  ignoreHeld(around.controls);
  takeContacts(state, around.contacts);
  const double weight = std::min(1.0, around.dt / kMemory);
  updateImbalance(weight);
  approach(strains.excess, weight, excess_);
  if (isSoft_) approach(strains.softness, weight, softness_);
  approach(strains.stretch, weight, stretch_);
}

/// Tells whether there is no measurement of this cloth yet.
bool ResultWatch::isFirst(const State& state) const {
  return velocity_.size() != state.v.size() || revision_ != state.v.revision() || state.t <= time_;
}

void ResultWatch::begin(std::uint64_t step, const Model& model, const State& state) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  velocity_.resize(count);
  for (std::size_t k = 0; k < count; ++k) velocity_[k] = state.v.values()[k].cast<float>();
  inertia_.resize(count);
  force_.resize(count);
  imbalance_.assign(count, Vec3f::Zero());
  stiffness_.resize(count);
  excess_ = softness_ = stretch_ = addedMass_ = residual_ = 0.0;
  began_ = step;
  revision_ = state.v.revision();
  time_ = state.t;
}

/// Adds the forces of springs and dashpots, and finds the largest strains.
/// \param force  on the whole cloth: what a spring may bear [N].
/// \param h      length of a substep [s].
ResultWatch::Strains ResultWatch::addSprings(const Model& model, const State& state, double force,
                                             double h) {
  Strains largest;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const Vec3 d = state.x[spring.b] - state.x[spring.a];
    const double length = d.norm();
    if (length == 0.0) continue;
    double tension = spring.stiffness * (length - spring.restLength);
    if (spring.damping > 0.0) {
      tension += spring.damping * (d.dot(state.v[spring.b] - state.v[spring.a]) / length);
    }
    addSpring(spring, d, length, tension);
    if (!traitsOf(spring.kind).isMembrane) continue;
    const double strain = length / spring.restLength - 1.0;
    const double excess = excessOf(spring, length, force);
    const bool isLarger = excess > largest.excess || strain > largest.stretch;
    if (isLarger && !isRaw(model, spring)) {
      largest.excess = std::max(largest.excess, excess);
      largest.stretch = std::max(largest.stretch, strain);
    }
    if (isSoft_) takeSoftness(spring, length, h, model, largest.softness);
  }
  return largest;
}

/// \param d        from one end of the spring to the other [m].
/// \param tension  of spring and dashpot [N].
void ResultWatch::addSpring(const Spring& spring, const Vec3& d, double length, double tension) {
  const Vec3f f = (tension / length * d).cast<float>();
  const bool isCounted = traitsOf(spring.kind).isMembrane;
  const auto stiffness = static_cast<float>(spring.stiffness * std::max(length, spring.restLength));
  for (const VertexId v : {spring.a, spring.b}) {
    const auto k = static_cast<std::size_t>(v);
    force_[k] += v == spring.a ? f : Vec3f(-f);
    if (isCounted) stiffness_[k] = std::max(stiffness_[k], stiffness);
  }
}

/// Finds m (g - a), and remembers the velocities.
/// \param dt  since the last measurement [s].
/// \return the sum of its lengths [N].
double ResultWatch::findInertia(const Model& model, const State& state, const Vec3& gravity,
                                double dt) {
  double sum = 0.0;
  for (std::size_t k = 0; k < velocity_.size(); ++k) {
    const Vec3f now = state.v.values()[k].cast<float>();
    const Vec3 a = (now - velocity_[k]).cast<double>() / dt;
    const Vec3 inertia = model.mass.values()[k] * (gravity - a);
    sum += inertia.norm();
    inertia_[k] = inertia.cast<float>();
    velocity_[k] = now;
  }
  return sum;
}

void ResultWatch::addInertia() {
  for (std::size_t k = 0; k < force_.size(); ++k) force_[k] += inertia_[k];
}

/// Ignores the particles that somebody holds or pulls.
void ResultWatch::ignoreHeld(const Controls& controls) {
  const auto ignore = [&](VertexId v) { stiffness_[static_cast<std::size_t>(v)] = 0.0f; };
  for (const KinematicTarget& target : controls.kinematic) ignore(target.vertex);
  for (const PointForce& point : controls.forces) ignore(point.vertex);
}

/// Takes from the forces on the particles beside obstacles what these can bear. Small forces, as
/// nearly all are, stay as they are: to find normals costs time.
void ResultWatch::takeContacts(const State& state, const Contacts& contacts) {
  constexpr float kSmall = 0.01f;  // imbalance [-]
  for (const ContactCandidates& near : contacts.candidates) {
    const Collider& collider = *near.collider;
    const double friction =
        collider.obstacle().friction.value_or(collider.properties()[near.cloth].friction);
    for (const VertexId v : near.vertices) {
      Vec3f& force = force_[static_cast<std::size_t>(v)];
      if (force.norm() <= kSmall * stiffness_[static_cast<std::size_t>(v)]) continue;
      Vec3 left = force.cast<double>();
      takeContact(collider.normal(state.x[v], state.t), friction, left);
      force = left.cast<float>();
    }
  }
}

/// Averages the imbalance of every particle, and finds the largest one.
/// \param weight  of this measurement in the average [-].
void ResultWatch::updateImbalance(double weight) {
  float squared = 0.0f;
  for (std::size_t k = 0; k < imbalance_.size(); ++k) {
    const Vec3f now = stiffness_[k] > 0.0f ? Vec3f(force_[k] / stiffness_[k]) : Vec3f::Zero();
    imbalance_[k] += static_cast<float>(weight) * (now - imbalance_[k]);
    squared = std::max(squared, imbalance_[k].squaredNorm());
  }
  largestImbalance_ = std::sqrt(static_cast<double>(squared));
}

}  // namespace cloth_sim
