// Faults: what goes wrong with agents, from exactly its tick on.
#include "experiment/faults.h"

#include <gmock/gmock.h>

#include <cmath>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kAt = 50;  // the tick of the faults below: 0.5 s

/// Two agents that hear each other, and accelerate towards each other or go on.
std::string TwoAgents(const std::string& run = "", const std::string& model = "double_integrator") {
  return "[run]\nduration_s = 2.0\n" + run + "[agents]\ncount = 2\nmodel = '" + model +
         "'\nposition_m = [[0, 0, 1], [4, 2, 1]]\n"
         "velocity_m_per_s = [[0, 0.5, 0], [0, -0.5, 0]]\n[graph]\ntopology = 'complete'\n[law]\nname = 'consensus'\n"
         "p_gain = 0.5\n";
}

std::string FaultEvent(const std::string& fault, const std::string& at_s = "0.5") {
  return "[[events]]\nat_s = " + at_s + "\nfault = { " + fault + " }\n";
}

std::string RestartEvent(int agent, const std::string& at_s) {
  return "[[events]]\nat_s = " + at_s + "\nrestart = " + std::to_string(agent) + "\n";
}

/// How a run ends, and its rows.
struct FaultyFlight {
  std::string failure;
  std::vector<DecodedRow> rows;
};

FaultyFlight FlyOn(const std::string& toml) {
  const Experiment experiment = Load(toml);
  Rows sink;
  const EngineResult result = RunInProcess(experiment, {&sink}, [] { return true; });
  return {result.failure, sink.rows};
}

Eigen::Vector3d P(const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
  return rows[static_cast<std::size_t>(tick)].motions[static_cast<std::size_t>(id - 1)].p_WB;
}
Eigen::Vector3d V(const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
  return rows[static_cast<std::size_t>(tick)].motions[static_cast<std::size_t>(id - 1)].v_WB;
}
const Command& CommandAt(const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
  return rows[static_cast<std::size_t>(tick)].commands[static_cast<std::size_t>(id - 1)];
}
bool HasAnswered(const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
  return rows[static_cast<std::size_t>(tick)].has_answered[static_cast<std::size_t>(id - 1)] != 0;
}

// --- reading ----------------------------------------------------------------------------------------

TEST(Fault, IsTheSameAfterItWasWritten) {
  for (const FaultRow& row : FaultRows()) {
    std::string text = "{ agent = 2, of = \"" + std::string(kFaultParts.Name(row.of)) + "\", kind = \"" +
                       std::string(kFaultKinds.Name(row.kind)) + "\"";
    const auto add = [&](const std::string& name, const std::string& value) {
      if ((", " + std::string(row.parameters) + ",").find(" " + name + ",") != std::string::npos)
        text += ", " + name + " = " + value;
    };
    add("lie", "\"oscillating\"");
    add("offset_m", "[1.5, 2.0, -3.0]");
    add("motor", "3");
    add("period_s", "0.25");
    add("remaining", "0.75");
    add("delay_s", "0.125");
    add("probability", "0.2");
    add("unanswered", "true");
    const Event event = EventFrom(7, "fault = " + text + " }", 2, "test");
    std::string expected = text + " }";
    if (const std::string agent = "of = \"agent\", "; expected.find(agent) != std::string::npos)
      expected.erase(expected.find(agent), agent.size());
    EXPECT_EQ(event.Toml(), "fault = " + expected + "\n");
    EXPECT_EQ(EventFrom(7, event.Toml(), 2, "test").Toml(), event.Toml());
  }
}

TEST(Fault, HasUsualValues) {
  const auto written = [](const std::string& fault) {
    return EventFrom(7, "fault = { " + fault + " }", 2, "t").Toml();
  };
  EXPECT_EQ(written("agent = 1, kind = 'lie'"),
            "fault = { agent = 1, kind = \"lie\", lie = \"constant\", offset_m = [1.0, 1.0, 1.0], period_s = 5.0 }\n");
  EXPECT_EQ(written("agent = 1, of = 'motor', kind = 'slow'"),
            "fault = { agent = 1, of = \"motor\", kind = \"slow\", motor = 0, period_s = 0.5 }\n");
}

