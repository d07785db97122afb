#include "cloth_panel.h"

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/service.h>
#include <rviz/visualization_manager.h>

#include <QCheckBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>
#include <pluginlib/class_list_macros.hpp>

#include "cloth_sim/ChangeResolution.h"
#include "cloth_sim/ClothConfig.h"
#include "cloth_sim/Pause.h"
#include "cloth_sim/ResetScene.h"
#include "cloth_sim/StartPhase.h"
#include "cloth_sim/Step.h"
#include "cloth_sim/scene/resolution.h"
#include "service_queue.h"
#include "strip_chart.h"
#include "value_slider.h"

namespace cloth_sim {
namespace {

constexpr int kPhaseColumns = 3;
constexpr int kLeastLines = 11;  ///< of text shown, in the lowest window
constexpr int kSpacing = 4;      ///< between rows [px]
constexpr int kMostSteps = 100000;
constexpr double kRatePeriod = 1.0;  ///< time over which frames are counted [s]
constexpr double kLeastTear = 0.01;  ///< strain at the left end of the slider [-]

/// A parameter of cfg/Cloth.cfg with a slider.
struct SliderParameter {
  const char* name;
  const char* title;
  const char* unit;
  double ClothConfig::*value;
  bool logarithmic;
};
constexpr SliderParameter kSliderParameters[] = {
    {"gravity", "Gravity", "m/s²", &ClothConfig::gravity, false},
    {"wind_x", "Wind x", "m/s", &ClothConfig::wind_x, false},
    {"wind_y", "Wind y", "m/s", &ClothConfig::wind_y, false},
    {"wind_z", "Wind z", "m/s", &ClothConfig::wind_z, false},
    {"tear_strain", "Tear strain", "", &ClothConfig::tear_strain, true},
    {"stiffness", "Stiffness", "×", &ClothConfig::stiffness, true},
};

SliderRange rangeOf(const SliderParameter& parameter) {
  SliderRange range;
  range.low = ClothConfig::__getMin__().*parameter.value;
  range.high = ClothConfig::__getMax__().*parameter.value;
  range.logarithmic = parameter.logarithmic;
  if (parameter.value == &ClothConfig::tear_strain) range.low = kLeastTear;
  return range;
}

QString byKind(const SpringCounts& counts) {
  return QString("%1 (%2 structural, %3 shear, %4 bend)")
      .arg(counts.total)
      .arg(counts.structural)
      .arg(counts.shear)
      .arg(counts.bend);
}

/// "", or the estimated errors.
QString errorsText(const ErrorInfo& error) {
  if (!error.known) return {};
  return QString("<br>estimated error: strain %1, positions %2 %%3")
      .arg(error.strain, 0, 'f', 4)
      .arg(100.0 * error.position, 0, 'f', 2)
      .arg(error.budget_sufficed ? "" : "<br>the budget of substeps did not suffice");
}

/// "", or a line for each doubt about the result.
QString warningsText(const std::vector<std::string>& warnings) {
  QString text;
  for (const std::string& warning : warnings) {
    text += "<br>" + QString::fromStdString(warning).toHtmlEscaped();
  }
  return text;
}

/// "", or the contact between layers of cloth.
QString contactText(const ContactInfo& contact) {
  if (!contact.on) return {};
  QString text = QString("<br>layers: %1 contacts").arg(contact.contacts);
  if (contact.smallest_distance > 0.0) {
    text += QString(", least distance %1 mm").arg(1e3 * contact.smallest_distance, 0, 'f', 2);
  }
  if (contact.blocked > 0) text += QString("<br>%1 held particles blocked").arg(contact.blocked);
  return text;
}

}  // namespace

ClothPanel::ClothPanel(QWidget* parent)
    : rviz::Panel(parent), services_(std::make_unique<ServiceQueue>()) {
  auto* column = new QVBoxLayout(this);
  addNodeRow(*column);
  addTimeRow(*column);
  addResolutionRow(*column);
  addSliders(*column);
  addFigures(*column);
  column->setSpacing(kSpacing);
  connectTo("/cloth");
}

ClothPanel::~ClothPanel() = default;

void ClothPanel::onInitialize() {
  framesSince_ = Clock::now();
  connect(vis_manager_, &rviz::VisualizationManager::preUpdate, this, [this] { countFrame(); });
}

void ClothPanel::addNodeRow(QBoxLayout& column) {
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel("Node"));
  nodeEdit_ = new QLineEdit;
  row->addWidget(nodeEdit_, 1);
  column.addLayout(row);
  connect(nodeEdit_, &QLineEdit::editingFinished, this, [this] {
    if (nodeEdit_->text().toStdString() == name_) return;
    connectTo(nodeEdit_->text());
    configChanged();
  });
}

