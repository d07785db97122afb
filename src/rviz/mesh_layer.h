#pragma once
/// \file A drawn list of triangles over vertex buffers that layers may share.

#include <OgreHardwareIndexBuffer.h>
#include <OgreHardwareVertexBuffer.h>
#include <OgreMaterial.h>
#include <OgreSimpleRenderable.h>

#include <string>
#include <vector>

namespace cloth_sim {

/// Returns a name that no other object of Ogre has: "cloth_sim/<part>/<number>".
std::string uniqueOgreName(const std::string& part);

/// A hardware vertex buffer that is written as a whole and grows when needed.
class VertexStream {
 public:
  /// \param vertexBytes  size of one vertex [bytes].
  explicit VertexStream(std::size_t vertexBytes) : vertexBytes_(vertexBytes) {}

  /// \return true if the buffer was replaced by a larger one.
  bool write(const void* data, std::size_t vertices);
  const Ogre::HardwareVertexBufferSharedPtr& buffer() const { return buffer_; }

 private:
  std::size_t vertexBytes_;
  std::size_t capacity_ = 0;  ///< vertices
  Ogre::HardwareVertexBufferSharedPtr buffer_;
};

/// A hardware index buffer that is written as a whole and grows when needed.
class IndexStream {
 public:
  /// \return true if the buffer was replaced by a larger one.
  bool write(const std::vector<std::uint32_t>& indices);
  const Ogre::HardwareIndexBufferSharedPtr& buffer() const { return buffer_; }

 private:
  std::size_t capacity_ = 0;
  Ogre::HardwareIndexBufferSharedPtr buffer_;
};

/// Triangles with a material of their own.
class MeshLayer : public Ogre::SimpleRenderable {
 public:
  /// \param coloured  true: the colours of the vertices come from a second stream; false: all have
  ///                  that of `setColour`.
  MeshLayer(const std::string& name, bool coloured);
  ~MeshLayer() override;
  MeshLayer(const MeshLayer&) = delete;
  MeshLayer& operator=(const MeshLayer&) = delete;

  /// The material's only pass, for settings without a method here.
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
