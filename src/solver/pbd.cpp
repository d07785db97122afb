#include <cmath>

#include "linalg/vector_operations.h"
#include "methods.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// Position-based dynamics: Verlet's x += keep (x - x_before) + h^2 g, then passes in which each
/// spring moves its ends by a part of its error (Mueller, Heidelberger, Hennix & Ratcliff 2007,
/// sec. 3.3; Jakobsen 2001).
///
/// `stiffness` is that part. How stiff the cloth is follows from it, the passes and the step, not
/// from the fabric, of which only masses count; dashpots act as impulses after the passes.
class Pbd final : public SubstepMethod {
 public:
  explicit Pbd(const SolverParameters& parameters)
      : passes_(static_cast<int>(parameters.at("iterations"))),
        stiffness_(parameters.at("stiffness")),
        keep_(parameters.at("velocity_factor")) {}

  void advance(Substep& now) override {
    Particles& p = now.particles;
    now.markStart();
    predict(now);
    now.placeKinematic();
    for (int pass = 0; pass < passes_ && !now.isStopped(); ++pass) {
      now.springs.sweep([&](const Element& spring) { relax(spring, now); });
    }
    now.contacts.project(p.view(), now.time, now.h);
    findVelocities(now);
    if (now.springs.areDamped()) {
      now.springs.sweep([&](const Element& spring) { damp(spring, now); });
    }
    now.iterations += passes_;
  }

 private:
  using Element = SpringConstraints::Element;

  void predict(Substep& now) const {
    Particles& p = now.particles;
    const std::size_t n = p.mass.size();
    setZero(n, now.force);
    if (now.controls.hasLoads()) now.addLoads();
    now.kinematic.addForces(now.h, now.force);
    const double keep = keep_ * std::exp(-now.controls.drag * now.h);
    for (std::size_t k = 0; k < n; ++k) {
      if (p.mass[k] <= 0.0) continue;
      const Vec3 a = now.controls.gravity + p.inverseMass[k] * now.force.at(k);
      p.x.set(k, p.x.at(k) + now.h * (keep * p.v.at(k) + now.h * a));
    }
  }

  static void findVelocities(Substep& now) {
    Particles& p = now.particles;
    setSum(p.x, -1.0, p.start, p.v);
    forAxes(
        [&](auto& axis) {
          for (double& v : axis) v /= now.h;
        },
        p.v);
  }

  /// Moves the ends of a spring together or apart by `stiffness` of its error.
  void relax(const Element& spring, Substep& now) const {
    Particles& p = now.particles;
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const double wa = p.inverseMass[a];
    const double wb = p.inverseMass[b];
    if (wa + wb == 0.0 || spring.parameters.stiffness <= 0.0) return;
    const Vec3 d = p.x.at(b) - p.x.at(a);
    const double length = d.norm();
    if (length == 0.0) return;
    const double error = length - spring.parameters.restLength;
    const Vec3 correction = stiffness_ * error / (length * (wa + wb)) * d;
    if (wa > 0.0) p.x.set(a, p.x.at(a) + wa * correction);
    if (wb > 0.0) p.x.set(b, p.x.at(b) - wb * correction);
    if (wa == 0.0) now.kinematic.addImpulseAt(a, correction / now.h);
    if (wb == 0.0) now.kinematic.addImpulseAt(b, -correction / now.h);
  }

  /// Takes from the ends of a spring the momentum that its dashpot would in the substep,
  /// implicitly.
  static void damp(const Element& spring, Substep& now) {
    Particles& p = now.particles;
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const double wa = p.inverseMass[a];
    const double wb = p.inverseMass[b];
    const Vec3 d = p.x.at(b) - p.x.at(a);
    const double square = d.squaredNorm();
    if (wa + wb == 0.0 || square == 0.0) return;
    const double c = now.h * spring.parameters.damping;
    const double rate = d.dot(p.v.at(b) - p.v.at(a)) / square;
    const Vec3 impulse = c * rate / (1.0 + c * (wa + wb)) * d;
    if (wa > 0.0) p.v.set(a, p.v.at(a) + wa * impulse);
    if (wb > 0.0) p.v.set(b, p.v.at(b) - wb * impulse);
    if (wa == 0.0) now.kinematic.addImpulseAt(a, impulse);
    if (wb == 0.0) now.kinematic.addImpulseAt(b, -impulse);
  }

  int passes_;        ///< over all springs in a substep
  double stiffness_;  ///< part of its error that a spring takes off in a pass
  double keep_;       ///< part of the velocity kept in a substep
};

SolverParameter part(const std::string& name, double value, const std::string& description) {
  SolverParameter parameter;
  parameter.name = name;
  parameter.defaultValue = value;
  parameter.minimum = 0.0;
  parameter.maximum = 1.0;
  parameter.description = description;
  return parameter;
}

}  // namespace

SolverInfo pbdInfo() {
  SolverInfo info;
  info.name = "pbd";
  info.title = "Position-based dynamics";
  info.reference = "Mueller, Heidelberger, Hennix & Ratcliff 2007; Jakobsen 2001";
  info.limitations = "stiffness follows from passes and step, not from the fabric";
  info.order = 0;
  info.followsFabric = false;
  info.noTearEnergy = "its springs have no energy";
  SolverParameter iterations = substepsParameter(16);
  iterations.name = "iterations";
  iterations.description = "passes over all springs in a substep";
  info.parameters = {substepsParameter(1), iterations,
                     part("stiffness", 0.5, "part of its error that a spring takes off in a pass"),
                     part("velocity_factor", 1.0, "part of the velocity kept in a substep")};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<SubstepSolver>(model, substepsOf(p), std::make_unique<Pbd>(p));
  };
  return info;
}

}  // namespace cloth_sim
