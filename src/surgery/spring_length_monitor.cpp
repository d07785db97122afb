#include "cloth_sim/surgery/spring_length_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// The slack, as a fraction of the mean margin between rest length and limit. A larger slack makes
/// more springs of a refined cloth candidates all the time.
constexpr double kSlack = 0.1;
/// Number of springs for which a second thread pays.
constexpr std::int32_t kGrain = 8192;

/// Counts the particles that have moved by at most `far` along each axis, apart from a common
/// `shift`. It counts instead of stopping at the first so that it can be vectorised.
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

/// Returns the index of the first flag from `first` on that is set; the size if there is none.
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
  checked_.clear();
  isCandidate_.clear();
  candidates_.clear();
  edited_.clear();
  margins_ = 0.0;
  limited_ = 0;
}

void SpringLengthMonitor::reserve(std::size_t springs) {
  springs_.reserve(springs);
  candidates_.reserve(springs);
  found_.reserve(springs);
}

void SpringLengthMonitor::add(const Spring& spring, double limit) {
  springs_.push_back({spring.a, spring.b, limit});
  if (limit == kUnlimited) return;
  margins_ += std::max(0.0, limit - spring.restLength);
  ++limited_;
}

void SpringLengthMonitor::replace(std::int32_t k, const Spring& spring, double limit) {
  springs_[static_cast<std::size_t>(k)] = {spring.a, spring.b, limit};
  addCandidate(k);
}

void SpringLengthMonitor::addCandidate(std::int32_t k) {
  const auto index = static_cast<std::size_t>(k);
  if (index >= isCandidate_.size()) isCandidate_.resize(index + 1, 0);
  if (isCandidate_[index] != 0) return;
  isCandidate_[index] = 1;
  isSorted_ = isSorted_ && (candidates_.empty() || candidates_.back() < k);
  candidates_.push_back(k);
}

const std::vector<std::int32_t>& SpringLengthMonitor::find(const VertexData<Vec3>& x) {
  found_.clear();
  if (limited_ == 0) return found_;
  const auto check = [&](std::int32_t k) {
    const LimitedSpring& spring = springs_[static_cast<std::size_t>(k)];
    if ((x[spring.b] - x[spring.a]).squaredNorm() > spring.limit * spring.limit) {
      found_.push_back(k);
    }
  };
  // With few springs, as along a seam, checking them costs less than checking the particles.
  if (springs_.size() < x.size()) {
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(springs_.size()); ++k) check(k);
    return found_;
  }
  updateCandidates(x);
  if (haveMoved(x)) checkAll(x);
  for (const std::int32_t k : candidates_) check(k);
  return found_;
}

/// Takes over added springs and edited particles since the last call.
void SpringLengthMonitor::updateCandidates(const VertexData<Vec3>& x) {
  if (checked_.empty()) return;  // all will be checked
  for (auto k = isCandidate_.size(); k < springs_.size(); ++k) {
    addCandidate(static_cast<std::int32_t>(k));
  }
  if (!isSorted_) std::sort(candidates_.begin(), candidates_.end());
  isSorted_ = true;
  if (checked_.size() < x.size()) checked_.resize(x.size());
  const Vec3 shift = x[0] - checked_[0];
  for (const VertexId v : edited_) checked_[static_cast<std::size_t>(v)] = x[v] - shift;
  edited_.clear();
}

/// Returns whether a particle has moved by more than the slack since all springs were checked. The
/// displacement of particle 0 is subtracted: a common translation stretches no spring.
bool SpringLengthMonitor::haveMoved(const VertexData<Vec3>& x) const {
  if (checked_.size() != x.size() || checked_.empty()) return true;
  const Vec3 shift = x[0] - checked_[0];
  // The limit applies to each axis, so a displacement is at most sqrt(3) / 2 of the slack; the rest
  // covers rounding.
  const double far = 0.5 * slack_;
  return countNear(x.size(), x.data()->data(), checked_.data()->data(), shift.data(), far) !=
         static_cast<std::int64_t>(x.size());
}

/// Makes the list of candidates from all springs.
void SpringLengthMonitor::checkAll(const VertexData<Vec3>& x) {
  checked_ = x.values();
  edited_.clear();
  slack_ = kSlack * margins_ / static_cast<double>(limited_);
  isCandidate_.resize(springs_.size());
  const auto check = [springs = springs_.data(), x = x.data(), isCandidate = isCandidate_.data(),
                      within = 2.0 * slack_](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) {
      const LimitedSpring& spring = springs[k];
      const double least = std::max(0.0, spring.limit - within);
      isCandidate[k] = (x[spring.b] - x[spring.a]).squaredNorm() >= least * least;
    }
  };
  parallelFor(static_cast<std::int32_t>(springs_.size()), kGrain, check);
  candidates_.clear();
  isSorted_ = true;
  for (std::size_t k = nextSet(isCandidate_, 0); k < isCandidate_.size();
       k = nextSet(isCandidate_, k + 1)) {
    candidates_.push_back(static_cast<std::int32_t>(k));
  }
}

}  // namespace cloth_sim
