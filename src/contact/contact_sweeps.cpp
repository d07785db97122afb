#include "contact_sweeps.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Layers that are nearer than their thickness when a step begins, as after a cut, part at this
/// speed [m/s].
constexpr double kPartingSpeed = 0.2;
/// A push moves no vertex by more than this many times what is missing in the distance: where the
/// closest point is nearly at a vertex that cannot move, a light one beside it would be thrown far.
constexpr double kFarthestPush = 4.0;
/// Layers that rest on layers are settled more than once: what is left of a load throws them, each
/// one and a half times as fast as the one below.
constexpr int kRoundsAbove = 2;

}  // namespace

void ContactSweeps::add(const LayerPush& push, double h) {
  pushes_.push_back(push);
  LayerPush& added = pushes_.back();
  added.aim = std::min(push.distance, push.normal.dot(push.before) + kPartingSpeed * h);
  Mobility mobility{push.share, 0.0};
  for (int k = 0; k < 4; ++k) mobility.ofSides += push.weight[k] * push.share[k];
  limit(mobility);
  added.mobility = mobility.ofSides;
}

/// Makes loads smaller that would move a vertex too far.
void ContactSweeps::limit(Mobility& of) {
  if (!(of.ofSides > 0.0)) return;
  for (const double share : of.share) {
    of.ofSides = std::max(of.ofSides, std::abs(share) / kFarthestPush);
  }
}

int ContactSweeps::project(const SubstepMotion& motion) {
  int active = 0;
  const auto project = [&](LayerPush& push) {
    return projectOne(push, {push.share, push.mobility}, motion);
  };
  for (LayerPush& push : pushes_) project(push);
  for (auto push = pushes_.rbegin(); push != pushes_.rend(); ++push) {
    if (project(*push)) ++active;
  }
  return active;
}

void ContactSweeps::settle(const SubstepMotion& motion, std::vector<std::uint8_t>& supported) {
  pending_.resize(pushes_.size());
  for (std::size_t k = 0; k < pending_.size(); ++k) pending_[k] = static_cast<std::uint32_t>(k);
  const auto isSettled = [&](std::uint32_t k) {
    return isSideSupported(pushes_[k], true, supported) &&
           isSideSupported(pushes_[k], false, supported);
  };
  constexpr int kMostLevels = 32;
  for (int level = 0; level < kMostLevels; ++level) {
    raised_.clear();
    const int rounds = level == 0 ? 1 : kRoundsAbove;
    for (int round = 0; round < rounds; ++round) settleLevel(motion, supported);
    if (raised_.empty()) return;
    for (const VertexId v : raised_) supported[v] = 1;
    pending_.erase(std::remove_if(pending_.begin(), pending_.end(), isSettled), pending_.end());
  }
}

/// Sweeps once forwards and once backwards over the contacts with one side that is supported.
void ContactSweeps::settleLevel(const SubstepMotion& motion,
                                const std::vector<std::uint8_t>& supported) {
  for (const std::uint32_t k : pending_) settleOne(pushes_[k], motion, supported);
  for (auto k = pending_.rbegin(); k != pending_.rend(); ++k) {
    settleOne(pushes_[*k], motion, supported);
  }
}

/// Tells whether all vertices that take part on a side of a contact are supported.
bool ContactSweeps::isSideSupported(const LayerPush& push, bool first,
                                    const std::vector<std::uint8_t>& supported) {
  for (int k = first ? 0 : push.corners; k < (first ? push.corners : 4); ++k) {
    if (push.weight[k] != 0.0 && supported[push.v[k]] == 0) return false;
  }
  return true;
}

/// Projects a contact with one side that is supported and another that is not.
void ContactSweeps::settleOne(LayerPush& push, const SubstepMotion& motion,
                              const std::vector<std::uint8_t>& supported) {
  const bool first = isSideSupported(push, true, supported);
  if (first == isSideSupported(push, false, supported)) return;
  const int begin = first ? push.corners : 0;
  const int end = first ? 4 : push.corners;
  // The mobility is that of the whole side, also where a part of it is supported: the rest would
  // be thrown far to make up for it.
  Mobility mobility;
  for (int k = begin; k < end; ++k) {
    mobility.ofSides += push.weight[k] * push.share[k];
    if (supported[push.v[k]] == 0) mobility.share[k] = push.share[k];
  }
  limit(mobility);
  if (!projectOne(push, mobility, motion)) return;
  for (int k = begin; k < end; ++k) raised_.push_back(push.v[k]);
}

/// Pushes the sides of a contact apart, or lets them come nearer by what it pushed before, and
/// brings friction within its bound.
/// \return whether it carries load.
bool ContactSweeps::projectOne(LayerPush& push, const Mobility& mobility,
                               const SubstepMotion& motion) {
  const Vec3& n = push.normal;
  Vec3 after = Vec3::Zero();
  for (int k = 0; k < 4; ++k) after += push.weight[k] * motion.end[push.v[k]];
  const double gap = n.dot(after);
  if (gap >= push.distance && push.load == 0.0) return false;
  if (!(mobility.ofSides > 0.0)) return push.load > 0.0;
  const double load = std::max(0.0, push.load + (push.aim - gap) / mobility.ofSides);
  Vec3 slip = after - push.before;
  slip -= n.dot(slip) * n;
  Vec3 drag = push.drag - slip / mobility.ofSides;
  drag -= n.dot(drag) * n;
  const double bound = push.friction * load;
  if (drag.squaredNorm() > bound * bound) drag *= bound / drag.norm();
  const Vec3 move = (load - push.load) * n + drag - push.drag;
  push.load = load;
  push.drag = drag;
  for (int k = 0; k < 4; ++k) motion.end[push.v[k]] += mobility.share[k] * move;
  return load > 0.0;
}

}  // namespace cloth_sim
