// Flights of one experiment, one after the other, that somebody steps.
#include "orchestrator/engines/episodes.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "orchestrator/engines/inprocess.h"
#include "tests/support/recorded_with_actions.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// Two quadrotors that hear each other, with losses and noise.
std::string TwoOf(const std::string& law = "name = 'actions'\n", const std::string& more = "") {
  return "[run]\nname = 'pair'\nduration_s = 0.5\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [0, 3, 1]]\n"
         "[graph]\ntopology = 'complete'\n[link]\nloss = 0.3\n[sensors.own]\nposition_std_m = 0.1\n[law]\n" +
         law + more;
}

/// Keeps what it is given.
class Seen final : public EpisodeWitness, public RowSink {
 public:
  std::vector<RowSink*> Begin(const Experiment& experiment) override {
    begun.push_back(experiment.run.seed);
    return {this};
  }
  void Add(const FlownRow& row) override {
    rows.push_back(row.decoded().motions[1].p_WB);
    ticks.push_back(row.tick());
  }
  void End(const EngineResult& result) override {
    failures.push_back(result.failure);
    unanswered = result.unanswered;
  }

  std::vector<std::uint64_t> begun;
  std::vector<Eigen::Vector3d> rows;
  std::vector<std::int64_t> ticks;
  std::vector<std::string> failures;
  std::vector<Event> unanswered;
};

void Fly(Episodes& episodes, ActionSource& source, std::int64_t until) {
  while (episodes.tick() < until) {
    const auto actions = source.At(episodes.tick());
    for (int id = 1; id <= 2; ++id) episodes.Act(id, actions[static_cast<std::size_t>(id - 1)]);
    episodes.Step();
  }
}

TEST(Episodes, AreTheFlightsOfTheEngine) {
  const Experiment experiment = Load(TwoOf());
  Seen expected, seen;
  Waves waves(1);
  EXPECT_EQ(RunInProcess(
                experiment, {&expected}, [] { return true; }, nullptr, Crew::Alone(), [](const std::string&) {}, &waves)
                .failure,
            "");
  Episodes episodes(TwoOf(), "pair.toml", {});
  episodes.SetWitnesses({&seen});
  Fly(episodes, waves, 50);
  EXPECT_TRUE(episodes.is_over());
  EXPECT_THAT(seen.failures, ElementsAre(""));
  EXPECT_EQ(seen.ticks, expected.ticks);
  EXPECT_EQ(seen.rows, expected.rows);
}

TEST(Episodes, ThatAreRestoredAreTheSame) {
  Episodes episodes(TwoOf(), "pair.toml", {});
  Waves waves(1);
  episodes.Reset({{.key = "run.seed", .value = "7"}});
  Fly(episodes, waves, 20);
  episodes.Take("set = { 'control.max_acceleration_m_per_s2' = 0.2 }");
  Fly(episodes, waves, 30);
  const Episodes::Snapshot snapshot = episodes.Save();
  Fly(episodes, waves, 50);
  const Eigen::Vector3d end = episodes.row().motions[1].p_WB;
  std::vector<std::int64_t> looked;
  episodes.Restore(snapshot, [&] { looked.push_back(episodes.tick()); });
  EXPECT_EQ(looked.size(), 31u);
  EXPECT_EQ(looked.back(), 30);
  EXPECT_EQ(episodes.experiment().run.seed, 7u);
  EXPECT_EQ(episodes.now().agent(1).control.max_acceleration_m_per_s2, 0.2);
  Fly(episodes, waves, 50);
  EXPECT_EQ(episodes.row().motions[1].p_WB, end);
}

TEST(Episodes, ThatKeepNoHistoryAreNotSaved) {
  Episodes episodes(TwoOf(), "pair.toml", {}, Episodes::Keeps::kNothing);
  Waves waves(1);
  Fly(episodes, waves, 3);
  EXPECT_THAT([&] { episodes.Save(); }, ThrowsMessage<std::logic_error>("a snapshot of episodes without a history"));
}

