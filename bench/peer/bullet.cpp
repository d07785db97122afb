// Bullet's soft body (position-based links), set up as its own cloth demos do.

#include <cmath>
#include <stdexcept>

#include "cloth.h"
#include "cloth_sim/scene/build.h"
#include "motion_cloth.h"
#include "soft_body_world.h"

namespace cloth_sim::bench {
namespace {

class BulletCloth final : public Cloth {
 public:
  BulletCloth(const Task& task, int substeps, int iterations)
      : frame_(task.frame), substeps_(substeps), world_(Vec3(0.0, 0.0, -9.81)) {
    addCloth(task, iterations);
    if (task.sphere) addObstacles(*task.sphere);
  }

  void advance() override {
    world_.world().stepSimulation(static_cast<btScalar>(frame_), substeps_,
                                  static_cast<btScalar>(frame_ / substeps_));
    world_.info().m_sparsesdf.GarbageCollect();
  }

  Grid3 positions() const override {
    Grid3 result;
    const auto& nodes = world_.cloth().m_nodes;
    for (int k = 0; k < nodes.size(); ++k) result.push_back(fromBullet(nodes[k].m_x));
    return result;
  }
  Grid3 velocities() const override {
    Grid3 result;
    const auto& nodes = world_.cloth().m_nodes;
    for (int k = 0; k < nodes.size(); ++k) result.push_back(fromBullet(nodes[k].m_v));
    return result;
  }

 private:
  void addCloth(const Task& task, int iterations) {
    const double half = 0.5 * task.side;
    const bool hangs = !task.sphere;
    // Rows run from the lower edge to the upper one, from which the cloth hangs.
    const auto corner = [&](double u, double v) {
      return hangs ? Vec3(u * half, 0.0, task.height + v * half)
                   : Vec3(u * half, v * half, task.height);
    };
    constexpr int kUpperCorners = 4 + 8;
    btSoftBody& cloth =
        world_.addPatch({corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1)},
                        task.particles, task.particles, hangs ? kUpperCorners : 0, true);
    cloth.setTotalMass(static_cast<btScalar>(task.mass));
    if (hangs) {
      const int n = task.particles;
      cloth.setMass(n * (n - 1), 0);
      cloth.setMass(n * n - 1, 0);
    }
    cloth.m_cfg.piterations = iterations;
    cloth.m_cfg.kDP = btScalar(0.005);
    cloth.m_cfg.kDF = btScalar(0.5);
    cloth.m_cfg.collisions = hangs ? 0 : btSoftBody::fCollision::SDF_RS;
  }

  void addObstacles(const Task::Sphere& sphere) {
    world_.addBody(std::make_unique<btSphereShape>(static_cast<btScalar>(sphere.radius)),
                   sphere.centre);
    world_.addBody(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)),
                   Vec3::Zero());
  }

  double frame_;
  int substeps_;
  SoftBodyWorld world_;
};

/// A soft body in the place of the cloth of a motion: the same particles, masses, pins and drag.
class BulletMotion final : public MovingCloth {
 public:
  BulletMotion(const Motion& motion, const BulletSetting& setting)
      : gravity_(motion.scene.gravity),
        drag_(motion.scene.drag),
        dt_(motion.scene.solver.dt),
        substeps_(setting.substeps),
        model_(buildModel(motion.scene.cloths)),
        state_(initialState(motion.scene.cloths, model_, motion.scene.seed)),
        world_(gravity_) {
    if (!motion.scene.obstacles.empty() || !motion.scene.clamps.empty()) {
      throw std::invalid_argument("expected a motion without obstacles and clamps");
    }
    addCloth(motion, setting);
    readState();
  }

  void step() override {
    const Vec3 before = linearMomentum(model_, state_);
    for (int k = 0; k < substeps_; ++k) {
      // With 0 as the most substeps, Bullet takes this one as it is, without a rest of time.
      world_.world().stepSimulation(static_cast<btScalar>(dt_ / substeps_), 0);
    }
    readState();
    const Vec3 after = linearMomentum(model_, state_);
    force_ = totalMass(model_) * gravity_ - (after - before) / dt_ - 0.5 * drag_ * (before + after);
  }
  const Model& model() const override { return model_; }
  const State& state() const override { return state_; }
  /// Bullet has no force at fixed nodes: this is what the momentum of the cloth lacks.
  Vec3 holdingForce() const override { return force_; }
  std::string failure() const override { return isFinite(state_) ? "" : "not finite"; }

 private:
  void addCloth(const Motion& motion, const BulletSetting& setting) {
    const Grid& grid = *model_.cloths[0].grid;
    const auto at = [&](int i, int j) { return state_.x[grid.vertex(i, j)]; };
    const int last = grid.columns - 1;
    btSoftBody& cloth = world_.addPatch({at(0, 0), at(last, 0), at(0, last), at(last, last)},
                                        grid.columns, grid.columns, 0, setting.bends);
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      cloth.setMass(v, static_cast<btScalar>(model_.mass[v]));
    }
    for (const PinSpec& pin : motion.scene.cloths[0].pins) {
      cloth.setMass(grid.vertex(pin.column, pin.row), 0);
    }
    cloth.m_cfg.piterations = setting.iterations;
    cloth.m_cfg.kDP = static_cast<btScalar>(1.0 - std::exp(-drag_ * dt_ / substeps_));
    cloth.m_cfg.collisions = 0;
  }

  void readState() {
    const auto& nodes = world_.cloth().m_nodes;
    for (VertexId v = 0; v < model_.particleCount(); ++v) {
      state_.x[v] = fromBullet(nodes[v].m_x);
      state_.v[v] = fromBullet(nodes[v].m_v);
    }
  }

  Vec3 gravity_;
  double drag_;
  double dt_;
  int substeps_;
  Model model_;
  State state_;
  Vec3 force_ = Vec3::Zero();  ///< on the pins, mean over the last step [N]
  SoftBodyWorld world_;
};

}  // namespace

std::unique_ptr<MovingCloth> bulletMotion(const Motion& motion, const BulletSetting& setting) {
  return std::make_unique<BulletMotion>(motion, setting);
}

Contender bullet(int substeps, int iterations) {
  return {
      "Bullet", std::to_string(substeps) + " x " + std::to_string(iterations),
      [=](const Task& task) { return std::make_unique<BulletCloth>(task, substeps, iterations); }};
}

}  // namespace cloth_sim::bench
