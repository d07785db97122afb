/// \file Random edits of random cloths: nothing is lost, nothing dangles, everything goes on.

#include <gtest/gtest.h>

#include <set>

#include "cloth_sim/surgery/apply.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// What no edit may change.
struct Invariants {
  Invariants(const Model& model, const State& state)
      : area(model.mesh.totalRestArea()),
        mass(totalMass(model)),
        momentum(linearMomentum(model, state)),
        angular(angularMomentum(model, state, Vec3::Zero())),
        faces(model.mesh.faceCount()) {
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      speed += model.mass[v] * state.v[v].norm();
      turning += model.mass[v] * state.v[v].norm() * state.x[v].norm();
    }
  }
  double area, mass;
  Vec3 momentum, angular;
  std::int32_t faces;
  double speed = 0.0;    ///< scale of the momentum
  double turning = 0.0;  ///< scale of the angular momentum
};

void expectKept(const Invariants& before, const Invariants& after) {
  EXPECT_EQ(after.faces, before.faces);
  // The same corners, summed in the same order.
  EXPECT_EQ(after.area, before.area);
  EXPECT_NEAR(after.mass, before.mass, 1e-12 * before.mass);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.speed);
  EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * before.turning);
}

void expectNothingDangles(const Model& model, const State& state) {
  ASSERT_EQ(describeDefect(model.mesh), "");
  const auto n = static_cast<std::size_t>(model.particleCount());
  ASSERT_EQ(state.x.size(), n);
  ASSERT_EQ(state.v.size(), n);
  ASSERT_EQ(model.mass.size(), n);
  EXPECT_EQ(state.x.revision(), model.mesh.revision());
  EXPECT_EQ(state.v.revision(), model.mesh.revision());
  EXPECT_EQ(model.mass.revision(), model.mesh.revision());
  for (double mass : model.mass) EXPECT_GT(mass, 0.0);
  const auto exists = [&](VertexId v) { return v >= 0 && v < model.particleCount(); };
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    ASSERT_TRUE(exists(spring.a) && exists(spring.b) && spring.a != spring.b);
    ASSERT_TRUE(exists(spring.support[0]));
    ASSERT_TRUE(spring.support[1] == kNone || exists(spring.support[1]));
    EXPECT_GT(spring.restLength, 0.0);
    EXPECT_GT(spring.stiffness, 0.0);
    // It stands on faces that are still there.
    if (spring.kind == SpringKind::kBend) {
      EXPECT_FALSE(model.mesh.facesAround(spring.support[0]).empty());
    } else {
      EXPECT_NE(model.mesh.facesOnEdge(spring.support[0], spring.support[1])[0], kNone);
    }
  }
}

void expectEachSpringFailsOnce(const std::vector<FailureEvent>& events) {
  std::set<std::tuple<VertexId, VertexId, SpringKind>> failed;
  for (const FailureEvent& event : events) {
    // Two bend springs may join the same ends, over the two sides of a slit between them.
    if (event.kind != SpringKind::kBend) {
      EXPECT_TRUE(failed.insert({event.a, event.b, event.kind}).second);
    }
    EXPECT_TRUE(event.position.allFinite());
    EXPECT_GT(event.stretch, 0.0);
  }
}

/// A cloth that is edited at random while every method keeps up with it.
class Patient {
 public:
  explicit Patient(Generator& random) {
    Fabric fabric = fabricPreset(random() % 2 == 0 ? "interlock" : "denim");
    fabric.damping = random() % 2 == 0 ? 0.0 : 2e-5;
    ClothSpec spec = clothOf(whole(random, 2, 9), whole(random, 2, 9), 0.05, fabric);
    spec.height *= uniform(random, 0.6, 1.5);
    spec.springs.shear = random() % 4 != 0;
    spec.springs.bend = random() % 4 != 0;
    if (random() % 3 == 0) spec.raw = RawSprings{{80.0, 40.0, 5.0}, random() % 2 == 0, 1e-3};
    if (random() % 4 == 0) spec.particleMass = 1e-3;
    model = buildModel(spec);
    state = shakenState(model, 0.005, 0.5, random());
    for (const SolverInfo& info : solverRegistry()) solvers.push_back(makeSolver(info, model, 20));
  }

  /// Carries out `openings` and checks everything that must hold after it.
  SurgeryResult operate(const std::vector<Opening>& openings, FailureCause cause) {
    const Invariants before(model, state);
    SurgeryResult result = openSurface(model, state, openings, cause);
    expectKept(before, Invariants(model, state));
    expectNothingDangles(model, state);
    expectEachSpringFailsOnce(result.events);
    if (result.changes.mesh.empty()) return result;
    for (auto& solver : solvers) solver->onModelChanged(model, result.changes);
    return result;
  }

