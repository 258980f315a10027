// Agents whose law takes actions: a program steps the run, and what it gives is recorded.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "orchestrator/engines/flight.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/recording/compare.h"
#include "orchestrator/recording/recorded_actions.h"
#include "orchestrator/recording/recording.h"
#include "tests/support/load.h"
#include "tests/support/recorded_with_actions.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// Two double integrators at 100 Hz; agent 1 hears agent 2.
std::string Stepped(const std::string& law = "name = 'actions'\n", const std::string& more = "") {
  return "[run]\nname = 'stepped'\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
         "position_m = [[0, 0, 1], [0, 3, 1]]\n[graph]\nedges = [[1, 2]]\n[law]\n" +
         law + more;
}

void Go(Flight& flight, int ticks) {
  for (int k = 0; k < ticks; ++k) {
    flight.Exchange();
    flight.Step();
  }
}

TEST(Actions, AreTheAccelerationsOfTheirAgentsUntilTheNext) {
  const Experiment experiment = Load(Stepped());
  Flight flight(experiment);
  flight.Sense();
  flight.Act(1, std::vector{2.0, 1.0, 0.0});
  Go(flight, 10);
  const Motion first = flight.Sense().motions[0];
  EXPECT_NEAR(first.v_WB.x(), 0.2, 1e-9);
  EXPECT_NEAR(first.v_WB.y(), 0.1, 1e-9);
  EXPECT_EQ(flight.Sense().motions[1].v_WB, Eigen::Vector3d::Zero()) << "no action is 0";
  flight.Act(1, std::vector{0.0, 0.0, 0.0});
  Go(flight, 10);
  EXPECT_NEAR(flight.Sense().motions[0].v_WB.x(), 0.2, 1e-9);
}

TEST(Actions, MayBeVelocities) {
  const Experiment experiment = Load(Stepped("name = 'actions'\noutput = 'velocity'\n"));
  Flight flight(experiment);
  flight.Sense();
  flight.Act(1, std::vector{0.5, 0.0, 0.0});
  const DecodedRow& row = flight.Exchange();
  const double k_v = experiment.agent(1).control.velocity_gain;
  EXPECT_NEAR(row.commands[0].a_law_W.x(), k_v * 0.5, 1e-12);
}

TEST(Actions, AreBoundByTheLimitsOfTheAgent) {
  const Experiment experiment = Load(Stepped());
  Flight flight(experiment);
  flight.Sense();
  flight.Act(2, std::vector{100.0, 0.0, 0.0});
  const Command& command = flight.Exchange().commands[1];
  EXPECT_EQ(command.a_limited_W.x(), experiment.agent(2).control.max_acceleration_m_per_s2);
  EXPECT_EQ(command.flags, kAccelerationLimited);
}

TEST(Actions, HaveTheMessageBehindWhatIsWanted) {
  const Experiment experiment = Load(Stepped("name = 'actions'\nmessage = 2\n"));
  Flight flight(experiment);
  flight.Sense();
  flight.Act(2, std::vector{0.0, 0.0, 0.0, 7.0, 8.0});
  EXPECT_THAT(flight.Exchange().messages[1], ElementsAre(7.0, 8.0));
  flight.Step();
  flight.Sense();
  ASSERT_EQ(flight.agent(1).heard().size(), 1U);
  EXPECT_THAT(flight.agent(1).heard()[0].message, ElementsAre(7.0, 8.0));
  EXPECT_THAT(flight.agent(2).heard(), IsEmpty());
}

TEST(Actions, OfAnotherSizeAreRefused) {
  const Experiment mixed =
      Load(Stepped("name = 'consensus'\n", "[[agents.override]]\nid = 2\nlaw = {name = 'actions'}\n"));
  Flight flight(mixed);
  flight.Sense();
  EXPECT_THAT(
      [&] {
        flight.Act(2, std::vector{1.0, 2.0});
      },
      ThrowsMessage<std::invalid_argument>("agent 2: expected an action of 3 numbers, got 2"));
  EXPECT_THAT(
      [&] {
        flight.Act(1, std::vector{1.0, 2.0, 3.0});
      },
      ThrowsMessage<std::invalid_argument>("agent 1: expected an action of 0 numbers, got 3"));
}

