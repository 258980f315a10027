// Agents that take actions, over DDS: a program gives them, tick by tick, as in one process.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "orchestrator/control/run_requests.h"
#include "orchestrator/recording/attached_experiment.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/run_writer.h"
#include "orchestrator/team/row_sink.h"
#include "orchestrator/verbs/fly.h"
#include "system/console.h"
#include "system/descendants.h"
#include "tests/support/folders.h"
#include "tests/support/load.h"
#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;

/// Gives actions that depend on the tick and the agent; each third one is missing, so that the one before holds. Agents
/// of which `numbers` says 0 get none.
class Swings final : public ActionSource {
 public:
  using Numbers = std::function<std::size_t(int id, std::int64_t tick)>;
  Swings(int agents, Numbers numbers) : numbers_(std::move(numbers)), actions_(static_cast<std::size_t>(agents)) {}

  std::span<const std::vector<double>> At(std::int64_t tick) override {
    EXPECT_EQ(tick, next_++);
    if (tick == fails_at_) throw std::runtime_error("the program that decides has gone");
    for (std::size_t i = 0; i < actions_.size(); ++i) {
      const int id = static_cast<int>(i) + 1;
      actions_[i].clear();
      if ((tick + id) % 3 == 0) continue;
      for (std::size_t k = 0; k < numbers_(id, tick); ++k)
        actions_[i].push_back(0.3 * std::sin(0.1 * static_cast<double>(tick) + id + static_cast<double>(k)));
    }
    return actions_;
  }
  void FailAt(std::int64_t tick) { fails_at_ = tick; }
  std::int64_t asked() const { return next_; }

 private:
  const Numbers numbers_;
  std::vector<std::vector<double>> actions_;
  std::int64_t next_ = 0, fails_at_ = -1;
};

/// The rows that a run has had when actions of a tick were asked for.
class RowsSoFar final : public RowSink {
 public:
  void Add(const FlownRow& row) override { rows_ = row.tick() + 1; }
  std::int64_t rows() const { return rows_; }

 private:
  std::int64_t rows_ = 0;
};

struct FlownTold {
  EngineResult result;
  std::string recording;  ///< the bytes of run.mcap
};

/// Flies `toml` in the folder `name`, whose config.toml has what happened to agents.
FlownTold FlyTold(const ScratchFolder& scratch, const std::string& name, const std::string& toml, const char* engine,
                  ActionSource* actions, std::vector<RowSink*> sinks = {}) {
  const Experiment experiment = Load(toml);
  FlownTold flown;
  AdoptDescendants();  // as `orchestrator` does: else nobody is told how the copies of an agent's process end
  {
    const RunFolder folder(scratch.File(name), experiment, false);
    RunWriter writer(experiment, folder, WithoutDelivery(experiment));
    RunRequests happened(experiment, /*pace=*/0);
    sinks.insert(sinks.end(), {&writer, &happened});
    StopSignal stop;
    Console console(/*quiet=*/true);
    Crew crew;
    EngineRun run(engine, experiment, folder, sinks, nullptr, console, stop, crew, nullptr, actions);
    flown.result = run.Fly();
    run.End(/*process_goes_on=*/true);
    const Experiment as_flown = WithEvents(experiment, happened.by_hand());
    folder.Write("config.toml", as_flown.resolved);
    writer.Close(WithoutDelivery(as_flown));
  }
  flown.recording = ReadFile(scratch.File(name + "/run.mcap"));
  return flown;
}

/// Three points on a ring that are told what to do, and send two numbers.
std::string ToldRing(const std::string& run = "", const std::string& more = "") {
  return "[run]\nname = 'told'\nduration_s = 1.0\n" + run +
         "[agents]\ncount = 3\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [0, 3, 1], [3, 0, 1]]\n[graph]\n"
         "topology = 'ring'\n[law]\nname = 'actions'\nmessage = 2\n" +
         more;
}

std::size_t FiveNumbers(int /*id*/, std::int64_t /*tick*/) { return 5; }

/// Flies `toml` in one process, and over DDS with `network`, lines of [network], and expects the same bytes.
void ExpectBytesOfOneProcess(const std::string& toml, const std::string& network,
                             const Swings::Numbers& numbers = FiveNumbers) {
  const ScratchFolder scratch;
  const std::string both = toml + "[network]\n" + network;
  const int agents = Load(both).size();
  Swings here(agents, numbers), over_dds(agents, numbers);
  const FlownTold one = FlyTold(scratch, "one", both, kInProcess, &here);
  const FlownTold dds = FlyTold(scratch, "dds", both, kOverDds, &over_dds);
  EXPECT_EQ(one.result.failure, "");
  EXPECT_EQ(dds.result.failure, "");
  EXPECT_EQ(dds.result.wire_matches_graph, true);
  EXPECT_EQ(here.asked(), over_dds.asked());
  EXPECT_FALSE(one.recording.empty());
  EXPECT_TRUE(one.recording == dds.recording) << "run.mcap differs";
  EXPECT_THAT(one.recording, HasSubstr("/agent_2/action"));
}

