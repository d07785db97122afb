// Compares cloth_sim with Bullet's soft body in one run on one machine: the cost of a frame and the
// stretch of the cloth. See `peer_bullet --help`.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cloth.h"
#include "cloth_sim/threads/thread_limit.h"
#include "motions.h"

namespace cloth_sim::bench {
namespace {

/// Number of parts of a run that are timed separately. The result is their median, with the least
/// and the most. All contenders take their turn at a part before the next part begins, so that a
/// slow phase of the machine affects all of them.
constexpr int kParts = 5;
/// Depth in the sphere or under the ground from which a particle counts as fallen through [m].
constexpr double kThrough = 0.02;

struct Result {
  std::string engine;
  std::string setting;
  double median = 0.0, least = 0.0, most = 0.0;  ///< CPU time of a frame [ms]
  double column = 0.0;                           ///< largest strain of a column [-]
  double edge = 0.0;                             ///< largest length over rest length [-]
  double speed = 0.0;                            ///< of the fastest particle [m/s]
  int through = 0;                               ///< number of particles that have fallen through
  bool finite = true;
};

/// A contender with its cloth and its times.
class Racer {
 public:
  Racer(const Contender& contender, const Task& task)
      : contender_(contender), task_(task), cloth_(contender.make(task)) {}

  void takeTurn(int part) {
    const int frames = static_cast<int>(std::lround(task_.duration / task_.frame));
    const int count = frames * (part + 1) / kParts - frames * part / kParts;
    const double start = cpuTime();
    for (int k = 0; k < count; ++k) cloth_->advance();
    times_.push_back(1e3 * (cpuTime() - start) / count);
  }
  Result result() const;

 private:
  Contender contender_;
  Task task_;
  std::unique_ptr<Cloth> cloth_;
  std::vector<double> times_;  ///< of a frame, for each part [ms]
};

Result Racer::result() const {
  std::vector<double> times = times_;
  std::sort(times.begin(), times.end());
  const Grid3 x = cloth_->positions();
  Result result;
  result.engine = contender_.engine;
  result.setting = contender_.setting;
  result.median = times[kParts / 2];
  result.least = times.front();
  result.most = times.back();
  result.column = columnStretch(x, task_.particles, task_.side);
  result.edge = worstEdge(x, task_.particles, task_.side);
  result.speed = fastest(cloth_->velocities());
  result.finite = std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
  if (task_.sphere) {
    result.through = countInside(x, task_.sphere->centre, task_.sphere->radius, kThrough) +
                     countBelow(x, -kThrough);
  }
  return result;
}

void print(const Result& r) {
  std::printf("  %-10s %-34s %8.2f [%7.2f %7.2f] %8.2f %% %7.3f %9.4f %6d%s\n", r.engine.c_str(),
              r.setting.c_str(), r.median, r.least, r.most, 100.0 * r.column, r.edge, r.speed,
              r.through, r.finite ? "" : "  not finite");
  std::fflush(stdout);
}

/// \return the cheapest result that is stretched by at most `column` and `edge`, or null.
const Result* cheapest(const std::vector<Result>& results, double column, double edge) {
  const Result* best = nullptr;
  for (const Result& r : results) {
    const bool holds = r.finite && r.through == 0 && r.column <= column && r.edge <= edge;
    if (holds && (best == nullptr || r.median < best->median)) best = &r;
  }
  return best;
}

nlohmann::json toJson(const Result& r) {
  return {{"engine", r.engine},   {"setting", r.setting}, {"ms_per_frame", r.median},
          {"ms_least", r.least},  {"ms_most", r.most},    {"column_stretch", r.column},
          {"worst_edge", r.edge}, {"speed", r.speed},     {"fallen_through", r.through},
          {"finite", r.finite}};
}

struct Comparison {
  std::string name;
  Task task;
  std::vector<Contender> peers;
  std::vector<Contender> ours;
  double ask = 0.0;  ///< largest strain of a column with which a peer counts as holding the cloth
};

/// Prints both lists, and the ratio of the cost of the cheapest peer that holds the cloth to that
/// of our cheapest setting with equal or smaller stretch.
nlohmann::json compare(const Comparison& comparison) {
  std::printf("%s: %d x %d particles, %.3g s, frames of 1/%.0f s, one thread\n",
              comparison.name.c_str(), comparison.task.particles, comparison.task.particles,
              comparison.task.duration, 1.0 / comparison.task.frame);
  std::printf("  %-10s %-34s %8s [%7s %7s] %10s %7s %9s %6s\n", "engine", "setting", "ms/frame",
              "least", "most", "column", "edge", "m/s", "fallen");
  nlohmann::json json = {{"scene", comparison.name}, {"particles", comparison.task.particles}};
  std::vector<Racer> racers;
  for (const auto* contenders : {&comparison.peers, &comparison.ours}) {
    for (const Contender& contender : *contenders) racers.emplace_back(contender, comparison.task);
  }
  for (int part = 0; part < kParts; ++part) {
    for (Racer& racer : racers) racer.takeTurn(part);
    std::fprintf(stderr, "part %d of %d\n", part + 1, kParts);
  }
  std::vector<Result> peers, ours;
  for (std::size_t k = 0; k < racers.size(); ++k) {
    const Result result = racers[k].result();
    print(result);
    json["rows"].push_back(toJson(result));
    (k < comparison.peers.size() ? peers : ours).push_back(result);
  }
  const Result* peer = cheapest(peers, comparison.ask, std::numeric_limits<double>::infinity());
  if (peers.empty()) return json;
  if (peer == nullptr) {
    std::printf("  no setting of the peer keeps columns below %.3g %%\n\n", 100.0 * comparison.ask);
    return json;
  }
  const Result* own = cheapest(ours, peer->column, peer->edge);
  if (own == nullptr) {
    std::printf("  no setting of cloth_sim stretches the cloth as little as %s of the peer\n\n",
                peer->setting.c_str());
    return json;
  }
  json["ratio"] = peer->median / own->median;
  json["peer"] = peer->setting;
  json["own"] = own->setting;
  std::printf("  %s costs %.1f times as much as %s, which stretches the cloth no more\n\n",
              ("Bullet " + peer->setting).c_str(), peer->median / own->median,
              own->setting.c_str());
  return json;
}

std::vector<Contender> settingsOfBullet(bool few) {
  std::vector<Contender> result;
  for (const auto& [substeps, iterations] :
       std::vector<std::pair<int, int>>{{4, 4}, {4, 16}, {8, 4}, {12, 4}, {12, 8}, {20, 4}}) {
    if (!few || substeps == 4) result.push_back(bullet(substeps, iterations));
  }
  return result;
}

/// \param text  method and parameters, such as "projective substeps=1 iterations=2".
Contender ownSetting(const std::string& text) {
  std::istringstream words(text);
  std::string method, word;
  words >> method;
  std::vector<std::string> overrides;
  while (words >> word) overrides.push_back("solver." + word);
  return own(method, overrides);
}

std::vector<Contender> settingsOfOurs() {
  return {own("projective", {"solver.substeps=1", "solver.iterations=1"}),
          own("projective", {"solver.substeps=1", "solver.iterations=2"}),
          own("projective", {"solver.substeps=2", "solver.iterations=1"}),
          own("projective", {"solver.substeps=3", "solver.iterations=1"}),
          own("projective", {"solver.substeps=4", "solver.iterations=1"}),
          own("xpbd", {"solver.substeps=20"}),
          own("xpbd", {"solver.substeps=32"}),
          own("xpbd", {"solver.substeps=40"}),
          own("line_xpbd", {"solver.substeps=20"}),
          own("line_xpbd", {"solver.error=0.01"})};
}

int measureMotion(const std::string& file, int particles) {
  std::ofstream out(file);
  writeAtSize(out, compareInMotion(particles));
  out.close();
  if (!out) throw std::runtime_error(file + ": cannot be written");
  return 0;
}

}  // namespace
}  // namespace cloth_sim::bench

