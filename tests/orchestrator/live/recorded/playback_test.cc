// A recording as viewers see it: any tick, in any order, as in the run; and which tick is to be seen when.
#include "orchestrator/live/recorded/playback.h"

#include <gmock/gmock.h>

#include <limits>
#include <mutex>
#include <set>

#include "agent/laws/laws.h"
#include "orchestrator/live/recorded/projector.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "orchestrator/live/shown/shown_keys.h"
#include "tests/orchestrator/live/shown/viewer.h"
#include "tests/orchestrator/recording/flown.h"
#include "tests/support/orchestrator.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Kind = Request::Kind;

/// Playback of 1001 ticks, 100 a second, by a clock that the test moves.
class PlaybackOfTenSeconds : public testing::Test {
 protected:
  void Pass(double wall_s) { now_ += std::chrono::nanoseconds(static_cast<std::int64_t>(wall_s * 1e9)); }
  Answer Ask(Kind kind, double number = 0) { return playback_.Ask({.kind = kind, .number = number}); }
  std::int64_t Tick() { return playback_.Now().tick; }
  bool Plays() { return playback_.Now().plays; }

  Playback::WallClock::time_point now_{};
  Playback playback_{100, {1001, 1}, [this] { return now_; }};
};

TEST_F(PlaybackOfTenSeconds, StandsAtItsStartUntilItIsToPlay) {
  Pass(5);
  EXPECT_EQ(playback_.Now(), Playback::PlaybackState());
  EXPECT_EQ(Ask(Kind::kResume).words, "plays from tick 0 (0 s)");
  Pass(0.5);
  EXPECT_EQ(Tick(), 50);
  EXPECT_EQ(Ask(Kind::kPause).words, "paused at tick 50 (0.5 s)");
  Pass(5);
  EXPECT_EQ(Tick(), 50);
}

TEST(Playback, StepsFromRowToRow) {
  Playback playback(100, {106, 10});
  const auto step = [&](double rows) { return playback.Ask({.kind = Kind::kStep, .number = rows}).words; };
  EXPECT_EQ(step(1), "at tick 10 (0.1 s)");
  EXPECT_EQ(step(9), "at tick 100 (1 s)");
  EXPECT_EQ(step(1), "at tick 105 (1.05 s)");
  EXPECT_EQ(step(1), "at tick 105 (1.05 s), where the recording ends");
  EXPECT_EQ(step(-1), "at tick 100 (1 s)");
  playback.Ask({.kind = Kind::kSeek, .number = 0.57});
  EXPECT_EQ(step(1), "at tick 60 (0.6 s)");
  EXPECT_EQ(step(-100), "at tick 0 (0 s)");
}

