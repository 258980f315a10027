// What a process of agents takes of bundles, and what it refuses.
#include "agent/process/bundle_inbox.h"

#include <gmock/gmock.h>

#include <functional>

#include "agent/laws/laws.h"
#include "bus/bundle.h"
#include "experiment/processes.h"

namespace mascot {
namespace {

using News = BundleInbox::News;
using testing::ElementsAre;
using testing::ThrowsMessage;

constexpr int kBundleRate = 100;

struct Said {
  int agent;
  std::int64_t tick;
  std::vector<double> numbers;
};

/// A bundle of states at x = 10 agent + tick. `change` may change the bodies.
std::vector<std::uint8_t> Bundle(std::int64_t tick, const std::vector<int>& agents, int own,
                                 const std::vector<Said>& messages = {}, int events = 0) {
  BundleWriter bundle;
  bundle.Begin(tick);
  bundle.BeginSection(static_cast<std::uint32_t>(own));
  for (const int id : agents) {
    Motion motion;
    motion.p_WB.x() = 10 * id + static_cast<double>(tick);
    PutState(tick, kBundleRate, id, events, motion, bundle.Add(kStateBody));
  }
  bundle.BeginSection();
  for (const auto& [agent, sent, numbers] : messages)
    PutMessage(sent, kBundleRate, agent, numbers, bundle.Add(MessageBody(numbers.size())));
  return bundle.bytes();
}

/// Agents 2 and 3 of a path of five share a process: they may hear 1, each other, and 4. `law`: lines of [law].
class BundleInboxTest : public testing::Test {
 protected:
  static Experiment Path(const std::string& law, const std::string& mode = "lockstep") {
    return LoadExperiment(
        Section::FromText(
            "[run]\nduration_s = 1.0\nmode = '" + mode +
                "'\n[agents]\ncount = 5\nmodel = 'double_integrator'\n[graph]\ntopology = 'path'\n[law]\n" + law,
            "a.toml"),
        "a");
  }
  std::vector<double> Xs(BundleInbox& inbox, int id) {
    std::vector<double> xs;
    for (const Sample& sample : inbox.SamplesOf(id)) xs.push_back(sample.motion->p_WB.x());
    return xs;
  }

  const Experiment silent_ = Path("name = 'consensus'\n"), talking_ = Path("name = 'event_triggered'\n"),
                   realtime_ = Path("name = 'event_triggered'\n", "realtime");
  const std::vector<int> sources_{2, 3, 1, 4};
};

TEST_F(BundleInboxTest, SourcesAreItsOwnAgentsAndThenThoseThatTheyMayHear) {
  EXPECT_EQ(SourcesOf(silent_, {2, 3}), sources_);
  EXPECT_THAT(SourcesOf(silent_, {5, 5}), ElementsAre(5, 4));
}

TEST_F(BundleInboxTest, ABundleHasAllThatATickNeeds) {
  BundleInbox inbox(silent_, {2, 3});
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kComplete);
  EXPECT_EQ(inbox.tick(), 0);
  EXPECT_EQ(inbox.MotionOf(2).p_WB.x(), 20);
  EXPECT_EQ(inbox.MotionOf(3).p_WB.x(), 30);
  EXPECT_THAT(Xs(inbox, 2), ElementsAre(10, 30));
  EXPECT_THAT(Xs(inbox, 3), ElementsAre(20, 40));
}

TEST_F(BundleInboxTest, AnOldBundleIsIgnoredAndAnAnsweredOneIsAnsweredAgain) {
  BundleInbox inbox(silent_, {2, 3});
  inbox.OnBundle(Bundle(0, sources_, 2));
  inbox.Answered();
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kAgain);
  EXPECT_EQ(inbox.OnBundle(Bundle(1, sources_, 2)), News::kComplete);
  inbox.Answered();
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kOld);
  EXPECT_EQ(inbox.MotionOf(2).p_WB.x(), 21);
}

TEST_F(BundleInboxTest, ATickWaitsForTheEventsThatItsStatesSpeakOf) {
  BundleInbox inbox(silent_, {2, 3});
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2, {}, /*events=*/2)), News::kWaits);
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2, {}, /*events=*/2)), News::kWaits) << "sent again";
  EXPECT_FALSE(inbox.OnEvent(1, {}));
  EXPECT_TRUE(inbox.OnEvent(2, {}));
  EXPECT_EQ(inbox.events(), 2);
  inbox.Answered();
  EXPECT_FALSE(inbox.OnEvent(3, {}));
  EXPECT_EQ(inbox.OnBundle(Bundle(1, sources_, 2, {}, /*events=*/3)), News::kComplete);
}

