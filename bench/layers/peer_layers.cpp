// Measures what contact between layers costs, beside Bullet in the same run, and prints tables in
// markdown. See `peer_layers --help`.

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "../../test/verify/intersections.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/threads/thread_limit.h"
#include "support/cpu_clock.h"
#include "task.h"

namespace cloth_sim::bench {
namespace {

struct Settings {
  int particles = 128;
  std::vector<int> sizes = {32, 64, 128};
  int warmUp = 30;      ///< frames before those that are timed
  int frames = 30;      ///< that are timed
  double limit = 90.0;  ///< CPU time of one contender [s]
  int peerMost = 128;   ///< largest size with Bullet
};

/// Frames of a turn.
constexpr int kTurn = 3;

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool isFinite(const std::vector<Vec3>& x) {
  return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
}

/// A contender with its cloth and its times.
class Racer {
 public:
  Racer(const LayersContender& contender, LayersTask task) : contender_(contender), task_(task) {
    if (contender.halves) task_.start = Start::kTwoHalves;
    cloth_ = contender.make(task_);
  }
  /// Simulates frames, unless the time is used up.
  void takeTurn(int frames, const Settings& settings) {
    for (int k = 0; k < frames && failure_.empty() && spent_ < settings.limit; ++k) {
      const double start = threadCpuTime();
      try {
        cloth_->advance();
      } catch (const std::exception& error) {
        failure_ = error.what();
      }
      const double seconds = threadCpuTime() - start;
      spent_ += seconds;
      if (failure_.empty() && !isFinite(cloth_->positions())) failure_ = "not finite";
      if (!failure_.empty()) break;
      ++done_;
      all_.push_back(1e3 * seconds);
      if (done_ > settings.warmUp) times_.push_back(1e3 * seconds);
    }
  }

  const LayersContender& contender() const { return contender_; }
  const LayeredCloth& cloth() const { return *cloth_; }
  /// Of a frame after the warm-up; of all frames if there is none [ms].
  double median() const { return medianOf(times()); }
  double least() const { return *std::min_element(times().begin(), times().end()); }
  double most() const { return *std::max_element(times().begin(), times().end()); }
  std::string remark(const Settings& settings) const;
  std::string layersText() const;

 private:
  const std::vector<double>& times() const { return times_.empty() ? all_ : times_; }

