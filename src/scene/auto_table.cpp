#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <locale>
#include <map>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "auto_method.h"
#include "built_in_auto_table.h"

namespace cloth_sim {
namespace {

const char* const kTableHeader = "class,error,solver,dt,scale,substep,longest_s,cost_s";
const char* const kCacheHeader = "scene,error,solver,dt,parameters";

using Fields = std::vector<std::string>;

Fields split(const std::string& line, char separator) {
  Fields fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, separator);) fields.push_back(field);
  return fields;
}

/// \throws std::invalid_argument
double positive(const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double number = 0.0;
  in >> number;
  if (in.fail() || !in.eof() || !(number > 0.0)) {
    throw std::invalid_argument("expected a number > 0 (got '" + text + "')");
  }
  return number;
}

SceneClass readClass(const std::string& text) {
  for (const SceneClass kind : {SceneClass::kSmooth, SceneClass::kContact, SceneClass::kTearing}) {
    if (text == toString(kind)) return kind;
  }
  throw std::invalid_argument("expected smooth, contact or tearing (got '" + text + "')");
}

/// Calls `read` with the fields of each line below the header.
template <typename Read>
void readLines(std::istream& in, const std::string& header, const Read& read) {
  const std::size_t columns = split(header, ',').size();
  bool begun = false;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    try {
      if (!begun) {
        if (line != header) throw std::invalid_argument("expected the header " + header);
        begun = true;
        continue;
      }
      const Fields fields = split(line, ',');
      if (fields.size() != columns) {
        throw std::invalid_argument("expected " + std::to_string(columns) + " fields");
      }
      read(fields);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("line " + std::to_string(number) + ": " + error.what());
    }
  }
}

AutoRow readRow(const Fields& fields) {
  AutoRow row;
  row.kind = readClass(fields[0]);
  row.error = positive(fields[1]);
  row.method = &findSolver(fields[2]);
  row.dt = positive(fields[3]);
  if (fields[4] != toString(scaleOf(*row.method))) {
    throw std::invalid_argument("steps of " + row.method->name + " scale with the " +
                                toString(scaleOf(*row.method)));
  }
  row.substep = positive(fields[5]);
  row.longest = positive(fields[6]);
  row.cost = positive(fields[7]);
  return row;
}

struct CacheEntry {
  std::string key;
  double error = 0.0;
  SolverSpec solver;
};

CacheEntry readEntry(const Fields& fields) {
  CacheEntry entry;
  entry.key = fields[0];
  entry.error = positive(fields[1]);
  entry.solver.method = fields[2];
  entry.solver.dt = positive(fields[3]);
  SolverParameters given;
  for (const std::string& item : split(fields[4], ' ')) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos) throw std::invalid_argument("expected name=value ...");
    given[item.substr(0, equals)] = positive(item.substr(equals + 1));
  }
  entry.solver.parameters = completeParameters(findSolver(entry.solver.method), given);
  return entry;
}

std::vector<CacheEntry> readCache(const std::string& file) {
  std::vector<CacheEntry> entries;
  std::ifstream in(file);
  if (!in) return entries;
  try {
    readLines(in, kCacheHeader,
              [&](const Fields& fields) { entries.push_back(readEntry(fields)); });
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
  out << kTableHeader << '\n';
  for (const AutoRow& row : table) {
    out << toString(row.kind) << ',' << std::setprecision(6) << row.error << ',' << row.method->name
        << ',' << row.dt << ',' << toString(scaleOf(*row.method)) << ',' << std::setprecision(4)
        << row.substep << ',' << row.longest << ',' << row.cost << '\n';
  }
}

AutoTable readAutoTable(std::istream& in) {
  AutoTable table;
  readLines(in, kTableHeader, [&](const Fields& fields) { table.push_back(readRow(fields)); });
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
  const std::string temporary = file_ + ".tmp";
  std::ofstream out(temporary);
  out << "# Written by cloth_study --advise --cache; see solver.method auto in docs/scene.md.\n"
      << kCacheHeader << '\n';
  for (const CacheEntry& entry : before) {
    if (entry.key != key || entry.error != error) writeEntry(out, entry);
  }
  writeEntry(out, {key, error, solver});
  out.close();
  if (!out || std::rename(temporary.c_str(), file_.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw std::runtime_error(file_ + ": cannot be written");
  }
}

}  // namespace cloth_sim