TEST(Fault, IsSaidInWords) {
  const auto words = [](const std::vector<std::string>& faults) {
    AgentFaults agent;
    for (const std::string& fault : faults)
      Begin(*EventFrom(7, "fault = { agent = 1, " + fault + " }", 2, "t").fault, 7, agent);
    return InWords(agent);
  };
  const std::string sensor = "of = 'sensor', kind = ", motor = "of = 'motor', kind = ", link = "of = 'link', kind = ";
  EXPECT_THAT(words({}), IsEmpty());
  EXPECT_THAT(words({"kind = 'kill'"}), ElementsAre("lost: its process has died"));
  EXPECT_THAT(words({"kind = 'hang'"}), ElementsAre("lost: it hangs"));
  EXPECT_THAT(words({"kind = 'mute'", "kind = 'deaf'"}), ElementsAre("mute: nobody hears it", "deaf: it hears nobody"));
  EXPECT_THAT(words({"kind = 'mute'", "kind = 'ok'"}), IsEmpty());
  EXPECT_THAT(words({sensor + "'wrong', offset_m = [1.5, 0, 0]"}), ElementsAre("sensor wrong: off by [1.5, 0, 0] m"));
  EXPECT_THAT(words({link + "'garbage'"}), ElementsAre("link garbage: off by up to [1, 1, 1] m"));
  EXPECT_THAT(words({link + "'slow', period_s = 0.25"}), ElementsAre("link slow: every 0.25 s"));
  EXPECT_THAT(words({link + "'delayed', delay_s = 0.3"}), ElementsAre("link delayed by 0.3 s"));
  EXPECT_THAT(words({sensor + "'intermittent', probability = 0.2"}),
              ElementsAre("sensor intermittent: fails with probability 0.2"));
  EXPECT_THAT(words({motor + "'off'"}), ElementsAre("all motors off"));
  EXPECT_THAT(words({motor + "'garbage', motor = 2", motor + "'wrong', motor = 1, remaining = 0.8"}),
              ElementsAre("motor 2 garbage", "motor 1 wrong: 0.8 of its command"));
  EXPECT_THAT(words({motor + "'stuck', motor = 2", motor + "'stuck', motor = 4", sensor + "'off'"}),
              ElementsAre("sensor off", "motors 2, 4 stuck"));
}

TEST(Fault, MistakesAreToldWithTheirPlace) {
  const auto refusal = [](const std::string& fault) { return Refusal(TwoAgents() + FaultEvent(fault)); };
  EXPECT_THAT(refusal("agent = 3, kind = 'kill'"), HasSubstr("agent: expected an integer in [1, 2], got 3"));
  EXPECT_THAT(refusal("agent = 1, kind = 'kil'"), HasSubstr("(did you mean \"kill\"?)"));
  EXPECT_THAT(refusal("agent = 1, kind = 'stuck'"),
              HasSubstr("kind: expected for of = \"agent\" one of kill, hang, mute, deaf, lie or ok, got 'stuck'"));
  EXPECT_THAT(
      refusal("agent = 1, of = 'motor', kind = 'lie'"),
      HasSubstr("kind: expected for of = \"motor\" one of off, stuck, garbage, wrong, slow, delayed, intermittent "
                "or ok, got 'lie'"));
  EXPECT_THAT(refusal("agent = 1, kind = 'mute', delay_s = 1"),
              HasSubstr("delay_s: expected only with kind = delayed, got 'mute' of = \"agent\""));
  EXPECT_THAT(refusal("agent = 1, of = 'sensor', kind = 'stuck', motor = 1"), HasSubstr("motor: expected only with"));
  EXPECT_THAT(Refusal(TwoAgents() + "[[events]]\nat_s = 0.5\nrestart = 3\n"),
              HasSubstr("restart: expected an integer in [1, 2], got 3"));
  EXPECT_THAT(Refusal(TwoAgents() + "[[events]]\nat_s = 0.5\nrestart = 1\nfault = { agent = 1, kind = 'kill' }\n"),
              HasSubstr("expected one of set, goto, graph, cut, mend, fault, restart, got fault and restart"));
  EXPECT_THAT(Refusal(TwoAgents() + "[[events]]\nat_s = 0.5\nrestart = 1\nafter_loss = true\n"),
              HasSubstr("after_loss: unknown key"));
  EXPECT_THAT(Refusal(TwoAgents("on_agent_loss = 'stop'\n")),
              HasSubstr("run.on_agent_loss: expected one of abort, hold, drop, restart, got 'stop'"));
}

