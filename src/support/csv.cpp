#include "csv.h"

#include <istream>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace cloth_sim {
namespace {

std::vector<std::string> splitFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  if (quoted) throw std::invalid_argument("a quoted field does not end");
  return fields;
}

std::map<std::string, std::size_t> readHeader(const std::string& line,
                                              const std::vector<std::string>& needed) {
  std::map<std::string, std::size_t> columns;
  for (const std::string& name : splitFields(line)) {
    if (!columns.emplace(name, columns.size()).second) {
      throw std::invalid_argument("there are two columns " + name);
    }
  }
  for (const std::string& name : needed) {
    if (columns.count(name) == 0) throw std::invalid_argument("expected a column " + name);
  }
  return columns;
}

}  // namespace

double parseNumber(const std::string& text) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == "inf") return kInfinity;
  if (text == "-inf") return -kInfinity;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double number = 0.0;
  in >> number;
  if (in.fail() || !in.eof()) throw std::invalid_argument("expected a number (got '" + text + "')");
  return number;
}

double CsvRow::number(const std::string& column) const {
  try {
    return parseNumber(text(column));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(column + ": " + error.what());
  }
}

double CsvRow::positive(const std::string& column) const {
  const double value = number(column);
  if (value > 0.0) return value;
  throw std::invalid_argument(column + ": expected a number > 0 (got '" + text(column) + "')");
}

void readCsv(std::istream& in, const std::vector<std::string>& needed,
             const std::function<void(const CsvRow&)>& onRow,
             const std::function<void(const std::string&)>& onComment) {
  std::map<std::string, std::size_t> columns;
  std::size_t number = 0;
  try {
    for (std::string line; std::getline(in, line);) {
      ++number;
      if (!line.empty() && line[0] == '#') {
        if (onComment) onComment(line);
      } else if (line.empty()) {
        continue;
      } else if (columns.empty()) {
        columns = readHeader(line, needed);
      } else {
        std::vector<std::string> fields = splitFields(line);
        if (fields.size() != columns.size()) {
          throw std::invalid_argument("expected " + std::to_string(columns.size()) + " fields");
        }
        onRow(CsvRow(columns, std::move(fields)));
      }
    }
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error("line " + std::to_string(number) + ": " + error.what());
  }
  if (columns.empty()) throw std::runtime_error("expected a line with the names of the columns");
}

}  // namespace cloth_sim
