#pragma once
/// \file A number over the last seconds.

#include <QWidget>
#include <deque>

namespace cloth_sim {

/// Draws how a count grew over the last seconds of simulated time.
class StripChart : public QWidget {
 public:
  explicit StripChart(const QString& title, QWidget* parent = nullptr);

  /// \param time  simulated [s]; one that goes back begins the chart anew.
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
