#include "strain_legend.h"

#include <OgreHardwarePixelBuffer.h>
#include <OgreMaterialManager.h>
#include <OgreResourceGroupManager.h>
#include <OgreTechnique.h>
#include <OgreTextureManager.h>
#include <Overlay/OgreOverlay.h>
#include <Overlay/OgreOverlayManager.h>
#include <Overlay/OgrePanelOverlayElement.h>

#include <QImage>
#include <QPainter>
#include <QString>
#include <string>

#include "cloth_sim/ros/shading.h"
#include "mesh_layer.h"

namespace cloth_sim {
namespace {

constexpr int kLegendWidth = 104;   ///< of the legend [px]
constexpr int kLegendHeight = 216;  ///< [px]
constexpr int kLegendMargin = 12;   ///< from the corner of the view [px]
constexpr int kBarTop = 34;         ///< [px]
constexpr int kBarLeft = 14;        ///< [px]
constexpr int kBarWidth = 22;       ///< [px]
constexpr int kBarHeight = 168;     ///< [px]
constexpr int kTicks = 4;           ///< parts between numbers

QColor toQt(const std_msgs::ColorRGBA& colour) {
  return QColor::fromRgbF(colour.r, colour.g, colour.b);
}

QImage paintLegend(double range) {
  QImage image(kLegendWidth, kLegendHeight, QImage::Format_ARGB32);
  image.fill(Qt::transparent);
  QPainter painter(&image);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(255, 255, 255, 200));
  painter.drawRoundedRect(image.rect(), 6, 6);
  for (int row = 0; row < kBarHeight; ++row) {
    const double fraction = 1.0 - (row + 0.5) / kBarHeight;
    painter.fillRect(kBarLeft, kBarTop + row, kBarWidth, 1, toQt(strainColour(fraction)));
  }
  painter.setPen(QColor(30, 36, 46));
  QFont font("DejaVu Sans");
  font.setPixelSize(13);
  painter.setFont(font);
  painter.drawText(QRect(0, 6, kLegendWidth, 20), Qt::AlignHCenter | Qt::AlignVCenter, "strain");
  for (int tick = 0; tick <= kTicks; ++tick) {
    const double fraction = static_cast<double>(tick) / kTicks;
    const int y = kBarTop + static_cast<int>((1.0 - fraction) * kBarHeight);
    painter.drawLine(kBarLeft + kBarWidth, y, kBarLeft + kBarWidth + 4, y);
    painter.drawText(QRect(kBarLeft + kBarWidth + 8, y - 9, kLegendWidth, 18),
                     Qt::AlignLeft | Qt::AlignVCenter, QString::number(fraction * range, 'g', 3));
  }
  return image;
}

}  // namespace

StrainLegend::StrainLegend() {
  const std::string name = uniqueOgreName("strain_legend");
  texture_ = Ogre::TextureManager::getSingleton().createManual(
      name + "/texture", Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME, Ogre::TEX_TYPE_2D,
      kLegendWidth, kLegendHeight, 0, Ogre::PF_A8R8G8B8, Ogre::TU_DEFAULT);
  material_ = Ogre::MaterialManager::getSingleton().create(
      name + "/material", Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  Ogre::Pass& pass = *material_->getTechnique(0)->getPass(0);
  pass.createTextureUnitState(texture_->getName());
  pass.setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
  pass.setLightingEnabled(false);
  pass.setDepthCheckEnabled(false);
  pass.setDepthWriteEnabled(false);

  Ogre::OverlayManager& overlays = Ogre::OverlayManager::getSingleton();
  overlay_ = overlays.create(name);
  panel_ = static_cast<Ogre::PanelOverlayElement*>(
      overlays.createOverlayElement("Panel", name + "/panel"));
  panel_->setMetricsMode(Ogre::GMM_PIXELS);
  panel_->setVerticalAlignment(Ogre::GVA_BOTTOM);
  panel_->setDimensions(kLegendWidth, kLegendHeight);
  panel_->setPosition(kLegendMargin, -(kLegendHeight + kLegendMargin));
  panel_->setMaterialName(material_->getName(),
                          Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  overlay_->add2D(panel_);
}

StrainLegend::~StrainLegend() {
  Ogre::OverlayManager& overlays = Ogre::OverlayManager::getSingleton();
  overlay_->hide();
  overlay_->remove2D(panel_);
  overlays.destroyOverlayElement(panel_);
  overlays.destroy(overlay_);
  Ogre::MaterialManager::getSingleton().remove(
      material_->getName(), Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  Ogre::TextureManager::getSingleton().remove(
      texture_->getName(), Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
}

void StrainLegend::show(bool visible) { visible ? overlay_->show() : overlay_->hide(); }

void StrainLegend::setRange(double range) {
  QImage image = paintLegend(range);
  const Ogre::PixelBox pixels(kLegendWidth, kLegendHeight, 1, Ogre::PF_A8R8G8B8, image.bits());
  texture_->getBuffer()->blitFromMemory(pixels);
}

}  // namespace cloth_sim