TEST(Episodes, AreSeenFromTheirStartOnIfTheyMove) {
  Seen seen;
  Waves waves(1);
  Episodes episodes(TwoOf(), "pair.toml", {});
  Fly(episodes, waves, 1);
  episodes.SetWitnesses({&seen});  // this one has moved already
  Fly(episodes, waves, 5);
  for (const char* const seed : {"2", "3"}) episodes.Reset({{.key = "run.seed", .value = seed}});  // 2 does not move
  Fly(episodes, waves, 3);
  episodes.Finish();
  EXPECT_THAT(seen.begun, ElementsAre(3u));
  EXPECT_THAT(seen.ticks, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(seen.failures, ElementsAre(""));
}

TEST(Episodes, ThatEndWhenALawHasFailedTellWhoHasNotAnsweredTheirLastTick) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"),
            "def control(t, me, neighbours):\n    if me.id == 2 and round(100 * t) == 10:\n        raise "
            "ValueError('broken')\n    return [0.0, 0.0, 0.0]\n");
  const std::string file =
      "[run]\nduration_s = 1.0\non_agent_loss = 'hold'\n[agents]\ncount = 2\n[law]\nname = "
      "'custom'\nfile = 'law.py'\n";
  for (int steps = 8; steps <= 12; ++steps) {
    SCOPED_TRACE(steps);
    Episodes episodes(file, folder.File("pair.toml"), {});
    Seen seen;
    episodes.SetWitnesses({&seen});
    episodes.Reset({});
    for (int k = 0; k < steps; ++k) episodes.Step();
    const std::int64_t last = episodes.tick();
    episodes.Finish();
    EXPECT_EQ(seen.ticks.back(), last);
    ASSERT_EQ(seen.unanswered.size(), last == 10 ? 1u : 0u);
    if (last != 10) continue;
    EXPECT_EQ(seen.unanswered[0].tick, 11);
    EXPECT_EQ(seen.unanswered[0].fault->agent, 2);
  }
}

/// Counts how often it is asked to wait, and does then what a test says.
class Waits final : public EpisodeWitness {
 public:
  explicit Waits(Seen& seen, std::function<bool(Episodes&)> await) : seen_(seen), await_(std::move(await)) {}
  std::vector<RowSink*> Begin(const Experiment& /*experiment*/) override { return {&seen_}; }
  bool Await(Episodes& episodes) override {
    at.push_back(episodes.tick());
    return await_(episodes);
  }
  void End(const EngineResult& result) override { seen_.End(result); }
  std::vector<std::int64_t> at;

 private:
  Seen& seen_;
  const std::function<bool(Episodes&)> await_;
};

TEST(Episodes, WitnessesWaitAfterTheRowOfATickAndSeeTheSame) {
  Seen recorded, shown;
  Waits waits(shown, [&](Episodes& episodes) {
    EXPECT_EQ(recorded.ticks.back(), episodes.tick());
    EXPECT_EQ(shown.ticks.back(), episodes.tick());
    return true;
  });
  Waves waves(1);
  Episodes episodes(TwoOf(), "pair.toml", {});
  episodes.SetWitnesses({&recorded, &waits});
  Fly(episodes, waves, 50);
  EXPECT_EQ(waits.at.size(), 50u);  // not after the last
  EXPECT_EQ(shown.rows, recorded.rows);
  EXPECT_THAT(shown.failures, ElementsAre(""));
  EXPECT_THAT(recorded.failures, ElementsAre(""));
}

TEST(Episodes, AnEventOfAWitnessIsOneOfTheEpisode) {
  Seen seen;
  Waits gives(seen, [](Episodes& episodes) {
    if (episodes.tick() == 9)
      episodes.Take(EventFrom(0, "set = { 'control.max_acceleration_m_per_s2' = 0.2 }", 2, "test"));
    return true;
  });
  Waves waves(1);
  Episodes episodes(TwoOf(), "pair.toml", {});
  episodes.SetWitnesses({&gives});
  Fly(episodes, waves, 9);
  episodes.Take("cut = [[1, 2]]");
  Fly(episodes, waves, 10);
  EXPECT_EQ(episodes.now().agent(1).control.max_acceleration_m_per_s2, 0.2);
  EXPECT_EQ(episodes.row().events.size(), 2u);
  Fly(episodes, waves, 30);
  const Eigen::Vector3d there = episodes.row().motions[1].p_WB;
  const Episodes::Snapshot snapshot = episodes.Save();
  episodes.SetWitnesses({});
  episodes.Restore(snapshot, [] {});
  EXPECT_EQ(episodes.row().motions[1].p_WB, there);
}

