#include "surface_visual.h"

#include <OgreSceneManager.h>
#include <OgreSceneNode.h>

#include <atomic>

#include "mesh_layer.h"

namespace cloth_sim {
namespace {

/// How far towards the viewer things are moved in depth, so that what the cloth lies on does not
/// show through where the mesh is coarse, and lines are before faces. Half a millimetre at 2 m
/// [depth steps].
constexpr float kFaceBias = 16.0f;
constexpr float kWireBias = 32.0f;

/// Ogre's objects and materials need names of their own.
std::string uniqueName(const std::string& part) {
  static std::atomic<int> count{0};
  return "cloth_sim/" + part + "/" + std::to_string(count++);
}

}  // namespace

struct SurfaceVisual::Parts {
  VertexStream positions{3 * sizeof(float)};
  VertexStream frontColours{sizeof(Surface::Packed)};
  VertexStream backColours{sizeof(Surface::Packed)};
  VertexStream tornPositions{3 * sizeof(float)};
  IndexStream triangles;
  IndexStream tornTriangles;
  MeshLayer front{uniqueName("front"), true};
  MeshLayer back{uniqueName("back"), true};
  MeshLayer wires{uniqueName("wires"), false};
  MeshLayer torn{uniqueName("torn"), false};
  Ogre::SceneManager* scene = nullptr;
  Ogre::SceneNode* node = nullptr;

  std::array<MeshLayer*, 4> all() { return {&front, &back, &wires, &torn}; }
};

SurfaceVisual::SurfaceVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent)
    : parts_(std::make_unique<Parts>()) {
  parts_->scene = &scene;
  parts_->node = parent.createChildSceneNode();
  parts_->front.pass().setCullingMode(Ogre::CULL_CLOCKWISE);
  parts_->back.pass().setCullingMode(Ogre::CULL_ANTICLOCKWISE);
  parts_->wires.pass().setCullingMode(Ogre::CULL_NONE);
  parts_->wires.pass().setPolygonMode(Ogre::PM_WIREFRAME);
  parts_->wires.pass().setDepthBias(kWireBias);
  parts_->torn.pass().setCullingMode(Ogre::CULL_NONE);
  parts_->torn.pass().setDepthBias(kWireBias);
  for (MeshLayer* layer : {&parts_->front, &parts_->back}) layer->pass().setDepthBias(kFaceBias);
  for (MeshLayer* layer : parts_->all()) parts_->node->attachObject(layer);
  setLook(look_);
}

SurfaceVisual::~SurfaceVisual() {
  parts_->node->detachAllObjects();
  parts_->scene->destroySceneNode(parts_->node);
}

void SurfaceVisual::updateTriangles(const Surface& surface) {
  parts_->triangles.write(surface.triangles());
  for (MeshLayer* layer : {&parts_->front, &parts_->back, &parts_->wires}) {
    layer->setTriangles(parts_->triangles, surface.triangles().size());
  }
  hide();
}

void SurfaceVisual::updateVertices(const Surface& surface) {
  const std::size_t count = surface.positions().size() / 3;
  parts_->positions.write(surface.positions().data(), count);
  parts_->frontColours.write(surface.frontColours().data(), count);
  parts_->backColours.write(surface.backColours().data(), count);
  parts_->front.setVertices(parts_->positions, &parts_->frontColours, count);
  parts_->back.setVertices(parts_->positions, &parts_->backColours, count);
  parts_->wires.setVertices(parts_->positions, nullptr, count);

  const std::size_t corners = surface.tornPositions().size() / 3;
  parts_->tornPositions.write(surface.tornPositions().data(), corners);
  parts_->tornTriangles.write(surface.tornTriangles());
  parts_->torn.setVertices(parts_->tornPositions, nullptr, corners);
  parts_->torn.setTriangles(parts_->tornTriangles, surface.tornTriangles().size());

  filled_ = count > 0;
  if (filled_) {
    const Eigen::Vector3f& low = surface.low();
    const Eigen::Vector3f& high = surface.high();
    const Ogre::AxisAlignedBox box(low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
    for (MeshLayer* layer : parts_->all()) layer->setBox(box);
  }
  showParts();
}

void SurfaceVisual::setLook(const SurfaceLook& look) {
  look_ = look;
  parts_->wires.setColour(look.wireColour);
  parts_->torn.setColour(look.tornColour);
  showParts();
}

void SurfaceVisual::hide() {
  filled_ = false;
  showParts();
}

/// An empty list would crash some versions of rviz.
void SurfaceVisual::showParts() {
  const auto show = [this](MeshLayer& layer, bool wanted) {
    layer.setVisible(filled_ && wanted && !layer.empty());
  };
  show(parts_->front, look_.faces);
  show(parts_->back, look_.faces && look_.back);
  show(parts_->wires, look_.wireframe);
  show(parts_->torn, true);
}

}  // namespace cloth_sim
