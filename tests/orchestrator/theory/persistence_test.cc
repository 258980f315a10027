#include "orchestrator/theory/persistence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/laws/laws.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string Four(const std::string& rest) {
  return "[run]\nduration_s = 40.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n"
         "position_m = [[0, 0, 1], [10, 0, 2], [20, 0, 3], [40, 0, 4]]\n" +
         rest;
}

Persistence PersistenceIn(const std::string& toml) {
  const Experiment experiment = Load(toml);
  return PersistenceOf(experiment, TimelineOf(experiment).value());
}

std::vector<std::string> WarningsOf(const std::string& toml) {
  const Experiment experiment = Load(toml);
  const Timeline timeline = TimelineOf(experiment).value();
  return PersistenceWarnings(experiment, timeline, PersistenceOf(experiment, timeline));
}

// --- the graph over time ------------------------------------------------------------------------------

TEST(Timeline, OfOneGraphIsConstant) {
  const Timeline timeline = TimelineOf(Load(Four("[graph]\ntopology = 'path'\n"))).value();
  EXPECT_TRUE(timeline.IsConstant());
  EXPECT_EQ(timeline.At(0).graph.edges(), 6u);
  EXPECT_EQ(timeline.At(1000000).graph.edges(), 6u);
}

TEST(Timeline, ShowsAtEveryTickTheGraphThatAgentsHearBy) {
  const Experiment experiment =
      Load(Four("[[agents.override]]\nid = 4\nstart_s = 1.305\n"
                "[graph]\nedges = [[1, 2]]\nrepeat_s = 0.7\n[[graph.schedule]]\nat_s = 0.3\nedges = [[2, 3], [3, 4]]\n"
                "[[graph.schedule]]\nat_s = 0.555\nedges = [[4, 1]]\n"));
  const Timeline timeline = TimelineOf(experiment).value();
  for (std::int64_t tick = 0; tick < 1000; ++tick) {
    const double t_s = experiment.time_s(tick);
    const bool on = tick >= 131;
    const Graph& scheduled = experiment.schedule.At(t_s);
    for (int id = 1; id <= 4; ++id) {
      std::size_t expected = 0;
      for (const Graph::Neighbour& heard : scheduled.HeardBy(id)) expected += on || (id != 4 && heard.id != 4);
      ASSERT_EQ(timeline.At(tick).graph.HeardBy(id).size(), expected) << tick;
    }
    ASSERT_EQ(timeline.At(tick).on[3], on) << tick;
  }
  EXPECT_EQ(timeline.cycle_ticks, 70);
}

TEST(Timeline, RepeatsAfterAsManyRepetitionsAsMakeWholeTicks) {
  const std::string phases = "[[graph.schedule]]\nat_s = 0.1\nedges = [[2, 3]]\n";
  EXPECT_EQ(TimelineOf(Load(Four("[graph]\nedges = [[1, 2]]\nrepeat_s = 0.255\n" + phases)))->cycle_ticks, 51);
  EXPECT_FALSE(TimelineOf(Load(Four("[graph]\nedges = [[1, 2]]\nrepeat_s = 0.2512345\n" + phases))));
}

// --- spanning trees over time -----------------------------------------------------------------------------

TEST(Persistence, OfAConnectedGraphHoldsAtEveryTime) {
  const Persistence path = PersistenceIn(Four("[graph]\ntopology = 'path'\n"));
  EXPECT_TRUE(path.always && path.joint && !path.never_alone);
  EXPECT_EQ(path.from_s, 0.0);
  EXPECT_EQ(Describe(path), "at every time");
}

TEST(Persistence, OfASwitchingGraphIsThatOfItsUnionOverLongEnoughWindows) {
  // 1-2 and 3-4 for 0.3 s, then 2-3 for 0.5 s: a window that begins with 2-3 needs the first tick of the other graph.
  const std::string turns =
      "[graph]\nedges = [[1, 2], [2, 1], [3, 4], [4, 3]]\nrepeat_s = 0.8\n"
      "[[graph.schedule]]\nat_s = 0.3\nedges = [[2, 3], [3, 2]]\n";
  const Persistence persistence = PersistenceIn(Four(turns));
  EXPECT_TRUE(persistence.joint && persistence.never_alone);
  EXPECT_DOUBLE_EQ(persistence.window_s.value(), 0.51);
  EXPECT_EQ(Describe(persistence), "in the union of any 0.51 s; at no time alone");
  EXPECT_THAT(WarningsOf(Four(turns)), IsEmpty());
}

TEST(Persistence, WindowIsTheShortestThatEveryStartingTickNeeds) {
  // Compare with all windows, tick by tick.
  const Experiment experiment = Load(
      Four("[graph]\nedges = [[1, 2]]\nrepeat_s = 0.4\n[[graph.schedule]]\nat_s = 0.05\nedges = [[2, 3], [4, 1]]\n"
           "[[graph.schedule]]\nat_s = 0.25\nedges = [[3, 1]]\n[[graph.schedule]]\nat_s = 0.31\nedges = [[2, 4]]\n"));
  const Timeline timeline = TimelineOf(experiment).value();
  std::int64_t longest = 0;
  for (std::int64_t start = 0; start < 40; ++start) {
    std::vector<Schedule::Phase> phases;
    std::int64_t ticks = 0;
    do phases.push_back({0, timeline.At(start + ticks++).graph});
    while (Schedule(phases, 0, 0).Union().Roots().empty());
    longest = std::max(longest, ticks);
  }
  EXPECT_DOUBLE_EQ(PersistenceOf(experiment, timeline).window_s.value(), experiment.time_s(longest));
}

