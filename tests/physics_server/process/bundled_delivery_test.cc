// The server's side of network.delivery = "bundled", against processes of agents that this test plays.
#include "physics_server/process/bundled_delivery.h"

#include <gmock/gmock.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "physics_server/world.h"
#include "tests/support/load.h"
#include "tests/support/waits.h"

namespace mascot::test {
namespace {

constexpr int kAgents = 6;

Experiment Team() {
  return Load("[run]\nduration_s = 1000.0\n[agents]\ncount = " + std::to_string(kAgents) +
              "\n[graph]\ntopology = 'ring'\n");
}

class ServerAndAgents : public testing::Test {
 protected:
  DomainOptions Options(const std::string& name) const {
    DomainOptions options;
    options.domain = lock_.domain();
    options.name = name;
    options.loopback = true;
    return options;
  }

  DomainLock lock_{-1};
  Domain server_{Options("server"), [] {}};
  Domain agents_{Options("agents"), [] {}};
};

/// Writes the answers of one agent to a tick.
class Agent {
 public:
  Agent(Domain& domain, int id) : id_(id), answers_(domain, Topic::Answers({id, id}), Redelivery::kOnDemand) {}
  void Answer(std::int64_t tick, int messages = 0) {
    writer_.Begin(tick);
    writer_.BeginSection();
    PutCommand(tick, 100, id_, {}, writer_.Add(kCommandBody));
    writer_.BeginSection();
    for (int k = 0; k < messages; ++k) PutMessage(tick, 100, id_, {}, writer_.Add(MessageBody(0)));
    answers_.Write(writer_.bytes());
  }

 private:
  int id_;
  RawWriter answers_;
  BundleWriter writer_;
};

TEST_F(ServerAndAgents, AnswersThatComeWhileTheServerLeavesAreWrittenToNobodyThatIsGone) {
  const Experiment experiment = Team();
  const World world(experiment);
  std::atomic<bool> ends = false;
  std::thread agents([&] {
    std::vector<std::unique_ptr<Agent>> all;
    for (int id = 1; id <= kAgents; ++id) all.push_back(std::make_unique<Agent>(agents_, id));
    while (!ends)
      for (const auto& agent : all) agent->Answer(0);
  });
  for (int leaves = 0; leaves < 10; ++leaves) {
    std::mutex mutex;
    std::atomic<int> taken = 0;
    std::atomic<BundledDelivery*> there = nullptr;
    // As the server does, which publishes the next tick as soon as the last agent has answered.
    auto delivery = std::make_unique<BundledDelivery>(server_, experiment, [&](auto) {
      const std::lock_guard lock(mutex);
      if (there == nullptr) return;
      ++taken;
      there.load()->Publish(world, 0);
    });
    delivery->Publish(world, 0);
    there = delivery.get();
    EXPECT_TRUE(Until([&] { return taken > 20; }));
    delivery.reset();
  }
  ends = true;
  agents.join();
}

TEST_F(ServerAndAgents, ASilentProcessIsAskedAgainWithTheSameBytes) {
  const Experiment experiment = Team();
  const World world(experiment);
  std::atomic<int> taken = 0;
  std::mutex mutex;
  std::vector<std::vector<RawReader::Bytes>> came(2);  // to agents 1 and 2
  const auto count = [&](std::size_t agent) {
    const std::lock_guard lock(mutex);
    return came[agent].size();
  };
  std::vector<std::unique_ptr<RawReader>> readers;
  for (int id = 1; id <= 2; ++id)
    readers.push_back(std::make_unique<RawReader>(
        agents_, Topic::Bundle({id, id}),
        [&, id](const RawReader::Bytes& bytes, const Sender&) {
          const std::lock_guard lock(mutex);
          came[static_cast<std::size_t>(id - 1)].push_back(bytes);
        },
        Redelivery::kOnDemand));
  std::vector<std::unique_ptr<Agent>> all;
  for (int id = 1; id <= kAgents; ++id) all.push_back(std::make_unique<Agent>(agents_, id));
  BundledDelivery delivery(server_, experiment, [&](auto answers) { taken += static_cast<int>(answers.size()); });
  delivery.Publish(world, 0);
  ASSERT_TRUE(Until([&] {  // until all have found each other
    delivery.AskAgain();
    return count(0) > 0 && count(1) > 0;
  }));
  ASSERT_TRUE(Until([&] {
    all[0]->Answer(0);
    return taken > 0;
  }));
  const std::size_t before = count(1);
  ASSERT_TRUE(Until([&] {
    delivery.AskAgain();
    return count(1) > before + 5;
  }));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(came[1], testing::Each(came[1][0]));
}

TEST_F(ServerAndAgents, AProcessThatHasAnsweredIsNotAskedAgain) {
  const Experiment experiment = Team();
  const World world(experiment);
  std::atomic<int> taken = 0, bundles = 0, others = 0;
  const auto reader = [&](int id, std::atomic<int>& counter) {
    return std::make_unique<RawReader>(
        agents_, Topic::Bundle({id, id}), [&counter](const RawReader::Bytes&, const Sender&) { ++counter; },
        Redelivery::kOnDemand);
  };
  const auto first = reader(1, bundles), second = reader(2, others);
  Agent agent(agents_, 1);
  BundledDelivery delivery(server_, experiment, [&](auto) { ++taken; });
  delivery.Publish(world, 0);
  ASSERT_TRUE(Until([&] {
    agent.Answer(0);
    return taken > 0;
  }));
  ASSERT_TRUE(Until([&] {
    delivery.AskAgain();
    return others > 0;
  }));
  const int before = bundles;
  const int seen = others;
  ASSERT_TRUE(Until([&] {
    delivery.AskAgain();
    return others > seen + 20;
  }));
  EXPECT_EQ(bundles, before) << "while agent 2, which is silent, got more";
}

/// What the server says of an answer of agent 2 to tick `tick`, with so many messages.
class Refused : public ServerAndAgents {
 protected:
  std::string Says(std::int64_t tick, int messages) {
    const Experiment experiment = Team();
    const World world(experiment);
    std::atomic<int> taken = 0;
    BundledDelivery delivery(server_, experiment, [&](auto) { ++taken; });
    Agent agent(agents_, 2);
    delivery.Publish(world, 0);
    std::string said;
    Until([&] {
      agent.Answer(tick, messages);
      try {
        server_.RethrowFailure();
      } catch (const std::exception& failure) {
        said = failure.what();
      }
      return taken > 0 || !said.empty();
    });
    return said;
  }
};

TEST_F(Refused, AreAnswersToATickThatIsNotPublished) {
  EXPECT_EQ(Says(1, 0), "/agent_2/answers: answers to tick 1, of which there are no states yet");
}

TEST_F(Refused, IsNothingThatIsAsItShouldBe) {
  EXPECT_EQ(Says(0, 0), "");
  EXPECT_EQ(Says(0, 1), "");
}

}  // namespace
}  // namespace mascot::test
