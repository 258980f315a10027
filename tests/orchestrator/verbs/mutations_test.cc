// Experiments and recordings, changed at random: every verb that reads them ends in order, with an exit code and words
// that say where they are wrong. By hand, with many:
//   MASCOT_MUTATIONS=10000 build/release/mutations_test
// The file that a verb reads when it dies or hangs is left in the build folder, as mutant.toml or mutant.mcap.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <regex>

#include "experiment/read_experiment.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "tests/support/call.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

/// Changes bytes at random, always the same for the same seed.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string Change(std::string bytes) {
    using Edit = void (Mutator::*)(std::string & bytes);
    constexpr Edit kEdits[] = {&Mutator::FlipBit, &Mutator::Overwrite, &Mutator::Remove, &Mutator::Repeat,
                               &Mutator::Cut,     &Mutator::Number,    &Mutator::Number, &Mutator::MoveLine};
    for (std::size_t edits = 1 + Below(3); edits > 0 && !bytes.empty(); --edits)
      (this->*kEdits[Below(std::size(kEdits))])(bytes);
    return bytes;
  }

 private:
  std::size_t Below(std::size_t end) { return random_() % end; }

  void FlipBit(std::string& bytes) {
    char& byte = bytes[Below(bytes.size())];
    byte = static_cast<char>(byte ^ (1 << Below(8)));
  }
  void Overwrite(std::string& bytes) {
    for (std::size_t at = Below(bytes.size()), end = std::min(bytes.size(), at + 1 + Below(8)); at < end; ++at)
      bytes[at] = static_cast<char>(Below(256));
  }
  void Remove(std::string& bytes) { bytes.erase(Below(bytes.size()), 1 + Below(40)); }
  void Repeat(std::string& bytes) {
    const std::string piece = bytes.substr(Below(bytes.size()), 1 + Below(40));
    bytes.insert(Below(bytes.size()), piece);
  }
  void Cut(std::string& bytes) {
    if (Below(4) == 0) bytes.resize(Below(bytes.size()));
  }
  /// Puts something else in place of a number.
  void Number(std::string& bytes) {
    constexpr const char* kOthers[] = {"0",
                                       "-1",
                                       "1e308",
                                       "-1e-320",
                                       "nan",
                                       "-inf",
                                       "0.1",
                                       "2.0",
                                       "7",
                                       "30",
                                       "1000",
                                       "9223372036854775807",
                                       "[]",
                                       "false",
                                       "'x'",
                                       "{}",
                                       "[[1, 2], [2, 1]]"};
    const std::size_t at = bytes.find_first_of("0123456789", Below(bytes.size()));
    if (at == bytes.npos) return;
    const std::size_t end = bytes.find_first_not_of("0123456789.", at);
    bytes.replace(at, (end == bytes.npos ? bytes.size() : end) - at, kOthers[Below(std::size(kOthers))]);
  }
  void MoveLine(std::string& bytes) {
    const std::size_t begin = bytes.find('\n', Below(bytes.size()));
    if (begin == bytes.npos) return;
    const std::string line = bytes.substr(begin, bytes.find('\n', begin + 1) - begin);
    bytes.erase(begin, line.size());
    bytes.insert(bytes.find('\n', Below(bytes.size() + 1)) == bytes.npos ? bytes.size() : begin / 2, line);
  }

  std::mt19937_64 random_;
};

std::size_t Mutations(std::size_t usual) {
  const char* number = std::getenv("MASCOT_MUTATIONS");
  return number == nullptr ? usual : std::stoul(number);
}

/// Whether the experiment is of so many agents that reading it takes seconds.
bool IsLarge(const std::string& toml) try {
  Section document = Section::FromText(toml, "mutant.toml");
  document.Use(ExperimentKeys());
  return document.Child("agents").Integer("count") > 60;
} catch (const ConfigError&) {
  return false;
}

