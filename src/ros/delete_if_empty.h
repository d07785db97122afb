#pragma once
/// \file Markers without points.

#include <visualization_msgs/Marker.h>

namespace cloth_sim {

/// Turns a marker without points into its deletion: there is nothing to draw, and some versions of
/// rviz crash on an empty list.
inline void deleteIfEmpty(visualization_msgs::Marker& marker) {
  if (marker.points.empty()) marker.action = visualization_msgs::Marker::DELETE;
}

}  // namespace cloth_sim
