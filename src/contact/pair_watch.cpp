#include "pair_watch.h"

#include <algorithm>
#include <limits>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Share of the distance of boxes that is sure in spite of round-off in single precision.
constexpr double kSure = 1.0 - 1e-6;
/// Boxes around all faces pay from this share of new pairs in the number of faces on.
constexpr double kManyNew = 0.125;

/// A direction along an axis and the distance of two boxes along it [m].
struct AxisGap {
  int axis = 0;
  float gap = 0.0F;
};

AxisGap widest(const QuickBox::Corner& gap) {
  int axis = gap[1] > gap[0] ? 1 : 0;
  if (gap[2] > gap[axis]) axis = 2;
  return {axis, gap[axis]};
}

}  // namespace

Vec3 meanMotion(const SubstepMotion& motion) {
  Vec3 sum = Vec3::Zero();
  for (const VertexId v : motion.vertices) sum += motion.end[v] - motion.start[v];
  return sum / static_cast<double>(std::max<std::size_t>(1, motion.vertices.size()));
}

void PairWatch::begin(const std::vector<Face>& faces) {
  clear();
  faces_ = faces;
  travel_.assign(faces_.size(), 0.0);
  isPaired_.assign(faces_.size(), 0);
}

void PairWatch::clear() {
  for (const FaceId f : paired_) {
    isPaired_[f] = 0;
    travel_[f] = 0.0;
  }
  paired_.clear();
  ids_.clear();
  due_.clear();
  blockDue_.clear();
  known_ = 0;
  most_ = 0.0;
}

void PairWatch::append(const std::vector<FaceIds>& near, std::size_t first) {
  if (first == near.size()) return;
  ids_.insert(ids_.end(), near.begin() + static_cast<std::ptrdiff_t>(first), near.end());
  for (std::size_t k = first; k < near.size(); ++k) {
    for (const FaceId f : {near[k].first, near[k].second}) {
      if (isPaired_[f] == 0) paired_.push_back(f);
      isPaired_[f] = 1;
    }
  }
  due_.resize(ids_.size(), 0.0);
  isDue_.resize(ids_.size());
  blockDue_.resize(first / kBlock);
  blockDue_.resize((ids_.size() + kBlock - 1) / kBlock, 0.0);
}

void PairWatch::follow(const SubstepMotion& motion) {
  const Vec3 common = meanMotion(motion);
  step_.resize(motion.end.size());
  double farthest = 0.0;
  for (const VertexId v : motion.vertices) {
    step_[v] = (motion.end[v] - motion.start[v] - common).norm();
    farthest = std::max(farthest, step_[v]);
  }
  most_ += 2.0 * farthest;
  for (const FaceId f : paired_) {
    const Face& face = faces_[f];
    travel_[f] += std::max({step_[face[0]], step_[face[1]], step_[face[2]]});
  }
  const double many = kManyNew * static_cast<double>(faces_.size());
  if (static_cast<double>(ids_.size() - known_) > many) proveByBoxes(motion);
  known_ = ids_.size();
}

/// Puts boxes around the faces at both ends of the substep.
void PairWatch::boxFaces(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 2048;
  const std::array<const std::vector<Vec3>*, 2> places{&motion.start, &motion.end};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<Vec3>& x = *places[k];
    std::vector<QuickBox>& corners = corners_[k];
    corners.resize(x.size());
    boxes_[k].resize(faces_.size());
    for (const VertexId v : motion.vertices) corners[v] = QuickBox({x[v], x[v]});
    parallelFor(static_cast<std::int32_t>(paired_.size()), kGrain,
                [&](std::int32_t first, std::int32_t last) {
                  for (std::int32_t n = first; n < last; ++n) {
                    const Face& face = faces_[paired_[n]];
                    QuickBox box = corners[face[0]];
                    box.add(corners[face[1]]);
                    box.add(corners[face[2]]);
                    boxes_[k][paired_[n]] = box;
                  }
                });
  }
}

/// Finds when new pairs are due where their boxes are apart along the same axis at both ends of the
/// substep, and so at each time between.
void PairWatch::proveByBoxes(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 4096;
  boxFaces(motion);
  const auto prove = [&](std::size_t k) {
    const QuickBox& a = boxes_[1][ids_[k].first];
    const QuickBox& b = boxes_[1][ids_[k].second];
    const AxisGap above = widest(a.low - b.high);
    const AxisGap below = widest(b.low - a.high);
    const QuickBox& fromA = boxes_[0][ids_[k].first];
    const QuickBox& fromB = boxes_[0][ids_[k].second];
    const bool isAbove = above.gap >= below.gap;
    const float before = isAbove ? fromA.low[above.axis] - fromB.high[above.axis]
                                 : fromB.low[below.axis] - fromA.high[below.axis];
    const double slack = kSure * std::max(above.gap, below.gap) - kApart;
    if (before > 0.0F && slack > 0.0) due_[k] = travelOf(k) + slack;
  };
  parallelFor(static_cast<std::int32_t>(ids_.size() - known_), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t n = first; n < last; ++n) {
                  prove(known_ + static_cast<std::size_t>(n));
                }
              });
}

void PairWatch::listDue(std::vector<std::uint32_t>& pairs) {
  constexpr std::int32_t kGrain = 16;
  blocks_.clear();
  for (std::size_t block = 0; block < blockDue_.size(); ++block) {
    if (most_ >= blockDue_[block]) blocks_.push_back(static_cast<std::uint32_t>(block));
  }
  const auto lastOf = [this](std::size_t block) {
    return std::min(ids_.size(), (block + 1) * kBlock);
  };
  parallelFor(static_cast<std::int32_t>(blocks_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t n = first; n < last; ++n) {
                  const std::size_t block = blocks_[n];
                  double least = std::numeric_limits<double>::infinity();  // of those not due
                  for (std::size_t k = block * kBlock; k < lastOf(block); ++k) {
                    const double left = due_[k] - travelOf(k);
                    isDue_[k] = left <= 0.0 ? 1 : 0;
                    if (left > 0.0) least = std::min(least, left);
                  }
                  blockDue_[block] = most_ + least;
                }
              });
  pairs.clear();
  for (const std::size_t block : blocks_) {
    for (std::size_t k = block * kBlock; k < lastOf(block); ++k) {
      if (isDue_[k] != 0) pairs.push_back(static_cast<std::uint32_t>(k));
    }
  }
}

void PairWatch::setAllDue() {
  std::fill(due_.begin(), due_.end(), 0.0);
  std::fill(blockDue_.begin(), blockDue_.end(), 0.0);
}

void PairWatch::setDue(std::size_t k, double slack) {
  due_[k] = travelOf(k) + slack;
  blockDue_[k / kBlock] = std::min(blockDue_[k / kBlock], most_ + slack);
}

}  // namespace cloth_sim