std::vector<std::string> Configs() {
  std::vector<std::string> configs;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::SourceFolder() + "/configs"))
    if (entry.path().extension() == ".toml") configs.push_back(ReadFile(entry.path().string()));
  std::sort(configs.begin(), configs.end());
  return configs;
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Mutations, AChangedExperimentIsReadOrRefusedWithAPlace) {
  const std::string path = test::BuildFolder() + "/mutant.toml";
  const std::vector<std::string> configs = Configs();
  Mutator mutator(1);
  std::map<int, int> ends;
  for (std::size_t k = 0; k < Mutations(300); ++k) {
    const std::string mutant = mutator.Change(configs[k % configs.size()]);
    if (IsLarge(mutant)) continue;
    WriteFile(path, mutant);
    const Said said = Call(SetUpCheck, {path});
    ++ends[said.exit_code];
    ASSERT_THAT(said.exit_code, testing::AnyOf(kExitDone, kExitFailed, kExitUsage)) << "mutation " << k;
    if (said.exit_code == kExitFailed) {  // a law in Python, which theory asks
      ASSERT_THAT(said.err, testing::ContainsRegex("error: tick [0-9]+: the law of agent [0-9]+ failed at t = "))
          << "mutation " << k;
    }
    if (said.exit_code != kExitUsage) continue;
    for (const std::string& line : Lines(said.err))
      ASSERT_THAT(line, testing::ContainsRegex("^error: [^:]+:[0-9]+:[0-9]+: ")) << "mutation " << k;
  }
  for (const auto& [code, count] : ends) RecordProperty("exit_" + std::to_string(code), count);
  EXPECT_GT(ends[kExitDone], 0);
  EXPECT_GT(ends[kExitUsage], 0);
}

/// Recordings: of a real run, and two made-up ones without checksums, so that changes of their bytes are not noticed by
/// these.
std::vector<std::string> Recordings(const ScratchFolder& scratch) {
  WriteFile(scratch.File("two.toml"),
            "[run]\nduration_s = 0.2\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'consensus'\n");
  const Said said = Call(SetUpUp, {scratch.File("two.toml"), "--engine", "inprocess", "--out", scratch.File("run"),
                                   "--quiet", "--set", "output.save_plot=false"});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  const std::string corpus = test::SourceFolder() + "/tests/fuzz/corpus/recording/";
  return {ReadFile(scratch.File("run/run.mcap")), ReadFile(corpus + "loose"), ReadFile(corpus + "chunked")};
}

/// Whether the words say where: a byte of the file, a place in the experiment, a topic; or that it is another file.
bool HasPlace(const std::string& words) {
  static const std::regex place(
      "record at byte [0-9]+|tick [0-9]+ is missing|:[0-9]+:[0-9]+: |/agent_[0-9]+/|/clock|is no MCAP file|newer "
      "than|expected |holds no "
      "whole");
  return std::regex_search(words, place);
}

/// Looks at some ticks of a recording, as `view` does.
std::function<int()> SetUpLook(CLI::App& command) {
  auto run = std::make_shared<std::string>();
  command.add_option("run", *run);
  return [run] {
    RecordedRun recorded(*run);
    ShownRow row(recorded.experiment().size());
    for (const std::int64_t tick : {recorded.last_tick(), std::int64_t{0}, recorded.last_tick() / 2}) {
      recorded.Show(tick, row);
      recorded.FollowEdges(row, 100);
    }
    return recorded.part().loss.empty() ? kExitDone : (std::cout << recorded.part().loss, kExitIncomplete);
  };
}

TEST(Mutations, AChangedRecordingIsReadOrRefusedWithAPlace) {
  const ScratchFolder scratch;
  const std::string path = test::BuildFolder() + "/mutant.mcap";
  const std::vector<std::string> recordings = Recordings(scratch);
  const std::pair<std::function<int()> (*)(CLI::App&), std::vector<std::string>> verbs[] = {
      {SetUpInfo, {path}},
      {SetUpExport, {path, "--format", "csv", "--force", "--out", scratch.File("x.csv")}},
      {SetUpRecover, {path, "--force", "--out", scratch.File("x.mcap")}},
      {SetUpVerify, {path}},
      {SetUpLook, {path}},
  };
  Mutator mutator(2);
  std::map<int, int> ends;
  for (std::size_t k = 0; k < Mutations(300); ++k) {
    const std::string mutant = mutator.Change(recordings[k % recordings.size()]);
    WriteFile(path, mutant);
    for (const auto& [set_up, arguments] : verbs) {
      const Said said = Call(set_up, arguments);
      ++ends[said.exit_code];
      ASSERT_THAT(said.exit_code, testing::AnyOf(kExitDone, kExitFailed, kExitUsage, kExitIncomplete))
          << "mutation " << k;
      ASSERT_TRUE(said.exit_code == kExitDone || HasPlace(said.out + said.err))
          << "mutation " << k << ": " << said.out << said.err;
    }
  }
  for (const auto& [code, count] : ends) RecordProperty("exit_" + std::to_string(code), count);
  EXPECT_GT(ends[kExitDone], 0);
  EXPECT_GT(ends[kExitFailed], 0);
}

}  // namespace
}  // namespace mascot
