#include "tables.h"

#include <cmath>
#include <iomanip>
#include <ostream>

#include "cloth_sim/cloth/strain.h"

namespace cloth_sim {
namespace {

/// A number that is written as "nan" whatever the sign of a NaN is.
struct Number {
  double value;
};

std::ostream& operator<<(std::ostream& out, Number number) {
  if (std::isnan(number.value)) return out << "nan";
  return out << std::setprecision(6) << number.value;
}

std::ostream& operator<<(std::ostream& out, const Configuration& c) {
  return out << c.method->name << ',' << Number{c.dt} << ',' << c.substeps << ',' << c.iterations;
}

double none() { return std::numeric_limits<double>::quiet_NaN(); }

/// Returns the cost of a run [s/s]; nan for a run that was not made.
Number costOf(const WorkPrecisionRow& row) {
  return {row.run.simulatedTime > 0.0 ? row.run.cpuPerSimulatedSecond() : none()};
}

Number largestStrain(const WorkPrecisionRow& row) {
  return {row.run.simulatedTime > 0.0 ? strainOfStretch(row.run.largestStretch) : none()};
}

/// Returns a text as one quoted field.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "'" : std::string(1, c);
  return result + '"';
}

}  // namespace

void writeWorkPrecision(std::ostream& out, const std::vector<WorkPrecisionRow>& rows) {
  out << "scene,solver,dt,substeps,iterations,cpu_s_per_sim_s,error,max_strain,status\n";
  for (const WorkPrecisionRow& row : rows) {
    out << row.scene << ',' << row.configuration << ',' << costOf(row) << ',' << Number{row.error}
        << ',' << largestStrain(row) << ',' << toString(row.run.outcome) << '\n';
  }
}

void writeTearing(std::ostream& out, const std::vector<WorkPrecisionRow>& rows) {
  out << "solver,dt,substeps,first_failure_s,separation_s,broken,status\n";
  for (const WorkPrecisionRow& row : rows) {
    if (!row.tearing) continue;
    const TearRecord& tears = row.run.tearing;
    out << row.configuration.method->name << ',' << Number{row.configuration.dt} << ','
        << row.configuration.substeps << ',' << Number{tears.firstFailure} << ','
        << Number{tears.separation} << ',' << tears.torn << ',' << toString(row.run.outcome)
        << '\n';
  }
}

void writePareto(std::ostream& out, const std::vector<WorkPrecisionRow>& front) {
  out << "scene,solver,dt,substeps,iterations,cpu_s_per_sim_s,error\n";
  for (const WorkPrecisionRow& row : front) {
    out << row.scene << ',' << row.configuration << ',' << costOf(row) << ',' << Number{row.error}
        << '\n';
  }
}

void writeReferences(std::ostream& out, const std::vector<NamedReference>& references) {
  out << "scene,own_error,source\n";
  for (const NamedReference& reference : references) {
    out << reference.scene << ',' << Number{reference.ownError} << ',' << quoted(reference.source)
        << '\n';
  }
}

void writeStability(std::ostream& out, const std::vector<StabilityLimit>& limits) {
  out << "solver,omega_dt,stiffness,dt,outcome,predicted_limit\n";
  for (const StabilityLimit& limit : limits) {
    for (const Probe& probe : limit.inOmegaH.probes) {
      out << limit.method->name << ',' << Number{probe.value} << ',' << Number{limit.stiffness}
          << ',' << Number{probe.value / limit.omega} << ','
          << (probe.holds ? "stable" : "unstable") << ',' << Number{limit.method->stabilityLimit}
          << '\n';
    }
  }
}

void writeStabilityLimits(std::ostream& out, const std::vector<StabilityLimit>& limits) {
  out << "solver,system,stiffness,omega,measured_limit,predicted_limit\n";
  for (const StabilityLimit& limit : limits) {
    out << limit.method->name << ',' << limit.system << ',' << Number{limit.stiffness} << ','
        << Number{limit.omega} << ',' << Number{limit.inOmegaH.limit} << ','
        << Number{limit.method->stabilityLimit} << '\n';
  }
}

void writeResolution(std::ostream& out, const std::vector<ResolutionRow>& rows) {
  out << "quantity,particles,value,unit,difference_from_finest,substeps,cpu_s_per_sim_s\n";
  for (const ResolutionRow& row : rows) {
    out << row.quantity << ',' << row.particles << ',' << Number{row.value} << ',' << row.unit
        << ',' << Number{row.difference} << ',' << row.substeps << ','
        << Number{row.cpuPerSimulatedSecond} << '\n';
  }
}

int writeSkipped(std::ostream& out, const std::vector<WorkPrecisionRow>& rows) {
  int count = 0;
  for (const WorkPrecisionRow& row : rows) {
    const Outcome outcome = row.run.outcome;
    if (outcome != Outcome::kSkipped && outcome != Outcome::kRefused) continue;
    out << row.scene << ", " << row.configuration.method->name << ", steps of "
        << Number{row.configuration.dt} << " s, " << row.configuration.substeps << " substeps";
    if (row.configuration.iterations > 0) {
      out << ", " << row.configuration.iterations << " iterations";
    }
    out << ": " << toString(outcome) << ": " << row.run.why << '\n';
    ++count;
  }
  return count;
}

}  // namespace cloth_sim
