#pragma once
/// \file Makes rviz markers of a snapshot. Needs no node and no master.

#include <string>
#include <vector>

#include "cloth_sim/ros/cloth_markers.h"
#include "cloth_sim/ros/shading.h"
#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// The appearance of the markers.
struct MarkerStyle {
  std::string frame = "world";
  double strainRange = 0.2;  ///< strain of the last colour of the map [-], > 0
  /// Draws the back of the cloth as a second surface in its own colour, which doubles the message.
  bool twoSided = false;
  double surfaceOffset = 0.0005;  ///< distance of each of two sides from the particles [m]
};

/// Builds the markers of a simulation: `cloth` and `cloth_back` shaded and coloured by strain,
/// `torn_edges`, `contacts` between layers (if they touch each other), `obstacles`, `bounds`,
/// `text` and `clamps`. A marker without points has the action DELETE, because some versions of
/// rviz crash on an empty list.
///
/// Reuses the buffers of its message from call to call.
class MarkerBuilder {
 public:
  explicit MarkerBuilder(MarkerStyle style);

  /// Builds the complete markers, which do not depend on earlier messages. Valid until the next
  /// call. \param figures  the latest ones, for the text.
  const ClothMarkers& build(const Snapshot& snapshot, const Figures& figures,
                            const ros::Time& stamp);

  /// Builds the markers without the cloth, its torn edges and its contacts.
  const visualization_msgs::MarkerArray& buildSurroundings(const Snapshot& snapshot,
                                                           const Figures& figures,
                                                           const ros::Time& stamp);

 private:
  using Marker = visualization_msgs::Marker;

  void begin(const ros::Time& stamp);
  Marker& next(const char* space, int type);
  void addCloth(const Snapshot& snapshot);
  void placeCorners(const Snapshot& snapshot, bool front, std::vector<geometry_msgs::Point>& out);
  void paintVertices();
  void paintFaces(const Snapshot& snapshot);
  void paint(std::size_t k, const Eigen::Vector3f& normal, float strain);
  void addTornEdges(const Snapshot& snapshot);
  void addContacts(const Snapshot& snapshot);
  void addSurroundings(const Snapshot& snapshot, const Figures& figures);
  void addObstacle(const Obstacle& obstacle);
  void addClamp(const ClampSnapshot& clamp);
  void addText(const Snapshot& snapshot, const Figures& figures);

  MarkerStyle style_;
  StrainColours frontColours_;
  StrainColours backColours_;
  ClothMarkers markers_;
  ros::Time stamp_;
  std::size_t used_ = 0;
  std::size_t mostUsed_ = 0;              ///< by any call
  std::vector<Eigen::Vector3f> normals_;  ///< by vertex
  std::vector<float> strains_;            ///< by vertex [-]
};

/// Returns the text of the markers, such as "pull  t = 7.20 s", "16384 particles, pieces 1" and
/// "broken 214 (torn 160, cut 54)  strain 0.12" on three lines.
std::string statusLine(const Snapshot& snapshot, const Figures& figures);

}  // namespace cloth_sim
