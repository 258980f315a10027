// What survives when agents are lost, are not heard, hear nobody or lie.
#include "orchestrator/theory/survival.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "orchestrator/report/survival_report.h"
#include "orchestrator/theory/loss_tolerance.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kConsensus = "[law]\nname = 'consensus'\n";
constexpr const char* kLed = "[law]\nname = 'consensus'\nleader = 1\n";

/// Agents that fly for 20 s at 100 Hz, and keep on if some are lost.
std::string TeamOf(int count, const std::string& graph, const std::string& law, const std::string& rest = "",
                   const std::string& run = "on_agent_loss = 'hold'\n") {
  std::string places;
  for (int id = 1; id <= count; ++id) places += fmt::format("{}[{}, 0, 1]", id > 1 ? ", " : "", 2 * id);
  return "[run]\nduration_s = 20.0\n" + run + fmt::format("[agents]\ncount = {}\n", count) +
         "model = 'double_integrator'\nposition_m = [" + places + "]\n[graph]\n" + graph + law + rest;
}

std::string Topology(const std::string& name) { return "topology = '" + name + "'\n"; }

std::string EventAt(const std::string& at_s, const std::string& what) {
  return "[[events]]\nat_s = " + at_s + "\n" + what + "\n";
}
std::string FaultAt(const std::string& at_s, int agent, const std::string& kind, const std::string& more = "") {
  return EventAt(at_s, fmt::format("fault = {{ agent = {}, kind = '{}'{} }}", agent, kind, more));
}

std::vector<Survival> MomentsOf(const std::string& toml) { return SurvivalOf(Load(toml)).moments; }

std::vector<std::string> WordsOf(const std::string& toml) {
  const Experiment experiment = Load(toml);
  std::vector<std::string> lines;
  for (const auto& [label, text] : SurvivalLines(experiment, SurvivalOf(experiment))) {
    EXPECT_EQ(label, "faults");
    lines.push_back(text);
  }
  return lines;
}

std::vector<int> CannotLose(const std::string& toml) {
  const auto tolerance = LossToleranceOf(Load(toml));
  EXPECT_TRUE(tolerance && tolerance->is_known);
  return tolerance ? tolerance->cannot_lose : std::vector<int>{-1};
}
std::string ToleranceWords(const std::string& toml) {
  const auto tolerance = LossToleranceOf(Load(toml));
  return tolerance ? tolerance->words : "nothing";
}

// --- losses ---------------------------------------------------------------------------------------------

TEST(Survival, OfACompleteGraphIsASpanningTreeWhoeverIsLost) {
  EXPECT_THAT(WordsOf(TeamOf(4, Topology("complete"), kConsensus, FaultAt("2.0", 3, "kill"))),
              ElementsAre("from 2 s agent 3 is lost: the others have a spanning tree"));
  const auto moments =
      MomentsOf(TeamOf(4, Topology("complete"), kConsensus, FaultAt("2.0", 3, "kill") + FaultAt("3.0", 1, "hang")));
  ASSERT_THAT(moments, SizeIs(2));
  EXPECT_EQ(moments[1].from, 300);
  EXPECT_THAT(moments[1].lost, ElementsAre(1, 3));
  EXPECT_EQ(moments[1].spanning_tree, true);
  EXPECT_THAT(moments[1].cut_off, IsEmpty());
  EXPECT_FALSE(moments[1].robustness) << "nobody lies";
}

TEST(Survival, OfAPathEndsWhereItIsBroken) {
  const std::string path = TeamOf(5, Topology("path"), kConsensus);
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 2, "kill")),
              ElementsAre("from 2 s agent 2 is lost: no spanning tree: agent 1 is cut off from agents 3, 4 and 5"));
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 5, "kill")),
              ElementsAre("from 2 s agent 5 is lost: the others have a spanning tree"));
  EXPECT_THAT(MomentsOf(path + FaultAt("2.0", 4, "kill")),
              ElementsAre(AllOf(Field(&Survival::spanning_tree, std::optional(false)),
                                Field(&Survival::cut_off, ElementsAre(5)))));
}