// --- losses -----------------------------------------------------------------------------------------

TEST(LostAgent, EndsTheRunUnlessTheFileSaysOtherwise) {
  const FaultyFlight killed = FlyOn(TwoAgents() + FaultEvent("agent = 2, kind = 'kill'"));
  EXPECT_EQ(killed.failure, "tick 50: agent 2 is lost: its process has died (run.on_agent_loss = \"abort\")");
  EXPECT_EQ(killed.rows.size(), 50U);
  EXPECT_EQ(FlyOn(TwoAgents() + FaultEvent("agent = 1, kind = 'hang'")).failure,
            "tick 50: agent 1 is lost: it hangs (run.on_agent_loss = \"abort\")");
}

// With its last acceleration u held, a double integrator flies a parabola.
TEST(LostAgent, KeepsItsLastCommandWithHold) {
  const auto rows = Fly(TwoAgents("on_agent_loss = 'hold'\n") + FaultEvent("agent = 2, kind = 'kill'"));
  ASSERT_EQ(rows.size(), 201U);
  const Eigen::Vector3d u_W = CommandAt(rows, kAt - 1, 2).a_limited_W;
  ASSERT_GT(u_W.norm(), 0.1);
  for (const std::int64_t tick : {kAt, kAt + 1, kAt + 150}) {
    const double t_s = static_cast<double>(tick - kAt) / 100;
    EXPECT_FALSE(HasAnswered(rows, tick, 2));
    EXPECT_TRUE(HasAnswered(rows, tick, 1));
    EXPECT_LT((P(rows, tick, 2) - P(rows, kAt, 2) - t_s * V(rows, kAt, 2) - t_s * t_s / 2 * u_W).norm(),
              2e-2 * t_s + 1e-12);
    EXPECT_LT((V(rows, tick, 2) - V(rows, kAt, 2) - t_s * u_W).norm(), 1e-9);
  }
  EXPECT_TRUE(HasAnswered(rows, kAt - 1, 2));
}

TEST(LostAgent, CommandsNothingWithDrop) {
  const auto rows = Fly(TwoAgents("on_agent_loss = 'drop'\n") + FaultEvent("agent = 2, kind = 'hang'"));
  ASSERT_EQ(rows.size(), 201U);
  for (const std::int64_t tick : {kAt + 1, kAt + 150}) EXPECT_EQ(V(rows, tick, 2), V(rows, kAt, 2));
}

TEST(LostAgent, IsHeardByNobody) {
  for (const std::string kind : {"kill", "hang"}) {
    const auto rows = Fly(TwoAgents("on_agent_loss = 'hold'\n") + FaultEvent("agent = 2, kind = '" + kind + "'"));
    EXPECT_GT(CommandAt(rows, kAt - 1, 1).a_law_W.norm(), 0.1);
    // Alone, beta v is left of u = gain sum a_ij (p_j - p_i) - beta v.
    const Experiment experiment = Load(TwoAgents());
    const auto alone = CommandAt(rows, kAt, 1).a_law_W;
    EXPECT_LT(alone.cross(V(rows, kAt, 1)).norm(), 1e-12);
    EXPECT_LT(alone.dot(V(rows, kAt, 1)), 0);
  }
}

TEST(LostAgent, MayHaveLeftTheTickBeforeUnanswered) {
  const auto rows =
      Fly(TwoAgents("on_agent_loss = 'hold'\n") + FaultEvent("agent = 2, kind = 'kill', unanswered = true"));
  const auto without = Fly(TwoAgents());
  EXPECT_TRUE(HasAnswered(rows, kAt - 2, 2));
  EXPECT_FALSE(HasAnswered(rows, kAt - 1, 2));
  EXPECT_EQ(CommandAt(rows, kAt - 1, 2).a_limited_W, CommandAt(rows, kAt - 2, 2).a_limited_W);
  // At the tick that it has not answered, the other has heard it.
  EXPECT_EQ(CommandAt(rows, kAt - 1, 1).a_limited_W, CommandAt(without, kAt - 1, 1).a_limited_W);
  EXPECT_NE(CommandAt(rows, kAt, 1).a_limited_W, CommandAt(without, kAt, 1).a_limited_W);
}

