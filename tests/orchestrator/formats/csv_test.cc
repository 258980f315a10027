#include "orchestrator/formats/csv.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <bit>
#include <csignal>
#include <cstdint>
#include <limits>
#include <sstream>

#include "tests/support/scratch.h"

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