TEST_F(PlaybackOfTenSeconds, KeepsItsPlaceWhenTheSpeedChanges) {
  Ask(Kind::kResume);
  Pass(1);
  EXPECT_EQ(Ask(Kind::kPace, 0.1).words, "plays 0.1 simulated seconds a second");
  Pass(1);
  EXPECT_EQ(Tick(), 110);
  Ask(Kind::kPace, 100);
  Pass(0.05);
  EXPECT_EQ(Tick(), 610);
  EXPECT_EQ(playback_.Now().speed, 100);
  for (const double speed : {0.0, 0.09, 101.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(Ask(Kind::kPace, speed).words, HasSubstr("speed: expected a number in [0.1, 100], got "));
  EXPECT_EQ(playback_.Now().speed, 100);
}

TEST_F(PlaybackOfTenSeconds, PausesAtItsEndAndPlaysAgainFromTheStart) {
  Ask(Kind::kResume);
  Pass(60);
  EXPECT_EQ(Tick(), 1000);
  EXPECT_FALSE(Plays());
  Ask(Kind::kSeek, 9.9);
  EXPECT_EQ(Tick(), 990);
  Ask(Kind::kSeek, 10);
  EXPECT_EQ(Ask(Kind::kResume).words, "plays from tick 0 (0 s)");
  Pass(1);
  EXPECT_EQ(Tick(), 100);
}

TEST_F(PlaybackOfTenSeconds, SeeksWhilePlayingAndWhilePausedAndStepsEitherWay) {
  EXPECT_EQ(Ask(Kind::kSeek, 4.2).words, "at tick 420 (4.2 s)");
  EXPECT_FALSE(Plays());
  Ask(Kind::kResume);
  Ask(Kind::kSeek, 2);
  Pass(1);
  EXPECT_EQ(Tick(), 300);
  EXPECT_TRUE(Plays());
  Ask(Kind::kStep, 1);
  EXPECT_EQ(Tick(), 301);
  EXPECT_FALSE(Plays());
  Ask(Kind::kStep, -2);
  EXPECT_EQ(Tick(), 299);
  EXPECT_EQ(Ask(Kind::kSeek, 99).words, "at tick 1000 (10 s), where the recording ends");
  EXPECT_EQ(Ask(Kind::kSeek, -1).words, "at tick 0 (0 s)");
  EXPECT_EQ(Ask(Kind::kSeek, std::numeric_limits<double>::quiet_NaN()).words, "seek: expected a time in seconds");
  EXPECT_EQ(Ask(Kind::kStep, std::numeric_limits<double>::infinity()).words, "step: expected a number of ticks");
  EXPECT_EQ(Tick(), 0);
}

TEST_F(PlaybackOfTenSeconds, ChangesNothing) {
  for (const Kind kind : {Kind::kEvent, Kind::kStop}) {
    const Answer answer = Ask(kind);
    EXPECT_FALSE(answer.granted);
    EXPECT_EQ(answer.words, "a recording cannot be changed");
  }
}

/// 1 hears 2 by a link that loses in bursts and delays; the others by perfect ones, which an event cuts and mends.
constexpr const char* kThree = R"(
[run]
duration_s = 3.0
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2]]
model = "double_integrator"
[graph]
edges = [[1, 2], [2, 3], [3, 1]]
[law]
name = "consensus"
leader = 1
leader_waypoints_m = [[1, 1, 1]]
[[events]]
at_s = 1.0
set = { "law.p_gain" = 0.3 }
[[events]]
at_s = 1.5
cut = [[2, 3]]
[[events]]
at_s = 2.0
goto = { agent = 1, position_m = [5, 5, 2] }
[[events]]
at_s = 2.5
mend = [[2, 3]]
)";
constexpr const char* kLossy = R"(
[[link.override]]
edges = [[1, 2]]
loss = 0.3
delay_s = 0.05
hold_s = 0.1
)";

/// Edges as numbers, to be compared.
std::vector<std::pair<int, double>> Plain(const std::vector<EdgeNow>& edges) {
  std::vector<std::pair<int, double>> plain;
  for (const EdgeNow& edge : edges) plain.emplace_back(static_cast<int>(edge.state), edge.age_s);
  return plain;
}

TEST(RecordedRun, ShowsEachTickAsTheRunDidInWhateverOrder) {
  const ScratchFolder folder;
  for (const auto& [name, toml] :
       {std::pair("perfect", std::string(kThree)), {"lossy", kThree + std::string(kLossy)}}) {
    const Flown run(folder, toml, name);
    RecordedRun recorded(run.path());
    ShownRow row(3);
    for (const std::int64_t tick : {0, 300, 1, 160, 159, 149, 150, 151, 250, 249, 20, 21, 299, 99, 100, 101, 201}) {
      recorded.Show(tick, row);
      while (!recorded.FollowEdges(row, 7)) EXPECT_TRUE(row.edges.empty());
      EXPECT_EQ(row.tick, tick);
      EXPECT_TRUE(IsSame(row.decoded, run.at(tick).row)) << name << " at tick " << tick;
      EXPECT_EQ(row.disagreement_m, run.at(tick).disagreement_m) << name << " at tick " << tick;
      EXPECT_EQ(Plain(row.edges), Plain(run.at(tick).edges)) << name << " at tick " << tick;
    }
  }
}