// NOLINTNEXTLINE(bugprone-exception-escape): only a wrong list of options throws before `try`.
int main(int argc, char** argv) {
  using namespace cloth_sim::bench;
  Task task;
  bool few = false;
  bool noPeer = false;
  std::vector<std::string> settings;
  std::string file;
  std::string motion;
  std::vector<std::string> only = {"hang", "sphere"};
  CLI::App app{"Compares cloth_sim with Bullet's soft body: CPU time of a frame and stretch."};
  app.add_option("--particles", task.particles, "particles along each side")
      ->check(CLI::Range(8, 1024))
      ->capture_default_str();
  app.add_option("--duration", task.duration, "simulated time of each run [s]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--scenes", only, "scenes to run: hang, sphere or both")->delimiter(',');
  app.add_flag("--few", few, "runs only the cheapest settings of Bullet");
  app.add_flag("--no-peer", noPeer, "runs cloth_sim only");
  app.add_option("--ours", settings,
                 "settings of cloth_sim instead of the default ones, each \"METHOD KEY=VALUE...\"");
  app.add_option("--json", file, "also writes the rows to this file");
  app.add_option("--motion", motion,
                 "instead measures errors in motion beside a reference, and writes this CSV file");
  CLI11_PARSE(app, argc, argv);
  try {
    const cloth_sim::ThreadLimit oneThread(1);
    if (!motion.empty()) return measureMotion(motion, task.particles);
    std::vector<Contender> ours;
    for (const std::string& text : settings) ours.push_back(ownSetting(text));
    if (ours.empty()) ours = settingsOfOurs();
    nlohmann::json all = nlohmann::json::array();
    for (const std::string& name : only) {
      Comparison comparison{name, task, settingsOfBullet(few), ours, 0.05};
      if (noPeer) comparison.peers.clear();
      if (name == "sphere") {
        comparison.task.sphere = Task::Sphere{{0.0, 0.0, 0.35}, 0.25};
        comparison.task.height = 0.7;
        comparison.ask = 0.10;
      } else if (name != "hang") {
        throw std::invalid_argument("--scenes: unknown scene '" + name + "' (hang, sphere)");
      }
      all.push_back(compare(comparison));
    }
    if (!file.empty()) std::ofstream(file) << all.dump(2) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "peer_bullet: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