TEST(Survival, OfAStarWithoutItsHubIsNothing) {
  EXPECT_THAT(WordsOf(TeamOf(4, Topology("star"), kConsensus, FaultAt("2.0", 1, "kill"))),
              ElementsAre("from 2 s agent 1 is lost: nobody hears anybody"));
}

TEST(Survival, KnowsThatTheLastOnesAreAlone) {
  const std::string two = TeamOf(2, Topology("complete"), kConsensus, FaultAt("2.0", 1, "kill"));
  EXPECT_THAT(
      WordsOf(two + FaultAt("3.0", 2, "kill")),
      ElementsAre("from 2 s agent 1 is lost: agent 2 is alone", "from 3 s agents 1 and 2 are lost: nobody is left"));
}

TEST(Survival, NamesALeaderThatIsLostAndThoseThatAreCutOffFromOne) {
  const std::string path = TeamOf(4, Topology("path"), kLed);
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 1, "kill")),
              ElementsAre("from 2 s agent 1 is lost: nobody leads the others"));
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 2, "kill")),
              ElementsAre("from 2 s agent 2 is lost: no spanning tree: agents 3 and 4 are cut off from leader 1"));
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 4, "kill")),
              ElementsAre("from 2 s agent 4 is lost: the others have a spanning tree from leader 1"));
}

TEST(Survival, OfALawThatPursuesOneParentIsThatOfItsTree) {
  const std::string law = "[law]\nname = 'minmax'\nleader = 1\nbeta = [1.0, 2.0, 3.0]\n";
  // In the complete graph all pursue the leader; in the path each the one before it.
  EXPECT_THAT(MomentsOf(TeamOf(3, Topology("complete"), law, FaultAt("2.0", 2, "kill"))),
              ElementsAre(Field(&Survival::spanning_tree, std::optional(true))));
  // 3 hears 1 by way of 2 only, though it hears 4, which hears 1.
  const std::string edges = "edges = [[2, 1], [4, 1], [3, 2], [3, 4]]\n";
  const std::string four = "[law]\nname = 'minmax'\nleader = 1\nbeta = [1.0, 2.0, 3.0, 2.0]\n";
  EXPECT_THAT(MomentsOf(TeamOf(4, edges, four, FaultAt("2.0", 2, "kill"))),
              ElementsAre(AllOf(Field(&Survival::spanning_tree, std::optional(false)),
                                Field(&Survival::cut_off, ElementsAre(3)))));
  EXPECT_THAT(MomentsOf(TeamOf(4, edges, kLed, FaultAt("2.0", 2, "kill"))),
              ElementsAre(Field(&Survival::spanning_tree, std::optional(true))))
      << "a law that listens to all has another way";
}

TEST(Survival, OfFollowersIsThatTheyHearALeader) {
  const std::string graph = "edges = [[3, 1], [4, 2], [4, 3]]\n";
  const std::string law = "[law]\nname = 'containment'\nleaders = [1, 2]\n";
  EXPECT_THAT(WordsOf(TeamOf(4, graph, law, FaultAt("2.0", 2, "kill"))),
              ElementsAre("from 2 s agent 2 is lost: the others hear a leader, directly or not"));
  EXPECT_THAT(WordsOf(TeamOf(4, graph, law, FaultAt("2.0", 1, "kill"))),
              ElementsAre("from 2 s agent 1 is lost: no spanning tree: agent 3 is cut off from any leader"));
  EXPECT_THAT(WordsOf(TeamOf(4, graph, law, FaultAt("2.0", 1, "kill") + FaultAt("2.0", 2, "kill"))),
              ElementsAre("from 2 s agents 1 and 2 are lost: nobody leads the others"));
}

TEST(Survival, KnowsWhoListensToNobodyByItsOwnLaw) {
  const std::string own = "[[agents.override]]\nid = 3\nlaw = { name = 'waypoint', waypoints_m = [[1, 1, 1]] }\n";
  EXPECT_THAT(MomentsOf(TeamOf(4, Topology("path"), kConsensus, own + FaultAt("2.0", 1, "kill"))),
              ElementsAre(Field(&Survival::spanning_tree, std::optional(true))))
      << "the others follow it";
  EXPECT_THAT(MomentsOf(TeamOf(5, Topology("ring"), kConsensus,
                               own + EventAt("1.0", "cut = [[4, 3]]") + FaultAt("2.0", 1, "kill"))),
              ElementsAre(AllOf(Field(&Survival::spanning_tree, std::optional(false)),
                                Field(&Survival::cut_off, ElementsAre(4, 5)))));
}

