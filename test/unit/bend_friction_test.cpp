/// \file Friction in bending: the loop of moment over curvature, what it dissipates, and forces
/// that add up to nothing.

#include "cloth_sim/cloth/bend_friction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using testing::HasSubstr;

// The broadcloth of Matsudaira et al. (2015).
constexpr double kRigidity = 11.57e-6;    // [N m]
constexpr double kHysteresis = 1.216e-3;  // [N]
constexpr double kMoment = 0.5 * kHysteresis;
constexpr double kSlip = SlipElement::kSlipCurvature;

PlateBending frictionOf(const TriangleMesh& mesh) {
  PlateBending::Plate plate;
  plate.rigidity = kRigidity;
  plate.hysteresis = kHysteresis;
  return PlateBending(mesh, MaterialStrips(), {plate});
}

/// A patch of cells of 1 mm.
TriangleMesh patch() { return makeGridMesh({9, 9, 8e-3, 8e-3}); }

/// Rolls a mesh to a cylinder. \param angle  of the way around it to u [rad].
std::vector<Vec3> rolled(const TriangleMesh& mesh, double curvature, double angle) {
  const Vec2 along(std::cos(angle), std::sin(angle));
  std::vector<Vec3> x;
  for (const Vec2& p : mesh.material()) {
    const double s = along.dot(p), t = along.x() * p.y() - along.y() * p.x();
    if (curvature == 0.0) {
      x.emplace_back(s, t, 0.0);
    } else {
      x.emplace_back(std::sin(curvature * s) / curvature, t,
                     (1.0 - std::cos(curvature * s)) / curvature);
    }
  }
  return x;
}

/// A face in the middle, as it is bent and unbent.
class BentFace {
 public:
  explicit BentFace(double angle)
      : mesh_(patch()),
        face_(mesh_.faceCount() / 2 + 8),
        element_(slipElement(frictionOf(mesh_), mesh_, face_)),
        angle_(angle) {}

  /// Bends it on. \return moment of friction per width [N].
  double bendTo(double curvature) {
    const std::vector<Vec3> x = rolled(mesh_, curvature, angle_);
    const Vec3 c = curvatureAt(x);
    z_ = SlipElement::slipped(c, z_);
    const Vec3 moment = element_.stiffness / mesh_.restArea(face_) * (c - z_);
    return (curvature < 0.0 ? -1.0 : 1.0) * moment.dot(c) / c.norm();
  }

 private:
  Vec3 curvatureAt(const std::vector<Vec3>& x) const {
    return signedCurvature(element_, [&](VertexId v) { return x[static_cast<std::size_t>(v)]; })
        .value;
  }

  TriangleMesh mesh_;
  FaceId face_;
  SlipElement element_;
  double angle_;
  Vec3 z_ = Vec3::Zero();
};

/// Moment of friction on the way back from a curvature `most` at which it slipped [N].
double onTheWayBack(double most, double curvature) {
  return std::max(-kMoment, kMoment - kMoment / kSlip * (most - curvature));
}

TEST(BendFriction, MomentOverCurvatureIsTheLoopOfASlider) {
  // Chords of the polygon and normals of faces miss the curvature, or its direction, by (h K)^2 =
  // 2.5e-3 at most.
  const double most = 50.5;  // no step is flat, where curvature has no direction
  for (const double angle : {0.0, 0.25 * M_PI, 0.5 * M_PI, 0.3}) {
    BentFace face(angle);
    for (double k = 0.5; k <= most; k += 1.0) {
      EXPECT_NEAR(face.bendTo(k), std::min(kMoment, kMoment / kSlip * k), 5e-3 * kMoment) << k;
    }
    for (double k = most - 1.0; k >= -most; k -= 1.0) {
      EXPECT_NEAR(face.bendTo(k), onTheWayBack(most, k), 5e-3 * kMoment) << k << ", " << angle;
    }
    for (double k = -most + 1.0; k <= most; k += 1.0) {
      EXPECT_NEAR(face.bendTo(k), -onTheWayBack(most, -k), 5e-3 * kMoment) << k << ", " << angle;
    }
  }
}

TEST(BendFriction, ACycleDissipatesTheAreaOfTheLoop) {
  // A parallelogram: 2 HB high, and 2 (K - the curvature of slip) wide.
  const double most = 50.125, step = 0.25;
  BentFace face(0.0);
  double before = 0.0;
  for (double k = 0.5 * step; k <= most; k += step) before = face.bendTo(k);
  double work = 0.0;
  const auto bend = [&](double from, double to) {
    const int steps = static_cast<int>(std::lround(std::abs(to - from) / step));
    for (int n = 1; n <= steps; ++n) {
      const double k = from + (to - from) * n / steps;
      const double moment = face.bendTo(k);
      work += 0.5 * (moment + before) * (to - from) / steps;
      before = moment;
    }
  };
  bend(most, -most);
  bend(-most, most);
  EXPECT_NEAR(work / (4.0 * kMoment * (most - kSlip)), 1.0, 5e-3);
}

TEST(BendFriction, NeverGivesBackMoreThanItTook) {
  Generator random(3);
  const auto any = [&] {
    return Vec3(uniform(random, -40, 40), uniform(random, -40, 40), uniform(random, -40, 40));
  };
  SlipElement element;
  element.stiffness = 2.0;
  Vec3 z = Vec3::Zero();
  for (int k = 0; k < 1000; ++k) {
    const Vec3 c = any();
    const Vec3 next = SlipElement::slipped(c, z);
    EXPECT_LE((c - next).norm(), kSlip * (1.0 + 1e-12));
    const double dissipated = element.stiffness * (c - next).dot(next - z);
    EXPECT_GE(dissipated, 0.0);
    EXPECT_NEAR(element.potential(c - z), element.energy(c - next) + dissipated,
                1e-12 * (1.0 + dissipated));
    z = next;
  }
}

