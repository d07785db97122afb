// Bullet's soft body with contact between layers: clusters that collide with those of the same body
// (CL_SELF), and vertices against faces of another body (VF_SS).
//
// Bullet 3.24 never calls its collider of clusters for a body with CL_SS and CL_SELF: the mask of
// the flags that it compares with CL_SS includes CL_SELF. So it is also called here, where Bullet's
// world would: after each substep, with the body as both parties.

#include <BulletSoftBody/btSoftBodyInternals.h>

#include "../peer/soft_body_world.h"
#include "cloth_sim/scene/build.h"
#include "task.h"

namespace cloth_sim::bench {
namespace {

constexpr int kSubsteps = 12;  // per frame
constexpr int kIterations = 4;
constexpr double kFrame = 1.0 / 60.0;  // [s]

enum class Touch {
  kNot,
  kClusters,       ///< CL_SS and CL_SELF, as Bullet documents them
  kClustersAsked,  ///< the same collider, called after each substep
  kFaces           ///< VF_SS, which is for two bodies
};

class BulletLayers final : public LayeredCloth {
 public:
  BulletLayers(const LayersTask& task, Touch touch, int clusters)
      : touch_(touch), world_(Vec3(0.0, 0.0, -9.81)) {
    const Scene scene = sceneOf(task, false);
    const Model model = buildModel(scene.cloths);
    const std::vector<Vec3> start = startOf(task);
    VertexId first = 0;
    for (const ClothSpec& spec : scene.cloths) {
      addCloth(spec, clusters);
      place(first, start, model);
      if (task.start == Start::kHanging) pin(spec);
      first += spec.columns * spec.rows;
    }
    if (task.start != Start::kHanging) {
      // A box, because soft bodies know distances from convex shapes only.
      world_.addBody(std::make_unique<btBoxShape>(btVector3(2, 2, btScalar(0.5))),
                     Vec3(0.0, 0.0, -0.5));
    }
  }

  void advance() override {
    for (int k = 0; k < kSubsteps; ++k) {
      // With 0 as the most substeps, Bullet takes this one as it is, without a rest of time.
      world_.world().stepSimulation(static_cast<btScalar>(kFrame / kSubsteps), 0);
      if (touch_ == Touch::kClustersAsked) collideClusters();
    }
    world_.info().m_sparsesdf.GarbageCollect();
  }
  std::vector<Vec3> positions() const override {
    std::vector<Vec3> x;
    for (const auto& cloth : world_.cloths()) {
      for (int k = 0; k < cloth->m_nodes.size(); ++k)
        x.push_back(fromBullet(cloth->m_nodes[k].m_x));
    }
    return x;
  }
  int contacts() const override {
    int count = 0;
    for (const auto& cloth : world_.cloths()) {
      count += cloth->m_joints.size() + cloth->m_scontacts.size();
    }
    return count;
  }
  int substeps() const override { return kSubsteps; }

 private:
  /// Adds a cloth laid flat, so that clusters and rest lengths are those of flat cloth.
  void addCloth(const ClothSpec& spec, int clusters) {
    const Vec3 u(spec.width, 0.0, 0.0), v(0.0, spec.height, 0.0);
    btSoftBody& cloth = world_.addPatch({Vec3::Zero(), u, v, u + v}, spec.columns, spec.rows, 0,
                                        /*bends=*/true);
    cloth.m_cfg.piterations = kIterations;
    cloth.m_cfg.kDP = btScalar(0.005);
    cloth.m_cfg.kDF = btScalar(0.5);
    cloth.m_cfg.collisions = btSoftBody::fCollision::SDF_RS + flags();
    cloth.getCollisionShape()->setMargin(static_cast<btScalar>(0.5 * kThickness));
    if (clusters > 0) cloth.generateClusters(clusters);
  }
  int flags() const {
    if (touch_ == Touch::kNot) return 0;
    if (touch_ == Touch::kFaces) return btSoftBody::fCollision::VF_SS;
    return btSoftBody::fCollision::CL_SS + btSoftBody::fCollision::CL_SELF;
  }
  /// Gives the last cloth its masses and its place.
  /// \param first  vertex of the model.
  void place(VertexId first, const std::vector<Vec3>& start, const Model& model) {
    btSoftBody& cloth = *world_.cloths().back();
    for (int k = 0; k < cloth.m_nodes.size(); ++k) {
      cloth.m_nodes[k].m_x = cloth.m_nodes[k].m_q = toBullet(start[first + k]);
      cloth.setMass(k, static_cast<btScalar>(model.mass[first + k]));
    }
    cloth.updateNormals();
  }
  void pin(const ClothSpec& spec) {
    btSoftBody& cloth = *world_.cloths().back();
    for (const PinSpec& at : spec.pins) cloth.setMass(at.row * spec.columns + at.column, 0);
  }
  void collideClusters() {
    for (const auto& cloth : world_.cloths()) {
      btSoftColliders::CollideCL_SS collider;
      collider.ProcessSoftSoft(cloth.get(), cloth.get());
    }
  }

  Touch touch_;
  SoftBodyWorld world_;
};

template <Touch kTouch, int kClusters>
std::unique_ptr<LayeredCloth> make(const LayersTask& task) {
  return std::make_unique<BulletLayers>(task, kTouch, kClusters);
}

}  // namespace

std::vector<LayersContender> peersOf(Start start) {
  std::vector<LayersContender> all = {
      {"Bullet", "without", false, make<Touch::kNot, 0>},
      {"Bullet", "`CL_SS + CL_SELF`, 64 clusters", true, make<Touch::kClusters, 64>},
      {"Bullet", "64 clusters, called directly", true, make<Touch::kClustersAsked, 64>},
      {"Bullet", "512 clusters, called directly", true, make<Touch::kClustersAsked, 512>}};
  if (start == Start::kFolded) {
    all.push_back({"Bullet", "`VF_SS`, two halves", true, make<Touch::kFaces, 0>, true});
  }
  return all;
}

}  // namespace cloth_sim::bench