TEST(Survival, SaysNothingOfTreesToLawsThatNeedNone) {
  const auto lost = [](const std::string& law) {
    return WordsOf(TeamOf(3, Topology("path"), law, FaultAt("2.0", 2, "kill")));
  };
  EXPECT_THAT(lost("[law]\nname = 'flocking'\n"), ElementsAre("from 2 s agent 2 is lost"));
  EXPECT_THAT(MomentsOf(TeamOf(3, Topology("path"), "[law]\nname = 'flocking'\n", FaultAt("2.0", 2, "kill"))),
              ElementsAre(Field(&Survival::spanning_tree, std::nullopt)));
}

// --- restarts and ends ----------------------------------------------------------------------------------

TEST(Survival, EndsWithTheRestartThatALossBrings) {
  const std::string run = "on_agent_loss = 'restart'\nrestart_after_s = 1.5\n";
  const std::string path = TeamOf(3, Topology("path"), kConsensus, FaultAt("2.0", 2, "kill"), run);
  EXPECT_THAT(WordsOf(path), ElementsAre("from 2 s agent 2 is lost: nobody hears anybody",
                                         "from 3.5 s no agent is lost, unheard or deaf, and none lies"));
  EXPECT_THAT(MomentsOf(path + FaultAt("3.0", 2, "kill") + EventAt("3.2", "restart = 2")),
              ElementsAre(Field(&Survival::from, 200), Field(&Survival::from, 320)))
      << "who is lost already is not lost again, and comes back once";
  EXPECT_THAT(MomentsOf(path + FaultAt("10.0", 1, "kill")),
              ElementsAre(Field(&Survival::from, 200), Field(&Survival::from, 350), Field(&Survival::from, 1000),
                          Field(&Survival::from, 1150)));
}

TEST(Survival, EndsWithTheRunThatALossEnds) {
  const std::string team = TeamOf(3, Topology("path"), kConsensus, FaultAt("2.0", 2, "kill"), "");
  EXPECT_THAT(WordsOf(team + FaultAt("3.0", 1, "mute")),
              ElementsAre("from 2 s agent 2 is lost: the run ends (run.on_agent_loss = \"abort\")"));
  EXPECT_THAT(MomentsOf(team), ElementsAre(Field(&Survival::ends_run, true)));
}

TEST(Survival, OfAProcessThatAnsweredNothingBeforeIsTheSame) {
  EXPECT_THAT(MomentsOf(TeamOf(3, Topology("path"), kConsensus, FaultAt("2.0", 1, "kill", ", unanswered = true"))),
              ElementsAre(Field(&Survival::lost, ElementsAre(1))));
}

// --- who is not heard, and who hears nobody -------------------------------------------------------------

TEST(Survival, KnowsWhoIsNotHeardAndWhoHearsNobody) {
  const std::string path = TeamOf(3, Topology("path"), kConsensus);
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 2, "mute")),
              ElementsAre("from 2 s agent 2 is not heard: no spanning tree: agent 3 is cut off from agents 1 and 2"));
  EXPECT_THAT(WordsOf(path + FaultAt("2.0", 2, "deaf")),
              ElementsAre("from 2 s agent 2 is deaf: all have a spanning tree"))
      << "it leads the others";
  EXPECT_THAT(
      WordsOf(path + FaultAt("2.0", 2, "deaf") + FaultAt("3.0", 3, "deaf")),
      ElementsAre("from 2 s agent 2 is deaf: all have a spanning tree",
                  "from 3 s agents 2 and 3 are deaf: no spanning tree: agent 3 is cut off from agents 1 and 2"));
}