TEST(BendFriction, CurvaturesHaveTheirGradientsAndNoTorque) {
  Generator random(8);
  TriangleMesh mesh = makeGridMesh({6, 6, 0.5, 0.5});
  MeshEditor editor(mesh);
  RandomEditor edits(editor, random);
  for (int k = 0; k < 8; ++k) edits.any();
  const PlateBending bending = frictionOf(mesh);
  std::vector<Vec3> x;
  for (const Vec2& p : mesh.material()) {
    x.emplace_back(p.x() + uniform(random, -0.02, 0.02), p.y(), uniform(random, -0.1, 0.1));
  }
  const auto at = [&](VertexId v) { return x[static_cast<std::size_t>(v)]; };
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const SlipElement element = slipElement(bending, mesh, f);
    const SignedCurvature c = signedCurvature(element, at);
    double scale = 0.0;
    for (std::size_t i = 0; i < element.count; ++i) {
      scale = std::max(scale, c.gradient[i].cwiseAbs().maxCoeff());
    }
    for (int k = 0; k < 3; ++k) {
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      for (std::size_t i = 0; i < element.count; ++i) {
        const Vec3 gradient = c.gradient[i][k] * c.normal;
        force += gradient;
        torque += at(element.vertex[i]).cross(gradient);
        const auto vertex = static_cast<std::size_t>(element.vertex[i]);
        for (int axis = 0; axis < 3; ++axis) {
          const double step = 1e-6, here = x[vertex][axis];
          x[vertex][axis] = here + step;
          const double above = signedCurvature(element, at).value[k];
          x[vertex][axis] = here - step;
          const double below = signedCurvature(element, at).value[k];
          x[vertex][axis] = here;
          EXPECT_NEAR((above - below) / (2.0 * step), gradient[axis], 1e-5 * scale) << f;
        }
      }
      EXPECT_LT(force.norm(), 1e-12 * scale);
      EXPECT_LT(torque.norm(), 1e-11 * scale);
    }
  }
}

// ---- scenes

const char* const kCloth =
    "cloth: {size: [0.2, 0.2], particles: [9, 9], pins: [first_row], fabric: {preset: cotton";

Scene sceneWith(const std::string& hysteresis, const std::string& rest = "") {
  return parseScene(kCloth + hysteresis + "}}\n" + rest, "s.yaml");
}

TEST(BendFriction, IsOffByDefault) {
  const auto hash = [](const std::string& hysteresis) {
    Simulation simulation(sceneWith(hysteresis));
    for (int k = 0; k < 20; ++k) simulation.step();
    EXPECT_EQ(simulation.state().bendOffset.empty(), hysteresis != ", bending_hysteresis: 1.0e-3");
    return stateHash(simulation.model(), simulation.state());
  };
  EXPECT_EQ(hash(""), hash(", bending_hysteresis: 0"));
  EXPECT_NE(hash(""), hash(", bending_hysteresis: 1.0e-3"));
}

TEST(BendFriction, SlidersFollowEdits) {
  Simulation simulation(sceneWith(", bending_hysteresis: 1.0e-3"));
  for (int k = 0; k < 20; ++k) simulation.step();
  const std::vector<Vec3> before = simulation.state().bendOffset;
  const FaceId last = simulation.model().mesh.faceCount() - 1;
  const Vec3 corner = simulation.state().x[0];
  ASSERT_TRUE(simulation.apply(RefineMesh{{{corner}, {0.02, 1, 0.0}}}).success);
  const auto faces = static_cast<std::size_t>(simulation.model().mesh.faceCount());
  ASSERT_GT(faces, before.size());
  const std::vector<Vec3>& after = simulation.state().bendOffset;
  ASSERT_EQ(after.size(), faces);
  EXPECT_EQ(after[static_cast<std::size_t>(last)], before[static_cast<std::size_t>(last)]);
  EXPECT_EQ(after[0], Vec3(0, 0, 0)) << "its rest shape is new";
  EXPECT_EQ(after[faces - 1], Vec3(0, 0, 0)) << "it is new";
}

std::string errorOf(const std::string& hysteresis, const std::string& rest = "") {
  return sceneErrorOf([&] { sceneWith(hysteresis, rest); });
}

TEST(BendFriction, BadInputIsRefusedInOneLine) {
  const std::string key = "s.yaml:1: cloth.fabric.bending_hysteresis: ";
  EXPECT_EQ(errorOf(", bending_hysteresis: -1"), key + "expected a number >= 0 (got -1)");
  EXPECT_THAT(errorOf(", bending_hysteresis: .nan"), HasSubstr(key + "expected a number >= 0"));
  EXPECT_EQ(errorOf(", bending: 0, bending_hysteresis: 1.0e-3"),
            key + "expected only where the cloth bends by the energy of a plate");
  EXPECT_EQ(errorOf(", bending_hysteresis: 1.0e-3", "solver: {method: verlet}"),
            key +
                "verlet has no friction in bending; take one of implicit_euler, line_xpbd, xpbd, "
                "or no bending_hysteresis");
  EXPECT_EQ(errorOf(", bending_hysteresis: 1.0e-3", "solver: {method: xpbd}"), "");
}

}  // namespace
}  // namespace cloth_sim
