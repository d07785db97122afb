#pragma once
/// \file The collision geometry of a robot from its URDF. Needs no node and no master.

#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cloth_sim/contact/shape.h"

namespace cloth_sim {

/// An error of a robot or of its description, in one line.
class RobotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One element of the collision geometry of a link.
struct CollisionPart {
  Pose place;   ///< in the frame of the link
  Shape shape;  ///< box, cylinder, sphere or mesh
};

/// The box around the collision geometry of a link, in the frame of the link.
struct LinkBox {
  Vec3 centre = Vec3::Zero();  ///< [m]
  Vec3 half = Vec3::Zero();    ///< half its edge lengths [m]
};
/// \param parts  at least one.
LinkBox boxAround(const std::vector<CollisionPart>& parts);

/// A joint with one degree of freedom.
struct RobotJoint {
  std::string link;        ///< that it moves; the tf frame of this link is the frame of the joint
  Vec3 axis;               ///< in this frame, of unit length
  bool isSliding = false;  ///< prismatic; otherwise it turns
};

/// Returns the path of the file that a mesh names, such as "package://arm/palm.stl".
/// \throws RobotError if there is no such package.
using MeshFinder = std::function<std::string(const std::string& url)>;

/// The links of a robot and their tree.
class RobotDescription {
 public:
  /// Parses a URDF. \throws RobotError with the first error of the parser.
  explicit RobotDescription(const std::string& urdf);

  /// The names of all links, sorted.
  const std::vector<std::string>& links() const { return links_; }
  /// Tells whether a link has collision geometry. \throws RobotError if there is no such link.
  bool isSolid(const std::string& link) const;
  /// Reads the collision geometry of a link; empty if it has none.
  /// \throws RobotError for an unknown link, bad dimensions, or a mesh that cannot be read.
  std::vector<CollisionPart> collision(const std::string& link, const MeshFinder& find) const;
  /// The nearest link from which both hang by joints. \throws RobotError if there is none.
  std::string commonParent(const std::string& a, const std::string& b) const;
  /// Tells whether a link is another or hangs on it by joints. \throws RobotError for unknown
  /// links.
  bool hangsOn(const std::string& link, const std::string& other) const;
  /// Returns a joint that slides or turns.
  /// \throws RobotError if there is no such joint, or if it has not one degree of freedom.
  RobotJoint joint(const std::string& name) const;

 private:
  /// An element before its mesh is read.
  struct Element {
    Pose place;
    Shape shape;
    std::string mesh;           ///< URL of its file; "": the shape is no mesh
    Vec3 scale = Vec3::Ones();  ///< length unit of the file along each axis [m]; not 0
  };
  struct Link {
    std::string parent;  ///< "": the root
    std::vector<Element> elements;
  };

  const Link& need(const std::string& link) const;
  std::vector<std::string> ancestors(const std::string& link) const;

  std::vector<std::string> links_;
  std::map<std::string, Link> byName_;
  std::map<std::string, std::optional<RobotJoint>> joints_;  ///< nothing: of another kind
};

}  // namespace cloth_sim