TEST(Survival, TakesALinkThatSendsNothingForSilence) {
  const std::string path = TeamOf(3, Topology("path"), kConsensus);
  EXPECT_THAT(MomentsOf(path + FaultAt("2.0", 1, "off", ", of = 'link'")),
              ElementsAre(Field(&Survival::unheard, ElementsAre(1))));
  EXPECT_THAT(MomentsOf(path + FaultAt("2.0", 1, "intermittent", ", of = 'link', probability = 1.0")),
              ElementsAre(Field(&Survival::unheard, ElementsAre(1))));
  for (const char* harmless : {"'slow'", "'delayed'", "'intermittent'"})
    EXPECT_THAT(
        MomentsOf(path + EventAt("2.0", fmt::format("fault = {{ agent = 1, of = 'link', kind = {} }}", harmless))),
        IsEmpty())
        << harmless;
  EXPECT_THAT(MomentsOf(path + FaultAt("2.0", 1, "off", ", of = 'motor'")), IsEmpty());
}

TEST(Survival, EndsWithTheFault) {
  EXPECT_THAT(WordsOf(TeamOf(3, Topology("complete"), kConsensus,
                             FaultAt("2.0", 1, "mute") + FaultAt("3.0", 2, "deaf") + FaultAt("4.0", 1, "ok") +
                                 FaultAt("5.0", 2, "ok"))),
              ElementsAre("from 2 s agent 1 is not heard: all have a spanning tree",
                          "from 3 s agent 1 is not heard, agent 2 is deaf: all have a spanning tree",
                          "from 4 s agent 2 is deaf: all have a spanning tree",
                          "from 5 s no agent is lost, unheard or deaf, and none lies"));
}

// --- the graph over time --------------------------------------------------------------------------------

TEST(Survival, ChangesWithEdgesThatEventsCutAndMend) {
  const std::string ring = TeamOf(4, Topology("ring"), kConsensus, FaultAt("2.0", 1, "kill"));
  EXPECT_THAT(WordsOf(ring + EventAt("3.0", "cut = [[3, 2], [2, 3]]") + EventAt("4.0", "mend = [[3, 2]]")),
              ElementsAre("from 2 s agent 1 is lost: the others have a spanning tree",
                          "from 3 s agent 1 is lost: no spanning tree: agent 2 is cut off from agents 3 and 4",
                          "from 4 s agent 1 is lost: the others have a spanning tree"));
  EXPECT_THAT(WordsOf(TeamOf(4, Topology("ring"), kConsensus,
                             EventAt("1.0", "cut = [[3, 2], [2, 3]]") + FaultAt("2.0", 1, "kill"))),
              ElementsAre("from 2 s agent 1 is lost: no spanning tree: agent 2 is cut off from agents 3 and 4"));
}

TEST(Survival, TakesTheUnionOfAScheduleThatRepeats) {
  const std::string phases =
      "edges = [[1, 2], [2, 1]]\n{}[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3], [3, 2], [3, 4], [4, 3]]\n";
  EXPECT_THAT(
      WordsOf(TeamOf(4, fmt::format(fmt::runtime(phases), "repeat_s = 1.0\n"), kConsensus, FaultAt("2.0", 4, "kill"))),
      ElementsAre("from 2 s agent 4 is lost: the others have a spanning tree"));
  EXPECT_THAT(WordsOf(TeamOf(4, fmt::format(fmt::runtime(phases), ""), kConsensus, FaultAt("0.2", 4, "kill"))),
              ElementsAre("from 0.2 s agent 4 is lost: no spanning tree: agent 3 is cut off from agents 1 and 2",
                          "from 0.5 s agent 4 is lost: no spanning tree: agent 1 is cut off from agents 2 and 3"));
}

TEST(Survival, LeavesOutEdgesThatDeliverNothing) {
  const std::string path = TeamOf(4, Topology("complete"), kConsensus, FaultAt("2.0", 4, "kill"));
  EXPECT_THAT(WordsOf(path + EventAt("3.0", "set = { \"link.loss\" = 1.0 }")),
              ElementsAre("from 2 s agent 4 is lost: the others have a spanning tree",
                          "from 3 s agent 4 is lost: nobody hears anybody"));
}

TEST(Survival, CountsOnlyAgentsWhoseLawIsOn) {
  const std::string fault = FaultAt("2.0", 4, "kill");
  const std::string path =
      TeamOf(4, Topology("path"), kConsensus, "[[agents.override]]\nid = 2\nstop_s = 5.0\n" + fault);
  EXPECT_THAT(WordsOf(path), ElementsAre("from 2 s agent 4 is lost: the others have a spanning tree",
                                         "from 5 s agent 4 is lost: nobody hears anybody"));
}