TEST(LostAgent, ComesBackAfterRestartAfterS) {
  for (const auto& [key, ticks] : {std::pair("", 100), std::pair("restart_after_s = 0.25\n", 25)}) {
    const auto rows =
        Fly(TwoAgents("on_agent_loss = 'restart'\n" + std::string(key)) + FaultEvent("agent = 2, kind = 'kill'"));
    ASSERT_EQ(rows.size(), 201U);
    for (std::int64_t tick = 0; tick <= 200; ++tick)
      EXPECT_EQ(HasAnswered(rows, tick, 2), tick < kAt || tick >= kAt + ticks) << tick;
    const auto& events = rows[static_cast<std::size_t>(kAt + ticks)].events;
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].event.Toml(), "restart = 2\nafter_loss = true\n");
  }
}

TEST(LostAgent, ComesBackByAnEvent) {
  const auto rows =
      Fly(TwoAgents("on_agent_loss = 'hold'\n") + FaultEvent("agent = 2, kind = 'kill'") + RestartEvent(2, "0.8"));
  for (const std::int64_t tick : {50, 79}) EXPECT_FALSE(HasAnswered(rows, tick, 2));
  for (const std::int64_t tick : {80, 200}) EXPECT_TRUE(HasAnswered(rows, tick, 2));
  EXPECT_GT(CommandAt(rows, 80, 1).a_law_W.dot(P(rows, 80, 2) - P(rows, 80, 1)), 0) << "the other hears it again";
}

TEST(LostAgent, ThatCameBackByAnEventIsNotRestartedOnceMore) {
  const auto rows =
      Fly(TwoAgents("on_agent_loss = 'restart'\n") + FaultEvent("agent = 2, kind = 'kill'") + RestartEvent(2, "0.8"));
  EXPECT_THAT(rows[150].events, IsEmpty());
}

// A law in Python counts its calls: a fresh one begins with 0.
TEST(LostAgent, IsDueToComeBackAtATickThatIsKnown) {
  const Experiment experiment = Load(TwoAgents("on_agent_loss = 'restart'\nrestart_after_s = 0.25\n"));
  LiveExperiment live(experiment, &LawTable(), true);
  EXPECT_EQ(live.NextRestart(), std::nullopt);
  live.Take({.tick = 60, .fault = Fault{.agent = 2}, .where = "test"});
  live.Take({.tick = 70, .fault = Fault{.agent = 1}, .where = "test"});
  EXPECT_EQ(live.NextRestart(), 85);
  EXPECT_THAT(live.RestartsAt(84), IsEmpty());
  for (const Event& event : live.RestartsAt(85)) live.Take(event);
  EXPECT_EQ(live.NextRestart(), 95);
  live.Take({.tick = 90, .restart = 1, .where = "test"});
  EXPECT_EQ(live.NextRestart(), std::nullopt);
}

TEST(Restart, BeginsWithAFreshLaw) {
  const std::string counts =
      "[run]\nduration_s = 1.0\non_agent_loss = 'hold'\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\n"
      "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n  me.calls = getattr(me, 'calls', 0) + 1\n"
      "  return me.calls * 1e-3, 0\n'''\n";
  const auto calls = [](const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
    return std::llround(1e3 * CommandAt(rows, tick, id).a_law_W.x());
  };
  const auto rows = Fly(counts + RestartEvent(2, "0.5"));  // also of an agent that is not lost
  EXPECT_EQ(calls(rows, 49, 2), 50);
  EXPECT_EQ(calls(rows, 50, 2), 1);
  EXPECT_EQ(calls(rows, 60, 2), 11);
  EXPECT_EQ(calls(rows, 60, 1), 61);
  EXPECT_TRUE(HasAnswered(rows, 50, 2));
}

TEST(Restart, ForgetsWhatIsOnItsWay) {
  const std::string late = TwoAgents() + "[link]\ndelay_s = 0.2\n";
  const auto rows = Fly(late + RestartEvent(1, "0.5"));
  const auto without = Fly(late);
  EXPECT_NE(CommandAt(rows, 50, 1).a_law_W, CommandAt(without, 50, 1).a_law_W);
  EXPECT_LT(CommandAt(rows, 69, 1).a_law_W.dot(V(rows, 69, 1)), 0) << "nothing has arrived: it brakes";
  EXPECT_GT(CommandAt(rows, 70, 1).a_law_W.dot(P(rows, 50, 2) - P(rows, 70, 1)), 0);
}

