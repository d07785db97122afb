#include <algorithm>
#include <stdexcept>

#include "readers.h"
#include "section.h"

namespace cloth_sim {
namespace {

constexpr Range kTimeStep{0.0, 1.0, true, false};  // [s]
constexpr Range kError{0.0, 1.0, true, false};
const char* const kAuto = "auto";
constexpr double kLeastError = 0.002;   ///< of the methods that choose their substeps
constexpr double kDefaultError = 0.01;  ///< of scenes that name neither a method nor substeps

const char* const kRealTime = "real_time";
const KeyTable kBudgetKeys{"`solver.budget`", {kRealTime}};

const Section<SleepSettings> kSleepSection{
    "`solver.sleep`",
    {{"speed", &SleepSettings::speed, kPositive}, {"after", &SleepSettings::after, kPositive}}};

/// Reads the settings, or true for the defaults, or false for none.
void readSleep(const SceneNode& node, SolverSpec& solver) {
  if (!node.isScalar()) {
    solver.sleep = kSleepSection.read(node);
  } else if (node.boolean()) {
    solver.sleep = SleepSettings();
  } else {
    solver.sleep.reset();
  }
}

void readGuard(const SceneNode& node, SolverSpec& solver) {
  solver.guard = node.choice<StepGuard>({{"allow", StepGuard::kAllow},
                                         {"subdivide", StepGuard::kSubdivide},
                                         {"refuse", StepGuard::kRefuse}});
}

/// The keys besides the parameters of the method. `error` and `budget` depend on the method: a
/// scene may name them and still be run with another method (`--set solver.method=...`).
const Section<SolverSpec> kSolverSection{"`solver`",
                                         {{"method"},
                                          {"dt", &SolverSpec::dt, kTimeStep},
                                          {"step_guard", readGuard},
                                          {"error"},
                                          {"budget"},
                                          {"sleep", readSleep}}};

/// The method of scenes that name none: the first that takes an `error`.
const SolverInfo& errorControlled() {
  const std::vector<SolverInfo>& all = solverRegistry();
  return *std::find_if(all.begin(), all.end(), [](const SolverInfo& info) {
    return findParameter(info, "error") != nullptr;
  });
}

/// Reads the method; returns nullptr for `auto`.
const SolverInfo* readMethod(const SceneNode& node, SolverSpec& solver) {
  const auto method = node.find("method");
  if (!method) {
    solver.method = errorControlled().name;
    return &errorControlled();
  }
  std::vector<std::pair<std::string, const SolverInfo*>> known;
  for (const SolverInfo& info : solverRegistry()) known.emplace_back(info.name, &info);
  known.emplace_back(kAuto, nullptr);
  const SolverInfo* info = method->choice(known);
  if (info != nullptr) solver.method = info->name;
  return info;
}

void readParameter(const SceneNode& node, const SolverParameter& parameter,
                   SolverParameters& parameters) {
  const auto value = node.find(parameter.name);
  if (!value) return;
  parameters[parameter.name] =
      parameter.integer
          ? static_cast<double>(value->integer(static_cast<std::int64_t>(parameter.minimum),
                                               static_cast<std::int64_t>(parameter.maximum)))
          : value->number({parameter.minimum, parameter.maximum, false, false});
}

/// Reads the bound on the error, which substeps override. An explicit method has none by default.
void readError(const SceneNode& node, SolverParameters& parameters) {
  if (node.find("substeps")) return;
  const auto error = node.find("error");
  if (!error) {
    if (!node.find("method")) parameters["error"] = kDefaultError;
    return;
  }
  const double bound = error->number(kError);
  if (bound < kLeastError) {
    error->refuse(
        "expected 0.002 or more, which takes some 200 substeps of a 60th of a second; "
        "for less, take method: verlet with as many substeps as it needs");
  }
  parameters["error"] = bound;
}

/// Reads a number of substeps, or `real_time`, or what that was: {real_time: 24}.
void readBudget(const SceneNode& node, const SolverParameter& parameter, SolverSpec& solver) {
  const auto budget = node.find(parameter.name);
  if (!budget) return;
  const auto least = static_cast<std::int64_t>(parameter.minimum);
  const auto most = static_cast<std::int64_t>(parameter.maximum);
  const std::string whole =
      "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  if (budget->isMap()) {
    budget->expectKeys(kBudgetKeys.names);
    solver.realTimeBudget = static_cast<int>(budget->need(kRealTime, whole).integer(least, most));
    solver.parameters[parameter.name] = *solver.realTimeBudget;
  } else if (budget->isWord(kRealTime)) {
    solver.realTimeBudget = 0;
  } else if (!budget->isNumber()) {
    budget->expected(whole + ", or " + kRealTime);
  } else {
    readParameter(node, parameter, solver.parameters);
  }
}

void readParameters(const SceneNode& node, const SolverInfo& info, SolverSpec& solver) {
  for (const SolverParameter& parameter : info.parameters) {
    if (parameter.name == "error") {
      readError(node, solver.parameters);
    } else if (parameter.name == "budget") {
      readBudget(node, parameter, solver);
    } else {
      readParameter(node, parameter, solver.parameters);
    }
  }
  try {
    solver.parameters = completeParameters(info, solver.parameters);
  } catch (const std::invalid_argument& error) {
    node.refuse(error.what());
  }
  const auto error = solver.parameters.find("error");
  const bool hasGoal = error != solver.parameters.end() && error->second > 0.0;
  if (!hasGoal) solver.realTimeBudget.reset();  // nothing takes a budget
}

}  // namespace

void dropOtherParameters(YamlValue& root) {
  YamlValue* const solver = root.find("solver");
  const YamlValue* const method = solver == nullptr ? nullptr : solver->find("method");
  if (method == nullptr || !method->overridden) return;
  const std::string name = method->text;
  const auto isOfOthers = [&name](const YamlValue& item) {
    bool isKnown = false;
    for (const SolverInfo& info : solverRegistry()) {
      if (findParameter(info, item.key) == nullptr) continue;
      if (info.name == name) return false;
      isKnown = true;
    }
    return isKnown && !item.overridden;
  };
  std::vector<YamlValue>& items = solver->items;
  items.erase(std::remove_if(items.begin(), items.end(), isOfOthers), items.end());
}

SolverSpec defaultSolver() {
  SolverSpec solver;
  solver.method = errorControlled().name;
  solver.parameters = completeParameters(errorControlled(), {{"error", kDefaultError}});
  return solver;
}

void readSolver(const SceneNode& node, SolverSpec& solver) {
  if (!node.isMap()) node.expected("a map, such as {error: 0.01}");
  const SolverInfo* info = readMethod(node, solver);
  std::vector<std::string> allowed = kSolverSection.keys().names;
  if (info != nullptr) {
    for (const SolverParameter& parameter : info->parameters) {
      const bool isNew = std::find(allowed.begin(), allowed.end(), parameter.name) == allowed.end();
      if (isNew) allowed.push_back(parameter.name);
    }
  }
  node.expectKeys(allowed);
  kSolverSection.readKnown(node, solver);
  if (info == nullptr) {
    solver.choice = AutoChoice{node.need("error", kError.text()).number(kError), ""};
  } else {
    readParameters(node, *info, solver);
  }
}

void listSolverKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kSolverSection.keys());
  tables.push_back(kBudgetKeys);
  tables.push_back(kSleepSection.keys());
}

}  // namespace cloth_sim
