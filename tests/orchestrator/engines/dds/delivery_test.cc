// Sizes of the buffers that a run over DDS needs.
#include "orchestrator/engines/dds/delivery.h"

#include <gtest/gtest.h>

#include "tests/support/load.h"

namespace mascot {
namespace {

/// A queue holds kRecorderWindow samples for each participant (bus/qos.cc). What does not fit is sent again, but not by
/// an agent that has died.
TEST(BuffersOnTopics, HoldAllThatTheRecorderMayHaveToRead) {
  const auto participants = [](const std::string& law) {
    return ParticipantsOfServer(
        Load("[run]\nduration_s = 1.0\n[agents]\ncount = 5\nmodel = 'double_integrator'\n[graph]\ntopology = "
             "'ring'\n[network]\ndelivery = "
             "'topics'\n[law]\nname = '" +
             law + "'\n"));
  };
  EXPECT_GE(participants("velocity_consensus"), 1 + 2 * 5) << "clock, states and commands";
  EXPECT_GE(participants("event_triggered"), 1 + 3 * 5) << "and messages";
}

}  // namespace
}  // namespace mascot
