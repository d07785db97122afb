#pragma once
/// \file A slider with its name and value.

#include <QLabel>
#include <QSlider>
#include <QTimer>
#include <QWidget>
#include <functional>

namespace cloth_sim {

/// What a slider stands for.
struct SliderRange {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;  ///< then `low` > 0
};

/// Tells of a value that the user chose, not more often than ten times a second. Values that come
/// from elsewhere move it only while nobody holds it.
class ValueSlider : public QWidget {
 public:
  using Chosen = std::function<void(double)>;

  ValueSlider(const QString& title, const QString& unit, const SliderRange& range, Chosen chosen,
              QWidget* parent = nullptr);

  /// What others made of it.
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
