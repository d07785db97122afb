#pragma once
/// \file The colours of a cloth on a screen. Markers and the rviz display share them.

#include <std_msgs/ColorRGBA.h>

#include <Eigen/Core>

namespace cloth_sim {

std_msgs::ColorRGBA makeColour(float r, float g, float b, float a = 1.0f);
std_msgs::ColorRGBA blend(const std_msgs::ColorRGBA& from, const std_msgs::ColorRGBA& to,
                          float fraction);

/// Colour of a strain, from 0 (or below) to 1 (or above) times the range, on a map of even
/// perceptual steps from blue over green to yellow.
std_msgs::ColorRGBA strainColour(double fraction);

/// Light from above and a little from the side, soft all around the surface (half Lambert): rviz
/// does not light vertices with colours of their own.
/// \param normal  unit, towards the viewer's side of the surface.
/// \return factor of a colour, 0.3 ... 1.05.
float brightness(const Eigen::Vector3f& normal);

/// Opaque, no brighter than white.
std_msgs::ColorRGBA shaded(const std_msgs::ColorRGBA& base, float factor);

}  // namespace cloth_sim
