#pragma once
/// \file Every key that a scene file may have, by the map that it stands in; docs/scene.md says
/// what each means. The keys of a solver's own parameters are in the registry.

#include <string>
#include <vector>

namespace cloth_sim::keys {

using Keys = std::vector<std::string>;

inline const Keys kScene{"cloth",     "solver", "gravity", "wind",   "drag",
                         "obstacles", "clamps", "tearing", "phases", "seed"};

inline const Keys kPose{"position", "rpy", "orientation"};

inline const Keys kCloth{"name",     "obj",       "scale",       "uv_scale",
                         "size",     "particles", "pose",        "random_offset",
                         "velocity", "fabric",    "raw_springs", "particle_mass",
                         "shear",    "bending",   "pins",        "surgery"};
inline const Keys kFabric{"preset",  "areal_density", "tensile_warp", "tensile_weft", "shear",
                          "bending", "damping",       "friction",     "thickness"};
inline const Keys kRawSprings{"structural", "shear", "bend", "per_stretch", "dashpot"};

inline const Keys kSurgery{"snap",       "min_edge",    "max_particles",
                           "drop_below", "clear_strip", "refine_cuts"};
inline const Keys kRefinement{"radius", "generations", "min_edge"};

inline const Keys kSolver{"method", "dt", "step_guard", "error", "sleep"};
inline const Keys kSleep{"speed", "after"};
inline const Keys kWind{"velocity", "density", "drag_coefficient"};

/// Besides `type` and the dimensions of the shape.
inline const Keys kObstacle{"position", "rpy",      "orientation",
                            "velocity", "friction", "tangential_decay"};

inline const Keys kClamp{
    "pose",          "patch",     "plate_size",        "gap_open",         "gap_closed",
    "closing_speed", "max_speed", "max_angular_speed", "max_acceleration", "grip_force"};
inline const Keys kPatch{"cloth", "particle", "radius"};

inline const Keys kTearing{"enabled", "ratio", "seam", "tip_speed", "refine_tip"};
inline const Keys kRatio{"structural", "shear", "bend"};
inline const Keys kSeam{"cloth", "path", "half_width"};

inline const Keys kPhase{"name", "clamps", "obstacles", "wind",    "tearing",   "notch",
                         "cut",  "refine", "until",     "timeout", "on_timeout"};
inline const Keys kClampAction{"hold",    "attach", "grasp",       "move_by",
                               "move_to", "rpy",    "orientation", "speed"};
inline const Keys kObstacleAction{"velocity"};
inline const Keys kPhaseTearing{"enabled", "ratio"};
inline const Keys kNotch{"cloth", "path"};
inline const Keys kStroke{"path", "direction", "reach", "blades", "first_layer", "half_width"};
inline const Keys kRefine{"path", "point", "radius", "generations", "min_edge"};
inline const Keys kUntil{"elapsed", "mean_speed", "contact", "clamps", "pieces", "broken"};
inline const Keys kMeanSpeed{"below", "for"};

}  // namespace cloth_sim::keys
