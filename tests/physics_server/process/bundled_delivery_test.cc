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
  Agent(Domain& domain, int id) : id_(id), answers_(domain, Topic::Answers({id, id})) {}
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
