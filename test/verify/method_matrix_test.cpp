/// \file No method is wrong in silence: every method on every shipped scene at its shipped size.
///
/// Each scene runs with its own method to a moment at which something happens. From that state,
/// every method goes on for a third of a second at most, with its default settings, or with those
/// of the scene if it is the scene's own; methods with a stability limit also with as many substeps
/// as that asks for (`step_guard: subdivide`). Methods that cost much take fewer steps, six at
/// least. The reference is line_xpbd with 200 substeps from
/// the same state, which differs from Verlet at the stable step by less than a third of the bounds
/// where nothing flutters.
///
/// method_matrix.csv keeps the outcomes:
///   accurate  the largest strain and the positions are within the bounds below
///   refused   the scene is refused, with a reason (`pbd` cannot go on from cloth that bends by a
///             plate energy; told to run the scene from its start, it has bend springs)
///   failed    the simulation stops in its last good state, with a reason
///   told      not accurate, and `warnings` says so
///   wrong     not accurate, and nothing says so: a finding (docs/limits.md)
/// With CLOTH_SIM_RECORD=1 this test adds the rows that are missing, and compares nothing. To
/// record a row again, delete it first.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "fewer_cases.h"
#include "support/csv.h"
#include "unit/scene_support.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Error of the largest strain that counts as accurate: this much [-], and half of the reference.
constexpr double kStrainBound = 0.03;
/// Root mean square error of positions that counts as accurate: this fraction of the side of the
/// cloth, and of the way that the reference has moved.
constexpr double kSideBound = 0.03;
constexpr double kWayBound = 0.2;

constexpr int kMostSteps = 20;
constexpr int kFewestSteps = 6;
constexpr double kLongestRun = 0.5;  ///< of a pair of scene and method when recording [s]
constexpr int kReferenceSubsteps = 200;

// ---- scenes -----------------------------------------------------------------------------------

/// The moment of a scene at which methods are compared.
struct Start {
  const char* scene;
  double time;  ///< [s]
};

const std::vector<Start>& matrixStarts() {
  static const std::vector<Start> all{
      {"curtain_gusts", 0.6},       // a gust has begun
      {"curtain_hover", 0.2},       // hangs
      {"curtain_relaxed", 0.2},     // swings
      {"cut", 0.95},                // hangs at rest; the first cut comes at 1 s
      {"drape_sphere", 0.5},        // lies on the sphere, and its borders fall
      {"explicit_blows_up", 0.0},   // begins to fall
      {"explicit_hang", 0.0},       // begins to fall
      {"fold_quarters", 3.6},       // both layers are lifted
      {"fold_towel", 0.6},          // the clamps lift it
      {"folding_board", 0.6},       // the flap lifts it
      {"hang", 0.0},                // takes up its weight
      {"knot", 2.0},                // the loop closes
      {"napkin_ring", 1.6},         // the ring gathers it
      {"pile", 0.3},                // the lower cloths have met
      {"robot_fold", 0.0},          // its side begins to hang over the table
      {"robot_tear", 0.1},          // the hand has closed
      {"rod", 0.3},                 // falls over the rod
      {"round_tablecloth", 0.3},    // its border falls
      {"stack", 0.2},               // lies a thickness apart
      {"strip", 0.0},               // lies at rest
      {"table_edge", 0.1},          // the part beside the table falls
      {"tear_seam", 0.5},           // hits the table
      {"tear_seam_explicit", 0.5},  // hits the table
      {"tongue_tear", 0.1},         // the legs are bent apart
      {"twist", 4.0},               // after three turns
      {"two_cloths", 0.5},          // the scarf has hit the ball
      {"weak_grip", 0.8},           // the clamp pulls
      {"wind", 0.3},                // the flag turns into the wind
  };
  return all;
}

/// Loads a scene whose cloth never sleeps. Bending is not damped, because explicit methods would
/// need minutes for a step of a damped pile.
Scene awakeScene(const std::string& name) {
  Scene scene = loadScene(shipped(name));
  scene.solver.sleep.reset();
  for (ClothSpec& cloth : scene.cloths) cloth.fabric.bendingDamping = 0.0;
  return scene;
}

/// Returns the state of a scene at its start, as saved.
std::string startState(const Scene& scene, double time) {
  Simulation simulation(scene);
  while (simulation.time() < time) simulation.step();
  return simulation.save();
}

