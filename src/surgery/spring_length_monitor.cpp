#include "cloth_sim/surgery/spring_length_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// The slack, over how much longer than at rest springs have to be on average. With more of it,
/// more springs of a refined cloth are close all the time.
constexpr double kSlack = 0.1;
/// Springs for which a second thread pays.
constexpr std::int32_t kGrain = 8192;

/// Particles that have not moved by more than `far` along any axis, but for `shift`. Counts instead
/// of leaving early, so that it can be vectorised.
CLOTH_SIM_VECTOR_CLONES
std::int64_t countNear(std::size_t count, const double* now, const double* before,
                       const double* shift, double far) {
  std::int64_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = std::abs(now[3 * k] - before[3 * k] - shift[0]);
    const double dy = std::abs(now[3 * k + 1] - before[3 * k + 1] - shift[1]);
    const double dz = std::abs(now[3 * k + 2] - before[3 * k + 2] - shift[2]);
    near += (dx <= far) & (dy <= far) & (dz <= far);
  }
  return near;
}

/// The first of `flags` from `first` on that is 1; their number, if there is none.
std::size_t nextSet(const std::vector<char>& flags, std::size_t first) {
  const std::size_t left = flags.size() - first;
  const void* found = left > 0 ? std::memchr(flags.data() + first, 1, left) : nullptr;
  return found == nullptr
             ? flags.size()
             : static_cast<std::size_t>(static_cast<const char*>(found) - flags.data());
}

}  // namespace

void SpringLengthMonitor::clear() {
  springs_.clear();
  before_.clear();
  isClose_.clear();
  close_.clear();
  put_.clear();
  margins_ = 0.0;
  finite_ = 0;
}

void SpringLengthMonitor::reserve(std::size_t springs) {
  springs_.reserve(springs);
  close_.reserve(springs);
  long_.reserve(springs);
}

void SpringLengthMonitor::watch(const Spring& spring, double length) {
  springs_.push_back({spring.a, spring.b, length});
  if (length == kNever) return;
  margins_ += std::max(0.0, length - spring.restLength);
  ++finite_;
}

void SpringLengthMonitor::replace(std::int32_t k, const Spring& spring, double length) {
  springs_[static_cast<std::size_t>(k)] = {spring.a, spring.b, length};
  lookAt(k);
}

void SpringLengthMonitor::lookAt(std::int32_t k) {
  const auto place = static_cast<std::size_t>(k);
  if (place >= isClose_.size()) isClose_.resize(place + 1, 0);
  if (isClose_[place] != 0) return;
  isClose_[place] = 1;
  isSorted_ = isSorted_ && (close_.empty() || close_.back() < k);
  close_.push_back(k);
}

const std::vector<std::int32_t>& SpringLengthMonitor::find(const VertexData<Vec3>& x) {
  long_.clear();
  if (finite_ == 0) return long_;
  const auto keepIfLong = [&](std::int32_t k) {
    const Watched& it = springs_[static_cast<std::size_t>(k)];
    if ((x[it.b] - x[it.a]).squaredNorm() > it.length * it.length) long_.push_back(k);
  };
  if (springs_.size() < x.size()) {  // as along a seam: to look at particles would cost more
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(springs_.size()); ++k) keepIfLong(k);
    return long_;
  }
  settle(x);
  if (haveMoved(x)) lookAtAll(x);
  for (const std::int32_t k : close_) keepIfLong(k);
  return long_;
}

/// Takes up what was put, and watched anew.
void SpringLengthMonitor::settle(const VertexData<Vec3>& x) {
  if (before_.empty()) return;  // all will be looked at
  for (auto k = isClose_.size(); k < springs_.size(); ++k) lookAt(static_cast<std::int32_t>(k));
  if (!isSorted_) std::sort(close_.begin(), close_.end());
  isSorted_ = true;
  if (before_.size() < x.size()) before_.resize(x.size());
  const Vec3 shift = x[0] - before_[0];
  for (const VertexId v : put_) before_[static_cast<std::size_t>(v)] = x[v] - shift;
  put_.clear();
}

/// Where all moved alike, no spring is longer.
bool SpringLengthMonitor::haveMoved(const VertexData<Vec3>& x) const {
  if (before_.size() != x.size() || before_.empty()) return true;
  const Vec3 shift = x[0] - before_[0];
  // Along each axis; so the way is shorter than sqrt(3)/2 of the slack, and rounding has room.
  const double far = 0.5 * slack_;
  return countNear(x.size(), x.data()->data(), before_.data()->data(), shift.data(), far) !=
         static_cast<std::int64_t>(x.size());
}

void SpringLengthMonitor::lookAtAll(const VertexData<Vec3>& x) {
  before_ = x.values();
  put_.clear();
  slack_ = kSlack * margins_ / static_cast<double>(finite_);
  isClose_.resize(springs_.size());
  const auto look = [springs = springs_.data(), x = x.data(), isClose = isClose_.data(),
                     within = 2.0 * slack_](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) {
      const Watched& it = springs[k];
      const double least = std::max(0.0, it.length - within);
      isClose[k] = (x[it.b] - x[it.a]).squaredNorm() >= least * least;
    }
  };
  parallelFor(static_cast<std::int32_t>(springs_.size()), kGrain, look);
  close_.clear();
  isSorted_ = true;
  for (std::size_t k = nextSet(isClose_, 0); k < isClose_.size(); k = nextSet(isClose_, k + 1)) {
    close_.push_back(static_cast<std::int32_t>(k));
  }
}

}  // namespace cloth_sim
