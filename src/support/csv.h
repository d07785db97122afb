#pragma once
/// \file A reader of CSV tables.

#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace cloth_sim {

/// One row of a table; its fields are found by the names of their columns.
class CsvRow {
 public:
  /// \param columns  index of each column; must outlive this.
  CsvRow(const std::map<std::string, std::size_t>& columns, std::vector<std::string> fields)
      : columns_(columns), fields_(std::move(fields)) {}

  const std::string& text(const std::string& column) const { return fields_[columns_.at(column)]; }
  /// Returns a number, which may be nan or inf. \throws std::invalid_argument naming the column.
  double number(const std::string& column) const;
  /// Returns a number > 0. \throws std::invalid_argument naming the column.
  double positive(const std::string& column) const;

 private:
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string> fields_;
};

/// Returns the number that `text` is, in the "C" locale; "nan", "inf" and "-inf" are numbers, too.
/// \throws std::invalid_argument if it is none.
double parseNumber(const std::string& text);

/// Reads a table: a line with the names of the columns, then one line for each row, with as many
/// fields. Fields are separated by commas; a field in double quotes may contain commas. Empty lines
/// and lines that begin with '#' are comments.
/// \param needed     columns that must be there.
/// \param onRow      called for each row; may throw std::invalid_argument.
/// \param onComment  called for each line that begins with '#'; may throw the same.
/// \throws std::runtime_error "line <number>: <what is wrong>".
void readCsv(std::istream& in, const std::vector<std::string>& needed,
             const std::function<void(const CsvRow&)>& onRow,
             const std::function<void(const std::string&)>& onComment = {});

}  // namespace cloth_sim