TEST(Persistence, OfAScheduleThatEndsIsThatOfItsLastGraph) {
  const Persistence late =
      PersistenceIn(Four("[graph]\nedges = [[1, 2]]\n[[graph.schedule]]\nat_s = 3.0\nedges = [[1, 2], [2, 3], "
                         "[3, 4]]\n[[graph.schedule]]\nat_s = 5.0\nedges = [[4, 3], [3, 2], [2, 1]]\n"));
  EXPECT_TRUE(late.joint);
  EXPECT_EQ(late.from_s, 3.0);
  EXPECT_EQ(Describe(late), "from 3 s on");
  const std::string ends = Four("[graph]\ntopology = 'path'\n[[graph.schedule]]\nat_s = 3.0\nedges = [[1, 2]]\n");
  EXPECT_EQ(Describe(PersistenceIn(ends)), "none");
  EXPECT_THAT(WarningsOf(ends),
              ElementsAre("graph.schedule: from 3 s on nobody is heard by everyone, directly or not (no spanning "
                          "tree), so agents will not all meet"));
}

TEST(Persistence, WithALeaderNeedsATreeRootedAtIt) {
  const std::string turns =
      "[graph]\nedges = [[2, 1]]\nrepeat_s = 1.0\n[[graph.schedule]]\nat_s = 0.5\nedges = [[3, 2], [4, 3]]\n[law]\n";
  EXPECT_TRUE(PersistenceIn(Four(turns + "leader = 1\n")).joint);
  EXPECT_THAT(WarningsOf(Four(turns + "leader = 2\n")),
              ElementsAre("graph.schedule: in the union of its graphs leader 2 is not heard, directly or not, by agent "
                          "1, who will not follow"));
}

TEST(Persistence, WarnsOfAUnionThatIsNotConnected) {
  EXPECT_THAT(WarningsOf(Four("[graph]\nedges = [[1, 2], [2, 1]]\nrepeat_s = 1.0\n"
                              "[[graph.schedule]]\nat_s = 0.5\nedges = [[3, 4], [4, 3]]\n")),
              ElementsAre("graph.schedule: in the union of its graphs nobody is heard by everyone, directly or not (no "
                          "spanning tree), so agents will not all meet"));
}

TEST(Persistence, WarnsOfLinksThatLoseEverything) {
  const std::string path = "[graph]\ntopology = 'path'\n[[link.override]]\nedges = [[2, 3], [3, 2]]\nloss = ";
  EXPECT_THAT(WarningsOf(Four(path + "0.9\n")), IsEmpty());
  EXPECT_THAT(WarningsOf(Four(path + "1.0\n")),
              ElementsAre("link.loss: nobody is heard by everyone, directly or not (no spanning tree), so agents will "
                          "not all meet"));
}

TEST(Persistence, IncludesAgentsThatStartLateAndNotAgentsThatStop) {
  const std::string path = "[graph]\ntopology = 'path'\n[[agents.override]]\n";
  EXPECT_EQ(PersistenceIn(Four(path + "id = 2\nstart_s = 4.0\n")).from_s, 4.0);
  EXPECT_TRUE(PersistenceIn(Four(path + "id = 4\nstop_s = 4.0\n")).joint) << "the others still hear each other";
  EXPECT_TRUE(PersistenceIn(Four(path + "id = 2\nstop_s = 400.0\n")).always) << "after the run";
  EXPECT_THAT(WarningsOf(Four(path + "id = 2\nstop_s = 4.0\n")),
              ElementsAre("agents.override.stop_s: from 4 s on nobody is heard by everyone, directly or not (no "
                          "spanning tree), so agents will not all meet"));
}

TEST(Persistence, ChecksTheRangeAtTheStart) {
  const std::string near = "[graph]\ntopology = 'path'\nrange_m = ";
  EXPECT_EQ(PersistenceIn(Four(near + "25.0\n")).in_range_at_start, true);
  EXPECT_EQ(Describe(PersistenceIn(Four(near + "25.0\n"))), "at every time, and within range at the start");
  EXPECT_EQ(Describe(PersistenceIn(Four(near + "15.0\n"))), "at every time, but not within range at the start");
  EXPECT_THAT(WarningsOf(Four(near + "15.0\n")),
              ElementsAre("graph.range_m: from where they start, with 15 m, nobody is heard by everyone, directly or "
                          "not (no spanning tree), so agents may not all meet"));
  EXPECT_THAT(WarningsOf(Four(near + "15.0\n[law]\nleader = 1\n")),
              ElementsAre("graph.range_m: from where they start, with 15 m, leader 1 is not heard, directly or not, by "
                          "agent 4, who may not follow"));
}

}  // namespace
}  // namespace mascot
