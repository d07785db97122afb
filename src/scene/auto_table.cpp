#include <filesystem>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "auto_method.h"
#include "built_in_auto_table.h"
#include "support/csv.h"
#include "support/input_file.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

using Columns = std::vector<std::string>;
const Columns kTableColumns{"class", "error",   "solver",    "dt",
                            "scale", "substep", "longest_s", "cost_s"};
constexpr std::uint64_t kMaxCacheSize = 64 << 20;  // [bytes]
const Columns kCacheColumns{"scene", "error", "solver", "dt", "parameters"};

void writeHeader(std::ostream& out, const Columns& columns) {
  const char* separator = "";
  for (const std::string& column : columns) {
    out << separator << column;
    separator = ",";
  }
  out << '\n';
}

SceneClass readClass(const std::string& text) {
  for (const SceneClass kind : {SceneClass::kSmooth, SceneClass::kContact, SceneClass::kTearing}) {
    if (text == toString(kind)) return kind;
  }
  throw std::invalid_argument("expected smooth, contact or tearing (got '" + text + "')");
}

AutoRow toAutoRow(const CsvRow& fields) {
  AutoRow row;
  row.kind = readClass(fields.text("class"));
  row.error = fields.positive("error");
  row.method = &findSolver(fields.text("solver"));
  row.dt = fields.positive("dt");
  if (fields.text("scale") != toString(scaleOf(*row.method))) {
    throw std::invalid_argument("steps of " + row.method->name + " scale with the " +
                                toString(scaleOf(*row.method)));
  }
  row.substep = fields.positive("substep");
  row.longest = fields.positive("longest_s");
  row.cost = fields.positive("cost_s");
  return row;
}

struct CacheEntry {
  std::string key;
  double error = 0.0;
  SolverSpec solver;
};

/// Reads "name=value name=value ...".
SolverParameters readParameters(const std::string& text) {
  SolverParameters parameters;
  std::istringstream in(text);
  for (std::string item; in >> item;) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos) throw std::invalid_argument("expected name=value ...");
    parameters[item.substr(0, equals)] = parseNumber(item.substr(equals + 1));
  }
  return parameters;
}

CacheEntry toCacheEntry(const CsvRow& fields) {
  CacheEntry entry;
  entry.key = fields.text("scene");
  entry.error = fields.positive("error");
  entry.solver.method = fields.text("solver");
  entry.solver.dt = fields.positive("dt");
  entry.solver.parameters = completeParameters(findSolver(entry.solver.method),
                                               readParameters(fields.text("parameters")));
  return entry;
}

std::vector<CacheEntry> readCache(const std::string& file) {
  std::vector<CacheEntry> entries;
  if (!std::filesystem::exists(file)) return entries;
  std::istringstream in(readInputFile(file, {kMaxCacheSize, Links::kFollowed}));
  try {
    readCsv(in, kCacheColumns,
            [&](const CsvRow& fields) { entries.push_back(toCacheEntry(fields)); });
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what() + " (it is a cache: it may be deleted)");
  }
  return entries;
}

void writeEntry(std::ostream& out, const CacheEntry& entry) {
  out << entry.key << ',' << std::setprecision(17) << entry.error << ',' << entry.solver.method
      << ',' << entry.solver.dt << ',';
  const char* separator = "";
  for (const auto& [name, value] : entry.solver.parameters) {
    out << separator << name << '=' << value;
    separator = " ";
  }
  out << '\n';
}

}  // namespace

void writeAutoTable(std::ostream& out, const AutoTable& table, const std::string& remark) {
  std::istringstream lines(remark);
  for (std::string line; std::getline(lines, line);) out << "# " << line << '\n';
  writeHeader(out, kTableColumns);
  for (const AutoRow& row : table) {
    out << toString(row.kind) << ',' << std::setprecision(6) << row.error << ',' << row.method->name
        << ',' << row.dt << ',' << toString(scaleOf(*row.method)) << ',' << std::setprecision(4)
        << row.substep << ',' << row.longest << ',' << row.cost << '\n';
  }
}

AutoTable readAutoTable(std::istream& in) {
  AutoTable table;
  readCsv(in, kTableColumns, [&](const CsvRow& fields) { table.push_back(toAutoRow(fields)); });
  return table;
}

const AutoTable& builtInAutoTable() {
  static const AutoTable table = [] {
    std::istringstream in(kBuiltInAutoTable);
    return readAutoTable(in);
  }();
  return table;
}

std::optional<SolverSpec> AutoCache::find(const std::string& key, double error) const {
  std::optional<SolverSpec> found;
  double best = 0.0;
  for (const CacheEntry& entry : readCache(file_)) {
    if (entry.key != key || entry.error > error || entry.error < best) continue;
    best = entry.error;
    found = entry.solver;
  }
  return found;
}

void AutoCache::add(const std::string& key, double error, const SolverSpec& solver) const {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::create_directories(fs::path(file_).parent_path(), ignored);
  const std::vector<CacheEntry> before = readCache(file_);
  std::ostringstream out;
  out << "# Written by cloth_study --advise --cache; see solver.method auto in docs/scene.md.\n";
  writeHeader(out, kCacheColumns);
  for (const CacheEntry& entry : before) {
    if (entry.key != key || entry.error != error) writeEntry(out, entry);
  }
  writeEntry(out, {key, error, solver});
  OutputFile(file_).write(out.str());
}

}  // namespace cloth_sim
