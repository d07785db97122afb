#include "cloth_display.h"

#include <OgreSceneNode.h>
#include <ros/message_traits.h>
#include <ros/names.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/color_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/ros_topic_property.h>

#include <algorithm>
#include <chrono>
#include <pluginlib/class_list_macros.hpp>

#include "cloth_sim/ros/shading.h"
#include "contact_visual.h"
#include "scene_framing.h"
#include "strain_legend.h"

namespace cloth_sim {
namespace {

using Status = rviz::StatusProperty;

enum Mode { kSurface, kSurfaceAndWireframe, kWireframe };

constexpr double kReportPeriod = 1.0;  ///< [s]
constexpr double kMilli = 1e-3;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std_msgs::ColorRGBA toColour(const rviz::ColorProperty& property) {
  const QColor colour = property.getColor();
  return makeColour(static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()),
                    static_cast<float>(colour.blueF()));
}

/// Returns a topic beside that of frames: "/cloth/topology" beside "/cloth/frame".
std::string topicBeside(const std::string& frameTopic, const std::string& name) {
  return ros::names::append(ros::names::parentNamespace(frameTopic), name);
}

}  // namespace

ClothDisplay::ClothDisplay() {
  topic_ = new rviz::RosTopicProperty(
      "Topic", "/cloth/frame", QString::fromStdString(ros::message_traits::datatype<ClothFrame>()),
      "Frames of a cloth; \"topology\" and \"contacts\" are taken from the same namespace.", this);
  connect(topic_, &rviz::Property::changed, this, [this] {
    unsubscribe();
    surface_ = Surface();
    reset();
    subscribe();
  });
  addSurfaceProperties();
  showContacts_ = new rviz::BoolProperty(
      "Contacts", false, "Show where layers of cloth carry load, in the colour of the force.",
      this);
  contactLength_ =
      new rviz::FloatProperty("Length", static_cast<float>(2.0 * kContactReach),
                              "Length of the line across the layers [m].", showContacts_);
  contactLength_->setMin(0.0f);
  framesScene_ = new rviz::BoolProperty(
      "Frame Scene", false, "Move the camera to show the whole scene when a node begins with it.",
      this);
  connect(framesScene_, &rviz::Property::changed, this, [this] { subscribeFraming(); });
  connect(showContacts_, &rviz::Property::changed, this, [this] { subscribeContacts(); });
}

void ClothDisplay::addSurfaceProperties() {
  mode_ = new rviz::EnumProperty("Style", "Surface", "Parts of the cloth that are drawn.", this);
  mode_->addOption("Surface", kSurface);
  mode_->addOption("Surface and wireframe", kSurfaceAndWireframe);
  mode_->addOption("Wireframe", kWireframe);
  strain_ = new rviz::BoolProperty("Strain", true, "Colour the front by strain.", this);
  strainRange_ = new rviz::FloatProperty("Strain Range", 0.2f,
                                         "Strain of the last colour of the map.", strain_);
  strainRange_->setMin(1e-4f);
  showLegend_ =
      new rviz::BoolProperty("Legend", true, "Show the colours with their strains.", strain_);
  frontColour_ = new rviz::ColorProperty("Front Color", QColor(59, 107, 158),
                                         "Colour of the front when strain is not shown.", this);
  showBack_ = new rviz::BoolProperty("Back", true, "Draw the back side.", this);
  backColour_ =
      new rviz::ColorProperty("Color", QColor(219, 189, 158), "Colour of the back.", showBack_);
  wireColour_ =
      new rviz::ColorProperty("Wire Color", QColor(26, 31, 41), "Colour of the wireframe.", this);
  addBorderProperties();
  for (rviz::Property* property : std::initializer_list<rviz::Property*>{
           mode_, strain_, strainRange_, showLegend_, frontColour_, showBack_, backColour_,
           wireColour_, showBorder_, borderColour_, borderWidth_, tornColour_, tornWidth_}) {
    connect(property, &rviz::Property::changed, this, [this] { applyStyle(); });
  }
}