TEST_F(BundleInboxTest, MessagesAreThoseOfTheTickBefore) {
  BundleInbox inbox(talking_, {2, 3});
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kComplete);
  for (const Sample& sample : inbox.SamplesOf(2)) EXPECT_TRUE(sample.message.empty());
  inbox.Answered();
  EXPECT_EQ(inbox.OnBundle(Bundle(1, sources_, 2, {{2, 0, {0.2}}, {3, 0, {0.3, 3}}, {1, 0, {}}, {4, 0, {0.4}}})),
            News::kComplete);
  EXPECT_THAT(inbox.SamplesOf(2)[0].message, ElementsAre());
  EXPECT_THAT(inbox.SamplesOf(2)[1].message, ElementsAre(0.3, 3));
  EXPECT_THAT(inbox.SamplesOf(3)[0].message, ElementsAre(0.2));
  EXPECT_THAT(inbox.SamplesOf(3)[1].message, ElementsAre(0.4));
  EXPECT_EQ(inbox.SamplesOf(3)[1].message_age, 1);
}

TEST_F(BundleInboxTest, AgentsThatAreLostSendNoMessages) {
  BundleInbox inbox(talking_, {2, 3});
  inbox.OnBundle(Bundle(0, sources_, 2));
  inbox.Answered();
  EXPECT_THAT(
      [&] {
        inbox.OnBundle(Bundle(1, sources_, 2, {{2, 0, {}}, {3, 0, {}}, {4, 0, {}}}));
      },
      ThrowsMessage<std::runtime_error>("a bundle of tick 1 without a message of agent 1"));
  BundleInbox other(talking_, {2, 3});
  other.OnBundle(Bundle(0, sources_, 2));
  other.Answered();
  const Fault killed{.agent = 1, .kind = FaultKind::kKill, .unanswered = true};
  EXPECT_EQ(other.OnBundle(Bundle(1, sources_, 2, {{2, 0, {}}, {3, 0, {}}, {4, 0, {}}}, /*events=*/1)), News::kWaits);
  EXPECT_TRUE(other.OnEvent(1, {.tick = 1, .fault = killed}));
  other.Answered();
  EXPECT_FALSE(other.OnEvent(2, {.tick = 3, .restart = 1}));
  EXPECT_EQ(other.OnBundle(Bundle(3, sources_, 2, {{2, 2, {}}, {3, 2, {}}, {4, 2, {}}}, 2)), News::kComplete);
  other.Answered();
  EXPECT_THAT(
      [&] {
        other.OnBundle(Bundle(4, sources_, 2, {{2, 3, {}}, {3, 3, {}}, {4, 3, {}}}, 2));
      },
      ThrowsMessage<std::runtime_error>("a bundle of tick 4 without a message of agent 1"));
}

TEST_F(BundleInboxTest, InRealTimeMessagesMayBeMissingAndTheNewestCounts) {
  BundleInbox inbox(realtime_, {2, 3});
  EXPECT_EQ(inbox.OnBundle(Bundle(3, sources_, 2, {{4, 1, {1}}, {4, 2, {2}}, {1, 0, {5}}})), News::kComplete);
  EXPECT_THAT(inbox.SamplesOf(3)[1].message, ElementsAre(2));
  EXPECT_EQ(inbox.SamplesOf(3)[1].message_age, 1);
  EXPECT_THAT(inbox.SamplesOf(2)[0].message, ElementsAre(5));
  EXPECT_EQ(inbox.SamplesOf(2)[0].message_age, 3);
  EXPECT_TRUE(inbox.SamplesOf(2)[1].message.empty());
  EXPECT_EQ(inbox.OnBundle(Bundle(5, sources_, 2)), News::kComplete);
  EXPECT_EQ(inbox.SamplesOf(3)[1].message_age, 3) << "of tick 2";
}

