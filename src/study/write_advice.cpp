#include <cmath>
#include <iomanip>
#include <map>
#include <ostream>
#include <sstream>

#include "advise.h"

namespace cloth_sim {
namespace {

void writeFigures(std::ostream& out, const RunResult& run, double error) {
  out << std::setprecision(3);
  if (run.outcome != Outcome::kOk) {
    out << toString(run.outcome) << '\n';
  } else {
    out << "error " << error << ", " << run.cpuPerSimulatedSecond()
        << " s of CPU per simulated second\n";
  }
}

/// Tells whether the method diverges with more substeps, too: only its last divergence is written.
bool isFollowedByDivergence(const std::vector<WorkPrecisionRow>& rows, std::size_t k) {
  if (rows[k].run.outcome != Outcome::kDiverged) return false;
  for (std::size_t later = k + 1; later < rows.size(); ++later) {
    const Configuration &a = rows[k].configuration, &b = rows[later].configuration;
    if (a.method == b.method && a.dt == b.dt) {
      return rows[later].run.outcome == Outcome::kDiverged;
    }
  }
  return false;
}

void writeTrial(std::ostream& out, const WorkPrecisionRow& row) {
  const bool diverged = row.run.outcome == Outcome::kDiverged;
  out << "  " << std::left << std::setw(18) << row.configuration.method->name << std::right
      << (diverged ? " up to " : "       ") << std::setw(4) << row.configuration.substeps
      << " substeps of " << std::setprecision(3) << 1e3 * row.configuration.dt << " ms: ";
  writeFigures(out, row.run, row.error);
}

void writeTrials(std::ostream& out, const Advice& advice) {
  for (const SolverInfo& method : solverRegistry()) {
    for (std::size_t k = 0; k < advice.tried.size(); ++k) {
      const WorkPrecisionRow& row = advice.tried[k];
      if (row.configuration.method == &method && row.run.outcome != Outcome::kSkipped &&
          !isFollowedByDivergence(advice.tried, k)) {
        writeTrial(out, row);
      }
    }
  }
}

std::string percent(double part) {
  std::ostringstream text;
  text << std::lround(100.0 * part) << " %";
  return text.str();
}

/// Tells why a change was kept or not.
std::string verdict(const TriedChange& tried, double bound) {
  std::ostringstream text;
  text << std::setprecision(3);
  if (!tried.change.obstacle.empty()) {
    text << "not possible: " << tried.change.obstacle;
  } else if (tried.made) {
    text << "saves " << percent(tried.saved()) << ", error " << tried.error;
  } else if (tried.run.outcome != Outcome::kOk) {
    text << "no: " << (tried.run.outcome == Outcome::kSkipped ? "dearer" : tried.run.why);
  } else if (tried.error <= bound) {
    text << "saves nothing";
  } else if (std::isfinite(tried.error)) {
    text << "no: error " << tried.error;
  } else {
    text << "no: nothing to compare, its mesh changes";
  }
  return text.str();
}

void writeChanges(std::ostream& out, const Advice& advice) {
  if (advice.changes.empty()) return;
  out << "What may be left out, one after the other:\n";
  for (const TriedChange& tried : advice.changes) {
    out << (tried.made ? "  + " : "  - ") << std::left << std::setw(30) << tried.change.what
        << std::right << ' ' << verdict(tried, advice.bound) << '\n';
  }
}

/// Returns the configuration as "{method: ..., dt: ...}".
std::string solverText(const Scene& scene) {
  std::ostringstream text;
  text << "{method: " << scene.solver.method << ", dt: " << std::setprecision(17)
       << scene.solver.dt;
  for (const auto& [name, value] : scene.solver.parameters) text << ", " << name << ": " << value;
  text << '}';
  return text.str();
}

/// Overrides as a tree of YAML blocks. A value of null becomes a comment.
class Block {
 public:
  void set(const std::string& override) {
    const std::size_t equals = override.find('=');
    Block* at = this;
    std::istringstream keys(override.substr(0, equals));
    for (std::string key; std::getline(keys, key, '.');) at = &at->inside_[key];
    at->value_ = override.substr(equals + 1);
  }

  void write(std::ostream& out, const std::string& indent = "") const {
    for (const auto& [key, block] : inside_) {
      if (!block.inside_.empty()) {
        out << indent << key << ":\n";
        block.write(out, indent + "  ");
      } else if (block.value_ == "null") {
        out << indent << "# " << key << ": take it out\n";
      } else {
        out << indent << key << ": " << block.value_ << '\n';
      }
    }
  }

 private:
  std::map<std::string, Block> inside_;
  std::string value_;
};

void writeBlock(std::ostream& out, const Advice& advice, const Scene& scene) {
  Block block;
  for (const std::string& override : advice.overrides) block.set(override);
  block.write(out);
  out << "solver:\n  method: " << scene.solver.method << "\n  dt: " << std::setprecision(17)
      << scene.solver.dt << '\n';
  for (const auto& [name, value] : scene.solver.parameters) {
    out << "  " << name << ": " << value << '\n';
  }
}

void writeCommand(std::ostream& out, const Advice& advice, const Scene& scene,
                  const std::string& name) {
  out << "cloth_run " << name;
  for (const std::string& override : advice.overrides) out << " --set '" << override << '\'';
  out << " --set 'solver=" << solverText(scene) << "'\n";
}

}  // namespace

void writeAdvice(std::ostream& out, const Advice& advice, const std::string& scene) {
  out << advice.study.name << ", the first " << std::setprecision(3) << advice.study.duration
      << " s, against " << advice.reference.source << " (own error " << std::setprecision(2)
      << advice.reference.ownError << ")\n";
  writeTrials(out, advice);
  writeChanges(out, advice);
  out << "The scene's own (" << advice.study.scene.solver.method << "): ";
  writeFigures(out, advice.own, advice.ownError);
  if (!advice.complete) out << "The budget of CPU time ran out before everything was tried.\n";
  if (!advice.best) {
    out << "None of them has an error of at most " << advice.bound
        << " and keeps it with more substeps.\n";
    return;
  }
  const WorkPrecisionRow& best = *advice.best;
  out << "Cheapest with an error of at most " << std::setprecision(6) << advice.bound << ": ";
  writeFigures(out, best.run, best.error);
  const Scene chosen = withConfiguration(advice.study.scene, best.configuration);
  out << "---\n";
  writeBlock(out, advice, chosen);
  out << "---\n";
  writeCommand(out, advice, chosen, scene);
}

}  // namespace cloth_sim
