#include "strip_chart.h"

#include <QPainter>
#include <QPainterPath>
#include <algorithm>

namespace cloth_sim {
namespace {

constexpr double kChartSpan = 20.0;  ///< shown [s]
constexpr int kChartHeight = 72;     ///< [px]
constexpr int kChartMargin = 4;      ///< [px]

}  // namespace

StripChart::StripChart(const QString& title, QWidget* parent) : QWidget(parent), title_(title) {
  setMinimumHeight(kChartHeight);
  setMaximumHeight(2 * kChartHeight);
}

void StripChart::add(double time, int value) {
  if (!points_.empty() && time < points_.back().time) points_.clear();
  if (!points_.empty() && time == points_.back().time) {
    points_.back().value = value;
  } else {
    points_.push_back({time, value});
  }
  while (points_.front().time < time - kChartSpan) points_.pop_front();
  update();
}

void StripChart::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().base());
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawRect(rect().adjusted(0, 0, -1, -1));
  if (points_.size() > 1) drawCurve(painter);
  painter.setPen(palette().color(QPalette::Text));
  const QString last = points_.empty() ? "" : QString::number(points_.back().value);
  painter.drawText(rect().adjusted(kChartMargin + 2, kChartMargin, 0, 0),
                   Qt::AlignLeft | Qt::AlignTop, title_ + " " + last);
}

/// Scales the curve from the least to the largest value shown; the newest is at the right.
void StripChart::drawCurve(QPainter& painter) const {
  const auto [low, high] =
      std::minmax_element(points_.begin(), points_.end(),
                          [](const Point& p, const Point& q) { return p.value < q.value; });
  const double range = std::max(1, high->value - low->value);
  const double left = points_.back().time - kChartSpan;
  const double w = width() - 2 * kChartMargin;
  const double h = height() - 2 * kChartMargin;
  QPainterPath path;
  for (const Point& point : points_) {
    const QPointF at(kChartMargin + w * (point.time - left) / kChartSpan,
                     kChartMargin + h * (1.0 - (point.value - low->value) / range));
    path.elementCount() == 0 ? path.moveTo(at) : path.lineTo(at);
  }
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(QColor(230, 13, 64), 1.5));
  painter.drawPath(path);
}

}  // namespace cloth_sim