void ClothPanel::addTimeRow(QBoxLayout& column) {
  pauseButton_ = new QPushButton("Pause");
  auto* step = new QPushButton("Step");
  stepCount_ = new QSpinBox;
  stepCount_->setRange(1, kMostSteps);
  auto* reset = new QPushButton("Reset");
  auto* row = new QHBoxLayout;
  for (QWidget* widget : {static_cast<QWidget*>(pauseButton_), static_cast<QWidget*>(step),
                          static_cast<QWidget*>(stepCount_), static_cast<QWidget*>(reset)}) {
    row->addWidget(widget);
  }
  column.addLayout(row);
  phaseGrid_ = new QGridLayout;
  column.addLayout(phaseGrid_);
  connect(pauseButton_, &QPushButton::clicked, this, [this] {
    Pause::Request request;
    request.paused = !paused_;
    call<Pause>("pause", request);
  });
  connect(step, &QPushButton::clicked, this, [this] {
    Step::Request request;
    request.steps = static_cast<std::uint32_t>(stepCount_->value());
    call<Step>("step", request);
  });
  connect(reset, &QPushButton::clicked, this,
          [this] { call<ResetScene>("reset", ResetScene::Request()); });
}

void ClothPanel::addResolutionRow(QBoxLayout& column) {
  columns_ = new QSpinBox;
  columns_->setObjectName("Columns");
  columns_->setRange(kFewestOnSide, kMostOnSide);
  rows_ = new QLabel;
  resizeButton_ = new QPushButton("Resize");
  resizeButton_->setToolTip("Reset with that many particles along u; the other side in proportion");
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel("Particles"));
  row->addWidget(columns_);
  row->addWidget(rows_, 1);
  row->addWidget(resizeButton_);
  column.addLayout(row);
  connect(resizeButton_, &QPushButton::clicked, this, [this] {
    ChangeResolution::Request request;
    request.columns = static_cast<std::uint32_t>(columns_->value());
    call<ChangeResolution>("set_resolution", request);
    sceneKnown_ = false;
  });
}

void ClothPanel::addSliders(QBoxLayout& column) {
  for (const SliderParameter& parameter : kSliderParameters) {
    const std::string name = parameter.name;
    auto* slider =
        new ValueSlider(parameter.title, QString::fromUtf8(parameter.unit), rangeOf(parameter),
                        [this, name](double value) { setParameter(name, value); });
    column.addWidget(slider);
    sliders_[name] = slider;
  }
  tearing_ = new QCheckBox("Springs may tear");
  column.addWidget(tearing_);
  connect(tearing_, &QCheckBox::toggled, this, [this](bool on) { setParameter("tearing", on); });
}

void ClothPanel::addFigures(QBoxLayout& column) {
  rates_ = new QLabel("-");
  counts_ = new QLabel("-");
  counts_->setWordWrap(true);
  chart_ = new StripChart("broken springs");
  message_ = new QLabel;
  message_->setWordWrap(true);
  message_->setStyleSheet("color: #b00020");
  auto* text = new QWidget;
  auto* lines = new QVBoxLayout(text);
  lines->setContentsMargins(0, 0, 0, 0);
  for (QLabel* label : {rates_, message_, counts_}) lines->addWidget(label);
  lines->addStretch(1);
  // Scrolls where the window is too low for all lines; the controls stay.
  auto* scroll = new QScrollArea;
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setWidgetResizable(true);
  scroll->setWidget(text);
  scroll->setMinimumHeight(kLeastLines * fontMetrics().lineSpacing());
  column.addWidget(scroll, 1);
  column.addWidget(chart_);
}

void ClothPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString node;
  if (config.mapGetString("Node", &node)) connectTo(node);
}

void ClothPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", QString::fromStdString(name_));
}

void ClothPanel::connectTo(const QString& node) {
  name_ = node.toStdString();
  nodeEdit_->setText(node);
  sceneKnown_ = false;
  try {
    stateSubscriber_ = node_.subscribe(name_ + "/state", 1, &ClothPanel::onState, this);
    parametersSubscriber_ =
        node_.subscribe(name_ + "/parameter_updates", 1, &ClothPanel::onParameters, this);
    showMessage("");
  } catch (const ros::Exception& error) {
    showMessage(error.what());
  }
}

void ClothPanel::onState(const ClothState& state) {
  if (!sceneKnown_ || state.time < time_) askAboutScene();  // another run may have begun
  time_ = state.time;
  paused_ = state.paused != 0;
  pauseButton_->setText(paused_ ? "Play" : "Pause");
  for (const auto& [phase, button] : phaseButtons_) {
    QFont font = button->font();
    font.setBold(phase == state.phase);
    button->setFont(font);
  }
  chart_->add(state.time, static_cast<int>(state.broken.total));
  showFigures(state);
  if (state.failed) showMessage("failed: " + QString::fromStdString(state.failure));
}

