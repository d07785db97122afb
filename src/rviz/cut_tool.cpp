#include "cut_tool.h"

#include <OgreMaterial.h>
#include <ros/message_traits.h>
#include <rviz/display_context.h>
#include <rviz/ogre_helpers/billboard_line.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/ros_topic_property.h>

#include <cmath>
#include <cstdlib>
#include <pluginlib/class_list_macros.hpp>

namespace cloth_sim {
namespace {

constexpr int kPointSpacing = 3;           ///< least distance between points of a stroke [px]
constexpr std::size_t kMostPoints = 4096;  ///< of a stroke
constexpr double kPieceLength = 15.0;      ///< from which a piece of a stroke is sent [px]
constexpr std::chrono::milliseconds kPieceTime{100};  ///< after which a piece is sent
constexpr std::uint32_t kQueueLength = 1000;          ///< of pieces that are waiting to be sent
constexpr float kLineAt = 1.0f;     ///< distance of the drawn stroke from the camera [m]
constexpr double kLineWidth = 3.0;  ///< [px]
constexpr float kNearest = 0.02f;   ///< distance of the blade's heel from the camera [m]

geometry_msgs::Point toPoint(const Ogre::Vector3& value) {
  geometry_msgs::Point point;
  point.x = value.x;
  point.y = value.y;
  point.z = value.z;
  return point;
}

}  // namespace

CutTool::CutTool() { shortcut_key_ = 'x'; }

CutTool::~CutTool() = default;

void CutTool::onInitialize() {
  setName("Cut");
  topic_ =
      new rviz::RosTopicProperty("Topic", "/cloth/cut_stroke",
                                 QString::fromStdString(ros::message_traits::datatype<CutStroke>()),
                                 "Topic of the strokes.", getPropertyContainer());
  reach_ = new rviz::FloatProperty("Reach", 10.0f, "Length of the blade from the camera [m].",
                                   getPropertyContainer());
  reach_->setMin(0.1f);
  firstLayerOnly_ = new rviz::BoolProperty(
      "First Layer Only", false, "Cut only the layer of cloth in front.", getPropertyContainer());
  whilePressed_ = new rviz::BoolProperty("While Pressed", true,
                                         "Cut while the button is down, not when it is released.",
                                         getPropertyContainer());
  QObject::connect(topic_, &rviz::Property::changed, this, [this] { advertise(); });
  advertise();
  line_ = std::make_unique<rviz::BillboardLine>(scene_manager_);
  line_->setMaxPointsPerLine(kMostPoints);
  line_->setColor(0.90f, 0.05f, 0.25f, 0.99f);  // not opaque, so it is drawn after opaque objects
  line_->getMaterial()->setDepthCheckEnabled(false);
}

void CutTool::advertise() {
  publisher_ = node_.advertise<CutStroke>(topic_->getTopicStd(), kQueueLength);
}

QString CutTool::hint() const {
  return "<b>Left-Click</b>: Cut along the stroke. <b>Right-Click</b>: Abandon the stroke. "
         "<b>Shift, other buttons</b>: Move the camera.";
}

void CutTool::begin(const Pointer& at) {
  clear();
  line_->setLineWidth(static_cast<float>(kLineWidth * at.pixel * kLineAt));
  add(at);
}

void CutTool::move(const Pointer& to) {
  if (std::abs(to.x - last_.x) + std::abs(to.y - last_.y) >= kPointSpacing) add(to);
}

void CutTool::end(const Pointer& at) {
  if (at.x != last_.x || at.y != last_.y) add(at);
  if (stroke_.points.size() >= 2) send();
  cancel();
}

void CutTool::cancel() {
  clear();
  context_->queueRender();
}

/// Called for every picture, also while the pointer rests.
void CutTool::update(float /*wallDt*/, float /*rosDt*/) {
  if (!pressed() || !isPieceDue()) return;
  send();
  clear();
  add(last_);
}

bool CutTool::isPieceDue() const {
  if (!whilePressed_->getBool() || stroke_.points.size() < 2) return false;
  return length_ >= kPieceLength || std::chrono::steady_clock::now() - begun_ >= kPieceTime;
}

void CutTool::clear() {
  stroke_ = CutStroke();
  length_ = 0.0;
  line_->clear();
}

void CutTool::add(const Pointer& point) {
  if (stroke_.points.size() >= kMostPoints) return;
  if (stroke_.points.empty()) {
    begun_ = std::chrono::steady_clock::now();
  } else {
    length_ += std::hypot(point.x - last_.x, point.y - last_.y);
  }
  last_ = point;
  stroke_.heels.push_back(toPoint(point.ray.getPoint(kNearest)));
  stroke_.points.push_back(toPoint(point.ray.getPoint(reach_->getFloat())));
  line_->addPoint(point.ray.getPoint(kLineAt));
}

void CutTool::send() {
  stroke_.header.frame_id =
      context_->getFixedFrame().toStdString();  // stamp 0: the latest transform
  stroke_.first_layer_only = firstLayerOnly_->getBool();
  publisher_.publish(stroke_);
}

}  // namespace cloth_sim

PLUGINLIB_EXPORT_CLASS(cloth_sim::CutTool, rviz::Tool)
