#include "orchestrator/engines/dds/credentials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/peers.h"
#include "experiment/toml/section.h"
#include "orchestrator/engines/dds/rights.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

/// Agent 1 hears 2, from 1 s on; 2 hears 3. Laws send messages.
Experiment Three(const std::string& network) {
  return Load(
      "[run]\nduration_s = 5.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n[graph]\nedges = [[2, 3]]\n"
      "[[graph.schedule]]\nat_s = 1.0\nedges = [[1, 2], [2, 3]]\n[law]\nname = 'event_triggered'\n[network]\n"
      "security = 'graph'\n" +
      network);
}

std::vector<std::string> Names(const std::vector<Topic>& topics) {
  std::vector<std::string> names;
  for (const Topic& topic : topics) names.push_back(topic.Name());
  return names;
}

TEST(RightsOf, AgentsAreWhatTheUnionOfAllGraphsSays) {
  const Experiment experiment = Three("delivery = 'topics'\n");
  EXPECT_THAT(Names(RightsOf(experiment, "agent_1").reads),
              ElementsAre("/agent_2/message", "/agent_1/state", "/agent_2/state", "/clock", "/event", "/experiment",
                          "/request"));
  EXPECT_THAT(Names(RightsOf(experiment, "agent_1").writes),
              ElementsAre("/agent_1/command", "/agent_1/message", "/status"));
  EXPECT_THAT(Names(RightsOf(experiment, "agent_3").reads),
              ElementsAre("/agent_3/state", "/clock", "/event", "/experiment", "/request"));
}

TEST(RightsOf, AgentsOnBundlesAreTheirOwnBundle) {
  const Experiment experiment = Three("");
  EXPECT_THAT(Names(RightsOf(experiment, "agent_2").reads),
              ElementsAre("/agent_2/bundle", "/event", "/experiment", "/request"));
  EXPECT_THAT(Names(RightsOf(experiment, "agent_2").writes), ElementsAre("/agent_2/answers", "/status"));
  EXPECT_THAT(Names(RightsOf(experiment, "rviz").reads), ElementsAre());
  EXPECT_THAT(Names(RightsOf(experiment, "rviz").writes), ElementsAre("/status"));
}

TEST(RightsOf, ActionsAreOfTheirAgentAndTheOrchestrator) {
  const Experiment experiment = Load(
      "[run]\nduration_s = 5.0\n[agents]\ncount = 2\n[[agents.override]]\nid = 2\nlaw = { name = 'consensus' }\n"
      "[law]\nname = 'actions'\n[network]\nsecurity = 'graph'\n");
  EXPECT_THAT(Names(RightsOf(experiment, "agent_1").reads),
              ElementsAre("/agent_1/action", "/agent_1/bundle", "/event", "/experiment", "/request"));
  EXPECT_THAT(Names(RightsOf(experiment, "agent_2").reads),
              ElementsAre("/agent_2/bundle", "/event", "/experiment", "/request"));
  EXPECT_THAT(Names(RightsOf(experiment, kOrchestrator).writes), testing::Contains("/agent_1/action"));
  for (const char* other : {"agent_1", kPhysicsServer})
    EXPECT_THAT(Names(RightsOf(experiment, other).writes), Not(testing::Contains("/agent_1/action")));
}

TEST(RightsOf, TheServerAreNoMoreThanItNeeds) {
  const Experiment experiment = Three("");
  EXPECT_THAT(Names(RightsOf(experiment, kPhysicsServer).reads),
              ElementsAre("/agent_1/answers", "/agent_2/answers", "/agent_3/answers", "/agent_1/command",
                          "/agent_2/command", "/agent_3/command", "/experiment", "/request", "/status"));
}

TEST(Credentials, AreTextAndBack) {
  const Experiment experiment = Three("");
  const CertificateAuthority authority(experiment, 7);
  const auto [credentials, key] = authority.Issue("agent_2", 100);
  const Credentials back = CredentialsFrom(ToText(credentials), "agent_2.toml");
  EXPECT_EQ(back.process, "agent_2");
  EXPECT_EQ(back.certificate, credentials.certificate);
  EXPECT_EQ(back.private_key, credentials.private_key);
  EXPECT_EQ(back.permissions, credentials.permissions);
  EXPECT_EQ(back.governance, credentials.governance);
  EXPECT_EQ(back.orchestrator.bits(), authority.OfOrchestrator().key.bits());
  EXPECT_TRUE(back.orchestrator.IsOfSubject());
}

TEST(Credentials, OfOtherTextAreRefused) {
  EXPECT_THAT([] { CredentialsFrom("process = 'agent_2'", "a.toml"); },
              ThrowsMessage<ConfigError>(HasSubstr("a.toml:1:1: orchestrator: expected a string, got nothing")));
  EXPECT_THAT([] { CredentialsFrom("orchestrator = 'x'", "a.toml"); },
              ThrowsMessage<ConfigError>(HasSubstr("orchestrator: expected twelve hexadecimal digits, got 'x'")));
}