/// A length that stands for the size of the cloth: the side of a square of its rest area [m].
double sideOf(const Scene& scene) {
  return std::sqrt(Simulation(scene).model().mesh.totalRestArea());
}

// ---- runs -------------------------------------------------------------------------------------

/// A run from the start, or what came of it.
struct Course {
  std::string outcome;  ///< refused or failed; "" if it came to its end
  std::string reason;
  bool finite = true;
  bool told = false;                         ///< whether there was a warning
  std::vector<double> strains;               ///< largest, by step [-]
  std::vector<std::vector<Vec3>> positions;  ///< by step [m]

  int steps() const { return static_cast<int>(strains.size()); }
};

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Steps on from a saved state.
/// \param longest  CPU time after which it takes no more steps than kFewestSteps [s].
void stepOn(Simulation& simulation, int steps, double longest, Course& course) {
  const double start = cpuSeconds();
  while (course.steps() < steps) {
    if (course.steps() >= kFewestSteps && cpuSeconds() - start > longest) break;
    simulation.step();
    course.finite = course.finite && isFinite(simulation.state());
    if (simulation.failed()) break;
    course.strains.push_back(maxStretch(simulation.model(), simulation.state()) - 1.0);
    course.positions.push_back(simulation.state().x.values());
  }
  course.told = !simulation.warnings().empty();
  if (!simulation.failed()) return;
  course.outcome = "failed";
  course.reason = simulation.failure();
}

/// The state that a run takes over: positions and velocities, or the memory of the method, too.
enum class Memory { kNone, kOfMethod };

Course runFrom(const std::string& state, const Scene& scene, Memory memory, int steps,
               double longest) {
  Course course;
  try {
    Simulation simulation(scene);
    if (memory == Memory::kOfMethod) {
      simulation.load(state);
    } else {
      simulation.adopt(state);
    }
    stepOn(simulation, steps, longest, course);
  } catch (const std::invalid_argument& error) {
    course.outcome = "refused";
    course.reason = error.what();
  }
  return course;
}

Scene withMethod(Scene scene, const SolverInfo& info, const SolverParameters& parameters = {}) {
  scene.solver.method = info.name;
  scene.solver.parameters = completeParameters(info, parameters);
  return scene;
}

/// Root mean square distance of the particles that two states have in common [m].
double rmsDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const std::size_t count = std::min(a.size(), b.size());
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) sum += (a[k] - b[k]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(count));
}

// ---- the table --------------------------------------------------------------------------------

/// Scene, method, and `default` or `stable`.
using MatrixKey = std::array<std::string, 3>;

struct Row {
  int steps = 0;
  std::string outcome;
  double strain = 0.0;           ///< largest at the end [-]
  double referenceStrain = 0.0;  ///< of the reference at that time [-]
  double rms = 0.0;              ///< error of the positions [m]
  double score = 0.0;            ///< the larger error over its bound
};

/// Judges a run against the reference.
Row judge(const Course& course, const Course& reference, double side) {
  Row row;
  row.steps = course.steps();
  row.outcome = course.outcome;
  if (!row.outcome.empty()) return row;
  const auto last = static_cast<std::size_t>(course.steps()) - 1;
  row.strain = course.strains[last];
  row.referenceStrain = reference.strains[last];
  row.rms = rmsDistance(course.positions[last], reference.positions[last]);
  const double way = rmsDistance(reference.positions[last], reference.positions[0]);
  row.score = std::max(
      std::abs(row.strain - row.referenceStrain) / (kStrainBound + 0.5 * row.referenceStrain),
      row.rms / (kSideBound * side + kWayBound * way));
  row.outcome = row.score <= 1.0 ? "accurate" : course.told ? "told" : "wrong";
  return row;
}

std::string tableFile() {
  return std::string(CLOTH_SIM_SOURCE_DIR) + "/test/verify/method_matrix.csv";
}

using Table = std::map<MatrixKey, Row>;

Table readTable() {
  Table table;
  std::ifstream file(tableFile());
  if (!file) return table;
  readCsv(
      file,
      {"scene", "method", "setting", "steps", "outcome", "strain", "reference", "rms_m", "score"},
      [&](const CsvRow& row) {
        table[{row.text("scene"), row.text("method"), row.text("setting")}] = {
            static_cast<int>(row.number("steps")),
            row.text("outcome"),
            row.number("strain"),
            row.number("reference"),
            row.number("rms_m"),
            row.number("score")};
      });
  return table;
}

