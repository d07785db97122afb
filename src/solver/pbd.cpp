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
class Pbd final : public SubstepSolver {
 public:
  Pbd(const Model& model, const SolverParameters& parameters)
      : SubstepSolver(model, static_cast<int>(parameters.at("substeps"))),
        passes_(static_cast<int>(parameters.at("iterations"))),
        stiffness_(parameters.at("stiffness")),
        keep_(parameters.at("velocity_factor")) {}

 private:
  /// There is no stiffness that it could have: scenes that ask for it are refused.
  void loadBending(const Model& /*model*/) override {}

  void substep(const Substep& now) override {
    markStart();
    predict(now);
    placeKinematic(now.fraction);
    for (int pass = 0; pass < passes_; ++pass) {
      schedule_.sweep([&](const SpringSchedule::Element& spring) { relax(spring, now.h); });
    }
    now.contacts.project(particles_.view(), now.time, now.h);
    setSum(particles_.x, -1.0, particles_.start, particles_.v);
    forAxes(
        [&](auto& axis) {
          for (double& v : axis) v /= now.h;
        },
        particles_.v);
    if (schedule_.parameters.damped()) {
      schedule_.sweep([&](const SpringSchedule::Element& spring) { damp(spring, now.h); });
    }
    noteIterations(passes_, 0.0);
  }

  void predict(const Substep& now) {
    const std::size_t n = particles_.mass.size();
    setZero(n, force_);
    if (now.controls.hasLoads()) addLoads(now.model, now.controls);
    addForcesToReactions(now.h);
    const double keep = keep_ * std::exp(-now.controls.drag * now.h);
    for (std::size_t k = 0; k < n; ++k) {
      if (particles_.mass[k] <= 0.0) continue;
      const Vec3 a = now.controls.gravity + particles_.inverseMass[k] * force_.at(k);
      particles_.x.set(k, particles_.x.at(k) + now.h * (keep * particles_.v.at(k) + now.h * a));
    }
  }

  /// Moves the ends of a spring together or apart by `stiffness` of its error.
  void relax(const SpringSchedule::Element& spring, double h) {
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const double wa = particles_.inverseMass[a];
    const double wb = particles_.inverseMass[b];
    if (wa + wb == 0.0 || spring.parameters.stiffness <= 0.0) return;
    const Vec3 d = particles_.x.at(b) - particles_.x.at(a);
    const double length = d.norm();
    if (length == 0.0) return;
    const Vec3 correction =
        stiffness_ * (length - spring.parameters.restLength) / (length * (wa + wb)) * d;
    if (wa > 0.0) particles_.x.set(a, particles_.x.at(a) + wa * correction);
    if (wb > 0.0) particles_.x.set(b, particles_.x.at(b) - wb * correction);
    if (wa == 0.0) bear(a, correction / h);
    if (wb == 0.0) bear(b, -correction / h);
  }

  /// Takes from the ends of a spring what its dashpot would in the time h, implicitly.
  void damp(const SpringSchedule::Element& spring, double h) {
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const double w = particles_.inverseMass[a] + particles_.inverseMass[b];
    const Vec3 d = particles_.x.at(b) - particles_.x.at(a);
    const double square = d.squaredNorm();
    if (w == 0.0 || square == 0.0) return;
    const double c = h * spring.parameters.damping;
    const double rate = d.dot(particles_.v.at(b) - particles_.v.at(a)) / square;
    const Vec3 impulse = c * rate / (1.0 + c * w) * d;
    if (particles_.inverseMass[a] > 0.0) {
      particles_.v.set(a, particles_.v.at(a) + particles_.inverseMass[a] * impulse);
    } else {
      bear(a, impulse);
    }
    if (particles_.inverseMass[b] > 0.0) {
      particles_.v.set(b, particles_.v.at(b) - particles_.inverseMass[b] * impulse);
    } else {
      bear(b, -impulse);
    }
  }

  int passes_;
  double stiffness_;
  double keep_;
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
  SolverParameter iterations = substepsParameter(16);
  iterations.name = "iterations";
  iterations.description = "passes over all springs in a substep";
  info.parameters = {substepsParameter(1), iterations,
                     part("stiffness", 0.5, "part of its error that a spring takes off in a pass"),
                     part("velocity_factor", 1.0, "part of the velocity kept in a substep")};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<Pbd>(model, p);
  };
  return info;
}

}  // namespace cloth_sim
