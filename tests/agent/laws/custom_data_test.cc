// law.data: files that a law in Python reads, and that travel with the experiment.
#include <gmock/gmock.h>

#include "tests/agent/laws/custom_law.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kReadsData =
    "from pathlib import Path\nBYTES = Path(DATA['w.bin']).read_bytes()\n"
    "def control(t, me, neighbours):\n  return BYTES[0], len(BYTES), len(Path(DATA['w.bin']).read_bytes())\n";

/// An experiment in a folder, with a law that reads the file w.bin.
class LawData : public testing::Test {
 protected:
  LawData() {
    WriteFile(File("w.bin"), std::string("\x07\0\xff\r\n", 5));
    WriteFile(File("law.py"), kReadsData);
  }
  std::string File(const std::string& name) const { return scratch_.File(name); }
  Section Document(const std::string& lines = "data = ['w.bin']\n") const {
    WriteFile(File("run.toml"), Three("name = 'custom'\nfile = 'law.py'\n" + lines));
    return Section::FromFile(File("run.toml"));
  }
  static Eigen::Vector3d Wants(Section document) {
    const Experiment experiment = LoadExperiment(std::move(document), "run");
    return MakeLaw(experiment, 1)->Want_W(0, Motion{}, {});
  }
  std::string Resolved() const { return LoadExperiment(Document(), "run").resolved; }
  std::string Refusal(const std::string& lines) const {
    try {
      LoadExperiment(Document(lines), "run");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  const ScratchFolder scratch_;
};

TEST_F(LawData, IsFoundWhileTheCodeIsLoadedAndLater) { EXPECT_EQ(Wants(Document()), Eigen::Vector3d(7, 5, 5)); }

TEST_F(LawData, TravelsWithTheExperiment) {
  const std::string resolved = Resolved();
  EXPECT_THAT(resolved, HasSubstr("data_base64 = { \"w.bin\" = \"BwD/DQo=\" }"));
  fs::remove(File("w.bin"));
  EXPECT_EQ(Wants(Section::FromText(resolved, "elsewhere.toml")), Eigen::Vector3d(7, 5, 5));
  EXPECT_EQ(LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run").resolved, resolved);
}

TEST_F(LawData, ThatWasRecordedCountsThoughTheFileHasChanged) {
  WriteFile(File("again.toml"), Resolved());
  WriteFile(File("w.bin"), "other");
  EXPECT_EQ(Wants(Section::FromFile(File("again.toml"))), Eigen::Vector3d(7, 5, 5));
}

TEST_F(LawData, OfTheCommandLineReplacesThatOfTheFile) {
  WriteFile(File("again.toml"), Resolved());
  WriteFile(File("w.bin"), "other");
  const std::vector<Override> overrides{{.key = "law.data", .value = "['w.bin']"}};
  EXPECT_THROW(LoadExperiment(Section::FromFile(File("again.toml"), overrides), "run"), ConfigError)
      << "the path is that of the current folder, where no such file is";
}

TEST_F(LawData, IsThereForModulesBesideTheLaw) {
  WriteFile(File("gains.py"), "K = open(DATA['w.bin'], 'rb').read()[0]\n");
  WriteFile(File("law.py"), "import gains\ndef control(t, me, neighbours):\n  return gains.K, 0\n");
  EXPECT_EQ(Wants(Document()), Eigen::Vector3d(7, 0, 0));
}

TEST_F(LawData, IsInFoldersAsItsNamesAre) {
  fs::create_directory(scratch_.path() / "a");
  WriteFile(File("a/b.txt"), "3");
  WriteFile(File("law.py"),
            "def control(t, me, neighbours):\n  return float(open(DATA['a/b.txt']).read()), "
            "DATA['a/b.txt'].endswith('/a/b.txt')\n");
  EXPECT_EQ(Wants(Document("data = ['w.bin', 'a/b.txt']\n")), Eigen::Vector3d(3, 1, 0));
}

TEST_F(LawData, IsGoneWithTheExperiment) {
  std::string path;
  {
    WriteFile(File("law.py"), "def control(t, me, neighbours):\n  raise ValueError(DATA['w.bin'])\n");
    const Experiment experiment = LoadExperiment(Document(), "run");
    try {
      MakeLaw(experiment, 1)->Want_W(0, Motion{}, {});
    } catch (const std::runtime_error& error) {
      path = error.what();
    }
    path = path.substr(path.rfind("ValueError: ") + 12);
    EXPECT_TRUE(fs::exists(path)) << path;
  }
  EXPECT_FALSE(fs::exists(path)) << path;
}

TEST_F(LawData, ThatIsNotNamedIsMissedInWords) {
  EXPECT_THAT(Failure("def control(t, me, neighbours):\n  return DATA['v'], 0\n"),
              HasSubstr("KeyError: \"law.data does not name 'v', but nothing\""));
}

TEST_F(LawData, LeavesResolvedExperimentsWithoutItAsTheyWere) {
  EXPECT_THAT(Custom("def control(t, me, neighbours): return 0, 0\n").resolved,
              Not(AnyOf(HasSubstr("\ndata = "), HasSubstr("data_base64"))));
}

TEST_F(LawData, RefusesFilesThatAreNoneOrElsewhere) {
  const std::string where = File("run.toml") + ":12:9: law.data[0]: ";
  const std::string inside =
      where + "expected the path of a file in the folder of this file or below it, such as \"weights/w.npy\", got ";
  EXPECT_EQ(Refusal("data = ['/etc/passwd']\n"), inside + "'/etc/passwd'");
  EXPECT_EQ(Refusal("data = ['../w.bin']\n"), inside + "'../w.bin'");
  EXPECT_EQ(Refusal("data = ['']\n"), inside + "''");
  EXPECT_EQ(Refusal("data = ['v.bin']\n"),
            where + "expected a readable file, got " + File("v.bin") + ": cannot be read: No such file or directory");
  EXPECT_EQ(Refusal("data = ['.']\n"), inside + "'.'");
  fs::create_directory(scratch_.path() / "a");
  EXPECT_EQ(Refusal("data = ['a']\n"), where + "expected a readable file, got " + File("a") + ": is a directory");
  EXPECT_EQ(Refusal("data = ['w.bin', 'w.bin']\n"),
            File("run.toml") + ":12:18: law.data[1]: expected each file once, got w.bin again");
  EXPECT_EQ(Refusal("data = 'w.bin'\n"), File("run.toml") + ":12:8: law.data: expected a list of strings, got 'w.bin'");
}

TEST_F(LawData, RefusesMoreThanTravelsWell) {
  WriteFile(File("large.bin"), std::string((4 << 20) - 5, 'x'));
  EXPECT_EQ(Refusal("data = ['w.bin', 'large.bin']\n"), "");
  WriteFile(File("large.bin"), std::string((4 << 20) - 4, 'x'));
  EXPECT_EQ(Refusal("data = ['w.bin', 'large.bin']\n"),
            File("run.toml") +
                ":12:18: law.data[1]: expected files of at most 4 MiB together, which travel with the experiment, got "
                "4194305 bytes");
}

TEST_F(LawData, RefusesExperimentsThatNobodyCouldReadAgain) {
  WriteFile(File("large.bin"), std::string(4 << 20, 'x'));
  WriteFile(File("run.toml"),
            Three("name = 'custom'\nfile = 'law.py'\ndata = ['large.bin']\n",
                  "override = [{ id = 1, law.leader = 1 }, { id = 2, law.leader = 1 }, { id = 3, law.leader = "
                  "1 }]\n"));
  WriteFile(File("law.py"), "def control(t, me, neighbours):\n  return 0, 0\n");
  try {
    LoadExperiment(Section::FromFile(File("run.toml")), "run");
    ADD_FAILURE() << "expected a refusal";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("run.toml:1:1: expected at most 16 MiB with all that travels with the "
                                              "experiment, got 22"),
                                    HasSubstr("bytes (files of law.data count once for each law table)")));
  }
}

TEST_F(LawData, RefusesWhatIsNoRecordOfIt) {
  const std::string where = File("run.toml") + ":13:";
  EXPECT_THAT(Refusal("data = ['w.bin']\ndata_base64 = 3\n"),
              HasSubstr(where + "15: law.data_base64: expected a table, got a number"));
  EXPECT_THAT(Refusal("data = ['w.bin']\ndata_base64 = { 'w.bin' = 'x' }\n"),
              HasSubstr("law.data_base64.w.bin: expected base64, got other text"));
  EXPECT_THAT(Refusal("data = ['w.bin']\ndata_base64 = { 'v.bin' = '' }\n"),
              HasSubstr("law.data_base64: expected the files that law.data names"));
  EXPECT_THAT(Refusal("data_base64 = {}\n"), HasSubstr("law.data_base64: expected law.data with it, got none"));
}

}  // namespace
}  // namespace mascot
