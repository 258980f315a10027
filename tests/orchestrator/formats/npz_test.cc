#include "orchestrator/formats/npz.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <limits>
#include <string_view>

#include "orchestrator/formats/unnamed_file.h"
#include "orchestrator/formats/zip.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::ThrowsMessage;

/// Runs code with the system's Python, which has NumPy; `path` is a variable there.
std::string Python(const std::string& path, const std::string& code) {
  const ScratchFolder scratch;
  const std::string script = scratch.File("check.py");
  WriteFile(script, "import sys, zipfile\nimport numpy as np\npath = sys.argv[1]\n" + code);
  return Shell("/usr/bin/python3 '" + script + "' '" + path + "'").output;
}

/// `max_rows`: how many rows the writer expects at most; 0: as many as come.
void WriteExample(const std::string& path, int rows, std::int64_t max_rows = 0) {
  NpzWriter writer(path, static_cast<std::uint64_t>(std::max<std::int64_t>(rows, max_rows)));
  const int t = writer.AddArray("t", {});
  writer.AddConstant("id", std::vector<std::int64_t>{1, 2});
  const int position = writer.AddArray("position", {2, 3});
  for (int k = 0; k < rows; ++k) {
    writer.Append(t, std::vector<double>{0.01 * k});
    std::vector<double> row(6);
    for (int i = 0; i < 6; ++i) row[static_cast<std::size_t>(i)] = k + 0.1 * i;
    writer.Append(position, row);
  }
  writer.Close();
}

std::vector<std::string> Names(const ScratchFolder& scratch) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path()))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Npz, NumpyReadsEveryArrayWithoutPickle) {
  const ScratchFolder scratch;
  WriteExample(scratch.File("states.npz"), 20000);  // more than one buffer
  EXPECT_EQ(Python(scratch.File("states.npz"), R"(
data = np.load(path, allow_pickle=False)
print(data.files)
for name in data.files: print(name, data[name].dtype.str, data[name].shape, data[name].flags.c_contiguous)
k = np.arange(20000)
print(np.array_equal(data["t"], 0.01 * k), np.array_equal(data["id"], [1, 2]))
print(np.array_equal(data["position"], (k[:, None] + 0.1 * np.arange(6)).reshape(-1, 2, 3)))
print(zipfile.ZipFile(path).testzip())
)"),
            "['t', 'id', 'position']\n"
            "t <f8 (20000,) True\n"
            "id <i8 (2,) True\n"
            "position <f8 (20000, 2, 3) True\n"
            "True True\n"
            "True\n"
            "None\n");
}

TEST(Npz, ArraysMayBeEmpty) {
  const ScratchFolder scratch;
  WriteExample(scratch.File("states.npz"), 0);
  EXPECT_EQ(Python(scratch.File("states.npz"), "d = np.load(path)\nprint(d['t'].shape, d['position'].shape)\n"),
            "(0,) (0, 2, 3)\n");
}

TEST(Npz, DataBeginAtAMultipleOfSixtyFourBytesInEachArray) {
  const ScratchFolder scratch;
  WriteExample(scratch.File("states.npz"), 3);
  EXPECT_EQ(Python(scratch.File("states.npz"), R"(
z = zipfile.ZipFile(path)
print([(i.file_size - n) % 64 for i, n in zip(z.infolist(), (3 * 8, 2 * 8, 18 * 8))])
)"),
            "[0, 0, 0]\n");
}

TEST(Npz, EqualCallsGiveEqualBytes) {
  const ScratchFolder scratch;
  WriteExample(scratch.File("a.npz"), 100);
  WriteExample(scratch.File("b.npz"), 100);
  EXPECT_EQ(ReadFile(scratch.File("a.npz")), ReadFile(scratch.File("b.npz")));
}

TEST(Npz, OnlyACompleteFileIsEverThere) {
  const ScratchFolder scratch;
  {
    NpzWriter writer(scratch.File("states.npz"), 10000);
    const int t = writer.AddArray("t", {});
    for (int k = 0; k < 10000; ++k) writer.Append(t, std::vector<double>{0.0});
    EXPECT_THAT(Names(scratch), ElementsAre());
  }
  EXPECT_THAT(Names(scratch), ElementsAre()) << "never closed";
  WriteExample(scratch.File("states.npz"), 3);
  EXPECT_THAT(Names(scratch), ElementsAre("states.npz"));
}

