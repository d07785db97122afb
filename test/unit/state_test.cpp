/// \file Quantities of a state, and forces as derivatives of the energy.

#include "cloth_sim/cloth/state.h"

#include <gtest/gtest.h>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

// ---- figures ------------------------------------------------------------------------------------

TEST(State, FigureOfARigidMotion) {
  // A cloth that moves at u and turns at w about its centre: p = M u, and about the centre
  // L = I w with I the inertia of the lumped masses.
  const Model model = buildModel(clothOf(7, 5, 0.1));
  State state = flatState(model);
  const Vec3 centre = centreOfMass(model, state);
  const Vec3 u(1.0, -2.0, 0.5);
  const double w = 3.0;
  double inertia = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const Vec3 r = state.x[v] - centre;
    state.v[v] = u + w * Vec3::UnitZ().cross(r);
    inertia += model.mass[v] * r.squaredNorm();
  }
  const double mass = totalMass(model);
  EXPECT_NEAR(mass, model.cloths[0].fabric.arealDensity * 0.6 * 0.4, 1e-15);
  EXPECT_TRUE(linearMomentum(model, state).isApprox(mass * u, 1e-13));
  EXPECT_TRUE(angularMomentum(model, state, centre).isApprox(Vec3(0, 0, inertia * w), 1e-12));
  const Energies e = energies(model, state, Vec3(0.0, 0.0, -10.0));
  EXPECT_NEAR(e.kinetic, 0.5 * mass * u.squaredNorm() + 0.5 * inertia * w * w, 1e-13);
  EXPECT_NEAR(e.elastic, 0.0, 1e-25);
  EXPECT_EQ(e.gravity, 0.0) << "at z = 0";
}

TEST(State, GravityEnergyIsMassTimesHeight) {
  const Model model = buildModel(clothOf(4, 4, 0.1));
  State state = flatState(model);
  for (Vec3& x : state.x) x.z() = 2.0;
  EXPECT_NEAR(energies(model, state, Vec3(0, 0, -10)).gravity, totalMass(model) * 20.0, 1e-15);
}

TEST(State, MeanSpeedAndStretch) {
  const Model model = buildModel(clothOf(4, 4, 0.1));
  State state = flatState(model);
  EXPECT_NEAR(maxStretch(model, state), 1.0, 1e-15);
  for (Vec3& x : state.x) x.y() *= 1.25;
  EXPECT_NEAR(maxStretch(model, state), 1.25, 1e-14);
  state.v[3] = Vec3(3.0, 4.0, 0.0);
  EXPECT_DOUBLE_EQ(meanSpeed(state), 5.0 / 16.0);
}

TEST(State, MaxStretchLeavesOutBendSprings) {
  // Only the ends of one row move out by half a spacing each: their bend springs stretch by 1.25,
  // the structural ones by 1.5.
  const Model model = buildModel(clothOf(5, 5, 0.1));
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) state.x[v].x() *= 0.8;
  double bend = 0.0;
  for (const Spring& spring : model.springs.slots()) {
    if (spring.kind == SpringKind::kBend) bend = std::max(bend, stretch(spring, state));
  }
  EXPECT_NEAR(bend, 1.0, 1e-14);
  EXPECT_NEAR(maxStretch(model, state), 1.0, 1e-14);
}

TEST(State, IsFiniteSeesEveryBadNumber) {
  const Model model = buildModel(clothOf(3, 3, 0.1));
  const State good = flatState(model);
  EXPECT_TRUE(isFinite(good));
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (int axis = 0; axis < 3; ++axis) {
      State x = good;
      x.x[8][axis] = bad;
      EXPECT_FALSE(isFinite(x));
      State v = good;
      v.v[0][axis] = bad;
      EXPECT_FALSE(isFinite(v));
    }
  }
}

