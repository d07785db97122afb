#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

namespace cloth_sim {

/// Line on stderr that tells how far a program has come: redrawn in place on a terminal, otherwise
/// printed now and then.
class StatusLine {
 public:
  /// \param linePeriod  least wall time between two lines where stderr is no terminal [s].
  explicit StatusLine(double linePeriod) : period_(isTerminal_ ? kRedrawPeriod : linePeriod) {}

  /// Wall time since the program began to show it [s].
  double wallTime() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// Tells whether the line before is old enough for another one.
  bool isDue() const { return !shown_ || wallTime() - *shown_ >= period_; }

  /// Shows the text; on a terminal with a bar before it.
  /// \param done  fraction of the work that is done, 0 to 1; absent: unknown, so no bar.
  void show(std::optional<double> done, const std::string& text) {
    shown_ = wallTime();
    if (!isTerminal_) {
      std::fprintf(stderr, "%s\n", text.c_str());
    } else {
      std::fprintf(stderr, "\r%s%s\033[K", done ? bar(*done).c_str() : "", text.c_str());
    }
    std::fflush(stderr);
  }

  /// Leaves the line that is shown and begins another one.
  void keep() const {
    if (isTerminal_) std::fputc('\n', stderr);
  }
  /// Removes the line that is shown, so that something else can be printed.
  void clear() const {
    if (isTerminal_) std::fputs("\r\033[K", stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kRedrawPeriod = 0.1;  ///< on a terminal, wall time [s]

  static std::string bar(double done) {
    constexpr int kWidth = 24;  // [characters]
    const int filled = static_cast<int>(std::clamp(done, 0.0, 1.0) * kWidth);
    return '[' + std::string(filled, '#') + std::string(kWidth - filled, '.') + "] ";
  }

  bool isTerminal_ = isatty(STDERR_FILENO) != 0;
  double period_;
  Clock::time_point start_ = Clock::now();
  std::optional<double> shown_;  ///< wall time of the last output [s]
};

}  // namespace cloth_sim