TEST(Survival, SaysThatItHoldsWithinRange) {
  EXPECT_THAT(WordsOf(TeamOf(4, Topology("complete") + "range_m = 30.0\n", kConsensus, FaultAt("2.0", 4, "kill"))),
              ElementsAre("from 2 s agent 4 is lost: the others have a spanning tree, while they are in range"));
}

// --- liars ----------------------------------------------------------------------------------------------

TEST(Survival, HoldsLiarsAgainstTheRobustnessOfTheGraph) {
  // A complete graph of n agents is ceil(n / 2)-robust (LeBlanc et al. 2013).
  const std::string lie = FaultAt("2.0", 1, "lie") + FaultAt("3.0", 2, "lie");
  const auto moments = MomentsOf(TeamOf(6, Topology("complete"), kConsensus, lie));
  ASSERT_THAT(moments, SizeIs(2));
  EXPECT_THAT(moments[1].liars, ElementsAre(1, 2));
  EXPECT_EQ(moments[1].robustness, 3);
  EXPECT_EQ(moments[1].liars_tolerated, 1);
  EXPECT_EQ(moments[1].liars_heard, 2);
  EXPECT_EQ(moments[1].spanning_tree, true);
  EXPECT_THAT(MomentsOf(TeamOf(7, Topology("complete"), kConsensus, lie)).front().robustness, 4);
  EXPECT_THAT(MomentsOf(TeamOf(9, Topology("complete"), kConsensus, lie)).front().liars_tolerated, 2);
  const Survival ring = MomentsOf(TeamOf(6, Topology("ring"), kConsensus, lie)).front();
  EXPECT_EQ(ring.robustness, 1);
  EXPECT_EQ(ring.liars_tolerated, 0);
}

TEST(Survival, TakesTheRobustnessOfThoseThatAreNotLost) {
  const auto moments =
      MomentsOf(TeamOf(5, Topology("complete"), kConsensus, FaultAt("2.0", 1, "lie") + FaultAt("3.0", 2, "kill")));
  ASSERT_THAT(moments, SizeIs(2));
  EXPECT_EQ(moments[0].robustness, 3);
  EXPECT_EQ(moments[1].robustness, 2);
}

TEST(Survival, SaysWhetherTheLawLeavesOutEnough) {
  const auto words = [](int count, const std::string& f, const std::string& faults) {
    return WordsOf(TeamOf(count, Topology("complete"), "[law]\nname = 'resilient'\nf = " + f + "\n", faults));
  };
  const std::string one = FaultAt("2.0", 1, "lie"), two = one + FaultAt("2.0", 2, "lie");
  EXPECT_THAT(words(5, "1", one),
              ElementsAre("from 2 s agent 1 lies: the graph is 3-robust, so that those who tell the truth agree"));
  EXPECT_THAT(words(5, "1", two), ElementsAre("from 2 s agents 1 and 2 lie: law resilient leaves out 1 of those that "
                                              "lie, and an agent hears 2"));
  EXPECT_THAT(words(5, "2", one), ElementsAre("from 2 s agent 1 lies: the graph is 3-robust; those who tell the truth "
                                              "surely agree from 5 on"));
  EXPECT_THAT(words(17, "1", one), ElementsAre("from 2 s agent 1 lies: the robustness of the graph is not computed "
                                               "beyond 16 agents"));
  EXPECT_THAT(WordsOf(TeamOf(5, Topology("complete"), kConsensus, one)),
              ElementsAre("from 2 s agent 1 lies: law consensus leaves nothing out; the graph is 3-robust, with which "
                          "W-MSR would tolerate 1"));
  EXPECT_THAT(WordsOf(TeamOf(5, Topology("complete"), kConsensus, two)),
              ElementsAre("from 2 s agents 1 and 2 lie: law consensus leaves nothing out; the graph is 3-robust, with "
                          "which W-MSR would tolerate 1, and an agent hears 2"));
  EXPECT_THAT(WordsOf(TeamOf(5, Topology("ring"), kConsensus, one)),
              ElementsAre("from 2 s agent 1 lies: law consensus leaves nothing out; the graph is 1-robust, with which "
                          "W-MSR would tolerate none, and an agent hears 1"));
  EXPECT_THAT(WordsOf(TeamOf(2, "edges = [[1, 2]]\n", kConsensus, one)),
              ElementsAre("from 2 s agent 1 lies: nobody who tells the truth hears it"));
}