TEST(StateHash, TellsEveryBitApart) {
  Model model = buildModel(clothOf(4, 4, 0.1));
  const State state = shakenState(model, 0.01, 1.0, 3);
  const std::uint64_t hash = stateHash(model, state);
  EXPECT_EQ(stateHash(model, State(state)), hash);
  State later = state;
  later.t = 1e-300;
  EXPECT_NE(stateHash(model, later), hash);
  State moved = state;
  moved.x[5].y() = std::nextafter(moved.x[5].y(), 1.0);
  EXPECT_NE(stateHash(model, moved), hash);
  State faster = state;
  faster.v[15].z() = std::nextafter(faster.v[15].z(), 1.0);
  EXPECT_NE(stateHash(model, faster), hash);
  State swapped = state;
  std::swap(swapped.x[0], swapped.x[1]);
  EXPECT_NE(stateHash(model, swapped), hash);

  // The same particles, one face turned to other corners.
  Model other = model;
  std::vector<Face> faces = model.mesh.faces();
  std::swap(faces[0], faces[1]);
  other.mesh = TriangleMesh(model.mesh.material(), faces);
  EXPECT_NE(stateHash(other, state), hash);
}

// ---- forces -------------------------------------------------------------------------------------

/// Methods that integrate forces directly: from rest, the first substep gives v = h a(x).
class ForceMethods : public testing::TestWithParam<std::string> {
 protected:
  /// Returns the accelerations at `state`: the change of velocity in one step, over its length h.
  std::vector<Vec3> accelerations(const Model& model, const State& state, const Vec3& gravity) {
    const double h = 1e-6;
    const std::unique_ptr<Solver> solver = makeSolver(findSolver(GetParam()), model);
    Controls controls;
    controls.gravity = gravity;
    Contacts contacts;
    State after = state;
    solver->step(model, after, controls, contacts, {h});
    std::vector<Vec3> result;
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      result.push_back((after.v[v] - state.v[v]) / h);
    }
    return result;
  }
};

TEST_P(ForceMethods, ForceIsMinusTheGradientOfTheEnergy) {
  ClothSpec spec = clothOf(6, 5, 0.1);
  const Vec3 gravity(1.0, 2.0, -9.81);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Model model = buildModel(spec);
    const State state = shakenState(model, 0.02, 0.0, seed);
    const std::vector<Vec3> a = accelerations(model, state, gravity);
    const auto energy = [&](const State& s) {
      const Energies e = energies(model, s, gravity);
      return e.elastic + e.gravity;
    };
    double largest = 0.0;
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      largest = std::max(largest, model.mass[v] * a[v].norm());
    }
    // Central differences over d: truncation E''' d^2 / 6 ~ k / L d^2 = 1e-8 N, rounding of an
    // energy E ~ 20 J, 1e-15 E / d = 2e-8 N; forces are some 100 N.
    const double d = 1e-6;
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        State low = state, high = state;
        low.x[v][axis] -= d;
        high.x[v][axis] += d;
        const double gradient = (energy(high) - energy(low)) / (2.0 * d);
        EXPECT_NEAR(model.mass[v] * a[v][axis], -gradient, 1e-8 * largest)
            << "vertex " << v << ", axis " << axis;
      }
    }
  }
}

TEST_P(ForceMethods, DashpotsPullAlongTheSpringByItsRate) {
  // The difference that damping makes: sum of c (d . dv) d over the springs of a particle, d the
  // unit vector. Position Verlet looks half a step ahead: h v / L ~ 1e-5 relative.
  Fabric fabric = fabricPreset("silk");
  fabric.damping = 2e-3;
  const Model model = buildModel(clothOf(5, 5, 0.1, fabric));
  Fabric plain = fabric;
  plain.damping = 0.0;
  const Model undamped = buildModel(clothOf(5, 5, 0.1, plain));
  const State state = shakenState(model, 0.01, 1.0, 9);
  const std::vector<Vec3> with = accelerations(model, state, Vec3::Zero());
  const std::vector<Vec3> without = accelerations(undamped, state, Vec3::Zero());
  std::vector<Vec3> expected(25, Vec3::Zero());
  double largest = 0.0;
  for (const Spring& s : model.springs.slots()) {
    const Vec3 d = (state.x[s.b] - state.x[s.a]).normalized();
    const Vec3 f = s.damping * d.dot(state.v[s.b] - state.v[s.a]) * d;
    expected[s.a] += f;
    expected[s.b] -= f;
  }
  for (const Vec3& f : expected) largest = std::max(largest, f.norm());
  ASSERT_GT(largest, 1.0);
  for (VertexId v = 0; v < 25; ++v) {
    EXPECT_TRUE((model.mass[v] * (with[v] - without[v]) - expected[v]).norm() < 1e-3 * largest)
        << "vertex " << v;
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, ForceMethods, testing::Values("symplectic_euler", "verlet"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace cloth_sim
