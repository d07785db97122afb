#pragma once
/// \file One drawn list of triangles over vertex buffers that may be shared.

#include <OgreHardwareIndexBuffer.h>
#include <OgreHardwareVertexBuffer.h>
#include <OgreMaterial.h>
#include <OgreSimpleRenderable.h>

#include <vector>

namespace cloth_sim {

/// A vertex buffer that grows and is written as a whole.
class VertexStream {
 public:
  /// \param vertexBytes  size of one vertex.
  explicit VertexStream(std::size_t vertexBytes) : vertexBytes_(vertexBytes) {}

  /// \return whether the buffer is another one than before.
  bool write(const void* data, std::size_t vertices);
  const Ogre::HardwareVertexBufferSharedPtr& buffer() const { return buffer_; }

 private:
  std::size_t vertexBytes_;
  std::size_t capacity_ = 0;  ///< vertices
  Ogre::HardwareVertexBufferSharedPtr buffer_;
};

/// An index buffer of the same kind.
class IndexStream {
 public:
  /// \return whether the buffer is another one than before.
  bool write(const std::vector<std::uint32_t>& indices);
  const Ogre::HardwareIndexBufferSharedPtr& buffer() const { return buffer_; }

 private:
  std::size_t capacity_ = 0;
  Ogre::HardwareIndexBufferSharedPtr buffer_;
};

/// Triangles with a material of their own.
class MeshLayer : public Ogre::SimpleRenderable {
 public:
  /// \param coloured  vertices have colours, from a second stream; else `setColour` counts.
  MeshLayer(const std::string& name, bool coloured);
  ~MeshLayer() override;
  MeshLayer(const MeshLayer&) = delete;
  MeshLayer& operator=(const MeshLayer&) = delete;

  /// For its settings that are not here.
  Ogre::Pass& pass();
  void setColour(const Ogre::ColourValue& colour);

  /// \param colours  null unless the layer is coloured.
  void setVertices(const VertexStream& positions, const VertexStream* colours, std::size_t count);
  void setTriangles(const IndexStream& triangles, std::size_t indices);
  void setBox(const Ogre::AxisAlignedBox& box);
  bool empty() const;

  Ogre::Real getBoundingRadius() const override;
  Ogre::Real getSquaredViewDepth(const Ogre::Camera* camera) const override;

 private:
  Ogre::VertexData vertices_;
  Ogre::IndexData indices_;
};

}  // namespace cloth_sim