TEST(Restart, KeepsTheFaultsOfPartsAndEndsThoseOfTheProcess) {
  const Experiment experiment =
      Load(TwoAgents("on_agent_loss = 'hold'\n") + FaultEvent("agent = 1, kind = 'mute'", "0.1") +
           FaultEvent("agent = 1, kind = 'deaf'", "0.2") + FaultEvent("agent = 1, kind = 'lie'", "0.3") +
           FaultEvent("agent = 1, of = 'sensor', kind = 'stuck'", "0.4") + RestartEvent(1, "0.5"));
  LiveExperiment live(experiment, &LawTable(), true);
  for (std::size_t k = 0; k < 4; ++k) live.Take(experiment.events[k]);
  const AgentConfig before = live.current().agent(1);
  EXPECT_TRUE(before.faults.is_mute && before.faults.is_deaf && before.lie);
  EXPECT_EQ(before.lie->from_s, 0.3);
  live.Take(experiment.events[4]);
  const AgentConfig& after = live.current().agent(1);
  EXPECT_FALSE(after.faults.is_mute || after.faults.is_deaf || after.lie);
  EXPECT_EQ(after.faults.restarted, 50);
  ASSERT_NE(after.faults.Of(FaultPart::kSensor), nullptr);
}

TEST(Fault, EndsWithOk) {
  const Experiment experiment =
      Load(TwoAgents() + FaultEvent("agent = 1, kind = 'mute'", "0.1") +
           FaultEvent("agent = 1, of = 'motor', kind = 'off'", "0.2") +
           FaultEvent("agent = 1, of = 'motor', kind = 'ok', motor = 2", "0.3") +
           FaultEvent("agent = 1, of = 'motor', kind = 'wrong', motor = 3", "0.4") +
           FaultEvent("agent = 1, kind = 'ok'", "0.5") + FaultEvent("agent = 1, of = 'motor', kind = 'ok'", "0.6"));
  LiveExperiment live(experiment, &LawTable(), true);
  const auto faulty = [&live] {
    std::vector<int> motors;
    for (const PartFault& part : live.current().agent(1).faults.parts) motors.push_back(part.fault.motor);
    return motors;
  };
  live.Take(experiment.events[0]);
  live.Take(experiment.events[1]);
  EXPECT_THAT(faulty(), ElementsAre(1, 2, 3, 4));
  live.Take(experiment.events[2]);
  EXPECT_THAT(faulty(), ElementsAre(1, 3, 4));
  live.Take(experiment.events[3]);
  EXPECT_THAT(faulty(), ElementsAre(1, 4, 3)) << "the newest holds";
  EXPECT_EQ(live.current().agent(1).faults.Of(FaultPart::kMotor, 3)->since, 40);
  EXPECT_TRUE(live.current().agent(1).faults.is_mute);
  live.Take(experiment.events[4]);
  EXPECT_FALSE(live.current().agent(1).faults.is_mute);
  EXPECT_EQ(faulty().size(), 3U) << "of the agent alone";
  live.Take(experiment.events[5]);
  EXPECT_THAT(faulty(), IsEmpty());
}

// --- what is heard ----------------------------------------------------------------------------------

/// Whether the law of an agent wants anything else at a tick than to slow down: it hears the other.
bool Hears(const std::vector<DecodedRow>& rows, std::int64_t tick, int id) {
  return CommandAt(rows, tick, id).a_law_W.cross(V(rows, tick, id)).norm() > 1e-9;
}

TEST(MuteAgent, IsHeardByNobodyAndHearsOthers) {
  const auto rows =
      Fly(TwoAgents() + FaultEvent("agent = 2, kind = 'mute'") + FaultEvent("agent = 2, kind = 'ok'", "0.7"));
  EXPECT_TRUE(Hears(rows, 49, 1));
  EXPECT_FALSE(Hears(rows, 50, 1) || Hears(rows, 69, 1));
  EXPECT_TRUE(Hears(rows, 50, 2) && Hears(rows, 70, 1));
}

