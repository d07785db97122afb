#include "motion_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/cloth/strain.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/sim/simulation.h"
#include "drape_radius.h"
#include "reference.h"
#include "support/cpu_clock.h"

namespace cloth_sim {
namespace {

constexpr double kReferenceMargin = 0.35;  ///< part of the longest stable step
constexpr int kStepsPerSample = 3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr MotionErrors kNoErrors{kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan};

Scene withSetting(const Scene& scene, const MotionSetting& setting) {
  const SolverInfo& method = findSolver(setting.method);
  Scene result = withConfiguration(
      scene, configure(method, scene.solver.dt, std::max(1, setting.substeps), setting.iterations));
  if (setting.error > 0.0) result.solver.parameters["error"] = setting.error;
  return result;
}

class SimulatedCloth final : public MovingCloth {
 public:
  SimulatedCloth(Scene scene, bool tears) : simulation_(std::move(scene)), tears_(tears) {}

  void step() override { simulation_.step(); }
  const Model& model() const override { return simulation_.model(); }
  const State& state() const override { return simulation_.state(); }
  Vec3 holdingForce() const override {
    if (tears_) return simulation_.clamps()[0].wrench().force;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& reaction : simulation_.lastReport().reactions) sum += reaction;
    return sum;
  }
  int torn() const override { return simulation_.broken().torn; }
  int pieces() const override { return simulation_.pieces(); }
  std::string failure() const override { return simulation_.failure(); }
  std::optional<ErrorEstimate> estimate() const override { return simulation_.lastReport().error; }

 private:
  Simulation simulation_;
  bool tears_;
};

std::vector<double> strainsOf(const MovingCloth& cloth) {
  std::vector<double> strains;
  for (const Spring spring : cloth.model().springs.slots()) {
    if (!spring.exists() || !traitsOf(spring.kind).isMembrane) continue;
    strains.push_back(strainOfStretch(stretch(spring, cloth.state())));
  }
  return strains;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

double percentile999(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) differences[k] = std::abs(a[k] - b[k]);
  const auto at =
      differences.begin() + static_cast<std::ptrdiff_t>(differences.size() * 999 / 1000);
  std::nth_element(differences.begin(), at, differences.end());
  return *at;
}

double total(const Energies& energies) {
  return energies.kinetic + energies.elastic + energies.gravity;
}

/// Adds the differences at the times of the samples.
void compareSamples(const Motion& motion, const MotionRecord& run, const MotionRecord& reference,
                    MotionErrors& errors) {
  double forces = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < std::min(run.samples.size(), reference.samples.size()); ++k) {
    const MotionSample& a = run.samples[k];
    const MotionSample& b = reference.samples[k];
    errors.strain = std::max(errors.strain, std::abs(largest(a.strains) - largest(b.strains)));
    errors.strain999 = std::max(errors.strain999, percentile999(a.strains, b.strains));
    forces += (a.force - b.force).squaredNorm();
    scale += b.force.squaredNorm();
    errors.energy = std::max(errors.energy,
                             std::abs(total(a.energies) - total(b.energies)) / energyScale(motion));
  }
  errors.force = scale > 0.0 ? std::sqrt(forces / scale) : kNan;
}

/// Adds the differences of the shapes at rest.
void compareAtRest(const MotionRecord& run, const MotionRecord& reference, MotionErrors& errors) {
  const MotionSample& a = run.samples.back();
  const MotionSample& b = reference.samples.back();
  errors.restStrain = std::abs(largest(a.strains) - largest(b.strains));
  errors.restElastic = std::abs(a.energies.elastic / b.energies.elastic - 1.0);
  errors.restRadius = std::abs(borderRadius(run.grid, run.trajectory.positions.back()) -
                               borderRadius(reference.grid, reference.trajectory.positions.back()));
}

/// Adds the differences of the tears.
void compareTears(const MotionRecord& run, const MotionRecord& reference, MotionErrors& errors) {
  errors.peakForce = std::abs(run.peakForce / reference.peakForce - 1.0);
  if (run.separation == 0.0 || reference.separation == 0.0) return;
  errors.separation = std::abs(run.separation - reference.separation);
}

/// The first samples of a trajectory.
Trajectory firstOf(const Trajectory& trajectory, std::size_t count) {
  Trajectory first = trajectory;
  first.times.resize(count);
  first.positions.resize(count);
  return first;
}

}  // namespace

std::unique_ptr<MovingCloth> movingCloth(const Motion& motion, const MotionSetting& setting) {
  return std::make_unique<SimulatedCloth>(withSetting(motion.scene, setting), motion.tears);
}

MotionRun::MotionRun(const Motion& motion, std::unique_ptr<MovingCloth> cloth)
    : cloth_(std::move(cloth)),
      gravity_(motion.scene.gravity),
      dt_(motion.scene.solver.dt),
      steps_(static_cast<int>(std::lround(motion.duration / dt_))) {
  record_.grid = *cloth_->model().cloths[0].grid;
}

bool MotionRun::advance() {
  const int next = std::min(steps_, done_ + kStepsPerSample);
  if (done_ == next) return false;
  while (done_ < next && record_.failure.empty()) step();
  if (!record_.failure.empty()) return false;
  if (cloth_->torn() == 0) sample();
  return done_ < steps_;
}

void MotionRun::step() {
  const double start = threadCpuTime();
  cloth_->step();
  cpuTime_ += threadCpuTime() - start;
  record_.cost = cpuTime_ / ++done_;
  record_.failure = cloth_->failure();
  record_.estimate = cloth_->estimate();
  record_.peakForce = std::max(record_.peakForce, cloth_->holdingForce().norm());
  if (record_.separation == 0.0 && cloth_->pieces() > 1) record_.separation = done_ * dt_;
}

void MotionRun::sample() {
  record_.trajectory.times.push_back(done_ * dt_);
  record_.trajectory.positions.push_back(cloth_->state().x.values());
  record_.samples.push_back({strainsOf(*cloth_), cloth_->holdingForce(),
                             energies(cloth_->model(), cloth_->state(), gravity_)});
}

MotionRecord recordMotion(const Motion& motion, const MotionSetting& setting) {
  MotionRun run(motion, movingCloth(motion, setting));
  while (run.advance()) continue;
  return run.record();
}

MotionErrors compareMotions(const Motion& motion, const MotionRecord& run,
                            const MotionRecord& reference) {
  MotionErrors errors = kNoErrors;
  if (!run.failure.empty()) return errors;
  if (motion.tears) compareTears(run, reference, errors);
  const std::size_t common = std::min(run.samples.size(), reference.samples.size());
  if (common + 1 < reference.samples.size()) return errors;  // it tears long before
  errors.position =
      trajectoryError(firstOf(run.trajectory, common), firstOf(reference.trajectory, common),
                      longestSide(motion.scene.cloths));
  errors.strain = errors.strain999 = errors.energy = 0.0;
  compareSamples(motion, run, reference, errors);
  if (motion.endsAtRest) compareAtRest(run, reference, errors);
  return errors;
}

MotionReference makeReference(const Motion& motion) {
  const double longest = kReferenceMargin * stableStep(buildModel(motion.scene.cloths));
  const int substeps = static_cast<int>(std::ceil(motion.scene.solver.dt / longest));
  const MotionSetting fine{referenceMethod().name, substeps, 0, 0.0};
  const MotionSetting coarse{referenceMethod().name, substeps / 2, 0, 0.0};
  MotionReference reference{fine, recordMotion(motion, fine), {}};
  reference.own = compareMotions(motion, recordMotion(motion, coarse), reference.record);
  return reference;
}

}  // namespace cloth_sim
