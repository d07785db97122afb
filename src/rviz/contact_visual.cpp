#include "contact_visual.h"

#include <rviz/ogre_helpers/billboard_line.h>

#include <algorithm>

#include "cloth_sim/ros/shading.h"

namespace cloth_sim {
namespace {

Ogre::Vector3 vectorAt(const std::vector<float>& values, std::size_t k) {
  return {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
}

}  // namespace

ContactVisual::ContactVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent)
    : lines_(std::make_unique<rviz::BillboardLine>(&scene, &parent)) {
  lines_->setMaxPointsPerLine(2);
  lines_->setLineWidth(static_cast<float>(kContactWidth));
}

ContactVisual::~ContactVisual() = default;

void ContactVisual::show(const ClothContacts& contacts, float length) {
  hide();
  const std::size_t count = std::min(
      {contacts.positions.size() / 3, contacts.normals.size() / 3, contacts.forces.size()});
  if (count == 0) return;
  lines_->setNumLines(static_cast<std::uint32_t>(count));
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0) lines_->newLine();
    const Ogre::Vector3 place = vectorAt(contacts.positions, k);
    const Ogre::Vector3 reach = 0.5f * length * vectorAt(contacts.normals, k);
    const std_msgs::ColorRGBA colour = contactColour(contacts.forces[k]);
    const Ogre::ColourValue ogreColour(colour.r, colour.g, colour.b);
    lines_->addPoint(place - reach, ogreColour);
    lines_->addPoint(place + reach, ogreColour);
  }
}

void ContactVisual::hide() { lines_->clear(); }

}  // namespace cloth_sim