TEST(Actions, ThatAreNotFiniteFailTheLaw) {
  const Experiment experiment = Load(Stepped());
  Flight flight(experiment);
  flight.Sense();
  flight.Act(1, std::vector{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_THAT([&] { flight.Exchange(); },
              ThrowsMessage<std::runtime_error>("tick 0: agent 1: the law's acceleration is not finite (nan, 0, 0)"));
}

TEST(Actions, AreHeldByALawThatBeginsAnewAndAreZeroAfterAnother) {
  const Experiment experiment = Load(Stepped("name = 'actions'\n",
                                             "[[law.schedule]]\nat_s = 0.05\nname = 'consensus'\n"
                                             "[[law.schedule]]\nat_s = 0.1\nname = 'actions'\n"
                                             "[[events]]\nat_s = 0.03\nrestart = 1\n"));
  Flight flight(experiment);
  flight.Sense();
  flight.Act(1, std::vector{1.0, 0.0, 0.0});
  Go(flight, 3);
  EXPECT_EQ(flight.Exchange().commands[0].a_law_W.x(), 1.0) << "after its restart";
  flight.Step();
  Go(flight, 1);
  flight.Sense();
  EXPECT_THAT(
      [&] {
        flight.Act(1, std::vector{1.0, 0.0, 0.0});
      },
      ThrowsMessage<std::invalid_argument>("agent 1: expected an action of 0 numbers, got 3"));
  EXPECT_THAT(flight.Exchange().actions[0], IsEmpty());
  flight.Step();
  Go(flight, 4);
  EXPECT_THAT(flight.Exchange().actions[0], ElementsAre(0.0, 0.0, 0.0));
}

TEST(Actions, SeeWhatAgentsMeasureAndHearWithNoise) {
  const Experiment experiment = Load(Stepped("name = 'actions'\n", "[sensors.own]\nposition_std_m = 0.1\n"));
  Flight flight(experiment);
  const Eigen::Vector3d p_W = flight.Sense().motions[0].p_WB;
  EXPECT_NE(flight.agent(1).measured().p_WB, p_W);
  EXPECT_LT((flight.agent(1).measured().p_WB - p_W).norm(), 1);
}

// --- recordings ---------------------------------------------------------------------------------------

/// How the run with these actions differs from the recording; empty: it does not.
std::string DifferenceOf(const std::string& recording, const Experiment& experiment, ActionSource& actions) {
  const McapContents contents = ReadRecording(recording);
  const RecordingPlan plan = PlanOf(contents, recording);
  Comparison comparison(recording, plan, TicksIn(contents, plan), experiment);
  RunInProcess(
      experiment, {&comparison}, [] { return true; }, nullptr, Crew::Alone(), [](const std::string&) {}, &actions);
  comparison.Finish();
  return comparison.difference();
}

TEST(RecordedActions, FlyTheRunAgainBitForBit) {
  const ScratchFolder scratch;
  const std::string recording = RecordedWithActions(Stepped(), scratch.File("run"));
  EXPECT_EQ(Judge(recording, ReadRecording(recording)).reason, "");
  const Experiment experiment = Load(Stepped());
  RecordedActions actions(recording, PlanOf(ReadRecording(recording), recording), experiment);
  EXPECT_EQ(DifferenceOf(recording, experiment, actions), "");
}

TEST(RecordedActions, AreComparedThemselves) {
  const ScratchFolder scratch;
  const std::string recording = RecordedWithActions(Stepped(), scratch.File("run"));
  Waves others(2);
  EXPECT_EQ(DifferenceOf(recording, Load(Stepped()), others),
            "/agent_2/action at tick 0 (t = 0 s): data[1] is 1 in the recording, 2 flown");
}

TEST(RecordedActions, MustBeThereForEveryTick) {
  const ScratchFolder scratch;
  const std::string toml = Stepped("name = 'actions'\n", "[record]\nrate_hz = 10\n");
  const std::string recording = RecordedWithActions(toml, scratch.File("run"));
  EXPECT_THAT([&] { RecordedActions(recording, PlanOf(ReadRecording(recording), recording), Load(toml)); },
              ThrowsMessage<ConfigError>(recording + ": expected a recording of every tick, of agents that are told "
                                                     "what to do, got one of every 10 ticks (record.rate_hz)"));
}

TEST(RecordedActions, MustBeRecorded) {
  const ScratchFolder scratch;
  const std::string toml = Stepped("name = 'actions'\n", "[record]\ntopics = ['/clock', '*/state']\n");
  const std::string recording = RecordedWithActions(toml, scratch.File("run"));
  EXPECT_THAT([&] { RecordedActions(recording, PlanOf(ReadRecording(recording), recording), Load(toml)); },
              ThrowsMessage<ConfigError>(recording + ": holds no /agent_1/action, which says what its agent did: "
                                                     "record.topics left it out"));
}

TEST(RecordedActions, EndWithTheRecording) {
  const ScratchFolder scratch;
  const std::string recording = RecordedWithActions(Stepped(), scratch.File("run"));
  const Experiment experiment = Load(Stepped());
  RecordedActions actions(recording, PlanOf(ReadRecording(recording), recording), experiment);
  EXPECT_THAT(actions.At(50)[1], ElementsAre(std::sin(5.0), 1.0, 0.0));
  EXPECT_THAT([&] { actions.At(51); }, ThrowsMessage<std::runtime_error>(recording + ": has no actions of tick 51"));
}

TEST(Commands, ThatGiveNoActionsRefuseLawsThatTakeThem) {
  EXPECT_THAT([] { RefuseActions(Load(Stepped())); },
              ThrowsMessage<ConfigError>("law.name: expected laws that decide by themselves, got one of agent 1 that "
                                         "takes actions: a program that steps the run gives them, this command does "
                                         "not"));
  EXPECT_NO_THROW(RefuseActions(Load(Stepped("name = 'consensus'\n"))));
}

}  // namespace
}  // namespace mascot
