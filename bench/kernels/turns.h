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
  /// \param what   does the same as the last time with this name.
  /// \param parts  of the same kind that it has: the time of one is noted.
  template <typename Work>
  void time(const std::string& name, const Work& what, double parts = 1.0) {
    const Clock::time_point start = Clock::now();
    what();
    const std::chrono::duration<double> all = Clock::now() - start;
    seconds_[name].push_back(all.count() / parts);
  }

  /// Over all turns [s].
  double median(const std::string& name) const;
  /// Returns the median, over all turns, of the time of `name` over that of `other` in that turn.
  double medianOver(const std::string& name, const std::string& other) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::map<std::string, std::vector<double>> seconds_;
};

}  // namespace cloth_sim::bench