TEST(DeafAgent, HearsNobodyAndIsHeard) {
  const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, kind = 'deaf'"));
  EXPECT_TRUE(Hears(rows, 49, 2));
  EXPECT_FALSE(Hears(rows, 50, 2));
  EXPECT_TRUE(Hears(rows, 50, 1));
}

// What the other wants differs from the truth by the gain times the lie.
TEST(LyingAgent, IsHeardElsewhere) {
  const auto truth = Fly(TwoAgents());
  for (const std::string fault :
       {"kind = 'lie', offset_m = [3, 0, 0]", "of = 'link', kind = 'wrong', offset_m = [3, 0, 0]"}) {
    const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, " + fault));
    EXPECT_EQ(CommandAt(rows, 49, 1).a_law_W, CommandAt(truth, 49, 1).a_law_W);
    const Eigen::Vector3d more = CommandAt(rows, 50, 1).a_law_W - CommandAt(truth, 50, 1).a_law_W;
    EXPECT_LT((more - Eigen::Vector3d(1.5, 0, 0)).norm(), 1e-12) << fault;
    EXPECT_EQ(CommandAt(rows, 50, 2).a_law_W, CommandAt(truth, 50, 2).a_law_W);
  }
}

TEST(FaultyLink, ThatIsOffOrSlowOrIntermittentLosesWhatIsSent) {
  const auto hears = [](const std::string& fault) {
    const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, of = 'link', " + fault));
    std::vector<std::int64_t> ticks;
    for (std::int64_t tick = kAt; tick < kAt + 100; ++tick)
      if (Hears(rows, tick, 1)) ticks.push_back(tick - kAt);
    return ticks;
  };
  EXPECT_THAT(hears("kind = 'off'"), IsEmpty());
  EXPECT_THAT(hears("kind = 'slow', period_s = 0.4"), ElementsAre(0, 40, 80));
  EXPECT_NEAR(static_cast<double>(hears("kind = 'intermittent', probability = 0.3").size()), 70, 15);
  EXPECT_EQ(hears("kind = 'intermittent', probability = 0").size(), 100U);
}

TEST(FaultyLink, ThatIsStuckRepeatsWhatItSentFirst) {
  const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, of = 'link', kind = 'stuck'"));
  const Experiment experiment = Load(TwoAgents());
  // u = gain (p_2 - p_1) - beta v: with what is heard from the fault on, its part for p_2 stays.
  const auto part = [&](std::int64_t tick) -> Eigen::Vector3d {
    return CommandAt(rows, tick, 1).a_law_W + 0.5 * P(rows, tick, 1);
  };
  const auto brakes = [&](std::int64_t tick) { return V(rows, tick, 1); };
  const double beta = -(part(60) - part(50)).x() / (brakes(60) - brakes(50)).x();
  for (const std::int64_t tick : {51, 100, 199})
    EXPECT_LT((part(tick) + beta * brakes(tick) - part(50) - beta * brakes(50)).norm(), 1e-9);
}

TEST(FaultyLink, ThatIsDelayedDeliversLater) {
  const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, of = 'link', kind = 'delayed', delay_s = 0.3"));
  EXPECT_TRUE(Hears(rows, 49, 1));
  for (const std::int64_t tick : {50, 79}) EXPECT_FALSE(Hears(rows, tick, 1)) << tick;
  for (const std::int64_t tick : {80, 120}) EXPECT_TRUE(Hears(rows, tick, 1)) << tick;
}

TEST(FaultyLink, ThatSendsGarbageIsOffByUpToItsOffset) {
  const auto truth = Fly(TwoAgents());
  const auto rows = Fly(TwoAgents() + FaultEvent("agent = 2, of = 'link', kind = 'garbage', offset_m = [2, 0, 0]"));
  const Eigen::Vector3d more = CommandAt(rows, 50, 1).a_law_W - CommandAt(truth, 50, 1).a_law_W;
  EXPECT_NE(more.x(), 0);
  EXPECT_LE(std::abs(more.x()), 1);
  EXPECT_LT(std::abs(more.y()), 1e-12);
}

// --- what is measured -------------------------------------------------------------------------------