TEST(RecordedRun, KnowsWhatWasLeftOutAtEachTickInWhateverOrder) {
  const std::string toml = R"(
[run]
duration_s = 2.0
[agents]
count = 5
model = "single_integrator"
position_m = [[3, 0, 1], [-1, 1, 2], [4, 2, 3], [1, 3, 4], [-5, 4, 5]]
[[agents.override]]
id = 5
lie = { kind = "random", from_s = 0.5, offset_m = [5.0, 5.0, 0.0] }
[graph]
topology = "complete"
[sensors.own]
delay_s = 0.05
[law]
name = "velocity_consensus"
[[law.schedule]]
at_s = 1.0
name = "resilient"
gain = 0.3
)";
  const ScratchFolder folder;
  for (const auto& [name, more] : {std::pair("perfect", ""), {"lossy", "[link]\nloss = 0.3\n"}}) {
    const Flown run(folder, toml + more, name);
    LiveExperiment live(run.experiment(), &LawTable(), /*checked=*/true);
    LeftOutMeter meter(run.experiment());
    std::vector<std::vector<std::uint8_t>> left_out;
    for (std::int64_t tick = 0; tick <= run.last_tick(); ++tick) {
      if (tick == 100) meter.Adopt(live.After(run.experiment().events.at(0)));
      meter.Add(tick, run.at(tick).row.motions);
      std::vector<EdgeNow> edges = run.at(tick).edges;
      meter.Mark(edges);
      for (left_out.emplace_back(); const EdgeNow& edge : edges) left_out.back().push_back(edge.left_out);
      const auto some = std::ranges::count_if(left_out.back(), [](auto axes) { return axes != 0; });
      EXPECT_EQ(some > 0, tick >= 100) << tick;
    }
    RecordedRun recorded(run.path());
    ShownRow row(5);
    for (const std::int64_t tick : {200, 99, 100, 150, 149, 10, 101}) {
      recorded.Show(tick, row);
      while (!recorded.FollowEdges(row, 7)) EXPECT_TRUE(row.edges.empty());
      std::vector<std::uint8_t> shown;
      for (const EdgeNow& edge : row.edges) shown.push_back(edge.left_out);
      EXPECT_EQ(shown, left_out.at(static_cast<std::size_t>(tick))) << name << " at tick " << tick;
    }
  }
}

TEST(RecordedRun, ReadsNoRowForEdgesOnWhichNothingIsLost) {
  const ScratchFolder folder;
  std::string toml(kThree);
  toml.erase(toml.find("[[events]]"));
  const Flown run(folder, toml);
  RecordedRun recorded(run.path());
  ShownRow row(3);
  recorded.Show(300, row);
  const std::uint64_t read = recorded.rows().bytes_read();
  EXPECT_TRUE(recorded.FollowEdges(row, 1));
  EXPECT_EQ(recorded.rows().bytes_read(), read);
}

std::string ValueOf(const std::string& key, const std::vector<ShownKey>& keys) {
  for (const ShownKey& shown : keys)
    if (shown.name == key) return shown.value;
  return "there is no " + key;
}

std::map<int, std::string> OwnValuesOf(const std::string& key, const std::vector<ShownKey>& keys) {
  for (const ShownKey& shown : keys)
    if (shown.name == key) return shown.own;
  return {{0, "there is no " + key}};
}

TEST(RecordedRun, HasTheValuesThatAgentsHaveOfTheirOwn) {
  using Own = std::map<int, std::string>;
  const ScratchFolder folder;
  const Flown run(folder,
                  std::string(kThree) + "[[events]]\nat_s = 2.2\nagents = [2, 3]\nset = { \"law.p_gain\" = 2 }\n");
  RecordedRun recorded(run.path());
  EXPECT_EQ(OwnValuesOf("law.leader_waypoints_m", recorded.KeysAt(199)), Own());
  EXPECT_EQ(OwnValuesOf("law.leader_waypoints_m", recorded.KeysAt(200)), (Own{{1, "[[5.0, 5.0, 2.0]]"}}));
  EXPECT_EQ(OwnValuesOf("law.p_gain", recorded.KeysAt(219)), Own());
  EXPECT_EQ(OwnValuesOf("law.p_gain", recorded.KeysAt(220)), (Own{{2, "2.0"}, {3, "2.0"}}));
  EXPECT_EQ(ValueOf("law.p_gain", recorded.KeysAt(220)), "0.3") << "the team's";
}