TEST(Survival, KnowsLiesOfTheFileFromTheirTimeOn) {
  const std::string own = "[[agents.override]]\nid = 2\nlie = { from_s = 4.0, offset_m = [1, 0, 0] }\n";
  EXPECT_THAT(MomentsOf(TeamOf(4, Topology("complete"), kConsensus, own)),
              ElementsAre(AllOf(Field(&Survival::from, 400), Field(&Survival::liars, ElementsAre(2)))));
  EXPECT_THAT(MomentsOf(TeamOf(4, Topology("complete"), kConsensus, own + FaultAt("6.0", 2, "ok"))),
              ElementsAre(Field(&Survival::from, 400), Field(&Survival::from, 600)));
}

TEST(Survival, TakesForALieWhatFalsifiesWhatOthersHear) {
  const auto liars = [](const std::string& law, const std::string& of, const std::string& kind) {
    const auto moments =
        MomentsOf(TeamOf(4, Topology("complete"), law, FaultAt("2.0", 3, kind, ", of = '" + of + "'")));
    return moments.empty() ? std::vector<int>() : moments.front().liars;
  };
  const std::string messages = "[law]\nname = 'event_triggered'\n";
  for (const char* kind : {"stuck", "garbage", "wrong"}) {
    EXPECT_THAT(liars(kConsensus, "link", kind), ElementsAre(3)) << kind;
    EXPECT_THAT(liars(kConsensus, "sensor", kind), IsEmpty()) << kind << ": others hear where its body is";
    EXPECT_THAT(liars(messages, "sensor", kind), ElementsAre(3)) << kind << ": its messages are of what it measures";
  }
  EXPECT_THAT(liars(messages, "sensor", "off"), ElementsAre(3));
  for (const char* kind : {"slow", "delayed", "intermittent"}) {
    EXPECT_THAT(liars(messages, "link", kind), IsEmpty()) << kind;
    EXPECT_THAT(liars(messages, "sensor", kind), IsEmpty()) << kind;
  }
}

// --- agents that the team cannot lose -------------------------------------------------------------------

TEST(LossTolerance, NamesTheAgentsThatHoldAGraphTogether) {
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("path"), kConsensus)), ElementsAre(2, 3, 4));
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("star"), kConsensus)), ElementsAre(1));
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("ring"), kConsensus)), IsEmpty());
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("complete"), kConsensus)), IsEmpty());
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("path"), kLed)), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(CannotLose(TeamOf(5, Topology("complete"), kLed)), ElementsAre(1));
  // 1 and 2 hear each other and are heard by 3, which 4 hears.
  EXPECT_THAT(CannotLose(TeamOf(4, "edges = [[1, 2], [2, 1], [3, 1], [3, 2], [4, 3]]\n", kConsensus)), ElementsAre(3));
  // In a directed ring the agent behind the lost one is the new root.
  EXPECT_THAT(CannotLose(TeamOf(4, "edges = [[2, 1], [3, 2], [4, 3], [1, 4]]\n", kConsensus)), IsEmpty());
}

TEST(LossTolerance, OfEachAgentIsWhatSurvivalSaysOfItsLoss) {
  for (const std::string law : {kConsensus, kLed})
    for (const std::string graph : {"edges = [[2, 1], [3, 2], [3, 1], [4, 3], [5, 4], [5, 6], [6, 3], [2, 6]]\n",
                                    "random = { kind = 'erdos_renyi', p = 0.5 }\n", "topology = 'star'\n"}) {
      const std::string team = TeamOf(6, graph, law);
      const auto tolerance = LossToleranceOf(Load(team));
      if (!tolerance) continue;
      for (int id = 1; id <= 6; ++id) {
        const auto moments = MomentsOf(team + FaultAt("2.0", id, "kill"));
        ASSERT_THAT(moments, SizeIs(1));
        EXPECT_EQ(std::ranges::count(tolerance->cannot_lose, id), *moments[0].spanning_tree ? 0 : 1) << graph << id;
      }
    }
}