/// What agent 1 measures of its own position at a tick, from what its law wants: u = gain (p_2 - p_1) - beta v with
/// agent 2 at rest, far away, and deaf.
constexpr const char* kMeasures =
    "[run]\nduration_s = 2.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\nvelocity_m_per_s = [[1, 0, 0]]\n[law]\n"
    "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n"
    "  return 1e-3 * me.position[0], 1e-3 * me.velocity[0]\n'''\n";

/// Position and velocity, along x, that the agent measures at a tick.
Eigen::Vector2d MeasuredAt(const std::vector<DecodedRow>& rows, std::int64_t tick) {
  return 1e3 * CommandAt(rows, tick, 1).a_law_W.head<2>();
}

std::vector<DecodedRow> FlyMeasuring(const std::string& fault) {
  return Fly(kMeasures + FaultEvent("agent = 1, of = 'sensor', " + fault));
}

TEST(FaultySensor, ThatIsOffLeavesDeadReckoning) {
  const auto rows = FlyMeasuring("kind = 'off'");
  const Eigen::Vector2d last = MeasuredAt(rows, 49);
  for (const std::int64_t tick : {50, 150})
    EXPECT_LT(
        (MeasuredAt(rows, tick) - Eigen::Vector2d(last.x() + static_cast<double>(tick - 49) / 100 * last.y(), last.y()))
            .norm(),
        1e-9);
}

TEST(FaultySensor, ThatIsStuckRepeatsTheLastReading) {
  const auto rows = FlyMeasuring("kind = 'stuck'");
  for (const std::int64_t tick : {50, 200}) EXPECT_LT((MeasuredAt(rows, tick) - MeasuredAt(rows, 49)).norm(), 1e-12);
}

TEST(FaultySensor, ThatIsWrongIsOffByItsOffset) {
  const auto rows = FlyMeasuring("kind = 'wrong', offset_m = [7, 0, 0]");
  EXPECT_NEAR(MeasuredAt(rows, 49).x(), P(rows, 49, 1).x(), 1e-12);
  for (const std::int64_t tick : {50, 200}) EXPECT_NEAR(MeasuredAt(rows, tick).x(), P(rows, tick, 1).x() + 7, 1e-9);
}

TEST(FaultySensor, ThatMeasuresGarbageIsOffByUpToItsOffset) {
  const auto rows = FlyMeasuring("kind = 'garbage', offset_m = [3, 0, 0]");
  double largest = 0;
  for (std::int64_t tick = 50; tick <= 200; ++tick) {
    const double off = std::abs(MeasuredAt(rows, tick).x() - P(rows, tick, 1).x());
    EXPECT_LE(off, 3);
    largest = std::max(largest, off);
  }
  EXPECT_GT(largest, 2.5);
}

TEST(FaultySensor, ThatIsSlowKeepsWhatItHasMeasured) {
  const auto rows = FlyMeasuring("kind = 'slow', period_s = 0.25");
  for (const std::int64_t tick : {50, 74, 75, 99, 100})
    EXPECT_NEAR(MeasuredAt(rows, tick).x(), P(rows, 50 + (tick - 50) / 25 * 25, 1).x(), 1e-9) << tick;
}

TEST(FaultySensor, ThatIsDelayedMeasuresThePast) {
  const auto rows = FlyMeasuring("kind = 'delayed', delay_s = 0.3");
  for (const std::int64_t tick : {50, 60, 80, 81, 150})
    EXPECT_NEAR(MeasuredAt(rows, tick).x(), P(rows, std::max<std::int64_t>(50, tick - 30), 1).x(), 1e-9) << tick;
}

TEST(FaultySensor, ThatIsIntermittentKeepsReadingsNowAndThen) {
  const auto rows = FlyMeasuring("kind = 'intermittent', probability = 0.4");
  int kept = 0;
  for (std::int64_t tick = 50; tick <= 200; ++tick) {
    const double measured = MeasuredAt(rows, tick).x();
    if (std::abs(measured - P(rows, tick, 1).x()) < 1e-12) continue;
    EXPECT_NEAR(measured, MeasuredAt(rows, tick - 1).x(), 1e-9);
    ++kept;
  }
  EXPECT_NEAR(kept, 60, 20);
}

// --- what is driven ---------------------------------------------------------------------------------

