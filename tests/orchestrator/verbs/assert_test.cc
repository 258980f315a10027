// `orchestrator up --assert`: exit codes, what is said, and what summary.json states.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/support/call.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::HasSubstr;

/// Two points whose distance falls by 1 % in each tick, and so to 2 % after 3.9 s.
constexpr const char* kMeeting =
    "[run]\nduration_s = 20.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\nposition_m = [[-1, 0, 1], [1, 0, 1]]\n"
    "[graph]\ntopology = 'ring'\n[law]\nname = 'velocity_consensus'\np_gain = 0.5\n[physics]\ncollisions = "
    "false\n[output]\nsave_plot = false\n";

class UpAssert : public testing::Test {
 protected:
  Said Fly(std::vector<std::string> claims) {
    WriteFile(scratch_.File("meeting.toml"), kMeeting);
    std::vector<std::string> arguments = {
        scratch_.File("meeting.toml"), "--engine", "inprocess", "--quiet", "--force", "--out", scratch_.File("run")};
    for (const std::string& claim : claims) arguments.insert(arguments.end(), {"--assert", claim});
    return Call(SetUpUp, arguments);
  }
  nlohmann::json Summary() { return nlohmann::json::parse(ReadFile(scratch_.File("run/summary.json"))); }

  ScratchFolder scratch_;
};

TEST_F(UpAssert, SucceedsIfAllHold) {
  const Said said = Fly({"consensus.settling_time_s < 4", "consensus.rate_per_s>0.9", "safety.collisions == 0"});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_EQ(Summary()["exit"], 0);
}

TEST_F(UpAssert, FailsWithEachThatDoesNotHoldInWords) {
  const Said said = Fly({"consensus.settling_time_s < 3", "safety.collisions == 0", "consensus.rate_per_s > 2"});
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.err, testing::MatchesRegex("error: --assert consensus.settling_time_s < 3: it is 3\\.9[0-9]*; "
                                              "--assert consensus.rate_per_s > 2: it is 1\\.00[0-9]*\n"));
  EXPECT_EQ(Summary()["exit"], kExitFailed);
}

TEST_F(UpAssert, RefusesAMistakeBeforeItFlies) {
  const Said said = Fly({"consensus.settling_times < 3"});
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_THAT(said.err, HasSubstr("(did you mean \"consensus.settling_time_s\"?)"));
  EXPECT_EQ(Fly({"consensus.settling_time_s"}).exit_code, kExitUsage);
  EXPECT_FALSE(std::filesystem::exists(scratch_.File("run")));
}

}  // namespace
}  // namespace mascot
