#pragma once
/// \file A slider for a parameter.

#include <QLabel>
#include <QSlider>
#include <QTimer>
#include <QWidget>
#include <functional>

namespace cloth_sim {

/// The range of values of a slider.
struct SliderRange {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;  ///< needs `low` > 0
};

/// A slider with its name and value. It reports values that the user chooses, at most ten times a
/// second. Values from elsewhere move it only while the user does not hold it.
class ValueSlider : public QWidget {
 public:
  using Chosen = std::function<void(double)>;

  ValueSlider(const QString& title, const QString& unit, const SliderRange& range, Chosen chosen,
              QWidget* parent = nullptr);

  /// Shows a value that was set elsewhere.
  void show(double value);

 private:
  double value() const;
  void showText(double value);

  SliderRange range_;
  QString unit_;
  Chosen chosen_;
  QSlider* slider_ = nullptr;  ///< owned by this, as are all widgets
  QLabel* text_ = nullptr;
  QTimer* timer_ = nullptr;
};

}  // namespace cloth_sim
