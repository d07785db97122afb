#include "live_parameters.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth_sim {
namespace {

constexpr double kMirrorPeriod = 0.2;  ///< between comparisons with the simulation [s]
constexpr std::chrono::milliseconds kSettling{500};  ///< delay of a command in the observations
constexpr double kRounding = 1e-9;                   ///< relative difference that is no change

/// Returns the smallest ratio less one; infinity if nothing can tear.
double weakest(const TearRatios& ratio) {
  return *std::min_element(ratio.begin(), ratio.end()) - 1.0;
}

Vec3 windVelocity(const ClothConfig& config) {
  return {config.wind_x, config.wind_y, config.wind_z};
}

bool same(double a, double b) { return std::abs(a - b) <= kRounding * (std::abs(a) + std::abs(b)); }

bool same(const ClothConfig& a, const ClothConfig& b) {
  return same(a.gravity, b.gravity) && windVelocity(a) == windVelocity(b) &&
         a.tearing == b.tearing && same(a.tear_strain, b.tear_strain) &&
         a.quasi_static == b.quasi_static && same(a.stiffness, b.stiffness);
}

/// Returns the wind of a velocity; none for velocity zero in a scene without wind, because still
/// air would press on moving cloth.
std::optional<Wind> windFor(const Vec3& velocity, const Tuning& now, const SceneTuning& scene) {
  if (velocity.isZero(0.0) && !scene.wind) return std::nullopt;
  Wind wind = now.wind ? *now.wind : scene.wind.value_or(Wind());
  wind.velocity = velocity;
  return wind;
}

}  // namespace

SceneTuning sceneTuning(const Scene& scene) {
  SceneTuning tuning;
  if (!scene.gravity.isZero(0.0)) tuning.down = scene.gravity.normalized();
  tuning.wind = scene.wind;
  return tuning;
}

ClothConfig toConfig(const Tuning& tuning) {
  auto config = ClothConfig();  // sets to 0 what the generated class copies without having set it
  const Vec3 wind = tuning.wind ? tuning.wind->velocity : Vec3::Zero();
  config.gravity = tuning.gravity.norm();
  config.wind_x = wind.x();
  config.wind_y = wind.y();
  config.wind_z = wind.z();
  config.tearing = tuning.tearing;
  config.tear_strain = weakest(tuning.ratio);
  config.stiffness = tuning.stiffness;
  config.quasi_static = tuning.quasiStatic;
  config.__clamp__();
  return config;
}

TearRatios scaledRatios(const TearRatios& ratio, double strain) {
  TearRatios result = ratio;
  const double before = weakest(ratio);
  if (std::isfinite(before)) {
    for (double& value : result) value = 1.0 + (value - 1.0) * (strain / before);
  } else {
    for (const SpringKindTraits& traits : kSpringKindTraits) {
      if (traits.isMembrane) result[static_cast<std::size_t>(traits.kind)] = 1.0 + strain;
    }
  }
  return result;
}

std::vector<Command> commandsBetween(const ClothConfig& before, const ClothConfig& after,
                                     const Tuning& now, const SceneTuning& scene) {
  std::vector<Command> commands;
  if (after.gravity != before.gravity) commands.push_back(SetGravity{after.gravity * scene.down});
  if (windVelocity(after) != windVelocity(before)) {
    commands.push_back(SetWind{windFor(windVelocity(after), now, scene)});
  }
  if (after.tearing != before.tearing || after.tear_strain != before.tear_strain) {
    const bool moved = after.tear_strain != before.tear_strain;
    commands.push_back(
        SetTearing{after.tearing, moved ? scaledRatios(now.ratio, after.tear_strain) : now.ratio});
  }
  if (after.quasi_static != before.quasi_static) {
    commands.push_back(SetQuasiStatic{static_cast<bool>(after.quasi_static)});
  }
  if (after.stiffness != before.stiffness) commands.push_back(SetStiffness{after.stiffness});
  return commands;
}

std::vector<LiveParameter> listLiveParameters() {
  std::vector<LiveParameter> all;
  for (const auto& description : ClothConfig::__getParamDescriptions__()) {
    all.push_back({description->name, description->type == "bool"});
  }
  return all;
}

namespace {

/// Deletes the parameters that an earlier run left on the parameter server. \return `node`.
ros::NodeHandle withoutLeftovers(const ros::NodeHandle& node) {
  for (const LiveParameter& parameter : listLiveParameters()) node.deleteParam(parameter.name);
  return node;
}

}  // namespace

LiveParameters::LiveParameters(const ros::NodeHandle& privateNode, const Scene& scene,
                               SimulationThread& simulation)
    : scene_(sceneTuning(scene)),
      simulation_(simulation),
      config_(toConfig(simulation.observe().snapshot->tuning)),
      server_(mutex_, withoutLeftovers(privateNode)) {
  server_.updateConfig(config_);
  // This calls the callback once, with the present configuration.
  server_.setCallback(
      [this](ClothConfig& config, std::uint32_t level) { onChange(config, level); });
  timer_ = ros::NodeHandle(privateNode)
               .createSteadyTimer(ros::WallDuration(kMirrorPeriod),
                                  [this](const ros::SteadyTimerEvent&) { mirror(); });
}

/// Called with the mutex locked.
void LiveParameters::onChange(ClothConfig& config, std::uint32_t /*level*/) {
  const Tuning now = simulation_.observe().snapshot->tuning;
  const std::vector<Command> commands = commandsBetween(config_, config, now, scene_);
  config_ = config;
  if (!commands.empty()) changed_ = Clock::now();
  for (const Command& command : commands) {
    simulation_.post(command, [](const CommandResult& result) {
      if (!result.success) ROS_WARN_STREAM("~set_parameters: refused: " << result.message);
    });
  }
}

void LiveParameters::mirror() {
  const boost::recursive_mutex::scoped_lock lock(mutex_);
  if (Clock::now() - changed_ < kSettling) return;
  const ClothConfig now = toConfig(simulation_.observe().snapshot->tuning);
  if (same(now, config_)) return;
  config_ = now;
  server_.updateConfig(config_);
}

}  // namespace cloth_sim
