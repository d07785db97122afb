#pragma once
/// \file The legend of the strain colours, over a corner of the 3D view.

#include <OgreTexture.h>

namespace Ogre {
class Overlay;
class PanelOverlayElement;
}  // namespace Ogre

namespace cloth_sim {

/// Shows the colour map with its numbers.
class StrainLegend {
 public:
  StrainLegend();
  ~StrainLegend();
  StrainLegend(const StrainLegend&) = delete;
  StrainLegend& operator=(const StrainLegend&) = delete;

  void show(bool visible);
  /// \param range  strain of the last colour [-], > 0.
  void setRange(double range);

 private:
  Ogre::Overlay* overlay_ = nullptr;
  Ogre::PanelOverlayElement* panel_ = nullptr;
  Ogre::TexturePtr texture_;
  Ogre::MaterialPtr material_;
};

}  // namespace cloth_sim