struct Telling {
  std::string name, network;
};

class ActionsOverDds : public testing::TestWithParam<Telling> {};

TEST_P(ActionsOverDds, GiveTheBytesOfOneProcess) { ExpectBytesOfOneProcess(ToldRing(), GetParam().network); }

INSTANTIATE_TEST_SUITE_P(
    By, ActionsOverDds,
    testing::Values(Telling{"bundles", "delivery = 'bundled'\n"}, Telling{"topics", "delivery = 'topics'\n"},
                    Telling{"two in a process", "agents_per_process = 2\n"},
                    Telling{"two in a process topics", "agents_per_process = 2\ndelivery = 'topics'\n"},
                    Telling{"UDP", "transport = 'udp'\n"},
                    Telling{"signed", "security = 'graph'\nprotection = 'sign'\n"}),
    [](const auto& row) { return ParamName(row.param.name); });

/// Agent 1 decides by itself throughout, agent 2 has another law for a while.
TEST(Actions, OfMixedTeamsAndPhasesGiveTheBytesOfOneProcess) {
  const std::string toml =
      "[run]\nname = 'told'\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n"
      "position_m = [[0, 0, 1], [0, 3, 1], [3, 0, 1]]\n[[agents.override]]\nid = 1\nlaw = { name = 'consensus' }\n"
      "[graph]\ntopology = 'ring'\n[law]\nname = 'actions'\noutput = 'velocity'\n"
      "[[law.schedule]]\nat_s = 0.3\nname = 'consensus'\n[[law.schedule]]\nat_s = 0.6\nname = 'actions'\n";
  const auto numbers = [](int id, std::int64_t tick) {
    return id == 1 || (tick >= 30 && tick < 60) ? std::size_t{0} : std::size_t{3};
  };
  for (const char* delivery : {"bundled", "topics"})
    ExpectBytesOfOneProcess(toml, fmt::format("delivery = '{}'\n", delivery), numbers);
}

TEST(Actions, ThatNobodyGivesAreZeroAlike) {
  const ScratchFolder scratch;
  const FlownTold one = FlyTold(scratch, "one", ToldRing(), kInProcess, nullptr),
                  dds = FlyTold(scratch, "dds", ToldRing(), kOverDds, nullptr);
  EXPECT_EQ(dds.result.failure, "");
  EXPECT_TRUE(one.recording == dds.recording);
}

/// Agents 1 and 2 are lost, 1 without an answer to the tick before, and fresh ones take their places; then all are.
const std::string kToldLosses =
    "[[events]]\nat_s = 0.2\nfault = { agent = 2, kind = 'kill' }\n"
    "[[events]]\nat_s = 0.3\nfault = { agent = 1, kind = 'kill', unanswered = true }\n"
    "[[events]]\nat_s = 0.4\nfault = { agent = 3, kind = 'hang' }\n";
const std::string kToldRestarts =
    "[[events]]\nat_s = 0.5\nrestart = 2\n[[events]]\nat_s = 0.6\nrestart = 1\n[[events]]\nat_s = 0.6\nrestart = 3\n"
    "[[events]]\nat_s = 0.7\nrestart = 2\n";

TEST(Actions, OfAgentsThatAreLostAndOfFreshOnesGiveTheBytesOfOneProcess) {
  const std::string toml = ToldRing("on_agent_loss = 'hold'\n", kToldLosses + kToldRestarts);
  ExpectBytesOfOneProcess(toml, "");
  ExpectBytesOfOneProcess(toml, "agents_per_process = 2\n");
  ExpectBytesOfOneProcess(ToldRing("on_agent_loss = 'hold'\n", kToldLosses), "delivery = 'topics'\n");
  ExpectBytesOfOneProcess(ToldRing("on_agent_loss = 'restart'\nrestart_after_s = 0.4\n", kToldLosses), "");
}

/// As Swings; the process of agent 2 is killed when the actions of tick 40 are asked for.
class Killer final : public ActionSource {
 public:
  std::span<const std::vector<double>> At(std::int64_t tick) override {
    if (tick == 40) SignalTo(ChildOf(getpid(), "--id 2 "), SIGKILL);
    return swings_.At(tick);
  }

 private:
  Swings swings_{3, FiveNumbers};
};

TEST(Actions, OfAgentsThatAreKilledForRealFlyAgain) {
  for (const std::string delivery : {"bundled", "topics"}) {
    const ScratchFolder scratch;
    Killer killer;
    const std::string loss = delivery == "bundled" ? "'restart'\nrestart_after_s = 0.2\n" : "'hold'\n";
    const FlownTold flown =
        FlyTold(scratch, "run", ToldRing("on_agent_loss = " + loss, "[network]\ndelivery = '" + delivery + "'\n"),
                kOverDds, &killer);
    EXPECT_EQ(flown.result.failure, "");
    EXPECT_EQ(flown.result.lost, 0U);
    EXPECT_THAT(ReadFile(scratch.File("run/config.toml")), HasSubstr("kind = \"kill\""));
    const Ran same = Shell("'" + BuildFolder() + "/orchestrator' verify '" + scratch.File("run") + "'");
    EXPECT_EQ(same.exit_code, 0) << same.output;
    EXPECT_THAT(same.output, HasSubstr("the same, bit for bit: 101 ticks, "));
  }
}

