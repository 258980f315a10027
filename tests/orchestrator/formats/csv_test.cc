#include "orchestrator/formats/csv.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <csignal>
#include <cstdint>
#include <limits>
#include <random>
#include <sstream>

#include "tests/support/scratch.h"
#include "tests/support/strict_csv.h"

namespace mascot {
namespace {

using testing::ThrowsMessage;

const std::vector<std::string> kColumns = {"id", "value"};

TEST(Csv, IsATableWithANameOverEachColumn) {
  const ScratchFolder scratch;
  CsvWriter csv(scratch.File("x.csv"), kColumns);
  csv.Add(std::int64_t{7});
  csv.Add(0.5);
  csv.EndRow();
  csv.Add(std::int64_t{8});
  csv.Add(-2.0);
  csv.EndRow();
  csv.Close();
  EXPECT_EQ(ReadFile(scratch.File("x.csv")), "id,value\n7,0.5\n8,-2\n");
}

TEST(Csv, AFloatReadsBackAsTheSameBits) {
  const std::vector<double> values = {0.1, 1.0 / 3, -0.0, 1e-300, 5e-324, std::numeric_limits<double>::max(), 40.01};
  const ScratchFolder scratch;
  CsvWriter csv(scratch.File("x.csv"), std::vector<std::string>{"value"});
  for (const double value : values) {
    csv.Add(value);
    csv.EndRow();
  }
  csv.Close();
  std::istringstream lines(ReadFile(scratch.File("x.csv")));
  std::string line;
  std::getline(lines, line);
  for (const double value : values) {
    ASSERT_TRUE(std::getline(lines, line));
    const double back = std::strtod(line.c_str(), nullptr);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << line;
  }
  EXPECT_THAT(ReadFile(scratch.File("x.csv")), testing::HasSubstr("\n40.01\n")) << "and as the shortest such text";
}

using Rows = std::vector<std::vector<std::string>>;

/// Rows of cells with all that a table may stumble over.
Rows HardRows() {
  Rows rows = {{"", "", ""}, {"\"", ",", "\n"}, {"\"\"", "a\"b", "\"a\""}, {"\r\n", " a ", "a\n\nb,\"c\"\n"}};
  std::mt19937 draw(1);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same rows each time
  constexpr std::string_view kLetters = "a,\"\n\r;' ";
  for (int row = 0; row < 500; ++row) {
    rows.emplace_back(3);
    for (std::string& cell : rows.back())
      for (auto left = draw() % 6; left > 0; --left) cell += kLetters[draw() % kLetters.size()];
  }
  return rows;
}

TEST(Csv, RowsReadBackWhateverStandsInTheirCells) {
  const Rows rows = HardRows();
  std::string table;
  for (const auto& row : rows) table += CsvRow(row);
  EXPECT_EQ(StrictCsv(table), rows) << "by a strict reader";
  std::string_view text = table;
  for (const auto& row : rows) ASSERT_EQ(TakeCsvRow(text), row);
  EXPECT_EQ(text, "");
  EXPECT_EQ(CsvCells("a,\"b,c\""), (std::vector<std::string>{"a", "b,c"})) << "also without a line feed";
}

TEST(Csv, ATableThatIsCutAnywhereHasTheRowsThatEndBeforeTheCut) {
  Rows rows = HardRows();
  rows.resize(60);
  std::string table;
  std::vector<std::size_t> ends;
  for (const auto& row : rows) {
    table += CsvRow(row);
    ends.push_back(table.size());
  }
  for (std::size_t bytes = 0; bytes <= table.size(); ++bytes) {
    const std::string_view whole = WholeCsvRows(std::string_view(table).substr(0, bytes));
    const auto count = std::ranges::upper_bound(ends, bytes) - ends.begin();
    ASSERT_EQ(StrictCsv(std::string(whole)), Rows(rows.begin(), rows.begin() + count)) << bytes;
  }
}

TEST(Csv, RowsOfOthersReadBackTheSame) {
  const Rows rows = HardRows();
  std::string table;
  for (const auto& row : rows) table += CsvRow(row);
  std::string_view text = table;
  for (const auto& row : rows) {
    std::vector<std::string> cells;
    ASSERT_EQ(TakeForeignCsvRow(text, cells), "");
    ASSERT_EQ(cells, row);
  }
  EXPECT_EQ(text, "");
}

/// The cells of all rows of a table that somebody else wrote, and what is wrong with the last of them.
std::pair<Rows, std::string> Foreign(std::string_view text) {
  Rows rows;
  while (!text.empty()) {
    const std::string_view mistake = TakeForeignCsvRow(text, rows.emplace_back());
    if (!mistake.empty()) return {rows, std::string(mistake)};
  }
  return {rows, ""};
}

TEST(Csv, RowsOfOthersMayEndInACarriageReturnAndTheLastWithoutAnything) {
  using Read = std::pair<Rows, std::string>;
  EXPECT_EQ(Foreign("a,\"b\"\r\n\r\n,c"), (Read{{{"a", "b"}, {""}, {"", "c"}}, ""}));
  EXPECT_EQ(Foreign("a,\"b\r\n\"\"\""), (Read{{{"a", "b\r\n\""}}, ""}));
  EXPECT_EQ(Foreign("a,\n"), (Read{{{"a", ""}}, ""}));
  EXPECT_EQ(Foreign("a\r,b\n"), (Read{{{"a\r", "b"}}, ""})) << "it is of the cell, but at the end of a line";
}

TEST(Csv, RowsOfOthersWithQuotesThatSayNothingAreRefused) {
  using Read = std::pair<Rows, std::string>;
  EXPECT_EQ(Foreign("a,b\"c\"\n"), (Read{{{"a", ""}}, "a quote in a cell without quotes"}));
  EXPECT_EQ(Foreign("a, \"b\"\n"), (Read{{{"a", ""}}, "a quote in a cell without quotes"}));
  EXPECT_EQ(Foreign("\"a\"b,c\n"), (Read{{{"a"}}, "a character behind the second quote"}));
  EXPECT_EQ(Foreign("\"a\"\"b\n"), (Read{{{"a\"b\n"}}, "no second quote"}));
}

TEST(Csv, NamesOfColumnsMayBeAnyText) {
  const std::vector<std::string> columns = {"a,b", "\"c\"", "d\ne"};
  const ScratchFolder scratch;
  CsvWriter csv(scratch.File("x.csv"), columns);
  for (const double value : {1.0, -0.5, 2.0}) csv.Add(value);
  csv.EndRow();
  csv.Close();
  EXPECT_EQ(StrictCsv(ReadFile(scratch.File("x.csv"))), (Rows{columns, {"1", "-0.5", "2"}}));
}

TEST(Csv, WithoutCloseThereIsNoFile) {
  const ScratchFolder scratch;
  { CsvWriter csv(scratch.File("x.csv"), kColumns); }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(Csv, AFullDiskIsAnErrorThatNamesTheFileAndLeavesTheOldOne) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.csv");
  WriteFile(path, "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{100'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const auto write = [&] {
    CsvWriter csv(path, kColumns);
    for (std::int64_t i = 0; i < 100'000; ++i) {
      csv.Add(i);
      csv.Add(0.5);
      csv.EndRow();
    }
    csv.Close();
  };
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>("cannot write " + path + ".part: File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(Csv, AFolderThatIsNotThereIsAnError) {
  EXPECT_THAT([] { CsvWriter("/nowhere/x.csv", kColumns); },
              ThrowsMessage<std::runtime_error>("cannot create /nowhere/x.csv.part: No such file or directory"));
}

}  // namespace
}  // namespace mascot
