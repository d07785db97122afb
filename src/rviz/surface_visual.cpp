#include "surface_visual.h"

#include <OgreSceneManager.h>
#include <OgreSceneNode.h>

#include "mesh_layer.h"

namespace cloth_sim {
namespace {

/// Depth bias towards the viewer [depth steps]; 4 mm at 2 m with a near clip of 1 cm. It keeps
/// obstacles from showing through a coarse mesh, and draws lines in front of faces.
constexpr float kFaceBias = 160.0f;
constexpr float kWireBias = 192.0f;
/// Borders are drawn in front of the faces around them, and behind a layer of cloth above them.
constexpr float kBorderBias = 168.0f;

}  // namespace

struct SurfaceVisual::Layers {
  /// Ribbons in one colour, with buffers of their own.
  struct RibbonLayer {
    RibbonLayer(const char* name, float depthBias) : mesh(uniqueOgreName(name), false) {
      mesh.pass().setCullingMode(Ogre::CULL_NONE);
      mesh.pass().setDepthBias(depthBias);
    }

    void updateTriangles(const Ribbons& ribbons) {
      triangles.write(ribbons.triangles());
      mesh.setTriangles(triangles, ribbons.triangles().size());
    }
    void updateVertices(const Ribbons& ribbons) {
      const std::size_t corners = ribbons.positions().size() / 3;
      positions.write(ribbons.positions().data(), corners);
      mesh.setVertices(positions, nullptr, corners);
    }

    VertexStream positions{3 * sizeof(float)};
    IndexStream triangles;
    MeshLayer mesh;
  };

  VertexStream positions{3 * sizeof(float)};
  VertexStream frontColours{sizeof(Surface::Packed)};
  VertexStream backColours{sizeof(Surface::Packed)};
  IndexStream triangles;
  MeshLayer front{uniqueOgreName("front"), true};
  MeshLayer back{uniqueOgreName("back"), true};
  MeshLayer wires{uniqueOgreName("wires"), false};
  RibbonLayer border{"border", kBorderBias};
  RibbonLayer torn{"torn", kWireBias};
  Ogre::SceneManager* scene = nullptr;
  Ogre::SceneNode* node = nullptr;

  std::array<MeshLayer*, 5> all() { return {&front, &back, &wires, &border.mesh, &torn.mesh}; }
};

SurfaceVisual::SurfaceVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent)
    : layers_(std::make_unique<Layers>()) {
  layers_->scene = &scene;
  layers_->node = parent.createChildSceneNode();
  layers_->front.pass().setCullingMode(Ogre::CULL_CLOCKWISE);
  layers_->back.pass().setCullingMode(Ogre::CULL_ANTICLOCKWISE);
  layers_->wires.pass().setCullingMode(Ogre::CULL_NONE);
  layers_->wires.pass().setPolygonMode(Ogre::PM_WIREFRAME);
  layers_->wires.pass().setDepthBias(kWireBias);
  for (MeshLayer* layer : {&layers_->front, &layers_->back}) layer->pass().setDepthBias(kFaceBias);
  for (MeshLayer* layer : layers_->all()) layers_->node->attachObject(layer);
  setParts(parts_);
}

SurfaceVisual::~SurfaceVisual() {
  layers_->node->detachAllObjects();
  layers_->scene->destroySceneNode(layers_->node);
}

void SurfaceVisual::updateTriangles(const Surface& surface) {
  layers_->triangles.write(surface.triangles());
  for (MeshLayer* layer : {&layers_->front, &layers_->back, &layers_->wires}) {
    layer->setTriangles(layers_->triangles, surface.triangles().size());
  }
  layers_->border.updateTriangles(surface.border());
  layers_->torn.updateTriangles(surface.torn());
  hide();
}

void SurfaceVisual::updateVertices(const Surface& surface) {
  const std::size_t count = surface.positions().size() / 3;
  layers_->positions.write(surface.positions().data(), count);
  layers_->frontColours.write(surface.frontColours().data(), count);
  layers_->backColours.write(surface.backColours().data(), count);
  layers_->front.setVertices(layers_->positions, &layers_->frontColours, count);
  layers_->back.setVertices(layers_->positions, &layers_->backColours, count);
  layers_->wires.setVertices(layers_->positions, nullptr, count);

  layers_->border.updateVertices(surface.border());
  layers_->torn.updateVertices(surface.torn());

  filled_ = count > 0;
  if (filled_) {
    const Eigen::Vector3f& low = surface.low();
    const Eigen::Vector3f& high = surface.high();
    const Ogre::AxisAlignedBox box(low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
    for (MeshLayer* layer : layers_->all()) layer->setBox(box);
  }
  showParts();
}

void SurfaceVisual::setParts(const SurfaceParts& parts) {
  parts_ = parts;
  layers_->wires.setColour(parts.wireColour);
  layers_->border.mesh.setColour(parts.borderColour);
  layers_->torn.mesh.setColour(parts.tornColour);
  showParts();
}

void SurfaceVisual::hide() {
  filled_ = false;
  showParts();
}

/// Shows the layers that are wanted and not empty: an empty list crashes some versions of rviz.
void SurfaceVisual::showParts() {
  const auto show = [this](MeshLayer& layer, bool wanted) {
    layer.setVisible(filled_ && wanted && !layer.empty());
  };
  show(layers_->front, parts_.faces);
  show(layers_->back, parts_.faces && parts_.back);
  show(layers_->wires, parts_.wireframe);
  show(layers_->border.mesh, parts_.border);
  show(layers_->torn.mesh, true);
}

}  // namespace cloth_sim