TEST(LossTolerance, IsSaidInWords) {
  EXPECT_EQ(ToleranceWords(TeamOf(5, Topology("ring"), kConsensus)), "any one agent may be lost");
  EXPECT_EQ(ToleranceWords(TeamOf(5, Topology("complete"), kLed)), "any one agent may be lost, but not 1, the leader");
  EXPECT_EQ(ToleranceWords(TeamOf(4, Topology("path"), kConsensus)),
            "without agent 2 or 3 the others have no spanning tree");
  EXPECT_EQ(ToleranceWords(TeamOf(4, Topology("path"), kLed)),
            "without agent 1 (the leader), 2 or 3 the others have no spanning tree");
  EXPECT_EQ(ToleranceWords(TeamOf(8, Topology("path"), kConsensus)),
            "without any of agents 2, 3, 4, 5 and 2 more the others have no spanning tree");
  EXPECT_EQ(ToleranceWords(TeamOf(3, "edges = [[2, 1], [3, 2]]\n", kLed)),
            "without agent 1 (the leader) or 2 the others have no spanning tree");
}

TEST(LossTolerance, SaysNothingWhereItWouldBeOfNoUse) {
  EXPECT_EQ(ToleranceWords(TeamOf(2, Topology("complete"), kConsensus)), "nothing");
  EXPECT_EQ(ToleranceWords(TeamOf(4, Topology("path"), "[law]\nname = 'flocking'\n")), "nothing");
  EXPECT_EQ(ToleranceWords(TeamOf(4, "edges = [[1, 2]]\n", kConsensus)), "nothing") << "there is no tree to lose";
}

TEST(LossTolerance, TakesTheUnionOfAScheduleThatRepeatsElseItsLastGraph) {
  const std::string phases =
      "edges = [[1, 2], [2, 1], [1, 3], [3, 1]]\n{}[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3], [3, 2], [2, 1], "
      "[1, 2]]\n";
  EXPECT_THAT(CannotLose(TeamOf(3, fmt::format(fmt::runtime(phases), "repeat_s = 1.0\n"), kConsensus)), IsEmpty());
  EXPECT_THAT(CannotLose(TeamOf(3, fmt::format(fmt::runtime(phases), ""), kConsensus)), ElementsAre(2));
}

TEST(LossTolerance, OfALargeTeamIsKnownAndOfATooLargeOneIsSaidNotToBe) {
  EXPECT_THAT(CannotLose(TeamOf(1000, Topology("ring"), kConsensus)), IsEmpty());
  const std::string huge = TeamOf(10000, Topology("path"), kConsensus);
  EXPECT_EQ(ToleranceWords(huge), "which agents the team cannot lose is not looked at: it has too many edges");
  EXPECT_TRUE(LossToleranceJson(LossToleranceOf(Load(huge))).is_null());
}

// --- what viewers of a run are told ---------------------------------------------------------------------

TEST(Survival, OfARunGoesOnFromTheFaultsThatEventsHaveBrought) {
  const Experiment start = Load(TeamOf(4, Topology("path"), kConsensus,
                                       "[[agents.override]]\nid = 4\nlie = { from_s = 6.0, offset_m = [1, 0, 0] }\n"));
  EXPECT_THAT(SurvivalsOf(start), ElementsAre(Field(&Survival::from, 600)));
  LiveExperiment live(start, &LawTable(), /*checked=*/true);
  live.Take({.tick = 300, .fault = Fault{.agent = 2}, .where = "test"});
  const auto told = SurvivalsOf(live.current());
  ASSERT_THAT(told, SizeIs(2));
  EXPECT_EQ(told[0].words, "agent 2 is lost: no spanning tree: agent 1 is cut off from agents 3 and 4");
  EXPECT_THAT(told[1].liars, ElementsAre(4));
  live.Take({.tick = 700, .restart = 2, .where = "test"});
  live.Take({.tick = 700, .fault = Fault{.agent = 4, .kind = FaultKind::kOk}, .where = "test"});
  EXPECT_THAT(SurvivalsOf(live.current()), IsEmpty());
}

}  // namespace
}  // namespace mascot
