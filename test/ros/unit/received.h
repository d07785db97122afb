#pragma once
/// \file Messages as a subscriber receives them.

#include <gtest/gtest.h>

#include "cloth_sim/ros/cloth_markers.h"

namespace cloth_sim {

inline visualization_msgs::MarkerArray received(const ClothMarkers& markers) {
  const ros::SerializedMessage bytes = ros::serialization::serializeMessage(markers);
  visualization_msgs::MarkerArray array;
  ros::serialization::deserializeMessage(bytes, array);
  // Behind the four bytes that say how long it is.
  EXPECT_EQ(ros::serialization::serializationLength(array) + 4, bytes.num_bytes);
  return array;
}

}  // namespace cloth_sim
