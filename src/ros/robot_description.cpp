#include "robot_description.h"

#include <console_bridge/console.h>
#include <urdf_model/link.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/validation.h"
#include "scene/names.h"
#include "scene/surface_reader.h"

namespace cloth_sim {
namespace {

/// Keeps the first error that the parser reports, and prints nothing, for as long as it lives.
class ParserErrors : public console_bridge::OutputHandler {
 public:
  ParserErrors() : before_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~ParserErrors() override { console_bridge::useOutputHandler(before_); }
  ParserErrors(const ParserErrors&) = delete;
  ParserErrors& operator=(const ParserErrors&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text;
  }
  const std::string& first() const { return first_; }

 private:
  console_bridge::OutputHandler* before_;
  std::string first_;
};

/// Returns a message of the parser on one line, in ASCII, cut after 200 characters.
std::string onOneLine(const std::string& message) {
  constexpr std::size_t kLongest = 200;
  std::string line = message.substr(0, kLongest);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, ' ');
  return line.substr(0, line.find_last_not_of(" .") + 1);
}

urdf::ModelInterfaceSharedPtr parseUrdf(const std::string& text) {
  const ParserErrors errors;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& error) {
    throw RobotError("the URDF is malformed: " + onOneLine(error.what()));
  }
  if (!errors.first().empty()) {
    throw RobotError("the URDF is malformed: " + onOneLine(errors.first()));
  }
  if (!model) throw RobotError("the URDF is malformed");
  return model;
}

Pose poseOf(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {Vec3(pose.position.x, pose.position.y, pose.position.z),
          Quat(r.w, r.x, r.y, r.z).normalized()};
}

Shape toShape(const urdf::Geometry& geometry) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE: {
      SphereShape sphere;
      sphere.radius = static_cast<const urdf::Sphere&>(geometry).radius;
      return sphere;
    }
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      BoxShape box;
      box.size = Vec3(size.x, size.y, size.z);
      return box;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& from = static_cast<const urdf::Cylinder&>(geometry);
      CylinderShape cylinder;
      cylinder.radius = from.radius;
      cylinder.length = from.length;
      return cylinder;
    }
    case urdf::Geometry::MESH:
      break;
  }
  return MeshShape();
}

std::optional<RobotJoint> toJoint(const urdf::Joint& joint) {
  const bool isSliding = joint.type == urdf::Joint::PRISMATIC;
  const bool isTurning =
      joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
  const Vec3 axis(joint.axis.x, joint.axis.y, joint.axis.z);
  if ((!isSliding && !isTurning) || !axis.allFinite() || axis.isZero()) return std::nullopt;
  return RobotJoint{joint.child_link_name, axis.normalized(), isSliding};
}

Vec3 scaleOf(const urdf::Mesh& mesh, const std::string& link) {
  const Vec3 scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  if (scale.allFinite() && scale.cwiseAbs().minCoeff() > 0.0) return scale;
  throw RobotError("link '" + link + "': expected a mesh with a scale other than 0");
}

}  // namespace

LinkBox boxAround(const std::vector<CollisionPart>& parts) {
  Eigen::AlignedBox3d box;
  for (const CollisionPart& part : parts) {
    for (const DrawnPart& drawn : drawing(part.shape)) {
      const Vec3 low = drawn.surface ? drawn.surface->low() : Vec3(drawn.centre - drawn.size / 2.0);
      const Vec3 high =
          drawn.surface ? drawn.surface->high() : Vec3(drawn.centre + drawn.size / 2.0);
      const Eigen::AlignedBox3d own(low, high);
      for (int corner = 0; corner < 8; ++corner) {
        box.extend(
            part.place.toWorld(own.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
      }
    }
  }
  return {box.center(), box.sizes() / 2.0};
}

RobotDescription::RobotDescription(const std::string& urdf) {
  const urdf::ModelInterfaceSharedPtr model = parseUrdf(urdf);
  for (const auto& [name, from] : model->links_) {
    Link link;
    if (const urdf::LinkSharedPtr parent = from->getParent()) link.parent = parent->name;
    for (const urdf::CollisionSharedPtr& collision : from->collision_array) {
      if (!collision || !collision->geometry) continue;
      Element element{poseOf(collision->origin), toShape(*collision->geometry), "", Vec3::Ones()};
      if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(collision->geometry.get())) {
        element.mesh = mesh->filename;
        element.scale = scaleOf(*mesh, name);
      }
      link.elements.push_back(element);
    }
    links_.push_back(name);
    byName_.emplace(name, link);
  }
  for (const auto& [name, from] : model->joints_) joints_.emplace(name, toJoint(*from));
}

const RobotDescription::Link& RobotDescription::need(const std::string& link) const {
  const auto found = byName_.find(link);
  if (found == byName_.end()) throw RobotError(unknownName("link", link, links_));
  return found->second;
}

bool RobotDescription::isSolid(const std::string& link) const {
  return !need(link).elements.empty();
}

std::vector<CollisionPart> RobotDescription::collision(const std::string& link,
                                                       const MeshFinder& find) const {
  std::vector<CollisionPart> parts;
  for (const Element& element : need(link).elements) {
    CollisionPart part{element.place, element.shape};
    try {
      if (auto* mesh = std::get_if<MeshShape>(&part.shape)) {
        const std::string path = find(element.mesh);
        mesh->file = readSurface(path, path, element.scale);
        if (element.scale != Vec3::Ones()) mesh->scale = element.scale;
      }
    } catch (const std::runtime_error& error) {
      throw RobotError("link '" + link + "': " + error.what());
    }
    for (const std::string& error : {validationError(part.shape), validationError(part.place)}) {
      if (!error.empty()) throw RobotError("link '" + link + "': " + error);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// The link itself first, the root last.
std::vector<std::string> RobotDescription::ancestors(const std::string& link) const {
  std::vector<std::string> all;
  for (std::string it = link; !it.empty(); it = need(it).parent) all.push_back(it);
  return all;
}

std::string RobotDescription::commonParent(const std::string& a, const std::string& b) const {
  const std::vector<std::string> ofA = ancestors(a);
  for (const std::string& it : ancestors(b)) {
    if (it != b && it != a && std::find(ofA.begin(), ofA.end(), it) != ofA.end()) return it;
  }
  throw RobotError("links '" + a + "' and '" + b + "' hang on no common link");
}

bool RobotDescription::hangsOn(const std::string& link, const std::string& other) const {
  need(other);
  const std::vector<std::string> all = ancestors(link);
  return std::find(all.begin(), all.end(), other) != all.end();
}

RobotJoint RobotDescription::joint(const std::string& name) const {
  const auto found = joints_.find(name);
  if (found == joints_.end()) {
    std::vector<std::string> known;
    for (const auto& [other, joint] : joints_) known.push_back(other);
    throw RobotError(unknownName("joint", name, known));
  }
  if (!found->second) {
    throw RobotError("joint '" + name + "': expected one that slides or turns about an axis");
  }
  return *found->second;
}

}  // namespace cloth_sim
