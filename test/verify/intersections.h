#pragma once
/// \file Counts the pairs of faces of a cloth that intersect, by exact predicates.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "surgery/stroke_predicates.h"

namespace cloth_sim {

inline int signOfOrientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double value = exactOrientation(a, b, c, d);
  return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}

/// Tells whether the segment from p to q passes through the inside of a triangle.
inline bool passesThrough(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const int from = signOfOrientation(t[0], t[1], t[2], p);
  const int to = signOfOrientation(t[0], t[1], t[2], q);
  if (from == 0 || to == 0 || from == to) return false;
  const int side = signOfOrientation(p, q, t[0], t[1]);
  return side != 0 && side == signOfOrientation(p, q, t[1], t[2]) &&
         side == signOfOrientation(p, q, t[2], t[0]);
}

/// Tells whether an edge of face `f` passes through face `g`; edges with a corner of `g` do not
/// count.
inline bool pierces(const Face& f, const Face& g, const std::vector<Vec3>& x) {
  for (int k = 0; k < 3; ++k) {
    const VertexId a = f[k];
    const VertexId b = f[(k + 1) % 3];
    if (contains(g, a) || contains(g, b)) continue;
    if (passesThrough(x[a], x[b], {x[g[0]], x[g[1]], x[g[2]]})) return true;
  }
  return false;
}

/// Returns the number of pairs of faces that intersect. Faces with a common edge do not count: they
/// meet in it. Candidates are found on a grid of the longest edge.
inline int countIntersections(const Model& model, const State& state) {
  const std::vector<Face>& faces = model.mesh.faces();
  const std::vector<Vec3>& x = state.x.values();
  double cell = 1e-4;
  for (const Face& f : faces) {
    for (int k = 0; k < 3; ++k) cell = std::max(cell, (x[f[k]] - x[f[(k + 1) % 3]]).norm());
  }
  std::unordered_map<std::int64_t, std::vector<FaceId>> grid;
  std::set<std::pair<FaceId, FaceId>> found;
  const auto visitCells = [&](const Face& f, const auto& visit) {
    const Vec3 low = x[f[0]].cwiseMin(x[f[1]]).cwiseMin(x[f[2]]) / cell;
    const Vec3 high = x[f[0]].cwiseMax(x[f[1]]).cwiseMax(x[f[2]]) / cell;
    for (auto i = std::lround(std::floor(low.x())); i <= std::floor(high.x()); ++i) {
      for (auto j = std::lround(std::floor(low.y())); j <= std::floor(high.y()); ++j) {
        for (auto k = std::lround(std::floor(low.z())); k <= std::floor(high.z()); ++k) {
          visit(((i + 100000) * 200000 + j + 100000) * 200000 + k + 100000);
        }
      }
    }
  };
  for (FaceId f = 0; f < static_cast<FaceId>(faces.size()); ++f) {
    visitCells(faces[f], [&](std::int64_t key) {
      for (const FaceId g : grid[key]) {
        int shared = 0;
        for (const VertexId v : faces[f]) shared += std::count(faces[g].begin(), faces[g].end(), v);
        if (shared >= 2) continue;
        if (pierces(faces[f], faces[g], x) || pierces(faces[g], faces[f], x)) found.insert({g, f});
      }
      grid[key].push_back(f);
    });
  }
  return static_cast<int>(found.size());
}

}  // namespace cloth_sim