void ClothPanel::showFigures(const ClothState& state) {
  rates_->setText(QString("t = %1 s, %2 × real time, rviz %3 Hz")
                      .arg(state.time, 0, 'f', 2)
                      .arg(state.real_time_factor, 0, 'f', 2)
                      .arg(frameRate_, 0, 'f', 0));
  counts_->setText(QString("%1 particles, %2 faces, pieces %3<br>active: %4<br>broken: %5<br>"
                           "torn %6, cut %7; largest strain %8")
                       .arg(state.particles)
                       .arg(state.faces)
                       .arg(state.pieces)
                       .arg(byKind(state.springs), byKind(state.broken))
                       .arg(state.broken_torn)
                       .arg(state.broken_cut)
                       .arg(state.max_strain, 0, 'f', 3) +
                   errorsText(state.error_estimate) + contactText(state.contact) +
                   warningsText(state.warnings));
}

void ClothPanel::onParameters(const dynamic_reconfigure::Config& config) {
  for (const auto& parameter : config.doubles) {
    const auto slider = sliders_.find(parameter.name);
    if (slider != sliders_.end()) slider->second->show(parameter.value);
  }
  const QSignalBlocker blocker(tearing_);
  for (const auto& parameter : config.bools) {
    if (parameter.name == "tearing") tearing_->setChecked(parameter.value != 0);
  }
}

void ClothPanel::askAboutScene() {
  sceneKnown_ = true;
  services_->post([this, service = name_ + "/get_state"] {
    GetState exchange;
    if (!ros::service::call(service, exchange)) return;
    runIn(this, [this, scene = exchange.response] { showScene(scene); });
  });
}

void ClothPanel::showScene(const GetState::Response& scene) {
  showPhases(scene.phases);
  const bool isGrid = scene.columns > 0;
  columns_->setEnabled(isGrid);
  resizeButton_->setEnabled(isGrid);
  rows_->setText(isGrid ? QString("× %1").arg(scene.rows) : QString("from a file"));
  if (isGrid) columns_->setValue(static_cast<int>(scene.columns));
}

void ClothPanel::showPhases(const std::vector<std::string>& phases) {
  for (const auto& entry : phaseButtons_) entry.second->deleteLater();
  phaseButtons_.clear();
  int index = 0;
  for (const std::string& phase : phases) {
    auto* button = new QPushButton(QString::fromStdString(phase));
    phaseGrid_->addWidget(button, index / kPhaseColumns, index % kPhaseColumns);
    phaseButtons_[phase] = button;
    connect(button, &QPushButton::clicked, this, [this, phase] {
      StartPhase::Request request;
      request.phase = phase;
      call<StartPhase>("set_phase", request);
    });
    ++index;
  }
}

template <typename Service>
void ClothPanel::call(const std::string& name, const typename Service::Request& request) {
  services_->post([this, service = name_ + "/" + name, request] {
    Service exchange;
    exchange.request = request;
    QString problem;
    if (!ros::service::call(service, exchange)) {
      problem = QString::fromStdString(service) + " does not answer";
    } else if (!exchange.response.success) {
      problem = QString::fromStdString(exchange.response.message);
    }
    runIn(this, [this, problem] { showMessage(problem); });
  });
}

void ClothPanel::setParameter(const std::string& name, double value) {
  dynamic_reconfigure::Config change;
  change.doubles.resize(1);
  change.doubles[0].name = name;
  change.doubles[0].value = value;
  sendParameters(change);
}

void ClothPanel::setParameter(const std::string& name, bool value) {
  dynamic_reconfigure::Config change;
  change.bools.resize(1);
  change.bools[0].name = name;
  change.bools[0].value = value;
  sendParameters(change);
}

void ClothPanel::sendParameters(const dynamic_reconfigure::Config& change) {
  services_->post([this, service = name_ + "/set_parameters", change] {
    dynamic_reconfigure::Reconfigure exchange;
    exchange.request.config = change;
    const bool answered = ros::service::call(service, exchange);
    const QString problem = answered ? "" : QString::fromStdString(service) + " does not answer";
    runIn(this, [this, problem] { showMessage(problem); });
  });
}

void ClothPanel::showMessage(const QString& text) {
  message_->setText(text);
  message_->setVisible(!text.isEmpty());
}

void ClothPanel::countFrame() {
  ++frames_;
  const double elapsed = std::chrono::duration<double>(Clock::now() - framesSince_).count();
  if (elapsed < kRatePeriod) return;
  frameRate_ = frames_ / elapsed;
  frames_ = 0;
  framesSince_ = Clock::now();
}

}  // namespace cloth_sim

PLUGINLIB_EXPORT_CLASS(cloth_sim::ClothPanel, rviz::Panel)
