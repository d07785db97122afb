#include "parameters.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "live_parameters.h"
#include "scene/names.h"

namespace cloth_sim {
namespace {

using XmlRpc::XmlRpcValue;

constexpr double kMaxRate = 1000.0;    ///< [Hz]
constexpr double kMaxFactor = 1000.0;  ///< of real time [-]
constexpr int kMaxThreads = 1024;
constexpr double kMaxDepth = 1000.0;  ///< of a camera [m]
constexpr double kMaxFriction = 10.0;

/// The valid range of a number.
struct Range {
  double low = 0.0;
  double high = 0.0;
  bool lowIsIn = true;

  bool holds(double value) const {
    return std::isfinite(value) && value <= high && (lowIsIn ? value >= low : value > low);
  }
  std::string text() const {
    std::ostringstream text;
    text << (lowIsIn ? ">= " : "> ") << low << " and <= " << high;
    return text.str();
  }
};

/// Reads private parameters one by one and collects their names.
class Reader {
 public:
  explicit Reader(const ros::NodeHandle& node) : node_(node) {}

  void read(const std::string& name, std::string& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeString) fail(name, "a string", raw);
    value = static_cast<std::string>(raw);
    if (value.empty()) fail(name, "a string that is not empty", raw);
  }

  void read(const std::string& name, bool& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeBoolean) fail(name, "true or false", raw);
    value = static_cast<bool>(raw);
  }

  void read(const std::string& name, const Range& range, double& value) {
    XmlRpcValue raw;
    if (find(name, raw)) value = number(name, range, raw);
  }

