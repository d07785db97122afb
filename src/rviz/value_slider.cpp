#include "value_slider.h"

#include <QHBoxLayout>
#include <QSignalBlocker>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

constexpr int kSteps = 400;
constexpr int kSendPeriod = 100;  ///< between two messages [ms]
constexpr int kTitleWidth = 86;   ///< [px]
constexpr int kValueWidth = 78;   ///< [px]

}  // namespace

ValueSlider::ValueSlider(const QString& title, const QString& unit, const SliderRange& range,
                         Chosen chosen, QWidget* parent)
    : QWidget(parent), range_(range), unit_(unit), chosen_(std::move(chosen)) {
  auto* name = new QLabel(title);
  name->setFixedWidth(kTitleWidth);
  slider_ = new QSlider(Qt::Horizontal);
  slider_->setRange(0, kSteps);
  slider_->setObjectName(title);
  text_ = new QLabel;
  text_->setFixedWidth(kValueWidth);
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->addWidget(name);
  row->addWidget(slider_, 1);
  row->addWidget(text_);
  timer_ = new QTimer(this);
  timer_->setSingleShot(true);
  connect(timer_, &QTimer::timeout, this, [this] { chosen_(value()); });
  connect(slider_, &QSlider::valueChanged, this, [this] {
    showText(value());
    if (!timer_->isActive()) timer_->start(kSendPeriod);
  });
}

void ValueSlider::show(double value) {
  if (slider_->isSliderDown() || timer_->isActive()) return;
  const double inRange = std::clamp(value, range_.low, range_.high);
  const double part = range_.logarithmic
                          ? std::log(inRange / range_.low) / std::log(range_.high / range_.low)
                          : (inRange - range_.low) / (range_.high - range_.low);
  const QSignalBlocker blocker(slider_);
  slider_->setValue(static_cast<int>(std::lround(part * kSteps)));
  showText(value);
}

double ValueSlider::value() const {
  const double part = static_cast<double>(slider_->value()) / kSteps;
  return range_.logarithmic ? range_.low * std::pow(range_.high / range_.low, part)
                            : range_.low + part * (range_.high - range_.low);
}

void ValueSlider::showText(double value) {
  text_->setText(QString::number(value, 'g', 3) + " " + unit_);
}

}  // namespace cloth_sim
