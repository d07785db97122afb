#pragma once
/// \file The comparisons of the simulator with theory and with measured cloth, as tables.

#include <functional>
#include <string>
#include <vector>

namespace cloth_sim {

/// A table of the comparisons.
struct RealityTable {
  std::string file;    ///< name of the CSV file
  std::string header;  ///< its first line
};

/// All tables.
const std::vector<RealityTable>& realityTables();

/// Work that makes some lines of one table. Lines of a table are in the order of the runs.
struct RealityRun {
  std::string what;   ///< in words
  std::size_t table;  ///< index into `realityTables`
  std::function<std::string()> make;
};

/// All runs, those of one table in order. \param quick  fewer and coarser ones.
std::vector<RealityRun> realityRuns(bool quick);

}  // namespace cloth_sim