  void read(const std::string& name, const Range& range, int& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeInt || !range.holds(static_cast<int>(raw))) {
      fail(name, "a whole number " + range.text(), raw);
    }
    value = static_cast<int>(raw);
  }

  void read(const std::string& name, std::vector<std::string>& value) {
    XmlRpcValue raw;
    if (find(name, raw)) value = strings(name, "a list of strings \"dotted.key=value\"", raw);
  }

  /// {description: PARAMETER, links: [...], self_filter: [...], clamps: {name: GRIPPER}}; an empty
  /// map is no robot.
  void read(const std::string& name, std::optional<RobotSettings>& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeStruct) fail(name, "a map", raw);
    if (raw.size() > 0) value = readRobot(name, raw);
  }

  /// {frame: FRAME, size: [w, h], fov, near, far, rate}; an empty map is no camera.
  void read(const std::string& name, std::optional<CameraSettings>& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeStruct) fail(name, "a map", raw);
    if (raw.size() > 0) value = readCamera(name, raw);
  }

  /// {name: {tf: FRAME} | {pose: TOPIC} | {odometry: TOPIC}, ...}; a string is a tf frame.
  void read(const std::string& name, std::map<std::string, PoseSource>& value) {
    XmlRpcValue raw;
    if (!find(name, raw)) return;
    if (raw.getType() != XmlRpcValue::TypeStruct) fail(name, kSources, raw);
    for (auto& [tracked, source] : raw) value[tracked] = readSource(name + "/" + tracked, source);
  }

  /// Refuses a value of the wrong type. One of the right type is what an earlier run has left.
  void check(const LiveParameter& parameter) {
    bool isOn = false;
    if (parameter.isSwitch) return read(parameter.name, isOn);
    XmlRpcValue raw;
    if (find(parameter.name, raw)) number(parameter.name, "a number", raw);
  }

  /// Warns about private parameters that were not read.
  void warnAboutOthers() const {
    std::vector<std::string> names;
    node_.getParamNames(names);
    const std::string prefix = node_.getNamespace() + "/";
    for (const std::string& full : names) {
      if (full.compare(0, prefix.size(), prefix) != 0) continue;
      const std::string name = full.substr(prefix.size());
      if (isKnown(name)) continue;
      const std::string nearest = nearestName(name, known_);
      ROS_WARN_STREAM("unknown parameter "
                      << full << " has no effect"
                      << (nearest.empty() ? "; known are: " + joinNames(known_, kAllNames)
                                          : "; did you mean " + nearest + "?"));
    }
  }

  void allow(const std::string& name) { known_.push_back(name); }

 private:
  double number(const std::string& name, const std::string& expected, XmlRpcValue& raw) const {
    if (raw.getType() == XmlRpcValue::TypeInt) return static_cast<int>(raw);
    if (raw.getType() == XmlRpcValue::TypeDouble) return static_cast<double>(raw);
    fail(name, expected, raw);
  }

  std::vector<std::string> strings(const std::string& name, const std::string& expected,
                                   XmlRpcValue& raw) const {
    std::vector<std::string> value;
    if (raw.getType() != XmlRpcValue::TypeArray) fail(name, expected, raw);
    for (int i = 0; i < raw.size(); ++i) {
      if (raw[i].getType() != XmlRpcValue::TypeString) fail(name, expected, raw);
      value.push_back(static_cast<std::string>(raw[i]));
    }
    return value;
  }

  double number(const std::string& name, const Range& range, XmlRpcValue& raw) const {
    const double value = number(name, "a number " + range.text(), raw);
    if (!range.holds(value)) fail(name, "a number " + range.text(), raw);
    return value;
  }

  CameraSettings readCamera(const std::string& name, XmlRpcValue& raw) const {
    CameraSettings camera;
    for (auto& [key, value] : raw) {
      const std::string path = name + "/" + key;
      if (key == "frame") {
        if (value.getType() != XmlRpcValue::TypeString) fail(path, "the name of a tf frame", value);
        camera.frame = static_cast<std::string>(value);
      } else if (key == "size") {
        readImageSize(path, value, camera.lens);
      } else if (key == "fov") {
        camera.lens.fieldOfView = number(path, Range{1.0, 170.0}, value);
      } else if (key == "near") {
        camera.lens.nearest = number(path, Range{0.0, kMaxDepth, false}, value);
      } else if (key == "far") {
        camera.lens.farthest = number(path, Range{0.0, kMaxDepth, false}, value);
      } else if (key == "rate") {
        camera.rate = number(path, Range{0.0, kMaxRate, false}, value);
      } else {
        throw ParameterError(
            node_.resolveName(name) + ": " +
            unknownName("key", key, {"far", "fov", "frame", "near", "rate", "size"}));
      }
    }
    if (camera.frame.empty()) fail(name, "a map with the name of a tf frame as frame", raw);
    if (camera.lens.farthest <= camera.lens.nearest) fail(name, "far > near", raw);
    return camera;
  }

  void readImageSize(const std::string& name, XmlRpcValue& raw, CameraLens& lens) const {
    static const char* const expected = "two whole numbers >= 2 and <= 1920";
    const Range range{2.0, 1920.0};
    if (raw.getType() != XmlRpcValue::TypeArray || raw.size() != 2) fail(name, expected, raw);
    for (int k = 0; k < 2; ++k) {
      if (raw[k].getType() != XmlRpcValue::TypeInt || !range.holds(static_cast<int>(raw[k]))) {
        fail(name, expected, raw);
      }
    }
    lens.width = static_cast<int>(raw[0]);
    lens.height = static_cast<int>(raw[1]);
  }

  RobotSettings readRobot(const std::string& name, XmlRpcValue& raw) const {
    RobotSettings robot;
    for (auto& [key, value] : raw) {
      const std::string path = name + "/" + key;
      if (key == "description") {
        if (value.getType() != XmlRpcValue::TypeString)
          fail(path, "the name of a parameter", value);
        robot.description = static_cast<std::string>(value);
      } else if (key == "links") {
        robot.links = strings(path, "a list of links", value);
      } else if (key == "self_filter") {
        robot.selfFilter = strings(path, "a list of links", value);
      } else if (key == "clamps") {
        robot.clamps = readGrippers(path, value);
      } else {
        throw ParameterError(
            node_.resolveName(name) + ": " +
            unknownName("key", key, {"clamps", "description", "links", "self_filter"}));
      }
    }
    return robot;
  }

  std::map<std::string, GripperSettings> readGrippers(const std::string& name,
                                                      XmlRpcValue& raw) const {
    if (raw.getType() != XmlRpcValue::TypeStruct) fail(name, "a map {clamp: [link, link]}", raw);
    std::map<std::string, GripperSettings> result;
    for (auto& [clamp, value] : raw) result[clamp] = readGripper(name + "/" + clamp, value);
    return result;
  }

  /// [link, link], or {plates: [link, link], motor: JOINT, friction: MU}.
  GripperSettings readGripper(const std::string& name, XmlRpcValue& raw) const {
    GripperSettings gripper;
    if (raw.getType() != XmlRpcValue::TypeStruct) {
      gripper.plates = readPlates(name, raw);
      return gripper;
    }
    if (!raw.hasMember("plates")) fail(name, "two links as plates", raw);
    if (!raw.hasMember("motor")) fail(name, "a joint as motor", raw);
    for (auto& [key, value] : raw) {
      const std::string path = name + "/" + key;
      if (key == "plates") {
        gripper.plates = readPlates(path, value);
      } else if (key == "motor") {
        if (value.getType() != XmlRpcValue::TypeString) fail(path, "the name of a joint", value);
        gripper.motor = static_cast<std::string>(value);
      } else if (key == "friction") {
        gripper.friction = number(path, Range{0.0, kMaxFriction, false}, value);
      } else {
        throw ParameterError(node_.resolveName(name) + ": " +
                             unknownName("key", key, {"friction", "motor", "plates"}));
      }
    }
    return gripper;
  }

  std::array<std::string, 2> readPlates(const std::string& name, XmlRpcValue& raw) const {
    static const char* const expected = "two links";
    const std::vector<std::string> links = strings(name, expected, raw);
    if (links.size() != 2) fail(name, expected, raw);
    return {links[0], links[1]};
  }

  static constexpr const char* kSources =
      "a map {name: {tf: FRAME}}, or pose: TOPIC or odometry: TOPIC in place of tf";

  PoseSource readSource(const std::string& name, XmlRpcValue& raw) const {
    Follow::Request request;
    if (raw.getType() == XmlRpcValue::TypeString) {
      request.tf = static_cast<std::string>(raw);
    } else if (raw.getType() == XmlRpcValue::TypeStruct) {
      const std::map<std::string, std::string*> fields{{"tf", &request.tf},
                                                       {"pose", &request.pose},
                                                       {"odometry", &request.odometry},
                                                       {"grasp_width", &request.grasp_width}};
      for (auto& [key, text] : raw) {
        const auto field = fields.find(key);
        if (field == fields.end() || text.getType() != XmlRpcValue::TypeString) {
          fail(name, "{tf | pose | odometry: NAME, grasp_width: TOPIC}", raw);
        }
        *field->second = static_cast<std::string>(text);
      }
    } else {
      fail(name, "{tf | pose | odometry: NAME, grasp_width: TOPIC}", raw);
    }
    const std::string error = sourceError(request);
    if (!error.empty()) throw ParameterError(node_.resolveName(name) + ": " + error);
    return toPoseSource(request);
  }

  /// Tells whether a parameter was read, or is part of one that was.
  bool isKnown(const std::string& name) const {
    return std::any_of(known_.begin(), known_.end(), [&](const std::string& known) {
      return name == known || name.compare(0, known.size() + 1, known + "/") == 0;
    });
  }

  bool find(const std::string& name, XmlRpcValue& value) {
    allow(name);
    return node_.getParam(name, value);
  }

  [[noreturn]] void fail(const std::string& name, const std::string& expected,
                         const XmlRpcValue& value) const {
    std::ostringstream text;
    text << node_.resolveName(name) << ": expected " << expected << " (got ";
    value.write(text);
    text << ")";
    throw ParameterError(text.str());
  }

  const ros::NodeHandle& node_;
  std::vector<std::string> known_;
};

}  // namespace