void writeTable(const Table& table) {
  std::ofstream file(tableFile());
  file << "scene,method,setting,steps,outcome,strain,reference,rms_m,score\n";
  file << std::setprecision(2);
  for (const auto& [key, row] : table) {
    file << key[0] << ',' << key[1] << ',' << key[2] << ',' << row.steps << ',' << row.outcome
         << ',' << row.strain << ',' << row.referenceStrain << ',' << row.rms << ',' << row.score
         << '\n';
  }
}

bool recordsMatrix() { return std::getenv("CLOTH_SIM_RECORD") != nullptr; }

bool stopsEarly(const Row& row) { return row.outcome == "refused" || row.outcome == "failed"; }

/// Tells whether compilers may come to another outcome: flutter and folds change the digits.
bool isClose(const Row& row) { return row.score > 0.5 && row.score < 2.0; }

class MethodMatrix : public testing::TestWithParam<Start> {
 public:
  static void TearDownTestSuite() {
    if (recordsMatrix()) writeTable(table());
  }

 protected:
  /// Runs a pair, and records its row or compares it.
  void check(const MatrixKey& key, const Scene& scene) {
    SCOPED_TRACE(key[1] + ", " + key[2]);
    if (recordsMatrix()) {
      if (table().count(key) == 0) table()[key] = observe(key, scene, kMostSteps, kLongestRun);
      return;
    }
    ASSERT_EQ(table().count(key), 1U) << "no row: run it with CLOTH_SIM_RECORD=1 to add one";
    const Row& known = table().at(key);
    const int steps = known.steps + (stopsEarly(known) ? 1 : 0);
    const Row row = observe(key, scene, steps, std::numeric_limits<double>::infinity());
    if (isClose(row)) return;
    EXPECT_EQ(row.outcome, known.outcome) << "strain " << row.strain << ", reference "
                                          << row.referenceStrain << ", rms " << row.rms << " m";
  }

  Row observe(const MatrixKey& key, const Scene& scene, int steps, double longest) const {
    const Memory memory = key[2] == "scene" ? Memory::kOfMethod : Memory::kNone;
    const Course course = runFrom(state_, scene, memory, steps, longest);
    EXPECT_TRUE(course.finite) << "numbers that are not finite were shown";
    EXPECT_EQ(course.outcome.empty(), course.reason.empty()) << "it stopped without a reason";
    return judge(course, reference_, side_);
  }

  std::string state_;  ///< at the start
  Course reference_;
  double side_ = 0.0;  ///< [m]

  /// The rows of the file, and those that are recorded.
  static Table& table() {
    static Table rows = readTable();
    return rows;
  }
};

INSTANTIATE_TEST_SUITE_P(Shipped, MethodMatrix, testing::ValuesIn(fewerCasesOf(matrixStarts())),
                         [](const auto& test) { return std::string(test.param.scene); });

TEST_P(MethodMatrix, EndsAsKnown) {
  const std::string name = GetParam().scene;
  const Scene own = awakeScene(name);
  side_ = sideOf(own);
  state_ = startState(own, GetParam().time);
  Scene fine = withMethod(own, findSolver("line_xpbd"), {{"substeps", 1.0 * kReferenceSubsteps}});
  fine.tearing.energy.clear();  // it refuses to tear by energy; nothing tears here
  reference_ =
      runFrom(state_, fine, Memory::kNone, kMostSteps, std::numeric_limits<double>::infinity());
  ASSERT_EQ(reference_.steps(), kMostSteps) << reference_.reason;
  for (const SolverInfo& info : solverRegistry()) {
    const bool isOwn = info.name == own.solver.method;
    Scene scene = isOwn ? own : withMethod(own, info);
    check({name, info.name, isOwn ? "scene" : "default"}, scene);
    if (std::isinf(info.stabilityLimit)) continue;
    scene.solver.guard = StepGuard::kSubdivide;
    check({name, info.name, "stable"}, scene);
  }
}

TEST(MethodMatrixScenes, AreAllThatAreShipped) {
  std::set<std::string> listed, shipped;
  for (const Start& start : matrixStarts()) listed.insert(start.scene);
  for (const auto& file : std::filesystem::directory_iterator(sceneFolder())) {
    if (file.path().extension() == ".yaml") shipped.insert(file.path().stem());
  }
  EXPECT_EQ(listed, shipped);
}

}  // namespace
}  // namespace cloth_sim
