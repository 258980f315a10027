#include "orchestrator/formats/npz.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

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

void WriteExample(const std::string& path, int rows) {
  NpzWriter writer(path);
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
    NpzWriter writer(scratch.File("states.npz"));
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
  EXPECT_THAT([&] { WriteExample(path, 100'000); },
              ThrowsMessage<std::runtime_error>("cannot write " + path + ".2.part: File too large"));
  // Each array fits, but the joined file does not.
  EXPECT_THAT([&] { WriteExample(path, 2000); },
              ThrowsMessage<std::runtime_error>("cannot write " + path + ".part: File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(Names(scratch), ElementsAre());
}

TEST(Npz, AFolderThatIsNotThereIsAnError) {
  NpzWriter writer("/nowhere/states.npz");
  EXPECT_THAT([&] { writer.AddArray("t", {}); },
              ThrowsMessage<std::runtime_error>("cannot create /nowhere/states.npz.0.part: No such file or directory"));
}

TEST(Zip, EntriesBeyondTheOldLimitsAreWrittenTheZip64Way) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.zip");
  ZipWriter zip(path, /*zip64_from=*/40);
  const std::vector<std::string> contents = {"small, and first", "small, but far into the file", std::string(100, 'x')};
  for (const std::string& content : contents) {
    zip.Begin("entry" + std::to_string(content.size()), content.size(), Crc32(0, AsBytes(content)));
    zip.Write(AsBytes(content));
  }
  zip.Close();
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
  ZipWriter zip(scratch.File("x.zip"));
  for (int i = 0; i < 70000; ++i) zip.Begin(std::to_string(i), 0, 0);
  zip.Close();
  EXPECT_EQ(Python(scratch.File("x.zip"), "print(len(zipfile.ZipFile(path).namelist()))\n"), "70000\n");
}

}  // namespace
}  // namespace mascot
