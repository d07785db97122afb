#pragma once
/// \file A chart of a number over the last seconds.

#include <QWidget>
#include <deque>

namespace cloth_sim {

/// Draws a count over the last seconds of simulated time.
class StripChart : public QWidget {
 public:
  explicit StripChart(const QString& title, QWidget* parent = nullptr);

  /// \param time  simulated [s]; a smaller time than before clears the chart.
  void add(double time, int value);

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  struct Point {
    double time = 0.0;
    int value = 0;
  };
  void drawCurve(QPainter& painter) const;

  QString title_;
  std::deque<Point> points_;
};

}  // namespace cloth_sim
