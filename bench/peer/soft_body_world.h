#pragma once
/// \file A world of Bullet with soft bodies and rigid obstacles.

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim::bench {

inline btVector3 toBullet(const Vec3& p) {
  return {static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()), static_cast<btScalar>(p.z())};
}

inline Vec3 fromBullet(const btVector3& p) { return {p.x(), p.y(), p.z()}; }

/// The corners of a patch of nodes, whose rows follow each other from the lower two to the
/// upper two.
struct Corners {
  Vec3 lowerLeft, lowerRight, upperLeft, upperRight;  ///< [m]
};

/// Soft bodies of position-based links, alone in a world.
class SoftBodyWorld {
 public:
  explicit SoftBodyWorld(const Vec3& gravity)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &constraints_, &configuration_) {
    world_.setGravity(toBullet(gravity));
    info_ = &world_.getWorldInfo();
    info_->m_gravity = toBullet(gravity);
    info_->m_dispatcher = &dispatcher_;
    info_->m_broadphase = &broadphase_;
    info_->m_sparsesdf.Initialize();
  }
  SoftBodyWorld(const SoftBodyWorld&) = delete;
  SoftBodyWorld& operator=(const SoftBodyWorld&) = delete;
  ~SoftBodyWorld() {
    for (const auto& cloth : cloths_) world_.removeSoftBody(cloth.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  /// Adds a cloth, with full stiffness. \return it, to be given masses and settings.
  /// \param fixed  flags of fixed corners, as CreatePatch has them.
  btSoftBody& addPatch(const Corners& corners, int columns, int rows, int fixed, bool bends) {
    cloths_.emplace_back(btSoftBodyHelpers::CreatePatch(
        *info_, toBullet(corners.lowerLeft), toBullet(corners.lowerRight),
        toBullet(corners.upperLeft), toBullet(corners.upperRight), columns, rows, fixed, true));
    btSoftBody& cloth = *cloths_.back();
    cloth.m_materials[0]->m_kLST = 1;
    if (bends) cloth.generateBendingConstraints(2);
    world_.addSoftBody(&cloth);
    return cloth;
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

  btSoftRigidDynamicsWorld& world() { return world_; }
  btSoftBodyWorldInfo& info() { return *info_; }
  /// The first cloth.
  const btSoftBody& cloth() const { return *cloths_.front(); }
  const std::vector<std::unique_ptr<btSoftBody>>& cloths() const { return cloths_; }

 private:
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  btSoftRigidDynamicsWorld world_;
  btSoftBodyWorldInfo* info_ = nullptr;
  std::vector<std::unique_ptr<btSoftBody>> cloths_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace cloth_sim::bench
