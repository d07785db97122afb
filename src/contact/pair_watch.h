#pragma once
/// \file Which pairs of faces have moved so far that they may touch.

#include <array>
#include <vector>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "face_pair.h"
#include "material_tree.h"

namespace cloth_sim {

/// Keeps count of how far faces travel and of how much their edges change, and lists the pairs
/// whose faces have travelled as far as they were apart; where the faces have a common corner,
/// whose edges have changed by as much. Motion that all vertices have in common does not count.
class PairWatch {
 public:
  /// Starts with no pairs. \param faces  of the mesh.
  void begin(const std::vector<Face>& faces);
  /// Adds the pairs in `near` from number `first` on, which are due.
  void append(const std::vector<FaceIds>& near, std::size_t first);
  void clear();
  std::size_t count() const { return ids_.size(); }
  const FaceIds& ids(std::size_t k) const { return ids_[k]; }
  const std::vector<Face>& faces() const { return faces_; }
  /// The faces of pairs.
  const std::vector<FaceId>& paired() const { return paired_; }

  /// Adds the motion of a substep.
  void follow(const SubstepMotion& motion);
  /// Lists the pairs that are due, ascending.
  void listDue(std::vector<std::uint32_t>& pairs);
  /// Says that a pair is due when its faces have travelled `slack` in sum, or their edges changed
  /// by that, from the end of this substep on [m]; 0: in the next one again.
  void setDue(std::size_t k, double slack);
  /// Makes all pairs due, where motion was taken back that they were looked at with.
  void setAllDue();

 private:
  /// Pairs that have a bound in common.
  static constexpr std::size_t kBlock = 128;

  /// Motion of a face, or of the two of a pair in sum, that brings it nearer to others.
  struct FaceMotion {
    double travel = 0.0;  ///< of the corner that moves most: to faces without a common corner [m]
    double edgeChange = 0.0;  ///< of the edge that changes most: to faces with a common corner [m]

    double of(bool areJoined) const { return areJoined ? edgeChange : travel; }
    double& of(bool areJoined) { return areJoined ? edgeChange : travel; }
  };

  bool areJoined(std::size_t k) const { return areJoined_[k] != 0; }
  double motionOf(std::size_t k) const {
    const bool joined = areJoined(k);
    return motions_[ids_[k].first].of(joined) + motions_[ids_[k].second].of(joined);
  }
  FaceMotion motionIn(const Face& face) const;
  template <typename Visit>
  void forPaired(const Visit& visit) const;
  bool mayBeDue(std::size_t block) const;
  void boxFaces(const SubstepMotion& motion);
  void proveByBoxes(const SubstepMotion& motion);

  std::vector<Face> faces_;
  std::vector<FaceIds> ids_;             ///< by pair
  std::vector<std::uint8_t> areJoined_;  ///< by pair: 1 if its faces have a common corner
  std::vector<double> due_;              ///< by pair: `motionOf` from which it is due [m]
  std::vector<FaceMotion> blockDue_;     ///< by block: `most_` up to which no pair of it is due
  std::vector<FaceMotion> motions_;      ///< sums over substeps, by face
  FaceMotion most_;                      ///< the most that `motionOf` can have grown
  std::vector<FaceId> paired_;           ///< faces of pairs
  std::vector<std::uint8_t> isPaired_;   ///< by face
  std::size_t known_ = 0;                ///< pairs that boxes were tried on
  std::vector<Vec3> step_;               ///< scratch: motion in the substep, by vertex [m]
  std::vector<std::uint8_t> isDue_;      ///< scratch: by pair of the blocks that were looked at
  std::vector<std::uint32_t> blocks_;    ///< scratch: blocks with pairs that may be due
  /// Scratch, at the start and at the end of the substep.
  std::array<std::vector<QuickBox>, 2> corners_;  ///< by vertex
  std::array<std::vector<QuickBox>, 2> boxes_;    ///< by face
};

}  // namespace cloth_sim
