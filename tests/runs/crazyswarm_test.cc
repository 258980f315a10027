// network.crazyswarm: a script for Crazyswarm2, a program of its own, flies simulated agents.

#include <gmock/gmock.h>
#include <signal.h>

#include <string>

#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;

const std::string kTeam =
    "[run]\nmode = 'realtime'\nduration_s = 1000.0\nagent_timeout_s = 2.0\n[network]\ncrazyswarm = true\n"
    "[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0.0, 0.0, 0.1], [2.0, 0.0, 0.1]]\n"
    "[law]\nname = 'actions'\naxes = 'xyz'\n[output]\nsave_plot = false\nfidelity = false\n";

TEST(Crazyswarm, AScriptTakesOffFliesStreamsAndLands) {
  const ScratchFolder folder;
  WriteFile(folder.File("team.toml"), kTeam);
  Up up(folder, "run", folder.File("team.toml"), {});
  Running script(BuildFolder() + "/fake_script", {"--domain", std::to_string(DomainOf(up)), "--nonsense"},
                 folder.File("script"));
  EXPECT_EQ(script.Wait(), 0) << script.out() << script.err();
  for (const char* words :
       {"cf1 begins, at [0.00, 0.00, 0.10]", "cf1 reaches the height, at [0.0", "cf1 reaches the goal, at [0.",
        "cf1 reaches what is streamed, at [0.", "cf1 reaches the ground, at [0.", "done"})
    EXPECT_THAT(script.out(), HasSubstr(words));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_THAT(up.err(),
              HasSubstr("warning: network.crazyswarm: a message of cf1/cmd_full_state is left alone: it is too "
                        "short, or says what cannot be (a number that is none, a negative duration)"));
}

}  // namespace
}  // namespace mascot::test