TEST(Npz, AFullDiskIsAnErrorThatNamesTheFile) {
  const ScratchFolder scratch;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{100'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string path = scratch.File("states.npz");
  for (const int rows : {100'000, 2000})  // while rows come, and at the end
    EXPECT_THAT([&] { WriteExample(path, rows); },
                ThrowsMessage<std::runtime_error>("cannot write " + path + ".part: File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(Names(scratch), ElementsAre());
}

TEST(Npz, AFolderThatIsNotThereIsAnError) {
  EXPECT_THAT([] { NpzWriter("/nowhere/states.npz", 1); },
              ThrowsMessage<std::runtime_error>("cannot create /nowhere/states.npz.part: No such file or directory"));
}

TEST(Npz, ARunThatEndsEarlyGivesTheBytesOfAShorterOne) {
  const ScratchFolder scratch;
  for (const int rows : {0, 1, 9, 10'000, 29'999}) {  // in buffers only, and partly on disk
    WriteExample(scratch.File("planned.npz"), rows);
    WriteExample(scratch.File("ended.npz"), rows, 30'000);
    EXPECT_TRUE(ReadFile(scratch.File("planned.npz")) == ReadFile(scratch.File("ended.npz"))) << rows;
  }
}

TEST(Npz, ARowBeyondThoseExpectedIsAFault) {
  const ScratchFolder scratch;
  NpzWriter writer(scratch.File("states.npz"), 1);
  const int t = writer.AddArray("t", {});
  writer.Append(t, std::vector<double>{0});
  EXPECT_THAT([&] { writer.Append(t, std::vector<double>{1}); },
              ThrowsMessage<std::logic_error>("NpzWriter: array t has its 1 rows"));
}

TEST(Npz, ARunThatMayBecomeLongerThanAnyFileGrowsAsFarAsFilesCan) {
  const ScratchFolder scratch;
  const std::string planned = scratch.File("planned.npz"), endless = scratch.File("endless.npz");
  WriteExample(planned, 17'000);  // 952 kB
  constexpr std::int64_t kEndless = std::numeric_limits<std::int64_t>::max();
  WriteExample(endless, 17'000, kEndless);
  EXPECT_TRUE(ReadFile(planned) == ReadFile(endless));

  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1'000'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  for (const std::int64_t rows : {17'001L, 30'000L, kEndless}) {
    WriteExample(endless, 17'000, rows);
    EXPECT_TRUE(ReadFile(planned) == ReadFile(endless)) << rows;
  }
  EXPECT_THAT([&] { WriteExample(endless, 18'000, kEndless); },
              ThrowsMessage<std::runtime_error>("cannot write " + endless + ".part: File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
}

TEST(UnnamedFile, HasItsNameOnceItIsComplete) {
  const ScratchFolder scratch;
  using Without = UnnamedFile::WithoutName;
  for (const Without without : {Without::kIfPossible, Without::kNever}) {
    WriteFile(scratch.File("x"), "earlier");
    WriteFile(scratch.File("x.part"), "left by a process that was killed");
    const bool is_named = without == Without::kNever;
    {
      UnnamedFile file(scratch.File("x"), without);
      file.WriteAt(3, AsBytes(std::string_view("defgh")));
      EXPECT_EQ(ReadFile(scratch.File("x")), "earlier");
      EXPECT_EQ(std::filesystem::exists(scratch.File("x.part")), is_named) << "the file system has such files";
      file.WriteAt(0, AsBytes(std::string_view("abc")));
      file.Move(6, 5, 2);  // abcdeghh
      file.Move(0, 1, 4);  // aabcdghh
      file.Resize(7);
      file.Resize(8);
      file.Commit(8);
    }
    EXPECT_EQ(ReadFile(scratch.File("x")), std::string("aabcdgh\0", 8));
    EXPECT_THAT(Names(scratch), ElementsAre("x"));
    { const UnnamedFile dropped(scratch.File("x"), without); }
    EXPECT_EQ(ReadFile(scratch.File("x")), std::string("aabcdgh\0", 8));
    EXPECT_THAT(Names(scratch), ElementsAre("x"));
  }
}

TEST(Zip, EntriesBeyondTheOldLimitsAreWrittenTheZip64Way) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.zip");
  ZipRecords zip(/*zip64_from=*/40);
  Bytes file;
  const std::vector<std::string> contents = {"small, and first", "small, but far into the file", std::string(100, 'x')};
  for (const std::string& content : contents) {
    Append(file,
           zip.Add("entry" + std::to_string(content.size()), file.size(), content.size(), Crc32(0, AsBytes(content))));
    Append(file, AsBytes(content));
  }
  Append(file, zip.End(file.size()));
  WriteFile(path, {file.begin(), file.end()});
  EXPECT_EQ(Python(path, R"(
z = zipfile.ZipFile(path)
print(z.testzip(), [(i.filename, i.file_size, i.extract_version) for i in z.infolist()])
print([z.read(i)[:12] for i in z.infolist()], z.infolist()[0].date_time)
print(b"PK\x06\x06" in open(path, "rb").read())
)"),
            "None [('entry16', 16, 20), ('entry28', 28, 45), ('entry100', 100, 45)]\n"
            "[b'small, and f', b'small, but f', b'xxxxxxxxxxxx'] (1980, 1, 1, 0, 0, 0)\n"
            "True\n");
}

TEST(Zip, MoreEntriesThanSixteenBitsCountAreReadBack) {
  const ScratchFolder scratch;
  ZipRecords zip;
  Bytes file;
  for (int i = 0; i < 70000; ++i) Append(file, zip.Add(std::to_string(i), file.size(), 0, 0));
  Append(file, zip.End(file.size()));
  WriteFile(scratch.File("x.zip"), {file.begin(), file.end()});
  EXPECT_EQ(Python(scratch.File("x.zip"), "print(len(zipfile.ZipFile(path).namelist()))\n"), "70000\n");
}

}  // namespace
}  // namespace mascot
