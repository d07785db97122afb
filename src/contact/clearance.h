#pragma once
/// \file A quick check that cloth is nowhere near itself, nor other cloth.

#include <vector>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/contact/contacts.h"
#include "tile_bounds.h"

namespace cloth_sim {

/// Checks in each step, from its start on and every few substeps, that no parts of the cloth come
/// nearer than a margin. It divides the cloth into tiles of some cells, and looks at smaller parts
/// only where two tiles might touch; nothing is kept per face. Where all is clear, faces need not
/// be searched for pairs, and no contact would push anything.
///
/// The proof is that of material_tree.h: boxes and balls contain positions and gradients at two
/// times, and so those between, if each vertex moves on a straight line. What all vertices have in
/// common does not count.
class Clearance {
 public:
  /// Substeps from one check to the next. \param h  length of a substep [s].
  static int interval(double h);

  /// Follows the mesh. \param margin  half of the distance to keep [m].
  void build(const Model& model, double margin);
  /// Tells whether there is a check: only if all cloths are grids, neither cut nor torn nor
  /// refined.
  bool isUsable() const { return !sheets_.empty(); }
  /// Tells whether all is clear with these positions, by vertex [m].
  bool isClearAt(const std::vector<Vec3>& x);
  /// Tells whether all is clear at the start of a substep, the first of a step.
  bool begin(const ParticleView& particles);
  /// Tells whether all is clear on straight ways from where vertices were at the last check that
  /// found all clear. False for positions that are not finite.
  bool follow(const ParticleView& particles);

 private:
  /// A cloth.
  struct Sheet {
    GridTile firstTile;
    std::vector<MaterialLevel> levels;    ///< from cells on; below the tiles only as needed
    std::vector<TileBounds> bounds;       ///< by tile, at one end
    std::vector<TileBounds> lastBounds;   ///< the same at the last check
    std::vector<std::uint8_t> isDivided;  ///< by tile: 1 if levels below are up to date

    GridTile tile(std::int32_t k) const;
    /// The vertex of the first row and column of a cell.
    VertexId cornerOf(std::int32_t cell) const;
  };

  bool addSheet(const Model& model, std::size_t cloth);
  template <typename PlaceOf>
  bool beginAt(const PlaceOf& placeOf);
  bool areAllClear(const VectorArray& end, std::vector<TileBounds> Sheet::*endBounds);
  void bound(const VectorArray& x, std::vector<TileBounds> Sheet::*bounds);
  void join(const std::vector<TileBounds>& endBounds, Sheet& sheet);
  void joinEnds(const TileBounds& last, const TileBounds& end, std::int32_t node,
                MaterialLevel& level) const;
  void divideAround(const Place& tile, Sheet& sheet);
  void divide(const Place& tile, Sheet& sheet);
  void refreshCell(std::int32_t cell, Sheet& sheet) const;
  bool isClear(const Place& a, const Place& b, Sheet& sheet);
  bool areClear(const Place& a, Sheet& sheetA, const Place& b, Sheet& sheetB);
  int partsOf(const Place& place, Sheet& sheet, std::array<Place, 4>& out);

  std::vector<Sheet> sheets_;         ///< by cloth; empty if there is no check
  double margin_ = 0.0;               ///< [m]
  Vec3 common_ = Vec3::Zero();        ///< motion since the last check that all have in common [m]
  VectorArray last_;                  ///< positions at the last check, by vertex [m]
  VectorArray now_;                   ///< positions, by vertex [m]
  const VectorArray* end_ = nullptr;  ///< of the way that is looked at
};

}  // namespace cloth_sim