TEST(RecordedRun, HasTheExperimentOfEachTick) {
  const ScratchFolder folder;
  const Flown run(folder, kThree);
  RecordedRun recorded(run.path());
  using Cut = std::set<std::pair<int, int>>;
  EXPECT_EQ(recorded.At(210)->cut, (Cut{{2, 3}}));  // later ones first
  EXPECT_EQ(WaypointsOf(recorded.At(210)->agent(1)).back(), Eigen::Vector3d(5, 5, 2));
  EXPECT_EQ(recorded.At(250)->cut, Cut());
  EXPECT_EQ(WaypointsOf(recorded.At(199)->agent(1)).back(), Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(ValueOf("law.p_gain", recorded.KeysAt(100)), "0.3");
  EXPECT_NE(ValueOf("law.p_gain", recorded.KeysAt(99)), "0.3");
  EXPECT_EQ(recorded.At(99).get(), &recorded.experiment());
  std::vector<std::int64_t> ticks;
  for (const ShownEvent& event : recorded.Events()) ticks.push_back(event.tick);
  EXPECT_THAT(ticks, ElementsAre(100, 150, 200, 250));
}

TEST(RecordedRun, OfACutFileEndsAtTheCutAndSaysSo) {
  const ScratchFolder folder;
  const Flown run(folder, kThree);
  const std::string whole = ReadFile(run.path()), cut = folder.File("cut.mcap");
  WriteFile(cut, whole.substr(0, whole.size() / 2));
  RecordedRun recorded(cut);
  EXPECT_THAT(recorded.part().loss, HasSubstr("the file ends"));
  const std::int64_t last = recorded.part().last_tick;
  ASSERT_GT(last, 0);
  ASSERT_LT(last, 300);
  ShownRow row(3);
  recorded.Show(last, row);
  EXPECT_TRUE(IsSame(row.decoded, run.at(last).row));
  for (const ShownEvent& event : recorded.Events()) EXPECT_LE(event.tick, last);
}

TEST(Projector, PausesWhereTheFileIsDamagedAndShowsWhatFollowsWithoutEdges) {
  const ScratchFolder folder;
  std::string toml(kThree);
  toml.replace(toml.find("[[events]]"), std::string::npos, kLossy);
  const Flown flown(folder, toml);
  std::string bytes = ReadFile(flown.path());
  const std::uint64_t offset = McapIndex(flown.path()).chunks().at(1).offset;  // of 1.01 s to 2.01 s
  bytes[offset + 100] = static_cast<char>(bytes[offset + 100] ^ 1);
  WriteFile(flown.path(), bytes);

  std::mutex mutex;
  std::vector<std::string> lines;
  const auto log = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    lines.push_back(line);
  };
  RecordedRun run(flown.path());
  const Prediction prediction;
  Playback playback(100, run.rows().ticks());
  LiveView view(run.experiment(), prediction, playback, {.port = 0, .page = {}, .source = {.recorded = run.part()}},
                log);
  test::Viewer viewer(view.url());
  viewer.Subscribe("/ui/frame");
  {
    const Projector projector(run, playback, view, log);
    const auto go_to = [&](double t_s, std::int64_t tick) {
      viewer.Ask({{"ask", "seek"}, {"t_s", t_s}});
      return viewer.FrameAt(tick);
    };
    EXPECT_EQ(go_to(0.5, 50)["edge"].size(), 3u);
    EXPECT_EQ(go_to(2.6, 260)["edge"], nullptr);
    const auto has_said = [&](std::size_t number) {
      return test::Until([&] {
        const std::lock_guard lock(mutex);
        return lines.size() == number;
      });
    };
    EXPECT_TRUE(has_said(2));
    viewer.Ask({{"ask", "seek"}, {"t_s", 1.0}});
    viewer.Ask({{"ask", "resume"}});
    EXPECT_TRUE(has_said(3));
    EXPECT_EQ(go_to(0.5, 50)["state"], "paused");
  }
  const std::string damage = flown.path() + ": ", place = " (record at byte " + std::to_string(offset) + ")";
  const auto warns = [&](const char* what) {
    return testing::AllOf(testing::StartsWith("warning: " + damage), HasSubstr(place), testing::EndsWith(what));
  };
  EXPECT_THAT(lines, testing::UnorderedElementsAre(
                         warns(": curves end there"), warns(": states of edges are not known from there on"),
                         testing::AllOf(testing::StartsWith("error: " + damage), testing::EndsWith(place))));
}

}  // namespace
}  // namespace mascot