/// A double integrator that wants 1 m/s^2 and then 2 m/s^2 along x; motor 1 is the force along x.
std::vector<DecodedRow> FlyDriven(const std::string& fault) {
  return Fly(
      "[run]\nduration_s = 2.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\n[law]\nname = 'custom'\n"
      "python = '''\ndef control(t, me, neighbours):\n  return (1 if t < 0.495 else 2), 0.5\n'''\n" +
      FaultEvent("agent = 1, of = 'motor', " + fault));
}

/// The acceleration along x from a tick to the next.
double Driven(const std::vector<DecodedRow>& rows, std::int64_t tick) {
  return 100 * (V(rows, tick + 1, 1) - V(rows, tick, 1)).x();
}

TEST(FaultyMotor, CarriesOutWhatItsKindSays) {
  const auto driven = [](const std::string& fault, std::int64_t tick) { return Driven(FlyDriven(fault), tick); };
  for (const std::int64_t tick : {50, 90, 150}) {
    EXPECT_NEAR(driven("kind = 'off', motor = 1", tick), 0, 1e-9);
    EXPECT_NEAR(driven("kind = 'stuck', motor = 1", tick), 1, 1e-9);
    EXPECT_NEAR(driven("kind = 'wrong', motor = 1, remaining = 0.25", tick), 0.5, 1e-9);
    EXPECT_NEAR(driven("kind = 'off', motor = 2", tick), 2, 1e-9) << "another motor";
    EXPECT_NEAR(driven("kind = 'off'", tick), 0, 1e-9) << "all motors";
  }
  EXPECT_NEAR(driven("kind = 'delayed', motor = 1, delay_s = 0.4", 89), 1, 1e-9);
  EXPECT_NEAR(driven("kind = 'delayed', motor = 1, delay_s = 0.4", 90), 2, 1e-9);
  EXPECT_NEAR(driven("kind = 'off', motor = 1", 49), 1, 1e-9);
}

TEST(FaultyMotor, ThatIsSlowTakesACommandNowAndThen) {
  const std::string law =
      "[run]\nduration_s = 2.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\n[law]\nname = 'custom'\n"
      "python = '''\ndef control(t, me, neighbours):\n  return t, 0\n'''\n";
  const auto rows = Fly(law + FaultEvent("agent = 1, of = 'motor', kind = 'slow', period_s = 0.3"));
  for (const auto& [tick, taken_at_s] : {std::pair{50, 0.5}, {79, 0.5}, {80, 0.8}, {109, 0.8}, {110, 1.1}})
    EXPECT_NEAR(Driven(rows, tick), taken_at_s, 1e-9) << tick;
}

TEST(FaultyMotor, ThatIsIntermittentOrGarbageIsDrawn) {
  const auto intermittent = FlyDriven("kind = 'intermittent', motor = 1, probability = 0.3");
  const auto garbage = FlyDriven("kind = 'garbage', motor = 1");
  int off = 0;
  double least = 4, most = 0;
  for (std::int64_t tick = 50; tick < 200; ++tick) {
    off += std::abs(Driven(intermittent, tick)) < 1e-9;
    least = std::min(least, Driven(garbage, tick));
    most = std::max(most, Driven(garbage, tick));
  }
  EXPECT_NEAR(off, 45, 18);
  EXPECT_GE(least, -1e-9);
  EXPECT_LT(least, 0.5);
  EXPECT_LE(most, 4);
  EXPECT_GT(most, 3.5);
}

// A rotor that stops lets the quadrotor fall on that side, whatever it commands.
TEST(FaultyMotor, OfAQuadrotorIsOneRotor) {
  const std::string hover =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nposition_m = [[0, 0, 5]]\n[law]\nname = 'waypoint'\n"
      "waypoints_m = [[0, 0, 5]]\n";
  const auto rows = Fly(hover + FaultEvent("agent = 1, of = 'motor', kind = 'off', motor = 1"));
  EXPECT_NEAR(P(rows, 50, 1).z(), 5, 1e-3);
  EXPECT_LT(P(rows, 100, 1).z(), 4.8);
  EXPECT_GT(CommandAt(rows, 51, 1).actuator[0], 0) << "it is commanded all the same";
}

}  // namespace
}  // namespace mascot