  LayersContender contender_;
  LayersTask task_;
  std::unique_ptr<LayeredCloth> cloth_;
  std::vector<double> all_, times_;  ///< of frames [ms]
  double spent_ = 0.0;               ///< [s]
  int done_ = 0;
  std::string failure_;
};

std::string Racer::remark(const Settings& settings) const {
  if (!failure_.empty()) return failure_ + " in frame " + std::to_string(done_ + 1);
  if (done_ < settings.warmUp + settings.frames) {
    return "stopped after " + std::to_string(done_) + " frames";
  }
  return "";
}

/// Intersecting pairs of faces, and how far layers are apart.
std::string Racer::layersText() const {
  const std::vector<Vec3> x = cloth_->positions();
  if (!isFinite(x)) return "| |";
  const Scene scene = sceneOf(task_, false);
  const Model model = buildModel(scene.cloths);
  State state = initialState(scene.cloths, model, scene.seed);
  for (VertexId v = 0; v < model.particleCount(); ++v) state.x[v] = x[v];
  std::string text = std::to_string(countIntersections(model, state)) + " | ";
  const std::vector<double> gaps = gapsOf(task_, x);
  if (gaps.empty()) return text + "|";
  double lowest = x[0].z();
  for (const Vec3& p : x) lowest = std::min(lowest, p.z());
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "%.2f, %.2f; %.2f |",
                1e3 * *std::min_element(gaps.begin(), gaps.end()), 1e3 * medianOf(gaps),
                1e3 * lowest);
  return text + numbers;
}

using Racers = std::vector<std::unique_ptr<Racer>>;

/// Lets all contenders take turns at a task.
Racers race(const LayersTask& task, const Settings& settings) {
  std::vector<LayersContender> all = contenders();
  if (task.particles <= settings.peerMost) {
    for (const LayersContender& peer : peersOf(task.start)) all.push_back(peer);
  }
  Racers racers;
  for (const LayersContender& contender : all) {
    racers.push_back(std::make_unique<Racer>(contender, task));
  }
  for (int done = 0; done < settings.warmUp + settings.frames; done += kTurn) {
    const int count = std::min(kTurn, settings.warmUp + settings.frames - done);
    for (const auto& racer : racers) racer->takeTurn(count, settings);
    std::fprintf(stderr, "%d x %d: %d frames\n", task.particles, task.particles, done + count);
  }
  return racers;
}

/// Returns the time that contact between layers adds, as text.
std::string moreText(const Racer& racer, const Racer& without) {
  if (&racer == &without) return "";
  char text[64];
  std::snprintf(text, sizeof text, "%+.1f ms, x %.1f", racer.median() - without.median(),
                racer.median() / without.median());
  return text;
}

void printRace(const std::string& title, const Racers& racers, const Settings& settings) {
  std::printf("\n#### %s\n\n", title.c_str());
  std::printf(
      "| engine | contact between layers | ms per frame [least, most] | over without contact | "
      "contacts | intersections | gap: least, median; lowest [mm] | remark |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const Racer* without = nullptr;
  for (const auto& racer : racers) {
    if (!racer->contender().touches) without = racer.get();
    std::printf("| %s | %s | %.1f [%.1f, %.1f] | %s | %d | %s %s |\n",
                racer->contender().engine.c_str(), racer->contender().setting.c_str(),
                racer->median(), racer->least(), racer->most(), moreText(*racer, *without).c_str(),
                racer->cloth().contacts(), racer->layersText().c_str(),
                racer->remark(settings).c_str());
    std::fflush(stdout);
  }
}

/// A row of the table of growth, from the two racers of this package.
std::string growthRow(const LayersTask& task, const Racers& racers) {
  const Racer& without = *racers.at(0);
  const Racer& with = *racers.at(1);
  const int substeps = with.cloth().substeps();
  const double more = 1e6 * (with.median() - without.median()) / substeps;  // [ns]
  const int contacts = std::max(1, with.cloth().contacts());
  const int particles = task.particles * task.particles;
  char row[256];
  std::snprintf(row, sizeof row, "| %d x %d | %d | %d | %d | %d | %.1f | %.1f | %.0f | %.0f |\n",
                task.particles, task.particles, particles, with.cloth().pairs(),
                with.cloth().contacts(), substeps, without.median(), with.median(), more / contacts,
                more / particles);
  return row;
}

/// Memory that is allocated now [bytes].
double allocated() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

struct Memory {
  double built = 0.0;    ///< after construction [bytes]
  double stepped = 0.0;  ///< after frames [bytes]
};

Memory memoryOf(const LayersTask& task, bool layers, int frames) {
  const double before = allocated();
  const std::unique_ptr<LayeredCloth> cloth = ownCloth(task, layers);
  Memory memory;
  memory.built = allocated() - before;
  for (int k = 0; k < frames; ++k) cloth->advance();
  memory.stepped = allocated() - before;
  return memory;
}

void printMemory(const Settings& settings) {
  std::printf(
      "\n#### Memory, bytes per particle, %d x %d\n\n"
      "| start | when | without | `self_contact` | difference |\n|---|---|---|---|---|\n",
      settings.particles, settings.particles);
  const double particles = static_cast<double>(settings.particles) * settings.particles;
  for (const Start start : {Start::kHanging, Start::kFolded}) {
    const LayersTask task{start, settings.particles};
    const Memory without = memoryOf(task, false, settings.frames);
    const Memory with = memoryOf(task, true, settings.frames);
    const char* name = start == Start::kHanging ? "hanging" : "folded";
    std::printf("| %s | constructed | %.0f | %.0f | %.0f |\n", name, without.built / particles,
                with.built / particles, (with.built - without.built) / particles);
    std::printf("| %s | after %d frames | %.0f | %.0f | %.0f |\n", name, settings.frames,
                without.stepped / particles, with.stepped / particles,
                (with.stepped - without.stepped) / particles);
  }
}

void checkSizes(const Settings& settings) {
  std::vector<int> all = settings.sizes;
  all.push_back(settings.particles);
  for (const int n : all) {
    if (n % 2 != 0) {
      throw std::invalid_argument("expected an even number of particles, not " + std::to_string(n));
    }
  }
}

void measure(const Settings& settings) {
  checkSizes(settings);
  const std::string size = std::to_string(settings.particles);
  const LayersTask hanging{Start::kHanging, settings.particles};
  printRace("A hanging cloth, " + size + " x " + size, race(hanging, settings), settings);
  const LayersTask hemmed{Start::kHemmed, settings.particles};
  printRace("A cloth with a quarter in contact, " + size + " x " + size, race(hemmed, settings),
            settings);
  std::string growth;
  for (const int n : settings.sizes) {
    const LayersTask folded{Start::kFolded, n};
    const Racers racers = race(folded, settings);
    const std::string side = std::to_string(n);
    printRace("A folded cloth, " + side + " x " + side, racers, settings);
    growth += growthRow(folded, racers);
  }
  std::printf(
      "\n#### Growth, a folded cloth; differences in ns per substep\n\n"
      "| size | particles | pairs of faces | contacts | substeps | ms per frame without | with | "
      "difference per contact | per particle |\n|---|---|---|---|---|---|---|---|---|\n%s",
      growth.c_str());
  printMemory(settings);
}

}  // namespace
}  // namespace cloth_sim::bench

// NOLINTNEXTLINE(bugprone-exception-escape): only a wrong list of options throws before `try`.
int main(int argc, char** argv) {
  using namespace cloth_sim::bench;
  Settings settings;
  CLI::App app{"Measures contact between layers of cloth, beside Bullet: CPU time and memory."};
  app.add_option("--particles", settings.particles,
                 "along each side of the hanging and the hemmed cloth, even")
      ->check(CLI::Range(16, 512))
      ->capture_default_str();
  app.add_option("--sizes", settings.sizes, "particles along each side of folded cloths, even")
      ->delimiter(',')
      ->check(CLI::Range(16, 512))
      ->capture_default_str();
  app.add_option("--warm-up", settings.warmUp, "frames before those that are timed")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  app.add_option("--frames", settings.frames, "frames that are timed")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--limit", settings.limit, "CPU time of one contender, after which it stops [s]")
      ->capture_default_str();
  app.add_option("--peer-most", settings.peerMost, "largest size with Bullet; 0: without it")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    const cloth_sim::ThreadLimit oneThread(1);
    measure(settings);
  } catch (const std::exception& error) {
    std::cerr << "peer_layers: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