TEST(Episodes, AWitnessMayEndThem) {
  Seen seen;
  Waits ends(seen, [](Episodes& episodes) { return episodes.tick() < 4; });
  Waves waves(1);
  Episodes episodes(TwoOf(), "pair.toml", {});
  episodes.SetWitnesses({&ends});
  Fly(episodes, waves, 4);
  EXPECT_FALSE(episodes.is_over());
  episodes.Step();
  EXPECT_TRUE(episodes.is_over());
  EXPECT_EQ(episodes.failure(), "");
  EXPECT_EQ(episodes.tick(), 4);
  EXPECT_THAT(seen.ticks, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(seen.failures, ElementsAre(""));
  episodes.Reset({});
  Fly(episodes, waves, 1);
  EXPECT_THAT(seen.ticks, ElementsAre(0, 1, 2, 3, 4, 0));
}

TEST(Episodes, WitnessesKnowThatOneIsRestored) {
  Seen seen;
  std::vector<std::int64_t> restored;
  Waits notes(seen, [&](Episodes& episodes) {
    if (episodes.is_restoring()) restored.push_back(episodes.tick());
    return true;
  });
  Waves waves(1);
  Episodes episodes(TwoOf(), "pair.toml", {});
  Fly(episodes, waves, 3);
  const Episodes::Snapshot snapshot = episodes.Save();
  episodes.SetWitnesses({&notes});
  episodes.Restore(snapshot, [] {});
  Fly(episodes, waves, 6);
  EXPECT_THAT(restored, ElementsAre(0, 1, 2));
  EXPECT_THAT(notes.at, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(Episodes, ThatAreOverAreNotStepped) {
  Episodes episodes(TwoOf(), "pair.toml", {});
  Waves waves(1);
  Fly(episodes, waves, 50);
  EXPECT_THAT([&] { episodes.Step(); }, ThrowsMessage<std::runtime_error>("the episode is over: expected a reset"));
}

TEST(Episodes, ALossThatEndsTheRunEndsThem) {
  Seen seen;
  Episodes episodes(TwoOf("name = 'actions'\n", "[[events]]\nat_s = 0.1\nfault = { agent = 2, kind = 'kill' }\n"),
                    "pair.toml", {});
  episodes.SetWitnesses({&seen});
  Waves waves(1);
  while (!episodes.is_over()) Fly(episodes, waves, episodes.tick() + 1);
  EXPECT_EQ(episodes.tick(), 10);
  EXPECT_THAT(episodes.failure(), HasSubstr("tick 10: agent 2"));
  EXPECT_THAT(seen.failures, ElementsAre(HasSubstr("tick 10: agent 2")));
  EXPECT_EQ(seen.ticks.size(), 10u) << "as of a run of the engine";
}

TEST(Episodes, ALawThatFailsIsToldAndAnotherEpisodeMayFollow) {
  Seen seen;
  Episodes episodes(TwoOf(), "pair.toml", {});
  episodes.SetWitnesses({&seen});
  episodes.Act(1, std::vector{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_THAT([&] { episodes.Step(); }, ThrowsMessage<std::runtime_error>(HasSubstr("agent 1")));
  EXPECT_TRUE(episodes.is_over());
  EXPECT_THAT(seen.failures, ElementsAre(HasSubstr("agent 1")));
  episodes.Reset({});
  EXPECT_FALSE(episodes.is_over());
  EXPECT_THAT(episodes.failure(), IsEmpty());
}

TEST(Episodes, RefuseEventsThatAreNotLegalAndChangeNothing) {
  Episodes episodes(TwoOf(), "pair.toml", {});
  const std::pair<std::string, std::string> refused[] = {
      {"cut = [[1, 3]]", "event by hand: expected an edge of the graph (i hears j), got [1, 3]"},
      {"law = { name = 'consensus' }", "event by hand: expected keys of [[events]], got what no file has there"},
      {"set = { 'run.seed' = 2 }", "event by hand: "}};
  for (const auto& event : refused)
    EXPECT_THAT([&] { episodes.Take(event.first); }, ThrowsMessage<std::exception>(HasSubstr(event.second)))
        << event.first;
  episodes.Step();
  EXPECT_THAT(episodes.row().events, IsEmpty());
}

TEST(Episodes, KeepTheLastWhenAnotherCannotBegin) {
  Episodes episodes(TwoOf(), "pair.toml", {});
  EXPECT_THAT([&] { episodes.Reset({{.key = "run.duration_s", .value = "-1"}}); },
              ThrowsMessage<ConfigError>(HasSubstr("run.duration_s")));
  EXPECT_TRUE(episodes.is_over());
  EXPECT_THAT([&] { Episodes(TwoOf(), "pair.toml", {{.key = "run.mode", .value = "'realtime'"}}); },
              ThrowsMessage<ConfigError>("pair.toml: expected run.mode = \"lockstep\", got \"realtime\""));
  episodes.Reset({});
  episodes.Step();
}

}  // namespace
}  // namespace mascot
