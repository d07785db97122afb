#pragma once
/// \file Contacts between layers of cloth in an Ogre scene.

#include <memory>

#include "cloth_sim/ClothContacts.h"

namespace Ogre {
class SceneManager;
class SceneNode;
}  // namespace Ogre
namespace rviz {
class BillboardLine;
}

namespace cloth_sim {

/// A line across the layers for each contact, in the colour of its force.
class ContactVisual {
 public:
  /// \param parent  outlives this.
  ContactVisual(Ogre::SceneManager& scene, Ogre::SceneNode& parent);
  ~ContactVisual();
  ContactVisual(const ContactVisual&) = delete;
  ContactVisual& operator=(const ContactVisual&) = delete;

  /// Draws these contacts instead of those before. Entries that are not complete are left out.
  /// \param length  of a line [m].
  void show(const ClothContacts& contacts, float length);
  void hide();

 private:
  std::unique_ptr<rviz::BillboardLine> lines_;
};

}  // namespace cloth_sim
