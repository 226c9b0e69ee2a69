#include "canonpose/data/codecs/csv.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::vector<CsvRow> Rows(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.csv", text);
  return ReadCsv(folder / "a.csv");
}

std::string RowsError(const std::string& text) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Rows(text); });
}

TEST(Csv, CellsMayBeQuotedAndLinesEndInAnyWay) {
  const std::vector<CsvRow> rows = Rows(
      "\xEF\xBB\xBF"
      "a, \"b,\"\"c\"\"\" ,\r\n\n,,\n1,2\n\"x\ny\",3");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_THAT(rows[0].cells, ElementsAre("a", "b,\"c\"", ""));
  EXPECT_THAT(rows[1].cells, ElementsAre("1", "2"));
  EXPECT_EQ(rows[1].line, 4);
  EXPECT_THAT(rows[2].cells, ElementsAre("x\ny", "3"));
  EXPECT_EQ(rows[2].line, 5);
}

TEST(Csv, SemicolonsAndTabsSeparateWhereThereAreNoCommas) {
  EXPECT_THAT(Rows("a;b c\n").front().cells, ElementsAre("a", "b c"));
  EXPECT_THAT(Rows("a\tb\n").front().cells, ElementsAre("a", "b"));
  EXPECT_THAT(Rows("a,b;c\n").front().cells, ElementsAre("a", "b;c"));
}

TEST(Csv, NumbersMayBeMissing) {
  const CsvRow row = Rows("1.5,-2e1,,nan,NA,None,+3,1e-400,x,inf,1e12,1.2.3").front();
  EXPECT_EQ(CsvNumber(row, 0, "a.csv"), 1.5);
  EXPECT_EQ(CsvNumber(row, 1, "a.csv"), -20.0);
  for (const std::size_t column : {2U, 3U, 4U, 5U}) EXPECT_TRUE(std::isnan(CsvNumber(row, column, "a.csv")));
  EXPECT_EQ(CsvNumber(row, 6, "a.csv"), 3.0);
  EXPECT_EQ(CsvNumber(row, 7, "a.csv"), 0.0);
  const auto error = [&](std::size_t column) {
    return ErrorOf(ErrorKind::kBadInput, [&] { CsvNumber(row, column, "a.csv"); });
  };
  EXPECT_THAT(error(8), HasSubstr("a.csv: line 1, column 9: expected a number, found \"x\""));
  EXPECT_THAT(error(9), HasSubstr("found inf"));
  EXPECT_THAT(error(10), HasSubstr("expected a coordinate or a confidence, found 1e12"));
  EXPECT_THAT(error(11), HasSubstr("found \"1.2.3\""));
  EXPECT_THAT(error(12), HasSubstr("a row of 12 cells"));
}

TEST(Csv, OtherFilesAreRefused) {
  EXPECT_THAT(RowsError(""), HasSubstr("found an empty file"));
  EXPECT_THAT(RowsError(" \n,,\n"), HasSubstr("found an empty file"));
  EXPECT_THAT(RowsError("a,\"b"), AllOf(HasSubstr("line 1"), HasSubstr("the end of a text in quotes")));
  EXPECT_THAT(RowsError(std::string("a,b\0c", 5)), HasSubstr("bytes that are no text"));
  EXPECT_THAT(RowsError("PK\x03\x04"), HasSubstr("found a zip archive"));
}

}  // namespace
}  // namespace canonpose
