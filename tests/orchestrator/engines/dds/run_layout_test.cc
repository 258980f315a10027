// Where the processes of a run over DDS are, and how they find each other.
#include "orchestrator/engines/dds/run_layout.h"

#include <gmock/gmock.h>

#include "bus/ports.h"
#include "orchestrator/engines/dds/credentials.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

Experiment Team(int agents, const std::string& more = "", const std::string& of_agents = "") {
  return Load("[run]\nduration_s = 1.0\n[agents]\ncount = " + std::to_string(agents) +
              "\nmodel = 'double_integrator'\n" + of_agents + "[graph]\ntopology = 'path'\n" + more);
}

TEST(RunLayout, FindsSmallTeamsInAStarLargeOnesByAServerAndStrangersByMulticast) {
  const Experiment small = Team(4), large = Team(40), topics = Team(4, "[network]\ndelivery = 'topics'\n");
  const Experiment by_hand = Team(4, "", "override = [{id = 2, host = 'external'}]\n");
  const auto ways = [](const Experiment& experiment) {
    const RunLayout layout(experiment);
    return std::vector{layout.is_star(), layout.with_server(), layout.reaches_others()};
  };
  EXPECT_THAT(ways(small), ElementsAre(true, false, false));
  EXPECT_THAT(ways(large), ElementsAre(true, false, false)) << "all announce themselves to two";
  EXPECT_THAT(ways(topics), ElementsAre(false, false, false));
  EXPECT_THAT(ways(Team(40, "[network]\ndelivery = 'topics'\n")), ElementsAre(false, true, false));
  EXPECT_THAT(ways(by_hand), ElementsAre(false, false, true));
  EXPECT_THAT(ways(Team(4, "[[hosts]]\nname = 'lab'\nagents = '3-4'\nlaunch = ['true']\n")),
              ElementsAre(false, true, true));
}

TEST(RunLayout, GivesEachParticipantOfThisProcessWhatItNeeds) {
  const Experiment experiment = Team(40, "[network]\ndelivery = 'topics'\ntransport = 'udp'\n");
  RunLayout layout(experiment);
  layout.SetDomain(5, 12345);
  const DomainOptions own = layout.Options("orchestrator", DiscoveryRole::kObserver);
  EXPECT_EQ(own.domain, 5);
  EXPECT_EQ(own.transport, "udp");
  EXPECT_EQ(own.number, kNumberOfOrchestrator);
  EXPECT_EQ(own.server, "127.0.0.1:12345");
  EXPECT_TRUE(own.loopback);
  EXPECT_THAT(own.peers, IsEmpty());
  EXPECT_EQ(layout.ServerAt("10.0.0.7"), "10.0.0.7:12345");
  const DomainOptions server = layout.Options("discovery_server", DiscoveryRole::kServer);
  EXPECT_NE(server.number, own.number);
  EXPECT_GE(kFirstAgents, server.number + 1) << "agents have other numbers";
}

TEST(RunLayout, SaysWhoIsOnWhichHost) {
  const Experiment experiment = Team(5, "[[hosts]]\nname = 'lab'\nagents = '3-4'\nlaunch = ['true']\n",
                                     "override = [{id = 5, host = 'external'}]\n");
  RunLayout layout(experiment);
  layout.SetDomain(5, 12345);
  EXPECT_EQ(layout.ProcessesOn(""), 2);
  EXPECT_EQ(layout.ProcessesOn("lab"), 2);
  EXPECT_TRUE(layout.has_external());
  EXPECT_EQ(layout.PlacedName("agent_3"), "agent_3@lab");
  EXPECT_EQ(layout.PlacedName("agent_1"), "agent_1");
  EXPECT_EQ(layout.PlacedName("physics_server"), "physics_server");
  // This host has the orchestrator and the server besides.
  EXPECT_GT(layout.SharedMemoryOn(""), layout.SharedMemoryOn("lab"));
  EXPECT_GT(layout.SharedMemoryOn("lab"), 0u);
}

TEST(RunLayout, LetsProcessesBeFoundInTheOrderOfTheirRanksWithSecurity) {
  const std::string secure = "[network]\ndelivery = 'topics'\nsecurity = 'graph'\n";
  const Experiment quiet = Team(3, secure), talking = Team(3, secure + "[law]\nname = 'event_triggered'\n");
  const RunLayout layout(quiet), of_talking(talking);
  EXPECT_TRUE(layout.is_star());
  EXPECT_EQ(layout.RankOf("physics_server"), kMaxRank);
  EXPECT_GT(layout.RankOf("agent_1"), layout.RankOf("agent_2"));
  EXPECT_GT(layout.RankOf("agent_3"), 0);
  EXPECT_THAT(layout.PeersOf("agent_2"), UnorderedElementsAre(kNumberOfOrchestrator, kNumberOfServer));
  EXPECT_EQ(layout.MatesOf({2, 2}), 0);
  EXPECT_THAT(of_talking.PeersOf("agent_2"),
              UnorderedElementsAre(kNumberOfOrchestrator, kNumberOfServer, kFirstAgents));
  EXPECT_THAT(of_talking.PeersOf("agent_3"),
              UnorderedElementsAre(kNumberOfOrchestrator, kNumberOfServer, kFirstAgents + 1))
      << "a path: it hears agent 2";
  EXPECT_EQ(of_talking.MatesOf({2, 2}), 2);
}

}  // namespace
}  // namespace mascot
