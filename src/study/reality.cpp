#include "reality.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "reality_bending.h"
#include "reality_cloth.h"
#include "reality_drape.h"
#include "reality_elastica.h"
#include "reality_fling.h"
#include "reality_motion.h"
#include "reality_pull.h"
#include "reality_tear.h"

namespace cloth_sim {
namespace {

enum RealityTableIndex {
  kCantilever,
  kFold,
  kDrape,
  kRim,
  kFling,
  kFlingPath,
  kPull,
  kSlope,
  kSwing,
  kTear,
  kNotch,
  kTearTrace
};

constexpr double kLayerFriction = 0.5;

using RealityRuns = std::vector<RealityRun>;

/// Joins values with commas and ends the line. NaN is written as nan whatever its sign is.
class CsvLine {
 public:
  template <typename... Values>
  static std::string of(const Values&... values) {
    CsvLine line;
    (line.add(values), ...);
    return line.out_.str() + '\n';
  }

 private:
  template <typename Value>
  void add(const Value& value) {
    if (!isFirst_) out_ << ',';
    isFirst_ = false;
    out_ << value;
  }
  void add(double value) {
    if (std::isnan(value)) return add("nan");
    std::ostringstream text;
    text.precision(6);
    text << value;
    add(text.str());
  }

  std::ostringstream out_;
  bool isFirst_ = true;
};

void planCantilevers(bool quick, RealityRuns& runs) {
  constexpr double kSpacing = 3e-3;  // [m]
  for (const BendingFabric& fabric : bendingFabrics()) {
    if (quick && fabric.source == "Wang et al. 2011") continue;
    runs.push_back({"cantilever, " + fabric.name, kCantilever, [fabric] {
                      const double length = elastoGravityLength(fabric.bending, fabric.density);
                      const double overhang = simulatedOverhang(fabric, kSpacing);
                      return CsvLine::of(fabric.name, fabric.source, fabric.bending, fabric.density,
                                         fabric.bending / fabric.density, length, 2.0 * length,
                                         cantileverOverhang(41.5 * M_PI / 180.0) * length, overhang,
                                         overhang / (2.0 * length));
                    }});
  }
}

void planFolds(bool quick, RealityRuns& runs) {
  const std::vector<const char*> names =
      quick ? std::vector<const char*>{"preset cotton"}
            : std::vector<const char*>{"preset silk",      "preset cotton", "gray-interlock",
                                       "11oz-black-denim", "royal-target",  "stiff"};
  const double spacing = quick ? 3e-3 : 2e-3;  // [m]
  for (const BendingFabric& fabric : bendingFabrics()) {
    const auto isNamed = [&fabric](const char* name) { return fabric.name == name; };
    if (std::none_of(names.begin(), names.end(), isNamed)) continue;
    runs.push_back({"fold, " + fabric.name, kFold, [fabric, spacing] {
                      const double length = elastoGravityLength(fabric.bending, fabric.density);
                      const double height = simulatedFoldHeight(fabric, spacing);
                      return CsvLine::of(fabric.name, fabric.bending / fabric.density, length,
                                         spacing, height, height / length, findSoftFold().height);
                    }});
  }
}

/// A fabric on a mesh, with a note about what it shows.
struct DrapeCase {
  std::string shows;
  DrapeFabric fabric;
  DrapeMesh mesh;
};

constexpr double kUsualSide = 7.5e-3;  ///< of the triangles of a disc [m]

/// Appends a fabric without and with the friction of its yarns over a range of densities, as none
/// was published.
void addDensities(const DrapeFabric& fabric, double hysteresis, std::vector<DrapeCase>& cases) {
  DrapeFabric rubbing = fabric;
  rubbing.hysteresis = hysteresis;
  cases.push_back({"hysteresis", rubbing, {kUsualSide, 0.0}});
  for (const double density : {0.07, 0.15, 0.2}) {
    DrapeFabric other = fabric;
    other.density = rubbing.density = density;
    cases.push_back({"density", other, {kUsualSide, 0.0}});
    cases.push_back({"hysteresis", rubbing, {kUsualSide, 0.0}});
  }
}

std::vector<DrapeCase> drapeCases(bool quick) {
  // Bending and hysteresis: Matsudaira et al. 2015. Densities and shear stiffnesses are chosen:
  // they are not stated.
  const DrapeFabric broadcloth{"broadcloth", 11.57e-6, 0.12, 25.0};
  const DrapeFabric faille{"faille", 1.863e-6, 0.10, 25.0};
  if (quick) return {{"mesh", broadcloth, {0.012, 0.0}}};
  std::vector<DrapeCase> cases;
  for (const DrapeFabric& fabric : {broadcloth, faille}) {
    for (const DrapeMesh mesh : {DrapeMesh{kUsualSide, 0.0}, DrapeMesh{kUsualSide, 0.5},
                                 DrapeMesh{1e-2, 0.0}, DrapeMesh{5e-3, 0.0}}) {
      cases.push_back({"mesh", fabric, mesh});
    }
    for (const double shear : {15.0, 100.0}) {
      DrapeFabric other = fabric;
      other.shear = shear;
      cases.push_back({"shear", other, {kUsualSide, 0.0}});
    }
  }
  addDensities(broadcloth, 1.216e-3, cases);
  addDensities(faille, 6.86e-5, cases);
  return cases;
}

void planDrapes(bool quick, RealityRuns& runs) {
  for (const DrapeCase& c : drapeCases(quick)) {
    for (int start = quick ? 6 : 4; start <= (quick ? 6 : 8); ++start) {
      runs.push_back({"drape, " + c.fabric.name + ", " + c.shows, kDrape, [c, start] {
                        const Drape drape = simulateDrape(c.fabric, c.mesh, start);
                        return CsvLine::of(c.fabric.name, c.shows, c.fabric.bending,
                                           c.fabric.density, c.fabric.shear, c.fabric.hysteresis,
                                           c.mesh.side, c.mesh.turn, start, drape.coefficient,
                                           drape.folds, drape.energy, drape.isAtRest ? 1 : 0);
                      }});
    }
  }
}

/// The rims of the two fabrics from one start, for a picture.
void planRims(bool quick, RealityRuns& runs) {
  for (const DrapeCase& c : drapeCases(quick)) {
    const bool isShown = c.shows == "mesh" && c.mesh.turn == 0.0 &&
                         (quick || std::abs(c.mesh.side - kUsualSide) < 1e-9);
    if (!isShown) continue;
    const int start = c.fabric.name == "faille" ? 7 : 5;
    runs.push_back({"rim, " + c.fabric.name, kRim, [c, start] {
                      std::string lines;
                      for (const Vec2& at : simulateDrape(c.fabric, c.mesh, start).rim) {
                        lines += CsvLine::of(c.fabric.name, start, at.x(), at.y());
                      }
                      return lines;
                    }});
  }
}

std::string flingPath(const Fling& fling) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(4);
  for (std::size_t frame = 0; frame < fling.times.size(); ++frame) {
    for (const Vec3& x : fling.positions[frame]) {
      out << fling.times[frame] << ',' << x.x() << ',' << x.y() << ',' << x.z() << '\n';
    }
  }
  return out.str();
}

void planFlings(bool quick, RealityRuns& runs) {
  const FlingSetting reference{"verlet", 0, 0.0, quick ? 11 : 21};
  const int n = reference.columns;
  std::vector<FlingSetting> settings = {{"line_xpbd", 0, 0.01, n}};
  if (!quick) {
    settings.insert(settings.end(), {{"line_xpbd", 40, 0.0, n},
                                     {"xpbd", 40, 0.0, n},
                                     {"projective", 10, 0.0, n},
                                     {"implicit_euler", 4, 0.0, n},
                                     {"tr_bdf2", 4, 0.0, n},
                                     {"verlet", 0, 0.0, 11},
                                     {"line_xpbd", 0, 0.01, 11},
                                     {"line_xpbd", 0, 0.01, 41}});
  }
  for (const FlingSetting& setting : settings) {
    runs.push_back({"fling, " + setting.method, kFling, [setting, reference] {
                      const Fling exact = simulateFling(reference);
                      const Fling fling = simulateFling(setting);
                      return CsvLine::of(setting.method, setting.substeps, setting.error,
                                         setting.columns, fling.rows, flingDistance(fling, exact),
                                         flingChamfer(fling, exact), flingChamfer(exact, fling));
                    }});
  }
  runs.push_back({"fling, trajectory", kFlingPath,
                  [reference] { return flingPath(simulateFling(reference)); }});
}

void planPulls(bool quick, RealityRuns& runs) {
  for (const StretchFit& fit : stretchFits()) {
    for (const PullKind kind :
         {PullKind::kWarp, PullKind::kWeft, PullKind::kBias, PullKind::kBiaxial}) {
      if (quick && (kind != PullKind::kWarp || fit.preset != "denim")) continue;
      runs.push_back({"pull, " + fit.preset, kPull, [fit, kind, quick] {
                        std::string lines;
                        for (const double strain : {0.02, 0.05, 0.1, 0.15}) {
                          if (quick && strain > 0.02) break;
                          lines += CsvLine::of(fit.preset, fit.file, toString(kind), strain,
                                               fittedPull(fit, kind, strain),
                                               simulatedPull(fit.preset, kind, strain));
                        }
                        return lines;
                      }});
    }
  }
}

void planSlopes(bool quick, RealityRuns& runs) {
  for (const double degrees : {20.0, 24.0, 26.0, 27.0, 28.0, 30.0, 33.0}) {
    if (quick && degrees != 20.0 && degrees != 33.0) continue;
    runs.push_back({"slope", kSlope, [degrees] {
                      return CsvLine::of(kLayerFriction, std::atan(kLayerFriction) * 180.0 / M_PI,
                                         degrees, slideOnSlope(kLayerFriction, degrees));
                    }});
  }
}

void planSwings(bool quick, RealityRuns& runs) {
  for (const char* const name : {"cotton", "silk", "denim"}) {
    const std::string preset = name;
    if (quick && preset != "cotton") continue;
    runs.push_back({"swing, " + preset, kSwing, [preset] {
                      const SwingDecay air = simulateSwing(preset, true);
                      const SwingDecay none = simulateSwing(preset, false);
                      const SwingDecay theory = swingByTheory(preset);
                      return CsvLine::of(preset, fabricPreset(preset).arealDensity, air.period,
                                         theory.period, periodWithMovedAir(preset, 0.1), air.rate,
                                         theory.rate, none.rate, air.last, theory.last);
                    }});
  }
}

/// The largest meshes first: they take longest.
void planTears(bool quick, RealityRuns& runs) {
  for (const int particles : {257, 129, 65, 33}) {
    for (const double angle : {0.0, 15.0, 30.0, 45.0}) {
      if (quick && (particles > 33 || angle == 15.0 || angle == 30.0)) continue;
      runs.push_back({"trouser tear", kTear, [particles, angle] {
                        TrouserTear tear;
                        tear.particles = particles;
                        tear.angle = angle;
                        const TearForce force = trouserForce(tear);
                        return CsvLine::of(particles, angle, tear.energy, force.mean, force.scatter,
                                           force.advances, force.mean / (0.5 * tear.energy));
                      }});
    }
  }
}

void planNotches(bool quick, RealityRuns& runs) {
  const auto plan = [&runs](int particles, double notch) {
    runs.push_back({"notched strip", kNotch, [particles, notch] {
                      NotchedStrip strip;
                      strip.particles = particles;
                      strip.notch = notch;
                      return CsvLine::of(particles, notch, strip.energy, strengthOf(strip));
                    }});
  };
  for (const int particles : {17, 33, 65, 129}) {
    if (!quick || particles < 65) plan(particles, 0.1);
  }
  for (const double notch : {0.025, 0.05, 0.2}) {
    if (!quick) plan(65, notch);
  }
}

/// The force of one trouser tear over time, for a picture.
void planTearTrace(bool quick, RealityRuns& runs) {
  runs.push_back({"trouser tear, force over time", kTearTrace, [quick] {
                    TrouserTear tear;
                    tear.particles = quick ? 33 : 65;
                    const ForceTrace trace = traceTear(sceneOf(tear), 3);
                    std::string lines;
                    for (std::size_t k = 0; k < trace.time.size(); k += 2) {
                      lines += CsvLine::of(trace.time[k], trace.force[k]);
                    }
                    return lines;
                  }});
}

}  // namespace

