#pragma once
/// \file Times of works that are done in turns, so that what else the machine does meets each of
/// them alike.

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace cloth_sim::bench {

class Turns {
 public:
  /// Does some work and notes the time.
  /// \param what  does the same as the last time with this name.
  template <typename Work>
  void time(const std::string& name, const Work& what) {
    const Clock::time_point start = Clock::now();
    what();
    note(name, std::chrono::duration<double>(Clock::now() - start).count());
  }
  void note(const std::string& name, double seconds) { seconds_[name].push_back(seconds); }

  /// Over all turns [s].
  double median(const std::string& name) const;
  /// Of the time of one over that of the other in the same turn.
  double medianOver(const std::string& name, const std::string& other) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::map<std::string, std::vector<double>> seconds_;
};

}  // namespace cloth_sim::bench