void ClothDisplay::addBorderProperties() {
  showBorder_ = new rviz::BoolProperty(
      "Border", true, "Draw the borders of cloths, so that layers can be told apart.", this);
  borderColour_ =
      new rviz::ColorProperty("Color", QColor(26, 31, 41), "Colour of the borders.", showBorder_);
  borderWidth_ = new rviz::FloatProperty("Width", 0.002f, "Width of the borders [m].", showBorder_);
  borderWidth_->setMin(0.0f);
  tornColour_ = new rviz::ColorProperty("Torn Color", QColor(230, 13, 64),
                                        "Colour of the edges made by tears and cuts.", this);
  tornWidth_ = new rviz::FloatProperty("Torn Width", 0.005f,
                                       "Width of the edges made by tears and cuts [m].", this);
  tornWidth_->setMin(0.0f);
}

ClothDisplay::~ClothDisplay() { unsubscribe(); }

void ClothDisplay::onInitialize() {
  visual_ = std::make_unique<SurfaceVisual>(*scene_manager_, *scene_node_);
  contactVisual_ = std::make_unique<ContactVisual>(*scene_manager_, *scene_node_);
  legend_ = std::make_unique<StrainLegend>();
  framing_ = std::make_unique<SceneFraming>(*context_);
  applyStyle();
}

void ClothDisplay::onEnable() {
  subscribe();
  applyStyle();
}

void ClothDisplay::onDisable() {
  unsubscribe();
  reset();
  legend_->show(false);
}

void ClothDisplay::setTopic(const QString& topic, const QString& /*datatype*/) {
  topic_->setString(topic);
}

void ClothDisplay::reset() {
  Display::reset();
  waiting_.reset();
  drawn_.reset();
  statistics_ = Statistics();
  if (visual_) visual_->hide();
  waitingContacts_.reset();
  if (contactVisual_) contactVisual_->hide();
}

void ClothDisplay::subscribe() {
  const std::string frames = topic_->getTopicStd();
  if (!isEnabled() || frames.empty()) return;
  try {
    topologySubscriber_ =
        update_nh_.subscribe(topicBeside(frames, "topology"), 10, &ClothDisplay::onTopology, this);
    // A queue of one: a slow screen shows fewer frames instead of old ones.
    frameSubscriber_ = update_nh_.subscribe(frames, 1, &ClothDisplay::onFrame, this,
                                            ros::TransportHints().tcpNoDelay());
    setStatus(Status::Warn, "Topic", "no topology yet");
  } catch (const ros::Exception& error) {
    setStatusStd(Status::Error, "Topic", error.what());
  }
  subscribeContacts();
  subscribeFraming();
}

void ClothDisplay::subscribeFraming() {
  const std::string frames = topic_->getTopicStd();
  if (!framing_) return;
  framing_->unsubscribe();
  if (!isEnabled() || frames.empty() || !framesScene_->getBool()) return;
  try {
    framing_->subscribe(update_nh_, topicBeside(frames, "scene"),
                        topicBeside(frames, "scene_markers"));
  } catch (const ros::Exception& error) {
    setStatusStd(Status::Error, "Topic", error.what());
  }
}

/// Subscribes to the contacts if they are shown, so that the node computes them for nobody else.
void ClothDisplay::subscribeContacts() {
  contactSubscriber_.shutdown();
  waitingContacts_.reset();
  if (contactVisual_) contactVisual_->hide();
  const std::string frames = topic_->getTopicStd();
  if (!isEnabled() || frames.empty() || !showContacts_->getBool()) return;
  try {
    contactSubscriber_ =
        update_nh_.subscribe(topicBeside(frames, "contacts"), 1, &ClothDisplay::onContacts, this);
  } catch (const ros::Exception& error) {
    setStatusStd(Status::Error, "Topic", error.what());
  }
}

void ClothDisplay::unsubscribe() {
  topologySubscriber_.shutdown();
  frameSubscriber_.shutdown();
  contactSubscriber_.shutdown();
  if (framing_) framing_->unsubscribe();
}

void ClothDisplay::onTopology(const ClothTopology::ConstPtr& topology) {
  const std::string error = surface_.setTopology(*topology);
  if (!error.empty()) {
    setStatusStd(Status::Error, "Topic", "topology: " + error);
    return;
  }
  // The screen keeps the old surface until the first frame of the new revision.
  visualIsStale_ = true;
  setStatus(Status::Ok, "Topic", "OK");
}

void ClothDisplay::onFrame(const ClothFrame::ConstPtr& frame) { waiting_ = frame; }

void ClothDisplay::onContacts(const ClothContacts::ConstPtr& contacts) {
  waitingContacts_ = contacts;
}

