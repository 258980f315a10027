// record.rate_hz: which rows a recording has, and that all that reads it knows which.
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/recording.h"
#include "tests/support/call.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// 106 ticks; an event at a tick that has no row, one at the last tick.
constexpr const char* kRateTeam =
    "[run]\nduration_s = 1.05\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
    "position_m = [[0, 0, 1], [4, 0, 1]]\n[law]\nname = 'consensus'\np_gain = 0.2\n"
    "[[events]]\nat_s = 0.37\nset = { 'law.p_gain' = 0.3 }\n"
    "[[events]]\nat_s = 1.05\nset = { 'law.p_gain' = 0.4 }\n";

class RecordRate : public testing::Test {
 protected:
  /// Flies the experiment, with a row every 10 ticks unless told otherwise. Returns the recording's path.
  std::string Fly(const std::string& name, std::vector<std::string> sets = {"record.rate_hz=10"},
                  const std::string& toml = kRateTeam) {
    WriteFile(File("two.toml"), toml);
    std::vector<std::string> words = {File("two.toml"), "--engine", "inprocess", "--out",
                                      File(name),       "--quiet",  "--set",     "output.save_plot=false"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    const Said said = Call(SetUpUp, words);
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return File(name + "/run.mcap");
  }
  std::string File(const std::string& name) const { return scratch_.File(name); }

  ScratchFolder scratch_;
};

/// The bytes of all messages, by topic and time.
std::map<std::pair<std::string, std::uint64_t>, std::vector<std::uint8_t>> BytesByTopicAndTime(
    const std::string& path) {
  std::map<std::pair<std::string, std::uint64_t>, std::vector<std::uint8_t>> all;
  const McapContents contents = ReadMcap(path);
  ReadMcap(path, [&](const McapContents::Message& message) {
    all[{contents.channels.at(message.channel).topic, message.log_time}] = message.data;
  });
  return all;
}

TEST_F(RecordRate, KeepsTheSameBytesOfEveryNthTickAndTheLastAndAllEvents) {
  const auto all = BytesByTopicAndTime(Fly("all", {})), some = BytesByTopicAndTime(Fly("some"));
  std::map<std::string, std::vector<std::uint64_t>> times_ms;
  for (const auto& [key, bytes] : some) {
    EXPECT_TRUE(all.at(key) == bytes) << key.first << " of " << key.second << " ns";
    times_ms[key.first].push_back(key.second / 1'000'000);
  }
  const auto rows = ElementsAre(0, 100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1050);
  for (const char* topic : {"/agent_1/state", "/agent_2/state", "/agent_1/command", "/agent_2/command", "/clock"})
    EXPECT_THAT(times_ms[topic], rows) << topic;
  EXPECT_THAT(times_ms["/event"], ElementsAre(370, 1050));
}

TEST_F(RecordRate, ChangesNoFigureOfTheRun) {
  Fly("all", {});
  Fly("some");
  const auto figures = [&](const std::string& name) {
    auto summary = nlohmann::json::parse(ReadFile(File(name + "/summary.json")));
    EXPECT_EQ(summary["ticks"], 105);
    for (const char* key : {"wall_s", "real_time_factor", "ticks_per_s", "startup_s", "total_s", "samples"})
      summary.erase(key);
    return summary;
  };
  EXPECT_EQ(figures("all"), figures("some"));
  EXPECT_EQ(ReadFile(File("all/events.csv")), ReadFile(File("some/events.csv")));
  const auto summary = nlohmann::json::parse(ReadFile(File("some/summary.json")));
  EXPECT_EQ(summary["samples"]["recorded"], 12 * 5 + 2);
}

TEST_F(RecordRate, IsInWhatUpSays) {
  WriteFile(File("two.toml"), kRateTeam);
  const Said said = Call(SetUpUp, {File("two.toml"), "--engine", "inprocess", "--out", File("run"), "--set",
                                   "output.save_plot=false", "--set", "record.rate_hz=10"});
  EXPECT_THAT(said.out, HasSubstr("recorded       12 rows, 62 samples on 6 topics, 0 lost\n"));
}

TEST_F(RecordRate, IsProvedByInfo) {
  const std::string path = Fly("some");
  const Said said = Call(SetUpInfo, {path});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_THAT(said.out,
              HasSubstr("ticks:        106, of which 12 have a row, recorded without a gap\ncomplete: yes\n"));
  const auto json = nlohmann::json::parse(Call(SetUpInfo, {path, "--json"}).out);
  EXPECT_EQ(json["ticks"], 106);
  EXPECT_EQ(json["rows"], 12);
  EXPECT_EQ(json["complete"], true);
}

TEST_F(RecordRate, IsVerified) {
  const Said said = Call(SetUpVerify, {Fly("some")});
  EXPECT_EQ(said.exit_code, 0) << said.out;
  EXPECT_THAT(said.out, HasSubstr("the same, bit for bit: 106 ticks, of which 12 have a row, 62 messages\n"));
  const Said more = Call(SetUpVerify, {Fly("tenth", {"record.rate_hz=50", "run.duration_s=1.1"})});
  EXPECT_EQ(more.exit_code, 0) << more.out;
  EXPECT_THAT(more.out, HasSubstr("the same, bit for bit: 111 ticks, of which 56 have a row, 282 messages\n"));
}

TEST_F(RecordRate, IsTheRateOfTheArraysToo) {
  const std::string path = Fly("some");
  const std::string arrays = ReadFile(File("some/states.npz"));
  const Said said = Call(SetUpExport, {path, "--format", "npz", "--out", File("again.npz")});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("again.npz: 12 rows, 2 agents"));
  EXPECT_TRUE(ReadFile(File("again.npz")) == arrays);
  EXPECT_EQ(Call(SetUpExport, {path, "--format", "csv", "--out", File("states.csv")}).exit_code, 0);
  EXPECT_THAT(ReadFile(File("states.csv")), HasSubstr("\n1.05,2,"));
  EXPECT_EQ(Call(SetUpExport, {path, "--format", "mat", "--out", File("states.mat")}).exit_code, 0);
}

