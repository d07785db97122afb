#pragma once
/// \file A `Surface` in an Ogre scene, in hardware buffers that are written in place.

#include <OgreColourValue.h>

#include <memory>

#include "ros/surface.h"

namespace Ogre {
class SceneManager;
class SceneNode;
}  // namespace Ogre

namespace cloth_sim {

/// The parts of a surface that are drawn, and their colours.
struct SurfaceParts {
  bool faces = true;
  bool back = true;  ///< the back side of `faces`, too
  bool wireframe = false;
  Ogre::ColourValue wireColour{0.10f, 0.12f, 0.16f};
  Ogre::ColourValue tornColour{0.90f, 0.05f, 0.25f};
  bool border = true;
  Ogre::ColourValue borderColour{0.10f, 0.12f, 0.16f};
};

/// Front, back, wireframe, border and torn edges of a cloth. Front, back and wireframe share one
/// buffer of positions and one of triangles. Parts without triangles are hidden.
class SurfaceVisual {
 public:
  /// \param parent  outlives this.
  SurfaceVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent);
  ~SurfaceVisual();
  SurfaceVisual(const SurfaceVisual&) = delete;
  SurfaceVisual& operator=(const SurfaceVisual&) = delete;

  /// Copies the triangles of the surface, after its `setTopology`. Nothing is shown until the next
  /// `updateVertices`.
  void updateTriangles(const Surface& surface);
  /// Copies the vertices and colours of the surface, after its `setFrame`.
  void updateVertices(const Surface& surface);
  void setParts(const SurfaceParts& parts);
  void hide();

 private:
  struct Layers;
  void showParts();

  std::unique_ptr<Layers> layers_;
  SurfaceParts parts_;
  bool filled_ = false;  ///< the vertices belong to the triangles
};

}  // namespace cloth_sim