NodeParameters readParameters(const ros::NodeHandle& privateNode) {
  NodeParameters result;
  Reader reader(privateNode);
  reader.read("scene", result.scene);
  reader.read("set", result.set);
  reader.read("world_frame", result.worldFrame);
  reader.read("rate_markers", Range{0.0, kMaxRate}, result.rateMarkers);
  reader.read("rate_frame", Range{0.0, kMaxRate}, result.rateFrame);
  reader.read("rate_surface", Range{0.0, kMaxRate}, result.rateSurface);
  reader.read("rate_state", Range{0.0, kMaxRate, false}, result.rateState);
  reader.read("rate_wrench", Range{0.0, kMaxRate}, result.rateWrench);
  reader.read("rate_follow", Range{0.0, kMaxRate, false}, result.rateTracking);
  reader.read("wrench_cutoff", Range{0.0, kMaxRate}, result.wrenchCutoff);
  reader.read("real_time_factor", Range{0.0, kMaxFactor}, result.realTimeFactor);
  reader.read("threads", Range{0.0, kMaxThreads}, result.threads);
  reader.read("paused", result.paused);
  reader.read("publish_clock", result.publishClock);
  reader.read("state_directory", result.stateDirectory);
  reader.read("strain_range", Range{0.0, 100.0, false}, result.strainRange);
  reader.read("handles", result.handles);
  reader.read("two_sided", result.twoSided);
  reader.read("follow", result.clampSources);
  reader.read("follow_obstacle", result.obstacleSources);
  reader.read("robot", result.robot);
  reader.read("camera", result.camera);
  reader.allow("diagnostic_period");  // diagnostic_updater's own [s]
  for (const LiveParameter& parameter : listLiveParameters()) reader.check(parameter);
  reader.warnAboutOthers();
  return result;
}

}  // namespace cloth_sim