TEST_F(RecordRate, OfARunThatEndedEarlyIncludesItsLastTick) {
  // A law that fails at tick 57: ticks 0 to 56 are flown.
  const std::string fails =
      "[run]\nduration_s = 1.05\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
      "position_m = [[0, 0, 1], [4, 0, 1]]\n[law]\nname = 'custom'\npython = '''\ndef control(t, me, neighbours):\n"
      "    if t > 0.565: raise ValueError('over')\n    return [0, 0, 0]\n'''\n";
  WriteFile(File("fails.toml"), fails);
  EXPECT_EQ(Call(SetUpUp, {File("fails.toml"), "--engine", "inprocess", "--out", File("run"), "--quiet", "--set",
                           "output.save_plot=false", "--set", "record.rate_hz=10"})
                .exit_code,
            1);
  const Recording recording(File("run/run.mcap"));
  EXPECT_EQ(recording.ticks().last(), 56);
  EXPECT_EQ(recording.ticks().rows(), 7);
  const Said info = Call(SetUpInfo, {recording.path()});
  EXPECT_THAT(
      info.out,
      HasSubstr("ticks:        57 of 106: the run ended early, of which 7 have a row, recorded without a gap\n"));
  EXPECT_EQ(info.exit_code, 0);
}

TEST_F(RecordRate, OfACutRecordingIsKnownUpToTheCut) {
  const std::string path = Fly("some", {"record.rate_hz=10", "run.duration_s=9.05"}), cut = File("cut.mcap");
  const std::string whole = ReadFile(path);
  WriteFile(cut, whole.substr(0, whole.size() / 2));
  const Recording recording(cut);
  EXPECT_GT(recording.ticks().rows(), 10);
  EXPECT_LT(recording.ticks().rows(), 92);
  EXPECT_EQ(recording.ticks().last(), 10 * (recording.ticks().rows() - 1));
  std::vector<std::int64_t> ticks;
  recording.ForEachRow([&](const Row& row) { ticks.push_back(row.tick); });
  EXPECT_EQ(std::ssize(ticks), recording.ticks().rows());
  EXPECT_EQ(ticks.back(), recording.ticks().last());
  const Said verified = Call(SetUpVerify, {cut});
  EXPECT_EQ(verified.exit_code, 3);
  EXPECT_THAT(verified.out, HasSubstr("the same, bit for bit"));
  const Said recovered = Call(SetUpRecover, {cut, "--out", File("whole.mcap")});
  EXPECT_EQ(recovered.exit_code, 3);
  EXPECT_THAT(recovered.out, HasSubstr("whole up to tick " + std::to_string(recording.ticks().last()) + " of 905"));
  EXPECT_EQ(Recording(File("whole.mcap")).ticks().rows(), recording.ticks().rows());
}

TEST_F(RecordRate, LeavesTheLastRowOfACutRecordingAtItsTick) {
  const std::string path = Fly("some");
  // Whole up to the row of tick 105, which has no multiple of 10: as if the summary of a run that ended there were cut.
  const std::string config = BytesByTopicAndTime(path).empty() ? "" : ReadMcap(path).attachments.at(kConfigFile);
  std::string longer = ReadFile(path);
  longer.resize(longer.find(config));
  WriteFile(File("cut.mcap"), longer);
  const McapContents contents = ReadRecording(File("cut.mcap"));
  RecordingPlan plan = PlanOf(contents, "cut.mcap");
  plan.ticks = 1001;
  EXPECT_EQ(TicksIn(contents, plan).last(), 105);
  EXPECT_EQ(Prove(contents, plan).ticks, 106u);
}

TEST_F(RecordRate, ShowsTheNewestRowOfATick) {
  RecordedRun run(Fly("some"));
  EXPECT_EQ(run.last_tick(), 105);
  ShownRow row(2);
  for (const auto& [tick, shown] :
       {std::pair<std::int64_t, std::int64_t>{0, 0}, {9, 0}, {10, 10}, {57, 50}, {104, 100}, {105, 105}}) {
    run.Show(tick, row);
    EXPECT_EQ(row.tick, shown) << tick;
    EXPECT_TRUE(run.FollowEdges(row, 1000));
  }
  run.FollowCurves(1000);
  EXPECT_TRUE(run.curves().is_whole());
  for (const auto& point : run.curves().curves().points())
    EXPECT_TRUE(run.rows().ticks().Has(point.tick)) << point.tick;
  EXPECT_EQ(run.curves().curves().points().back().tick, 105);
}

TEST_F(RecordRate, FindsATamperedRow) {
  const std::string path = Fly("some");
  std::string config = ReadFile(File("some/config.toml"));
  config.replace(config.find("rate_hz = 10\n"), 13, "rate_hz = 20\n");  // of [record]
  WriteFile(File("some/config.toml"), config);
  const Said said = Call(SetUpVerify, {File("some")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, HasSubstr("[record] rate_hz = 20, the recording's says rate_hz = 10"));
}

}  // namespace
}  // namespace mascot
