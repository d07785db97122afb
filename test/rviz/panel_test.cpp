/// \file The panel with a real node, without rviz and without a screen.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <QApplication>
#include <QCheckBox>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QSpinBox>
#include <chrono>
#include <functional>

#include "cloth_sim/GetState.h"
#include "cloth_sim/Pause.h"
#include "cloth_sim/ResetScene.h"
#include "rviz/cloth_panel.h"

namespace cloth_sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kDeadline{30};

/// Runs Qt and ROS until the condition holds.
bool becomes(const std::function<bool()>& condition) {
  const Clock::time_point end = Clock::now() + kDeadline;
  while (!condition()) {
    if (Clock::now() > end) return false;
    ros::spinOnce();
    QApplication::processEvents(QEventLoop::AllEvents, 5);
  }
  return true;
}

GetState::Response node() {
  GetState exchange;
  EXPECT_TRUE(ros::service::call("/cloth/get_state", exchange));
  return exchange.response;
}

class PanelTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/cloth/get_state", ros::Duration(30.0)));
    Pause pause;
    pause.request.paused = true;
    ResetScene reset;
    ASSERT_TRUE(ros::service::call("/cloth/pause", pause));
    ASSERT_TRUE(ros::service::call("/cloth/reset", reset));
    panel_.show();
    ASSERT_TRUE(becomes([this] { return button("Play") && button("notch"); }));
  }

  QPushButton* button(const QString& text) const {
    for (auto* found : panel_.findChildren<QPushButton*>()) {
      if (found->text() == text) return found;
    }
    return nullptr;
  }
  bool says(const QString& text) const {
    for (auto* label : panel_.findChildren<QLabel*>()) {
      if (label->text().contains(text)) return true;
    }
    return false;
  }
  double parameter(const std::string& name) const {
    double value = 0.0;
    ros::param::get("/cloth/" + name, value);
    return value;
  }

  ClothPanel panel_;
};

TEST_F(PanelTest, ShowsCounts) {
  EXPECT_TRUE(becomes([this] { return says("289 particles, 512 faces, pieces 1"); }));
  EXPECT_TRUE(says("broken: 0"));
}

TEST_F(PanelTest, TextScrollsWhereTheWindowIsLow) {
  ASSERT_TRUE(becomes([this] { return says("289 particles"); }));
  auto* scroll = panel_.findChild<QScrollArea*>();
  ASSERT_NE(scroll, nullptr);
  for (const int height : {420, 900}) {
    panel_.resize(340, height);
    EXPECT_TRUE(becomes([&] {
      for (auto* label : scroll->findChildren<QLabel*>()) {
        if (label->height() < label->heightForWidth(label->width())) return false;
      }
      return true;
    })) << "a line is cut off at "
        << height << " px";
  }
  EXPECT_EQ(scroll->verticalScrollBar()->maximum(), 0) << "900 px show all lines";
}

TEST_F(PanelTest, PlaysAndPauses) {
  button("Play")->click();
  ASSERT_TRUE(becomes([this] { return button("Pause") != nullptr; }));
  EXPECT_TRUE(becomes([] { return node().state.step > 5; }));
  button("Pause")->click();
  ASSERT_TRUE(becomes([this] { return button("Play") != nullptr; }));
  EXPECT_TRUE(node().state.paused);
}

TEST_F(PanelTest, StepsAndResets) {
  panel_.findChild<QSpinBox*>()->setValue(7);
  button("Step")->click();
  ASSERT_TRUE(becomes([] { return node().state.step == 7; }));
  button("Reset")->click();
  EXPECT_TRUE(becomes([] { return node().state.step == 0; }));
}

TEST_F(PanelTest, ResizesTheCloth) {
  auto* columns = panel_.findChild<QSpinBox*>("Columns");
  ASSERT_NE(columns, nullptr);
  ASSERT_TRUE(becomes([&] { return columns->value() == 17; })) << "as the scene says";
  columns->setValue(9);
  button("Resize")->click();
  EXPECT_TRUE(becomes([this] { return says("81 particles, 128 faces, pieces 1"); }));
  EXPECT_EQ(node().columns, 9u);
  EXPECT_EQ(node().rows, 9u);
  button("Reset")->click();
  EXPECT_TRUE(becomes([] { return node().state.step == 0; }));
  EXPECT_EQ(node().columns, 9u) << "a reset keeps the size";
  columns->setValue(17);
  button("Resize")->click();
  EXPECT_TRUE(becomes([this] { return says("289 particles, 512 faces, pieces 1"); }));
}

TEST_F(PanelTest, PhaseButtonsBeginPhasesAndBrokenSpringsShow) {
  button("notch")->click();
  ASSERT_TRUE(becomes([] { return node().state.phase == "notch"; }));
  const unsigned total = node().state.broken.total;
  ASSERT_GT(total, 0u);
  EXPECT_TRUE(becomes([&] { return says(QString("broken: %1 (").arg(total)); }));
  EXPECT_TRUE(becomes([this] { return button("notch")->font().bold(); }));
  EXPECT_FALSE(button("stop")->font().bold());
}

TEST_F(PanelTest, SlidersTurnTheNodesParameters) {
  auto* gravity = panel_.findChild<QSlider*>("Gravity");
  ASSERT_NE(gravity, nullptr);
  ASSERT_TRUE(becomes([this] { return says("9.81 m/s"); })) << "what the scene says";
  gravity->setValue(gravity->minimum());
  EXPECT_TRUE(becomes([this] { return parameter("gravity") == 0.0; }));
  auto* stiffness = panel_.findChild<QSlider*>("Stiffness");
  stiffness->setValue(stiffness->maximum());
  EXPECT_TRUE(becomes([this] { return parameter("stiffness") > 19.9; }));
  EXPECT_EQ(parameter("gravity"), 0.0) << "each slider changes its own";
}

TEST_F(PanelTest, SlidersFollowWhatOthersTurn) {
  auto* stiffness = panel_.findChild<QSlider*>("Stiffness");
  stiffness->setValue(stiffness->maximum());
  ASSERT_TRUE(becomes([this] { return parameter("stiffness") > 19.9; }));
  button("Reset")->click();
  // In the middle of a logarithmic range of 1/20 ... 20.
  EXPECT_TRUE(becomes([&] { return stiffness->value() == stiffness->maximum() / 2; }));
}

TEST_F(PanelTest, TearingIsSwitched) {
  auto* tearing = panel_.findChild<QCheckBox*>();
  ASSERT_TRUE(becomes([&] { return tearing->isChecked(); })) << "as the scene says";
  tearing->click();
  EXPECT_TRUE(becomes([] {
    bool value = true;
    return ros::param::get("/cloth/tearing", value) && !value;
  }));
}

TEST_F(PanelTest, ANodeThatIsNotThereIsTold) {
  rviz::Config config;
  config.mapSetValue("Node", "/nobody");
  panel_.load(config);
  button("Reset")->click();
  EXPECT_TRUE(becomes([this] { return says("/nobody/reset does not answer"); }));
}

}  // namespace
}  // namespace cloth_sim

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "panel_test");
  ros::NodeHandle keep;  // keeps ROS up between the panels of the tests
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