  /// Two steps with every method, from the same state; goes on with one of them.
  void step(std::size_t goOnWith) {
    State next = state;
    const std::vector<KinematicTarget> pins{{0, state.x[0], Vec3::Zero()}};
    const double before = energy(state);
    for (std::size_t k = 0; k < solvers.size(); ++k) {
      State own = state;
      Controls controls;
      controls.kinematic = pins;
      controls.gravity = Vec3::Zero();
      Contacts contacts;
      for (int n = 0; n < 2; ++n) {
        // 20 substeps of 0.05 ms: stable for the lightest particle here.
        const StepReport& report = solvers[k]->step(model, own, controls, contacts, 1e-3);
        ASSERT_EQ(report.status, StepStatus::kOk) << solverRegistry()[k].name;
        ASSERT_EQ(report.reactions.size(), pins.size());
      }
      // Nothing drives it; a symplectic method's energy swings by omega h / 2 of it.
      ASSERT_LT(energy(own), 1.5 * before + 1e-9) << solverRegistry()[k].name;
      if (k == goOnWith % solvers.size()) next = own;
    }
    state = next;
  }

  Model model;
  State state;
  std::vector<std::unique_ptr<Solver>> solvers;

 private:
  double energy(const State& of) const {
    const Energies e = energies(model, of, Vec3::Zero());
    return e.kinetic + e.elastic;
  }
};

class RandomEdits : public testing::TestWithParam<int> {};

// Each seed is a block of sequences.
INSTANTIATE_TEST_SUITE_P(Seeds, RandomEdits, testing::Range(1, 11));

TEST_P(RandomEdits, SplitsKeepWhatMustBeKept) {
  Generator random(static_cast<std::uint64_t>(GetParam()));
  for (int sequence = 0; sequence < 20 && !HasFatalFailure(); ++sequence) {
    SCOPED_TRACE("sequence " + std::to_string(sequence));
    Patient patient(random);
    for (int edit = whole(random, 3, 12); edit > 0 && !HasFatalFailure(); --edit) {
      std::vector<Opening> openings;
      for (int k = whole(random, 1, 3); k > 0; --k) {
        openings.push_back(randomOpening(patient.model.mesh, random));
      }
      patient.operate(openings, FailureCause::kCut);
      patient.step(static_cast<std::size_t>(edit));
    }
  }
}

TEST_P(RandomEdits, TearsKeepWhatMustBeKeptAndComeToAnEnd) {
  Generator random(static_cast<std::uint64_t>(100 + GetParam()));
  for (int sequence = 0; sequence < 12 && !HasFatalFailure(); ++sequence) {
    SCOPED_TRACE("sequence " + std::to_string(sequence));
    Patient patient(random);
    const Model& model = patient.model;
    TearingSettings settings;
    settings.enabled = true;
    const double ratio = uniform(random, 1.05, 1.3);
    settings.ratio = {ratio, ratio + 0.05, ratio + 0.1};
    if (random() % 2 == 0) {
      const Vec2 size =
          model.mesh.material(model.grid->vertex(model.grid->columns - 1, model.grid->rows - 1));
      const Vec2 from(uniform(random, 0.0, size.x()), 0.0),
          to(uniform(random, 0.0, size.x()), size.y());
      settings.seam = Seam{{from, to}, uniform(random, 0.0, 0.06)};
    }
    Tearing tearing(settings, model);
    // Pulled apart a little more each round; a crack can split each corner of a face once.
    const int limit = 3 * model.mesh.faceCount();
    int openings = 0;
    for (int round = 0; round < 8 && !HasFatalFailure(); ++round) {
      for (Vec3& x : patient.state.x) x += 0.1 * Vec3(x.x(), 0.3 * x.y(), 0.0);
      while (!HasFatalFailure()) {
        const SurgeryResult result =
            patient.operate(tearing.plan(model, patient.state), FailureCause::kTear);
        if (result.changes.mesh.empty()) break;
        tearing.follow(model, result.changes);
        openings += static_cast<int>(result.changes.mesh.newVertices.size());
        ASSERT_LE(openings, limit);
      }
      patient.step(static_cast<std::size_t>(round));
    }
  }
}

TEST_P(RandomEdits, NotchesKeepWhatMustBeKept) {
  Generator random(static_cast<std::uint64_t>(200 + GetParam()));
  for (int sequence = 0; sequence < 8 && !HasFatalFailure(); ++sequence) {
    SCOPED_TRACE("sequence " + std::to_string(sequence));
    Patient patient(random);
    for (int cut = 0; cut < 3 && !HasFatalFailure(); ++cut) {
      MaterialPath path;
      for (int k = whole(random, 2, 4); k > 0; --k) {
        path.emplace_back(uniform(random, -0.1, 0.5), uniform(random, -0.1, 0.5));
      }
      patient.operate(planNotch(patient.model, path), FailureCause::kCut);
      patient.step(static_cast<std::size_t>(cut));
    }
  }
}

}  // namespace
}  // namespace cloth_sim
