#pragma once
/// \file rviz panel that commands a cloth_node and shows its figures.

#include <dynamic_reconfigure/Config.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rviz/panel.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cloth_sim/ClothState.h"
#include "cloth_sim/GetState.h"

class QBoxLayout;
class QCheckBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace cloth_sim {

class ServiceQueue;
class StripChart;
class ValueSlider;

/// Commands phases, pause, steps, reset and the number of particles by the node's services, sets
/// its dynamic parameters by sliders, and shows counts, rates, warnings and broken springs from its
/// ~state. Never waits for the node.
class ClothPanel : public rviz::Panel {
 public:
  explicit ClothPanel(QWidget* parent = nullptr);
  ~ClothPanel() override;

  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 protected:
  void onInitialize() override;

 private:
  using Clock = std::chrono::steady_clock;

  void addNodeRow(QBoxLayout& column);
  void addTimeRow(QBoxLayout& column);
  void addResolutionRow(QBoxLayout& column);
  void addSliders(QBoxLayout& column);
  void addFigures(QBoxLayout& column);

  void connectTo(const QString& node);
  void onState(const ClothState& state);
  void onParameters(const dynamic_reconfigure::Config& config);
  void showFigures(const ClothState& state);
  void askAboutScene();
  void showScene(const GetState::Response& scene);
  void showPhases(const std::vector<std::string>& phases);
  void countFrame();

  /// Calls a service of the node in the background, and shows its message if it refuses.
  template <typename Service>
  void call(const std::string& name, const typename Service::Request& request);
  void setParameter(const std::string& name, double value);
  void setParameter(const std::string& name, bool value);
  void sendParameters(const dynamic_reconfigure::Config& change);
  void showMessage(const QString& text);

  ros::NodeHandle node_;
  std::string name_;  ///< of the node, "/cloth"
  ros::Subscriber stateSubscriber_;
  ros::Subscriber parametersSubscriber_;
  bool sceneKnown_ = false;
  double time_ = 0.0;  ///< simulated [s]
  bool paused_ = false;
  Clock::time_point framesSince_;
  int frames_ = 0;          ///< of rviz, since `framesSince_`
  double frameRate_ = 0.0;  ///< [Hz]

  // Widgets are owned by this.
  QLineEdit* nodeEdit_ = nullptr;
  QPushButton* pauseButton_ = nullptr;
  QSpinBox* stepCount_ = nullptr;
  QSpinBox* columns_ = nullptr;
  QLabel* rows_ = nullptr;
  QPushButton* resizeButton_ = nullptr;
  QGridLayout* phaseGrid_ = nullptr;
  std::map<std::string, QPushButton*> phaseButtons_;
  QCheckBox* tearing_ = nullptr;
  std::map<std::string, ValueSlider*> sliders_;  ///< by parameter
  QLabel* rates_ = nullptr;
  QLabel* counts_ = nullptr;
  StripChart* chart_ = nullptr;
  QLabel* message_ = nullptr;

  std::unique_ptr<ServiceQueue> services_;  // last: its tasks use everything above
};

}  // namespace cloth_sim
