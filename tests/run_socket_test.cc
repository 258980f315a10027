// RunSocket: which users reach a run on this machine, and what it answers.
#include "orchestrator/live/run_socket.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "agent/laws.h"
#include "tests/three_agents.h"

namespace mascot {
namespace {

/// A run of this process, which has not begun.
class RunSocketTest : public testing::Test {
 protected:
  RunSocketTest()
      : experiment_(Load(Three("name = 'consensus'\n"))),
        helm_(experiment_, 0),
        socket_(experiment_, "/some/folder", "inprocess", "http://127.0.0.1:8765", helm_) {}

  /// What RunsAlive() says of this process.
  static RunningRun Mine(pid_t process = getpid()) {
    for (const RunningRun& run : RunsAlive())
      if (run.process == process) return run;
    return {};
  }
  /// Whether `condition` holds in a process of another user.
  static bool HoldsForNobody(const std::function<bool()>& condition) {
    const pid_t child = fork();
    if (child == 0) _exit(setgid(65534) == 0 && setuid(65534) == 0 && condition() ? 0 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  const Experiment experiment_;
  Helm helm_;
  const RunSocket socket_;
};

TEST_F(RunSocketTest, TellsWhatRunItIs) {
  const RunningRun run = Mine();
  EXPECT_TRUE(run.is_ours);
  EXPECT_EQ(run.name, "test");
  EXPECT_EQ(run.folder, "/some/folder");
  EXPECT_EQ(run.engine, "inprocess");
  EXPECT_EQ(run.page, "http://127.0.0.1:8765");
  EXPECT_EQ(run.agents, 3);
  EXPECT_EQ(run.domain, -1);
  EXPECT_EQ(run.tick, -1);
  EXPECT_EQ(run.duration_s, 1);
  const nlohmann::json json = nlohmann::json::parse(RunsJson({run}));
  EXPECT_EQ(json[0]["process"], getpid());
  EXPECT_EQ(json[0]["domain"], nullptr);
  EXPECT_EQ(json[0]["tick"], nullptr);
}

TEST_F(RunSocketTest, PassesWishesOnAndAnswersBack) {
  helm_.Close();
  const auto answer = AskRun(getpid(), {.kind = Wish::Kind::kPause});
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->granted);
  EXPECT_EQ(answer->words, "the run is over");
  EXPECT_EQ(AskRun(1, {.kind = Wish::Kind::kPause}), std::nullopt) << "no run";
}

TEST_F(RunSocketTest, ListensToItsOwnUserAndRootOnly) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  helm_.Close();
  const pid_t process = getpid();
  EXPECT_TRUE(HoldsForNobody([process] {
    const RunningRun run = Mine(process);
    return run.process == process && run.user == "root" && !run.is_ours;
  }));
  EXPECT_TRUE(HoldsForNobody([process] {
    const auto answer = AskRun(process, {.kind = Wish::Kind::kStop});
    return answer && !answer->granted && answer->words == "this run is user root's";
  }));
}

}  // namespace
}  // namespace mascot
