#pragma once
/// \file rviz display of a cloth, from ~topology, ~frame and ~contacts.

#include <ros/subscriber.h>
#include <rviz/display.h>

#include <memory>

#include "cloth_sim/ClothContacts.h"
#include "ros/surface.h"
#include "surface_visual.h"

namespace rviz {
class BoolProperty;
class ColorProperty;
class EnumProperty;
class FloatProperty;
class RosTopicProperty;
}  // namespace rviz

namespace cloth_sim {

class ContactVisual;
class SceneFraming;
class StrainLegend;

/// Draws the newest frame whose topology is known, once per frame of rviz. A frame that arrives
/// before its topology waits for it; other frames of another revision are dropped. Contacts between
/// layers are subscribed only while they are shown.
class ClothDisplay : public rviz::Display {
 public:
  ClothDisplay();
  ~ClothDisplay() override;

  void setTopic(const QString& topic, const QString& datatype) override;
  void reset() override;
  void update(float wallDt, float rosDt) override;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;
  void fixedFrameChanged() override { reset(); }

 private:
  /// Counts since the last report.
  struct Statistics {
    int frames = 0;        ///< drawn
    int dropped = 0;       ///< frames of another revision
    double busy = 0.0;     ///< time spent on computing vertices and filling buffers [s]
    double slowest = 0.0;  ///< largest time spent on one frame [s]
    double elapsed = 0.0;  ///< since the last report [s]
  };

  void subscribe();
  void unsubscribe();
  void onTopology(const ClothTopology::ConstPtr& topology);
  void onFrame(const ClothFrame::ConstPtr& frame);
  void onContacts(const ClothContacts::ConstPtr& contacts);
  void subscribeContacts();
  void drawWaiting();
  void drawContacts();
  void subscribeFraming();
  void frameScene();
  bool placeInScene(const std::string& frame);
  void addSurfaceProperties();
  void addBorderProperties();
  void applyStyle();
  SurfaceStyle style() const;
  SurfaceParts parts() const;
  void report(double elapsed);

  Surface surface_;
  std::unique_ptr<SurfaceVisual> visual_;
  std::unique_ptr<ContactVisual> contactVisual_;
  std::unique_ptr<StrainLegend> legend_;
  std::unique_ptr<SceneFraming> framing_;
  ros::Subscriber topologySubscriber_;
  ros::Subscriber frameSubscriber_;
  ros::Subscriber contactSubscriber_;
  ClothFrame::ConstPtr waiting_;  ///< received, not drawn yet
  ClothFrame::ConstPtr counted_;  ///< the last frame counted as dropped
  ClothFrame::ConstPtr drawn_;
  ClothContacts::ConstPtr waitingContacts_;  ///< received, not drawn yet
  bool visualIsStale_ = true;                ///< the triangles of `visual_` are of another revision
  Statistics statistics_;

  // Owned by rviz.
  rviz::RosTopicProperty* topic_ = nullptr;
  rviz::EnumProperty* mode_ = nullptr;
  rviz::BoolProperty* strain_ = nullptr;
  rviz::FloatProperty* strainRange_ = nullptr;
  rviz::BoolProperty* showLegend_ = nullptr;
  rviz::ColorProperty* frontColour_ = nullptr;
  rviz::BoolProperty* showBack_ = nullptr;
  rviz::ColorProperty* backColour_ = nullptr;
  rviz::ColorProperty* wireColour_ = nullptr;
  rviz::BoolProperty* showBorder_ = nullptr;
  rviz::ColorProperty* borderColour_ = nullptr;
  rviz::FloatProperty* borderWidth_ = nullptr;
  rviz::ColorProperty* tornColour_ = nullptr;
  rviz::FloatProperty* tornWidth_ = nullptr;
  rviz::BoolProperty* showContacts_ = nullptr;
  rviz::FloatProperty* contactLength_ = nullptr;
  rviz::BoolProperty* framesScene_ = nullptr;
};

}  // namespace cloth_sim
