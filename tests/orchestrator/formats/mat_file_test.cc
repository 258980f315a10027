#include "orchestrator/formats/mat_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <numeric>

#include "tests/orchestrator/formats/mat.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::StartsWith;
using testing::ThrowsMessage;

void WriteExample(const std::string& path, std::size_t ticks) {
  MatWriter mat(path);
  mat.AddText("config", "name = \"Übung €\"\n");
  const std::vector<std::size_t> dimensions = {ticks, 2, 3};
  std::vector<double> values(ticks * 6);
  std::iota(values.begin(), values.end(), 0.0);
  mat.Add("position", dimensions, values);
  mat.Close();
}

TEST(MatFile, MatioReadsEveryVariableWithItsShape) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mat");
  WriteExample(path, 5);
  EXPECT_THAT(MatNames(path), ElementsAre("config", "position"));
  const MatVariable position(path, "position");
  EXPECT_THAT(position.dimensions(), ElementsAre(5, 2, 3));
  EXPECT_EQ(position.At(4, 0, 0), 4);
  EXPECT_EQ(position.At(0, 1, 0), 5) << "the first index runs fastest";
  EXPECT_EQ(position.At(0, 0, 1), 10);
}

TEST(MatFile, TextKeepsEveryCharacter) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mat");
  MatWriter mat(path);
  mat.AddText("one_to_four_bytes", "a \u00DC \u20AC \U0001F681\n");
  mat.AddText("none", "");
  mat.AddText("last", "b");
  mat.Close();
  EXPECT_EQ(MatVariable(path, "one_to_four_bytes").text(), u"a \u00DC \u20AC \U0001F681\n");
  EXPECT_THAT(MatNames(path), ElementsAre("one_to_four_bytes", "none", "last"));
  EXPECT_EQ(MatVariable(path, "last").text(), u"b");
}

TEST(MatFile, BeginsAsMatlabsFilesDoAndNamesNoTime) {
  const ScratchFolder scratch;
  WriteExample(scratch.File("a.mat"), 100);
  WriteExample(scratch.File("b.mat"), 100);
  EXPECT_THAT(ReadFile(scratch.File("a.mat")), StartsWith("MATLAB 5.0 MAT-file, written by MASCOT"));
  EXPECT_EQ(ReadFile(scratch.File("a.mat")), ReadFile(scratch.File("b.mat")));
}

TEST(MatFile, WithoutCloseThereIsNoFile) {
  const ScratchFolder scratch;
  {
    MatWriter mat(scratch.File("x.mat"));
    mat.AddText("text", "unfinished");
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(MatFile, AFullDiskIsFoundOutAndLeavesTheOldFile) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mat");
  WriteFile(path, "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  for (const rlim_t limit : {100, 1000, 4096, 48'000, 48'300}) {  // the whole file has about 48'340 bytes
    const rlimit small{limit, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_THAT([&] { WriteExample(path, 1000); },
                ThrowsMessage<std::runtime_error>("cannot write " + path +
                                                  ".part: it does not read back as written; is the disk full?"))
        << limit;
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(ReadFile(path), "old");
    EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  }
  WriteExample(path, 1000);
  EXPECT_GT(std::filesystem::file_size(path), 48'300);
}

TEST(MatFile, AFolderThatIsNotThereIsAnError) {
  EXPECT_THAT([] { MatWriter("/nowhere/x.mat"); },
              ThrowsMessage<std::runtime_error>("cannot create /nowhere/x.mat.part: No such file or directory"));
}

TEST(MatFile, AVariableOfTwoGigabytesIsRefused) {
  const std::string error = "position does not fit a MATLAB file, whose variables are limited to 2 GiB";
  const auto require = [](std::vector<std::size_t> dimensions) { MatWriter::RequireFits("position", dimensions); };
  require({1u << 16, 1000, 4});  // 1.95 GiB
  EXPECT_THAT([&] { require({1u << 26, 4}); }, ThrowsMessage<std::runtime_error>(error));
  EXPECT_THAT(
      [&] {
        require({std::size_t{1} << 40, std::size_t{1} << 40, 3});
      },
      ThrowsMessage<std::runtime_error>(error));
}

}  // namespace
}  // namespace mascot
