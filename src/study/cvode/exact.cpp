#include "study/exact.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_version.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "cloth_sim/scene/build.h"

namespace cloth_sim {
namespace {

constexpr double kTolerance = 1e-10;      ///< relative
constexpr double kCheckTolerance = 1e-8;  ///< of the second run, for the error estimate
constexpr double kAbsolutePart = 1e-2;    ///< absolute over relative tolerance [m], [m/s]
constexpr long kMostSteps = 10000000;

/// The equations of motion, derived from the springs independently of the solvers' forces.
/// The state vector y holds the positions of all particles, then their velocities.
class Motion {
 public:
  explicit Motion(const StudyScene& study)
      : model_(buildModel(study.scene.cloths)),
        start_(initialState(study.scene.cloths, model_, study.scene.seed)),
        gravity_(study.scene.gravity),
        drag_(study.scene.drag),
        held_(static_cast<std::size_t>(model_.particleCount()), false) {
    for (const KinematicTarget& pin : pinTargets(study.scene.cloths, model_, start_)) {
      held_[pin.vertex] = true;
      start_.v[pin.vertex].setZero();
    }
  }

  long size() const { return 6L * model_.particleCount(); }

  void load(double* y) const {
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      at(y, v) = start_.x[v];
      at(y + size() / 2, v) = start_.v[v];
    }
  }

  std::vector<Vec3> positions(const double* y) const {
    std::vector<Vec3> x;
    for (VertexId v = 0; v < model_.particleCount(); ++v) x.push_back(at(y, v));
    return x;
  }

  void derivative(const double* y, double* rate) const {
    const double* velocity = y + size() / 2;
    double* acceleration = rate + size() / 2;
    std::fill(acceleration, acceleration + size() / 2, 0.0);
    for (const Spring& spring : model_.springs.slots()) addForce(spring, y, acceleration);
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      at(rate, v) = at(velocity, v);
      at(acceleration, v) =
          held_[v]
              ? Vec3::Zero()
              : Vec3(at(acceleration, v) / model_.mass[v] + gravity_ - drag_ * at(velocity, v));
    }
  }

 private:
  static Eigen::Map<Vec3> at(double* y, VertexId v) { return Eigen::Map<Vec3>(y + 3L * v); }
  static Eigen::Map<const Vec3> at(const double* y, VertexId v) {
    return Eigen::Map<const Vec3>(y + 3L * v);
  }

  void addForce(const Spring& spring, const double* y, double* force) const {
    const double* velocity = y + size() / 2;
    const Vec3 d = at(y, spring.b) - at(y, spring.a);
    const double length = d.norm();
    const double rate = d.dot(at(velocity, spring.b) - at(velocity, spring.a)) / length;
    const double tension = spring.stiffness * (length - spring.restLength) + spring.damping * rate;
    const Vec3 f = tension / length * d;
    at(force, spring.a) += f;
    at(force, spring.b) -= f;
  }

  Model model_;
  State start_;
  Vec3 gravity_;
  double drag_;
  std::vector<bool> held_;
};

int evaluate(realtype /*t*/, N_Vector y, N_Vector rate, void* motion) {
  static_cast<const Motion*>(motion)->derivative(N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
  return 0;
}

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string("CVODE: ") + what + " failed");
}

/// One integration. Owns what SUNDIALS allocates.
class Integration {
 public:
  Integration(Motion& motion, double tolerance) : motion_(motion) {
    check(SUNContext_Create(nullptr, &context_), "SUNContext_Create");
    y_ = N_VNew_Serial(motion.size(), context_);
    motion.load(N_VGetArrayPointer(y_));
    memory_ = CVodeCreate(CV_ADAMS, context_);
    if (memory_ == nullptr) throw std::runtime_error("CVODE: CVodeCreate failed");
    check(CVodeInit(memory_, evaluate, 0.0, y_), "CVodeInit");
    check(CVodeSStolerances(memory_, tolerance, kAbsolutePart * tolerance), "CVodeSStolerances");
    iteration_ = SUNNonlinSol_FixedPoint(y_, 0, context_);
    check(CVodeSetNonlinearSolver(memory_, iteration_), "CVodeSetNonlinearSolver");
    check(CVodeSetUserData(memory_, &motion), "CVodeSetUserData");
    check(CVodeSetMaxNumSteps(memory_, kMostSteps), "CVodeSetMaxNumSteps");
  }
  ~Integration() {
    SUNNonlinSolFree(iteration_);
    CVodeFree(&memory_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Integration(const Integration&) = delete;
  Integration& operator=(const Integration&) = delete;

  std::vector<Vec3> advance(double time) {
    realtype reached = 0.0;
    check(CVode(memory_, time, y_, &reached, CV_NORMAL), "CVode");
    return motion_.positions(N_VGetArrayPointer(y_));
  }

 private:
  Motion& motion_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  void* memory_ = nullptr;
  SUNNonlinearSolver iteration_ = nullptr;
};

Trajectory integrate(const StudyScene& study, double tolerance) {
  Motion motion(study);
  Integration integration(motion, tolerance);
  Trajectory trajectory;
  for (const double time : study.samples) {
    trajectory.times.push_back(time);
    trajectory.positions.push_back(integration.advance(time));
  }
  return trajectory;
}

}  // namespace

bool canIntegrateExactly() { return true; }

Reference integrateExactly(const StudyScene& study) {
  if (!study.isSmooth()) {
    throw std::invalid_argument(study.name + ": has more than springs, drag and gravity");
  }
  Reference reference;
  reference.trajectory = integrate(study, kTolerance);
  reference.ownError =
      trajectoryError(integrate(study, kCheckTolerance), reference.trajectory, study.side());
  char version[32] = "";
  SUNDIALSGetVersion(version, sizeof version);
  std::ostringstream source;
  source << "SUNDIALS CVODE " << version << ", Adams, relative tolerance " << kTolerance
         << " (own error: difference from " << kCheckTolerance << ")";
  reference.source = source.str();
  return reference;
}

}  // namespace cloth_sim