TEST_F(BundleInboxTest, WhatIsNotForTheseAgentsIsRefusedAndChangesNothing) {
  BundleInbox inbox(talking_, {2, 3});
  inbox.OnBundle(Bundle(0, sources_, 2));
  const std::vector<Said> all{{2, 0, {}}, {3, 0, {}}, {1, 0, {}}, {4, 0, {}}};
  const auto refused = [&](const std::vector<std::uint8_t>& bytes, const std::string& words) {
    EXPECT_THAT([&] { inbox.OnBundle(bytes); }, ThrowsMessage<std::runtime_error>(words));
    EXPECT_EQ(inbox.tick(), 0);
    EXPECT_EQ(inbox.MotionOf(2).p_WB.x(), 20);
  };
  refused(Bundle(1, {2, 3, 1}, 2, all), "a bundle of 3 states, 2 of them of its own agents; expected 4 and 2");
  refused(Bundle(1, {2, 3, 1, 4, 5}, 2, all), "a bundle of 5 states, 2 of them of its own agents; expected 4 and 2");
  refused(Bundle(1, sources_, 3, all), "a bundle of 4 states, 3 of them of its own agents; expected 4 and 2");
  refused(Bundle(1, {2, 3, 1, 5}, 2, all),
          "a bundle of tick 1 with a state of agent 5 at tick 1 in the place of agent 4's");
  refused(Bundle(101, sources_, 2, all), "a bundle of tick 101, the last one is 100");
  refused(Bundle(1, sources_, 2), "a bundle of tick 1 without a message of agent 2");
  refused(Bundle(1, sources_, 2, {{2, 0, {}}, {3, 0, {}}, {1, 0, {}}, {5, 0, {}}}),
          "a bundle of tick 1 with a message of agent 5 at tick 0");
  refused(Bundle(2, sources_, 2, all), "a bundle of tick 2 with a message of agent 2 at tick 0");
  std::vector<std::uint8_t> bytes = Bundle(1, sources_, 2, all);
  bytes.push_back(0);
  refused(bytes, "a sample with 1 bytes too many");
  bytes.resize(bytes.size() - 2);
  refused(bytes, "a sample of only " + std::to_string(bytes.size()) + " bytes");
  bytes = Bundle(1, sources_, 2, all);
  bytes[1] = 0;  // big-endian
  refused(bytes, "a sample that is no CDR of this kind");
  BundleInbox hears_late(realtime_, {2, 3});
  EXPECT_THAT(
      [&] {
        hears_late.OnBundle(Bundle(3, sources_, 2, {{4, 3, {}}}));
      },
      ThrowsMessage<std::runtime_error>("a bundle of tick 3 with a message of agent 4 at tick 3"));
  EXPECT_THAT(
      [&] {
        hears_late.OnBundle(Bundle(3, sources_, 2, {{5, 1, {}}}));
      },
      ThrowsMessage<std::runtime_error>("a bundle of tick 3 with a message of agent 5 at tick 1"));
}

TEST_F(BundleInboxTest, ATickWaitsForTheActionsOfAllAgentsThatTakeSome) {
  const Experiment told =
      Path("name = 'actions'\nmessage = 1\n[[agents.override]]\nid = 1\nlaw = { name = 'consensus' }\n");
  BundleInbox inbox(told, {2, 3});
  EXPECT_FALSE(inbox.OnAction(2, 0, std::vector{2.0}));
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kWaits);
  EXPECT_EQ(inbox.OnBundle(Bundle(0, sources_, 2)), News::kWaits) << "sent again";
  EXPECT_TRUE(inbox.OnAction(3, 0, std::vector{3.0}));
  EXPECT_THAT(inbox.ActionOf(2), ElementsAre(2.0));
  EXPECT_THAT(inbox.ActionOf(3), ElementsAre(3.0));
  inbox.Answered();
  EXPECT_FALSE(inbox.OnAction(2, 0, std::vector{9.0}));
  EXPECT_THAT(inbox.ActionOf(2), ElementsAre(2.0)) << "a late one is ignored";
  const std::vector<Said> said{{2, 0, {1}}, {3, 0, {1}}, {4, 0, {1}}};
  EXPECT_EQ(inbox.OnBundle(Bundle(1, sources_, 2, said, /*events=*/1)), News::kWaits);
  EXPECT_FALSE(inbox.OnAction(3, 1, std::vector{3.1}));
  EXPECT_TRUE(inbox.OnEvent(1, {.tick = 1, .fault = Fault{.agent = 2, .kind = FaultKind::kHang}})) << "2 gets none";
}

TEST_F(BundleInboxTest, AMessageThatIsMissingIsFoundWithTheActionToo) {
  BundleInbox inbox(Path("name = 'actions'\nmessage = 1\n"), {5, 5});
  inbox.OnBundle(Bundle(0, {5, 4}, 1));
  EXPECT_TRUE(inbox.OnAction(5, 0, std::vector{0.0}));
  inbox.Answered();
  EXPECT_FALSE(inbox.OnAction(5, 1, std::vector{0.0}));
  inbox.OnBundle(Bundle(1, {5, 4}, 1, {}, /*events=*/1));
  EXPECT_THAT([&] { inbox.OnEvent(1, {}); },
              ThrowsMessage<std::runtime_error>("a bundle of tick 1 without a message of agent 4"));
}

}  // namespace
}  // namespace mascot
