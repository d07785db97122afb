#pragma once
/// \file A `Surface` in an Ogre scene: hardware buffers that are written in place.

#include <OgreColourValue.h>

#include <memory>

#include "ros/surface.h"

namespace Ogre {
class SceneManager;
class SceneNode;
}  // namespace Ogre

namespace cloth_sim {

/// Which parts of a surface are drawn.
struct SurfaceLook {
  bool faces = true;
  bool back = true;  ///< of `faces`: also the back side
  bool wireframe = false;
  Ogre::ColourValue wireColour{0.10f, 0.12f, 0.16f};
  Ogre::ColourValue tornColour{0.90f, 0.05f, 0.25f};
};

/// Front, back, wireframe and torn edges of a cloth. Front, back and wireframe share one buffer of
/// positions and one of triangles; what is empty is hidden.
class SurfaceVisual {
 public:
  /// \param parent  outlives this.
  SurfaceVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent);
  ~SurfaceVisual();
  SurfaceVisual(const SurfaceVisual&) = delete;
  SurfaceVisual& operator=(const SurfaceVisual&) = delete;

  /// Writes what `setTopology` of the surface changed. Nothing is shown until the next
  /// `updateVertices`.
  void updateTriangles(const Surface& surface);
  /// Writes what `setFrame` of the surface changed.
  void updateVertices(const Surface& surface);
  void setLook(const SurfaceLook& look);
  void hide();

 private:
  struct Parts;
  void showParts();

  std::unique_ptr<Parts> parts_;
  SurfaceLook look_;
  bool filled_ = false;  ///< there are vertices that fit the triangles
};

}  // namespace cloth_sim
