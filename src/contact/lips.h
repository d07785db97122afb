#pragma once
/// \file The two sides of an opening: parts them where layers of cloth touch.

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/layers.h"
#include "cloth_sim/mesh/mesh_changes.h"

namespace cloth_sim {

/// Moves vertices that an edit has doubled by at most some micrometres, so that the faces around
/// each are apart from those around its copies, as layers that touch have to be. Both had the
/// vertex in common before, so each pair of faces has a direction that separates its cones; the
/// copies move apart along all of these directions, and by less where another layer is near.
/// \param model   after the edit.
/// \param layers  that follow it.
/// \return whether no layers overlap now.
bool partLips(const MeshChanges& changes, const Model& model, LayerContact& layers, State& state);

}  // namespace cloth_sim
