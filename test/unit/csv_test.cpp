/// \file The reader of CSV tables.

#include "support/csv.h"  // private: programs have no use for it

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

namespace cloth_sim {
namespace {

std::vector<std::string> names;
std::vector<double> values;

void read(const std::string& text) {
  names.clear();
  values.clear();
  std::istringstream in(text);
  readCsv(in, {"name", "value"}, [](const CsvRow& row) {
    names.push_back(row.text("name"));
    values.push_back(row.number("value"));
  });
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Csv, FindsFieldsByTheNamesOfTheirColumns) {
  read("# a remark\nvalue,other,name\n\n1.5,x,a\n-2e-3,,b\n");
  EXPECT_THAT(names, testing::ElementsAre("a", "b"));
  EXPECT_THAT(values, testing::ElementsAre(1.5, -2e-3));
}

TEST(Csv, QuotedFieldsMayHoldCommas) {
  read("name,value\n\"a, b\",1\r\n");
  EXPECT_THAT(names, testing::ElementsAre("a, b"));
}

TEST(Csv, KnowsNumbersThatAreNotFinite) {
  read("name,value\na,nan\nb,inf\nc,-inf\n");
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_GT(values[1], 1e308);
  EXPECT_LT(values[2], -1e308);
}

TEST(Csv, SaysInWhichLineATableIsWrong) {
  EXPECT_EQ(refusal("name,price\n"), "line 1: expected a column value");
  EXPECT_EQ(refusal("name,value,name\n"), "line 1: there are two columns name");
  EXPECT_EQ(refusal("name,value\na,1\nb\n"), "line 3: expected 2 fields");
  EXPECT_EQ(refusal("name,value\na,one\n"), "line 2: value: expected a number (got 'one')");
  EXPECT_EQ(refusal("name,value\n\"a,1\n"), "line 2: a quoted field does not end");
  EXPECT_EQ(refusal("# nothing\n"), "expected a line with the names of the columns");
}

}  // namespace
}  // namespace cloth_sim
