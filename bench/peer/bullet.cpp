// Bullet's soft body (position-based links), set up as its own cloth demos do.

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "cloth.h"

namespace cloth_sim::bench {
namespace {

btVector3 toBullet(const Vec3& p) {
  return {static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()), static_cast<btScalar>(p.z())};
}

Vec3 fromBullet(const btVector3& p) { return {p.x(), p.y(), p.z()}; }

class BulletCloth final : public Cloth {
 public:
  BulletCloth(const Task& task, int substeps, int iterations)
      : frame_(task.frame),
        substeps_(substeps),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &constraints_, &configuration_) {
    const btVector3 gravity(0, 0, btScalar(-9.81));
    world_.setGravity(gravity);
    info_ = &world_.getWorldInfo();
    info_->m_gravity = gravity;
    info_->m_dispatcher = &dispatcher_;
    info_->m_broadphase = &broadphase_;
    info_->m_sparsesdf.Initialize();
    addCloth(task, iterations);
    if (task.sphere) addObstacles(*task.sphere);
  }

  ~BulletCloth() override {
    world_.removeSoftBody(cloth_.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void advance() override {
    world_.stepSimulation(static_cast<btScalar>(frame_), substeps_,
                          static_cast<btScalar>(frame_ / substeps_));
    info_->m_sparsesdf.GarbageCollect();
  }

  Grid3 positions() const override {
    Grid3 result;
    for (int k = 0; k < cloth_->m_nodes.size(); ++k)
      result.push_back(fromBullet(cloth_->m_nodes[k].m_x));
    return result;
  }
  Grid3 velocities() const override {
    Grid3 result;
    for (int k = 0; k < cloth_->m_nodes.size(); ++k)
      result.push_back(fromBullet(cloth_->m_nodes[k].m_v));
    return result;
  }

 private:
  void addCloth(const Task& task, int iterations) {
    const double half = 0.5 * task.side;
    const bool hangs = !task.sphere;
    // Rows run from the lower edge to the upper one, from which the cloth hangs.
    const auto corner = [&](double u, double v) {
      return toBullet(hangs ? Vec3(u * half, 0.0, task.height + v * half)
                            : Vec3(u * half, v * half, task.height));
    };
    constexpr int kUpperCorners = 4 + 8;
    cloth_.reset(btSoftBodyHelpers::CreatePatch(*info_, corner(-1, -1), corner(1, -1),
                                                corner(-1, 1), corner(1, 1), task.particles,
                                                task.particles, hangs ? kUpperCorners : 0, true));
    cloth_->m_materials[0]->m_kLST = 1;
    cloth_->generateBendingConstraints(2);
    cloth_->setTotalMass(static_cast<btScalar>(task.mass));
    if (hangs) {
      const int n = task.particles;
      cloth_->setMass(n * (n - 1), 0);
      cloth_->setMass(n * n - 1, 0);
    }
    cloth_->m_cfg.piterations = iterations;
    cloth_->m_cfg.kDP = btScalar(0.005);
    cloth_->m_cfg.kDF = btScalar(0.5);
    cloth_->m_cfg.collisions = hangs ? 0 : btSoftBody::fCollision::SDF_RS;
    world_.addSoftBody(cloth_.get());
  }

  void addObstacles(const Task::Sphere& sphere) {
    addBody(std::make_unique<btSphereShape>(static_cast<btScalar>(sphere.radius)), sphere.centre);
    addBody(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), Vec3::Zero());
  }

  void addBody(std::unique_ptr<btCollisionShape> shape, const Vec3& place) {
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape.get());
    info.m_startWorldTransform.setIdentity();
    info.m_startWorldTransform.setOrigin(toBullet(place));
    info.m_friction = btScalar(0.5);
    shapes_.push_back(std::move(shape));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
  }

  double frame_;
  int substeps_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  btSoftRigidDynamicsWorld world_;
  btSoftBodyWorldInfo* info_ = nullptr;
  std::unique_ptr<btSoftBody> cloth_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace

Contender bullet(int substeps, int iterations) {
  return {
      "Bullet", std::to_string(substeps) + " x " + std::to_string(iterations),
      [=](const Task& task) { return std::make_unique<BulletCloth>(task, substeps, iterations); }};
}

}  // namespace cloth_sim::bench
