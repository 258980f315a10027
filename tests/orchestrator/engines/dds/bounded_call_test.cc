#include "orchestrator/engines/dds/bounded_call.h"

#include <gmock/gmock.h>
#include <signal.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>

namespace mascot {
namespace {

using namespace std::chrono_literals;

TEST(BoundedCall, ReturnsWhenTheCallDoes) {
  StopSignal stop;
  bool called = false;
  EXPECT_TRUE(ReturnsWithin(
      1h, [&] { called = true; }, stop));
  EXPECT_TRUE(called);
}

TEST(BoundedCall, ThrowsWhatTheCallThrows) {
  StopSignal stop;
  EXPECT_THROW(ReturnsWithin(
                   1h, [] { throw std::runtime_error("no"); }, stop),
               std::runtime_error);
}

/// Never returns.
struct Hang {
  std::shared_ptr<std::pair<std::mutex, std::condition_variable>> never =
      std::make_shared<std::pair<std::mutex, std::condition_variable>>();
  void operator()() const {
    std::unique_lock lock(never->first);
    never->second.wait(lock, [] { return false; });
  }
};

TEST(BoundedCall, IsLeftAfterTheLimit) {
  StopSignal stop;
  EXPECT_FALSE(ReturnsWithin(1ms, Hang(), stop));
}

TEST(BoundedCall, IsLeftAtASignal) {
  StopSignal stop;
  kill(getpid(), SIGTERM);
  EXPECT_FALSE(ReturnsWithin(1h, Hang(), stop));
}

}  // namespace
}  // namespace mascot
