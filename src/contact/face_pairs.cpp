#include "face_pairs.h"

#include <algorithm>
#include <numeric>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Passes of the certificate: at first vertices slide, then motion is shortened towards that of
/// zones, and at last towards where it starts, which cannot fail.
constexpr int kPassesOfSliding = 20;
constexpr int kPassesOfZones = 40;
constexpr int kPassesInAll = 60;
static_assert(kPassesOfFree < kPassesOfSliding);

}  // namespace

void FacePairs::assign(const std::vector<FaceIds>& near, const std::vector<Face>& faces,
                       double least) {
  least_ = least;
  clear();
  watch_.begin(faces);
  append(near, 0);
}

void FacePairs::clear() {
  watch_.clear();
  pairs_.clear();
  placeOf_.clear();
  indexed_ = 0;
}

void FacePairs::append(const std::vector<FaceIds>& near, std::size_t first) {
  watch_.append(near, first);
  placeOf_.resize(watch_.count(), kNone);
}

/// The corners and the direction of a pair, which are listed from the first time on that somebody
/// asks.
FacePair& FacePairs::pairAt(std::size_t k) {
  if (placeOf_[k] == kNone) {
    placeOf_[k] = static_cast<std::int32_t>(pairs_.size());
    const FaceIds& ids = watch_.ids(k);
    pairs_.emplace_back(watch_.faces()[ids.first], watch_.faces()[ids.second]);
  }
  return pairs_[placeOf_[k]];
}

/// Lists the pairs of each face.
void FacePairs::indexPairs() {
  indexed_ = watch_.count();
  pairsStart_.assign(watch_.faces().size() + 1, 0);
  const auto facesOf = [this](std::size_t k) {
    return std::array<FaceId, 2>{watch_.ids(k).first, watch_.ids(k).second};
  };
  for (std::size_t k = 0; k < indexed_; ++k) {
    for (const FaceId f : facesOf(k)) ++pairsStart_[f];
  }
  std::partial_sum(pairsStart_.begin(), pairsStart_.end(), pairsStart_.begin());
  pairsOf_.resize(2 * indexed_);
  for (std::size_t k = indexed_; k-- > 0;) {
    for (const FaceId f : facesOf(k)) pairsOf_[--pairsStart_[f]] = static_cast<std::uint32_t>(k);
  }
}

/// Lists the pairs that have to be looked at again after a pass that changed motion: those that
/// failed, or that have a vertex that was moved; unless their own motion was scaled.
void FacePairs::listAgain(const Truncation& last) {
  if (indexed_ != watch_.count()) indexPairs();
  isListed_.resize(watch_.count(), 0);
  listed_.clear();
  const auto list = [this](std::uint32_t k) {
    if (isListed_[k] != 0) return;
    isListed_[k] = 1;
    listed_.push_back(k);
  };
  const auto isMoved = [&](VertexId v) { return last.truncated[v] == last.pass; };
  for (const FaceId f : watch_.paired()) {
    const Face& face = watch_.faces()[f];
    if (!isMoved(face[0]) && !isMoved(face[1]) && !isMoved(face[2])) continue;
    for (auto at = pairsStart_[f]; at < pairsStart_[f + 1]; ++at) list(pairsOf_[at]);
  }
  for (const std::uint32_t k : failing_) list(k);
  for (const std::uint32_t k : listed_) isListed_[k] = 0;
  const auto isFixed = [this](std::uint32_t k) {
    return placeOf_[k] != kNone && pairs_[placeOf_[k]].isFixed;
  };
  listed_.erase(std::remove_if(listed_.begin(), listed_.end(), isFixed), listed_.end());
  std::sort(listed_.begin(), listed_.end());
}

/// Looks at the pairs that are listed, and lists those that do not stay apart in the substep.
void FacePairs::findFailing(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 256;
  for (const std::uint32_t k : listed_) pairAt(k);
  slack_.resize(listed_.size());
  parallelFor(static_cast<std::int32_t>(listed_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t n = first; n < last; ++n) {
                  slack_[n] = slackOf(pairs_[placeOf_[listed_[n]]], motion);
                }
              });
  failing_.clear();
  for (std::size_t n = 0; n < listed_.size(); ++n) {
    watch_.setDue(listed_[n], slack_[n]);
    if (slack_[n] == 0.0) failing_.push_back(listed_[n]);
  }
}

PairOutcome FacePairs::keepApart(Truncation now) {
  PairOutcome outcome;
  if (watch_.count() == 0) return outcome;
  const SubstepMotion& motion = now.motion;
  watch_.follow(motion);
  watch_.listDue(listed_);
  for (const std::uint32_t k : listed_) pairAt(k).isFixed = false;
  for (int pass = 0; pass < kPassesInAll; ++pass) {
    if (pass == kPassesOfZones) freePairs();
    if (pass > 0) listAgain(now);
    now.pass = static_cast<std::uint8_t>(pass + 1);
    findFailing(motion);
    if (failing_.empty()) return outcome;
    if (pass == kPassesOfSliding) zones_.begin(motion.end.size());
    outcome.changed = true;
    for (const std::uint32_t k : failing_) {
      if (!giveWay(pairAt(k), pass, now)) ++outcome.unproven;
    }
    zones_.restoreMomentum(now);
  }
  stop(now);
  return outcome;
}

/// Lets pairs that zones have kept apart be looked at again: the passes that follow do without
/// them.
void FacePairs::freePairs() {
  for (FacePair& pair : pairs_) pair.isFixed = false;
}

/// Changes the motion of a pair that would not stay apart.
/// \return whether it was apart at the start.
bool FacePairs::giveWay(FacePair& pair, int pass, Truncation now) {
  if (pass < kPassesOfSliding) {
    // Where others may slide, what stays now may be moved again.
    return slide(pair, least_, now) || shorten(pair, least_, now);
  }
  if (pass < kPassesOfZones) now.common = zones_.join(pair, now);
  pair.isFixed = true;
  return shorten(pair, least_, now);
}

void FacePairs::stop(const Truncation& now) {
  watch_.setAllDue();
  for (const VertexId v : now.motion.vertices) {
    if (now.motion.end[v] != now.motion.start[v]) moveBack(v, 0.0, now);
  }
}

}  // namespace cloth_sim
