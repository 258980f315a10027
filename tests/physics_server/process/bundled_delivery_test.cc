// The server's side of network.delivery = "bundled", against processes of agents that this test plays.
#include "physics_server/process/bundled_delivery.h"

#include <gtest/gtest.h>

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

/// Answers of process `id`, of one agent, to a tick.
std::vector<std::uint8_t>& Answers(std::int64_t tick, int id, BundleWriter& writer) {
  writer.Begin(tick);
  writer.BeginSection();
  PutCommand(tick, 100, id, {}, writer.Add(kCommandBody));
  writer.BeginSection();
  return writer.bytes();
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
  Experiment experiment_ = Load("[run]\nduration_s = 1000.0\n[agents]\ncount = " + std::to_string(kAgents) +
                                "\n[graph]\ntopology = 'ring'\n");
  World world_{experiment_};
};

TEST_F(ServerAndAgents, AnswersThatComeWhileTheServerLeavesAreWrittenToNobodyThatIsGone) {
  std::vector<std::unique_ptr<RawWriter>> answers;
  for (int id = 1; id <= kAgents; ++id)
    answers.push_back(std::make_unique<RawWriter>(agents_, Topic::Answers({id, id})));
  std::atomic<bool> ends = false;
  std::thread agents([&] {
    BundleWriter writer;
    for (std::int64_t tick = 0; !ends; ++tick)
      for (int id = 1; id <= kAgents; ++id)
        answers[static_cast<std::size_t>(id - 1)]->Write(Answers(tick % 1000, id, writer));
  });
  for (int leaves = 0; leaves < 30; ++leaves) {
    std::mutex mutex;
    std::atomic<int> taken = 0;
    std::atomic<BundledDelivery*> there = nullptr;
    // As the server does, which publishes the next tick as soon as the last agent has answered.
    auto delivery = std::make_unique<BundledDelivery>(server_, experiment_, [&](auto) {
      const std::lock_guard lock(mutex);
      if (there == nullptr) return;
      ++taken;
      there.load()->Publish(world_, 0);
    });
    there = delivery.get();
    EXPECT_TRUE(Until([&] { return taken > 20; }));
    delivery.reset();
  }
  ends = true;
  agents.join();
}

}  // namespace
}  // namespace mascot::test