TEST(CertificateAuthority, AllowsWhatTheGraphSaysAndInThisDomainAlone) {
  const Experiment experiment = Three("delivery = 'topics'\nprotection = 'sign'\n");
  const CertificateAuthority authority(experiment, 7);
  const Credentials credentials = authority.Issue("agent_1", 100).credentials;
  EXPECT_THAT(credentials.permissions, HasSubstr("<domains><id>7</id></domains>"));
  EXPECT_THAT(credentials.permissions, HasSubstr("<topic>rt/agent_2/state</topic>"));
  EXPECT_THAT(credentials.permissions, Not(HasSubstr("rt/agent_3")));
  EXPECT_THAT(credentials.permissions, HasSubstr("<default>DENY</default>"));
  EXPECT_THAT(credentials.permissions, HasSubstr("<subject_name>CN=/agent_1,OU=start 0 choice "));
  EXPECT_THAT(credentials.governance, HasSubstr("<metadata_protection_kind>SIGN</metadata_protection_kind>"));
  EXPECT_THAT(credentials.governance, HasSubstr("<enable_read_access_control>true</enable_read_access_control>"));
}

TEST(CertificateAuthority, SaysInShortWhoMayUseAllTopicsOfAKind) {
  const Experiment experiment = Three("delivery = 'topics'\n");
  const CertificateAuthority authority(experiment, 7);
  const std::string server = authority.Issue(kPhysicsServer, 100).credentials.permissions;
  EXPECT_THAT(server, HasSubstr("<topic>rt/agent*/command</topic>"));
  EXPECT_THAT(server, HasSubstr("<topic>rt/agent*/state</topic>"));
  EXPECT_THAT(server, Not(HasSubstr("rt/agent_")));
  EXPECT_THAT(server, Not(HasSubstr("/message")));
  EXPECT_THAT(authority.Issue("agent_1", 100).credentials.permissions, Not(HasSubstr("*")));
}

/// The first byte of the GUIDs that a key fits.
int FirstByte(const ProcessKey& key) { return std::stoi(key.ToHex().substr(0, 2), nullptr, 16); }

TEST(CertificateAuthority, KeysAreInTheOrderOfTheirRanks) {
  const Experiment experiment = Three("");
  const CertificateAuthority authority(experiment, 7);
  for (const int rank : {0, 1, 64, kMaxRank}) {
    EXPECT_EQ(FirstByte(authority.Issue("agent_1", rank).key), 0x80 + rank);
    EXPECT_EQ(FirstByte(authority.Issue("agent_1", rank, 1).key), 0x80 + rank);
  }
  EXPECT_NE(authority.Issue("agent_1", 5).key.bits(), authority.Issue("agent_1", 5, 1).key.bits());
  EXPECT_EQ(authority.Issue("agent_1", 5).key.bits(), authority.Issue("agent_1", 5).key.bits());
}

TEST(ProcessKey, OfASubjectIsHexadecimalAndBack) {
  std::vector<std::uint8_t> digest(32, 0);
  digest[0] = 0x80, digest[5] = 0x03;
  const ProcessKey key = ProcessKey::WithSubject(digest);
  EXPECT_EQ(key.ToHex(), "c00000000001") << "a bit that is set, then the first 47 bits";
  EXPECT_EQ(ProcessKey::FromHex("c00000000001")->bits(), key.bits());
  for (const char* other : {"", "c0", "c0000000000g", "c000000000011"})
    EXPECT_FALSE(ProcessKey::FromHex(other).has_value()) << other;
  ProcessKey::GuidPrefix guid;
  guid.value[0] = 0xc0, guid.value[5] = 1, guid.value[9] = 77;
  EXPECT_TRUE(key.Fits(guid));
  guid.value[5] = 2;
  EXPECT_FALSE(key.Fits(guid));
}

TEST(PeersOfCertificates, WhoHasTheCertificateOfAProcessIsOfItAndTheFirstOneSpeaks) {
  std::vector<std::uint8_t> digest(32, 1);
  const ProcessKey subject = ProcessKey::WithSubject(digest);
  const auto guid_of = [&](int number) {
    ProcessKey::GuidPrefix guid;
    for (int k = 0; k < 6; ++k)
      guid.value[k] = static_cast<std::uint8_t>(std::stoi(subject.ToHex().substr(2 * k, 2), nullptr, 16));
    guid.value[11] = guid.value[6] = static_cast<std::uint8_t>(number);
    return guid;
  };
  Peers peers;
  peers.Await("agent_4", subject);
  const auto version = peers.version();
  EXPECT_EQ(peers.Claim(guid_of(1), "agent_4"), "agent_4");
  EXPECT_GT(peers.version(), version) << "others must be told that it is there";
  EXPECT_EQ(peers.Claim(guid_of(2), "thief"), "agent_4");
  EXPECT_EQ(peers.ProcessOf(guid_of(2)), "agent_4");
  EXPECT_EQ(peers.Believe(Topic::Command(4), guid_of(1)), "agent_4");
  EXPECT_EQ(peers.Believe(Topic::Command(4), guid_of(2)), "");
  peers.Leave(guid_of(1));
  EXPECT_EQ(peers.Believe(Topic::Command(4), guid_of(2)), "agent_4") << "the place is free again";
}

}  // namespace
}  // namespace mascot