TEST(Actions, AreAskedForWhenTheSinksHaveAllRowsBefore) {
  class Asking final : public ActionSource {
   public:
    explicit Asking(const RowsSoFar& order) : order_(order), none_(3) {}
    std::span<const std::vector<double>> At(std::int64_t tick) override {
      EXPECT_EQ(order_.rows(), tick);
      return none_;
    }

   private:
    const RowsSoFar& order_;
    std::vector<std::vector<double>> none_;
  };
  const ScratchFolder scratch;
  for (const std::string network : {"delivery = 'bundled'", "delivery = 'topics'"})
    for (const char* engine : {kInProcess, kOverDds}) {
      RowsSoFar order;
      Asking asking(order);
      EXPECT_EQ(FlyTold(scratch, engine + network.substr(12, 6), ToldRing("", "[network]\n" + network + "\n"), engine,
                        &asking, {&order})
                    .result.failure,
                "");
      EXPECT_EQ(order.rows(), 101);
    }
}

TEST(Actions, OfASourceThatFailsEndTheRunInItsWords) {
  const ScratchFolder scratch;
  for (const char* engine : {kInProcess, kOverDds}) {
    Swings swings(3, FiveNumbers);
    swings.FailAt(40);
    const FlownTold flown = FlyTold(scratch, engine, ToldRing(), engine, &swings);
    EXPECT_EQ(flown.result.failure, "the program that decides has gone");
    EXPECT_EQ(swings.asked(), 41) << "it is not asked again";
  }
}

TEST(Actions, OfAnotherSizeEndTheRunInWordsAlike) {
  const ScratchFolder scratch;
  for (const char* engine : {kInProcess, kOverDds}) {
    Swings swings(3, [](int id, std::int64_t tick) { return id == 2 && tick > 10 ? std::size_t{4} : std::size_t{5}; });
    EXPECT_EQ(FlyTold(scratch, engine, ToldRing(), engine, &swings).result.failure,
              "agent 2: expected an action of 5 numbers, got 4");
  }
}

/// In real time an agent answers a tick with the action of that tick, or misses it: an action is recorded with its
/// answer.
TEST(Actions, InRealTimeAreRecordedWithTheAnswersToThem) {
  const ScratchFolder scratch;
  for (const std::string delivery : {"bundled", "topics"}) {
    Swings swings(3, FiveNumbers);
    const FlownTold flown =
        FlyTold(scratch, delivery, ToldRing("mode = 'realtime'\n", "[network]\ndelivery = '" + delivery + "'\n"),
                kOverDds, &swings);
    EXPECT_EQ(flown.result.failure, "");
    EXPECT_EQ(swings.asked(), 101);
    const McapContents contents = ReadRecording(scratch.File(delivery + "/run.mcap"));
    std::map<std::string, std::uint64_t> messages;
    for (const auto& [id, channel] : contents.channels) messages[channel.topic] = channel.messages;
    for (int id = 1; id <= 3; ++id) {
      EXPECT_GT(messages[fmt::format("/agent_{}/action", id)], 0U);
      EXPECT_EQ(messages[fmt::format("/agent_{}/action", id)], messages[fmt::format("/agent_{}/command", id)]);
    }
  }
}

// --- what was recorded ----------------------------------------------------------------------------------

class ToldAgain : public testing::TestWithParam<std::string> {
 protected:
  ToldAgain() {
    Swings swings(3, FiveNumbers);
    const std::string toml =
        ToldRing("on_agent_loss = 'hold'\n", kToldLosses + (GetParam() == "bundled" ? kToldRestarts : "") +
                                                 "[network]\ndelivery = '" + GetParam() + "'\n");
    EXPECT_EQ(FlyTold(scratch_, "run", toml, kInProcess, &swings).result.failure, "");
  }
  Ran Orchestrator(const std::string& verb, const std::string& more) const {
    return Shell("'" + BuildFolder() + "/orchestrator' " + verb + " '" + scratch_.File("run") + "' " + more);
  }
  const ScratchFolder scratch_;
};

TEST_P(ToldAgain, FliesAgainOverDds) {
  const Ran same = Orchestrator("verify", "--engine dds");
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_THAT(same.output, HasSubstr("the same, bit for bit: 101 ticks, "));
}

TEST_P(ToldAgain, GivesAnAgentItsActionsOnceMore) {
  for (const char* id : {"1", "2", "3"}) {
    const Ran same = Orchestrator("replay", "--quiet --to " + std::string(id));
    EXPECT_EQ(same.exit_code, 0) << same.output;
    EXPECT_THAT(same.output, HasSubstr("decides the same, bit for bit: "));
  }
}

INSTANTIATE_TEST_SUITE_P(By, ToldAgain, testing::Values("bundled", "topics"),
                         [](const auto& row) { return row.param; });

}  // namespace
}  // namespace mascot::test