void ClothDisplay::update(float wallDt, float /*rosDt*/) {
  drawWaiting();
  drawContacts();
  frameScene();
  report(wallDt);
}

void ClothDisplay::drawWaiting() {
  if (!waiting_) return;
  if (!surface_.fits(*waiting_)) {
    // The topology may be on its way; a newer frame replaces this one.
    if (waiting_ != counted_) ++statistics_.dropped;
    counted_ = waiting_;
    return;
  }
  const double start = now();
  const std::string error = surface_.setFrame(*waiting_, style());
  if (error.empty() && placeInScene(waiting_->header.frame_id)) {
    if (std::exchange(visualIsStale_, false)) visual_->updateTriangles(surface_);
    visual_->updateVertices(surface_);
    drawn_ = waiting_;
    context_->queueRender();
    const double took = now() - start;
    ++statistics_.frames;
    statistics_.busy += took;
    statistics_.slowest = std::max(statistics_.slowest, took);
  } else if (!error.empty()) {
    setStatusStd(Status::Error, "Topic", "frame: " + error);
  }
  waiting_.reset();
}

/// The contacts are in the frame of the cloth, whose node is in place once a frame is drawn.
void ClothDisplay::drawContacts() {
  if (!waitingContacts_ || !drawn_) return;
  contactVisual_->show(*waitingContacts_, contactLength_->getFloat());
  waitingContacts_.reset();
  context_->queueRender();
}

void ClothDisplay::frameScene() {
  if (!drawn_) return;
  const Eigen::Vector3f& low = surface_.low();
  const Eigen::Vector3f& high = surface_.high();
  framing_->update({low.x(), low.y(), low.z(), high.x(), high.y(), high.z()}, *scene_node_);
}

/// Moves the scene node to the pose of the positions' frame in the fixed frame.
/// \return false if tf does not know the pose.
bool ClothDisplay::placeInScene(const std::string& frame) {
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  if (!context_->getFrameManager()->getTransform(frame, ros::Time(), position, orientation)) {
    setStatusStd(Status::Error, "Transform",
                 "no transform from " + frame + " to " + fixed_frame_.toStdString());
    return false;
  }
  setStatus(Status::Ok, "Transform", "OK");
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  return true;
}

SurfaceStyle ClothDisplay::style() const {
  SurfaceStyle style;
  style.strain = strain_->getBool();
  style.strainRange = strainRange_->getFloat();
  style.front = toColour(*frontColour_);
  style.back = toColour(*backColour_);
  style.tornWidth = tornWidth_->getFloat();
  style.borderWidth = borderWidth_->getFloat();
  return style;
}

SurfaceParts ClothDisplay::parts() const {
  SurfaceParts parts;
  parts.faces = mode_->getOptionInt() != kWireframe;
  parts.wireframe = mode_->getOptionInt() != kSurface;
  parts.back = showBack_->getBool();
  parts.wireColour = wireColour_->getOgreColor();
  parts.tornColour = tornColour_->getOgreColor();
  parts.border = showBorder_->getBool();
  parts.borderColour = borderColour_->getOgreColor();
  return parts;
}

void ClothDisplay::applyStyle() {
  if (!visual_) return;
  visual_->setParts(parts());
  legend_->setRange(strainRange_->getFloat());
  legend_->show(isEnabled() && strain_->getBool() && showLegend_->getBool() &&
                mode_->getOptionInt() != kWireframe);
  if (!waiting_) waiting_ = drawn_;  // repaint
  context_->queueRender();
}

void ClothDisplay::report(double elapsed) {
  statistics_.elapsed += elapsed;
  if (statistics_.elapsed < kReportPeriod) return;
  if (statistics_.frames > 0) {
    const QString text = QString("%1 vertices, %2 Hz; update %3 ms (slowest %4 ms); %5 dropped")
                             .arg(surface_.vertexCount())
                             .arg(statistics_.frames / statistics_.elapsed, 0, 'f', 1)
                             .arg(statistics_.busy / statistics_.frames / kMilli, 0, 'f', 2)
                             .arg(statistics_.slowest / kMilli, 0, 'f', 2)
                             .arg(statistics_.dropped);
    setStatus(Status::Ok, "Frames", text);
  }
  statistics_ = Statistics();
}

}  // namespace cloth_sim

PLUGINLIB_EXPORT_CLASS(cloth_sim::ClothDisplay, rviz::Display)
