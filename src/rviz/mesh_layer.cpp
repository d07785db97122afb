#include "mesh_layer.h"

#include <OgreCamera.h>
#include <OgreHardwareBufferManager.h>
#include <OgreMaterialManager.h>
#include <OgreResourceGroupManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>

#include <algorithm>
#include <atomic>

namespace cloth_sim {
namespace {

constexpr auto kUsage = Ogre::HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE;

/// Capacity grows by half, so that a tear, which adds a vertex per frame, needs few new buffers.
std::size_t grown(std::size_t needed) { return needed + needed / 2; }

}  // namespace

std::string uniqueOgreName(const std::string& part) {
  static std::atomic<int> count{0};
  return "cloth_sim/" + part + "/" + std::to_string(count++);
}

bool VertexStream::write(const void* data, std::size_t vertices) {
  if (vertices == 0) return false;
  const bool grow = vertices > capacity_;
  if (grow) {
    capacity_ = grown(vertices);
    buffer_ = Ogre::HardwareBufferManager::getSingleton().createVertexBuffer(vertexBytes_,
                                                                             capacity_, kUsage);
  }
  buffer_->writeData(0, vertices * vertexBytes_, data, true);
  return grow;
}

bool IndexStream::write(const std::vector<std::uint32_t>& indices) {
  if (indices.empty()) return false;
  const bool grow = indices.size() > capacity_;
  if (grow) {
    capacity_ = grown(indices.size());
    buffer_ = Ogre::HardwareBufferManager::getSingleton().createIndexBuffer(
        Ogre::HardwareIndexBuffer::IT_32BIT, capacity_, kUsage);
  }
  buffer_->writeData(0, indices.size() * sizeof indices[0], indices.data(), true);
  return grow;
}

MeshLayer::MeshLayer(const std::string& name, bool coloured) : Ogre::SimpleRenderable(name) {
  vertices_.vertexDeclaration->addElement(0, 0, Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  if (coloured) {
    vertices_.vertexDeclaration->addElement(1, 0, Ogre::VET_COLOUR_ABGR, Ogre::VES_DIFFUSE);
  }
  mRenderOp.operationType = Ogre::RenderOperation::OT_TRIANGLE_LIST;
  mRenderOp.vertexData = &vertices_;
  mRenderOp.indexData = &indices_;
  mRenderOp.useIndexes = true;
  Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create(
      name + "/material", Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  material->setReceiveShadows(false);
  // Colours of vertices include the shading; a layer of one colour is emissive.
  material->getTechnique(0)->setLightingEnabled(!coloured);
  setMaterial(material);
}

MeshLayer::~MeshLayer() {
  mRenderOp.vertexData = nullptr;
  mRenderOp.indexData = nullptr;
  Ogre::MaterialManager::getSingleton().remove(
      mMaterial->getName(), Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
}

Ogre::Pass& MeshLayer::pass() { return *mMaterial->getTechnique(0)->getPass(0); }

void MeshLayer::setColour(const Ogre::ColourValue& colour) {
  pass().setAmbient(Ogre::ColourValue::Black);
  pass().setDiffuse(Ogre::ColourValue::Black);
  pass().setSelfIllumination(colour);
}

void MeshLayer::setVertices(const VertexStream& positions, const VertexStream* colours,
                            std::size_t count) {
  vertices_.vertexCount = count;
  if (count == 0) return;
  vertices_.vertexBufferBinding->setBinding(0, positions.buffer());
  if (colours != nullptr) vertices_.vertexBufferBinding->setBinding(1, colours->buffer());
}

void MeshLayer::setTriangles(const IndexStream& triangles, std::size_t indices) {
  indices_.indexCount = indices;
  indices_.indexBuffer = triangles.buffer();
}

void MeshLayer::setBox(const Ogre::AxisAlignedBox& box) {
  setBoundingBox(box);
  if (mParentNode != nullptr) mParentNode->needUpdate();
}

bool MeshLayer::empty() const { return vertices_.vertexCount == 0 || indices_.indexCount == 0; }

Ogre::Real MeshLayer::getBoundingRadius() const {
  return Ogre::Math::Sqrt(
      std::max(mBox.getMaximum().squaredLength(), mBox.getMinimum().squaredLength()));
}

Ogre::Real MeshLayer::getSquaredViewDepth(const Ogre::Camera* camera) const {
  return (camera->getDerivedPosition() - mBox.getCenter()).squaredLength();
}

}  // namespace cloth_sim