const std::vector<RealityTable>& realityTables() {
  static const std::vector<RealityTable> all = {
      {"reality_cantilever.csv",
       "fabric,source,bending,density,bending_over_density,length,standard_overhang,"
       "elastica_overhang,simulated_overhang,simulated_over_standard\n"},
      {"reality_fold.csv",
       "fabric,bending_over_density,length,spacing,height,height_over_length,elastica\n"},
      {"reality_drape.csv",
       "fabric,shows,bending,density,shear,hysteresis,side,turn,start,coefficient,folds,energy,at_"
       "rest\n"},
      {"reality_rim.csv", "fabric,start,x,y\n"},
      {"reality_fling.csv",
       "method,substeps,error,columns,rows,distance,chamfer_to_reference,chamfer_from_reference\n"},
      {"reality_fling_path.csv", "time,x,y,z\n"},
      {"reality_pull.csv", "preset,file,pull,strain,fitted,simulated\n"},
      {"reality_slope.csv", "friction,angle_of_friction,slope,slide\n"},
      {"reality_swing.csv",
       "preset,density,period,theory_period,period_with_moved_air,rate,theory_rate,rate_without_"
       "air,"
       "last_amplitude,theory_last_amplitude\n"},
      {"reality_tear.csv",
       "particles,angle,energy,force,scatter,advances,force_over_half_energy\n"},
      {"reality_notch.csv", "particles,notch,energy,strength\n"},
      {"reality_tear_trace.csv", "time,force\n"}};
  return all;
}

std::vector<RealityRun> realityRuns(bool quick) {
  RealityRuns runs;
  planTears(quick, runs);
  planTearTrace(quick, runs);
  planNotches(quick, runs);
  planDrapes(quick, runs);
  planRims(quick, runs);
  planFolds(quick, runs);
  planFlings(quick, runs);
  planPulls(quick, runs);
  planCantilevers(quick, runs);
  planSlopes(quick, runs);
  planSwings(quick, runs);
  return runs;
}

}  // namespace cloth_sim
