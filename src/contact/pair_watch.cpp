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
/// Faces of pairs are visited in the order of memory from this share of all faces on.
constexpr double kManyPaired = 0.125;

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

void PairWatch::begin(const std::vector<Face>& faces) {
  clear();
  faces_ = faces;
  motions_.assign(faces_.size(), {});
  isPaired_.assign(faces_.size(), 0);
}

void PairWatch::clear() {
  for (const FaceId f : paired_) {
    isPaired_[f] = 0;
    motions_[f] = {};
  }
  paired_.clear();
  ids_.clear();
  areJoined_.clear();
  due_.clear();
  blockDue_.clear();
  known_ = 0;
  most_ = {};
}

void PairWatch::append(const std::vector<FaceIds>& near, std::size_t first) {
  if (first == near.size()) return;
  ids_.insert(ids_.end(), near.begin() + static_cast<std::ptrdiff_t>(first), near.end());
  for (std::size_t k = first; k < near.size(); ++k) {
    for (const FaceId f : {near[k].first, near[k].second}) {
      if (isPaired_[f] == 0) paired_.push_back(f);
      isPaired_[f] = 1;
    }
    areJoined_.push_back(haveCommonCorner(faces_[near[k].first], faces_[near[k].second]) ? 1 : 0);
  }
  due_.resize(ids_.size(), 0.0);
  isDue_.resize(ids_.size());
  blockDue_.resize(first / kBlock);
  blockDue_.resize((ids_.size() + kBlock - 1) / kBlock);
}

/// Calls `visit(face)` for the faces of pairs.
template <typename Visit>
void PairWatch::forPaired(const Visit& visit) const {
  const double many = kManyPaired * static_cast<double>(faces_.size());
  if (static_cast<double>(paired_.size()) < many) {
    for (const FaceId f : paired_) visit(f);
    return;
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (isPaired_[f] != 0) visit(static_cast<FaceId>(f));
  }
}

/// The farthest motion of a corner of a face in the substep, and the largest change of an edge.
PairWatch::FaceMotion PairWatch::motionIn(const Face& face) const {
  const std::array<Vec3, 3> by{step_[face[0]], step_[face[1]], step_[face[2]]};
  const double travel = std::max({by[0].squaredNorm(), by[1].squaredNorm(), by[2].squaredNorm()});
  const double change = std::max({(by[1] - by[0]).squaredNorm(), (by[2] - by[1]).squaredNorm(),
                                  (by[0] - by[2]).squaredNorm()});
  return {std::sqrt(travel), std::sqrt(change)};
}

void PairWatch::follow(const SubstepMotion& motion) {
  const Vec3 common = meanMotion(motion);
  step_.resize(motion.end.size());
  for (const VertexId v : motion.vertices) step_[v] = motion.end[v] - motion.start[v] - common;
  FaceMotion most;
  forPaired([&](FaceId f) {
    const FaceMotion inSubstep = motionIn(faces_[f]);
    motions_[f].travel += inSubstep.travel;
    motions_[f].edgeChange += inSubstep.edgeChange;
    most.travel = std::max(most.travel, inSubstep.travel);
    most.edgeChange = std::max(most.edgeChange, inSubstep.edgeChange);
  });
  most_.travel += 2.0 * most.travel;
  most_.edgeChange += 2.0 * most.edgeChange;
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
    parallelForEach(paired_.size(), kGrain, [&](std::int32_t n) {
      const Face& face = faces_[paired_[n]];
      QuickBox box = corners[face[0]];
      box.add(corners[face[1]]);
      box.add(corners[face[2]]);
      boxes_[k][paired_[n]] = box;
    });
  }
}

/// Finds when new pairs are due where their boxes are apart along the same axis at both ends of the
/// substep, and so at each time between.
void PairWatch::proveByBoxes(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 4096;
  boxFaces(motion);
  const auto prove = [&](std::size_t k) {
    if (areJoined(k)) return;
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
    if (before > 0.0F && slack > 0.0) due_[k] = motionOf(k) + slack;
  };
  parallelForEach(ids_.size() - known_, kGrain,
                  [&](std::int32_t n) { prove(known_ + static_cast<std::size_t>(n)); });
}

void PairWatch::listDue(std::vector<std::uint32_t>& pairs) {
  constexpr std::int32_t kGrain = 16;
  blocks_.clear();
  for (std::size_t block = 0; block < blockDue_.size(); ++block) {
    if (mayBeDue(block)) blocks_.push_back(static_cast<std::uint32_t>(block));
  }
  const auto lastOf = [this](std::size_t block) {
    return std::min(ids_.size(), (block + 1) * kBlock);
  };
  parallelFor(
      static_cast<std::int32_t>(blocks_.size()), kGrain,
      [&](std::int32_t first, std::int32_t last) {
        for (std::int32_t n = first; n < last; ++n) {
          const std::size_t block = blocks_[n];
          constexpr double kEndless = std::numeric_limits<double>::infinity();
          FaceMotion least{kEndless, kEndless};  // left of those that are not due
          for (std::size_t k = block * kBlock; k < lastOf(block); ++k) {
            const double left = due_[k] - motionOf(k);
            isDue_[k] = left <= 0.0 ? 1 : 0;
            double& of = least.of(areJoined(k));
            if (left > 0.0) of = std::min(of, left);
          }
          blockDue_[block] = {most_.travel + least.travel, most_.edgeChange + least.edgeChange};
        }
      });
  pairs.clear();
  for (const std::size_t block : blocks_) {
    for (std::size_t k = block * kBlock; k < lastOf(block); ++k) {
      if (isDue_[k] != 0) pairs.push_back(static_cast<std::uint32_t>(k));
    }
  }
}

/// Tells whether pairs of a block may be due.
bool PairWatch::mayBeDue(std::size_t block) const {
  const FaceMotion& due = blockDue_[block];
  return most_.travel >= due.travel || most_.edgeChange >= due.edgeChange;
}

void PairWatch::setAllDue() {
  std::fill(due_.begin(), due_.end(), 0.0);
  std::fill(blockDue_.begin(), blockDue_.end(), FaceMotion());
}

void PairWatch::setDue(std::size_t k, double slack) {
  due_[k] = motionOf(k) + slack;
  double& due = blockDue_[k / kBlock].of(areJoined(k));
  due = std::min(due, most_.of(areJoined(k)) + slack);
}

}  // namespace cloth_sim
