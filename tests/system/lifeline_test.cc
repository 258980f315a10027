#include "system/lifeline.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "system/end_now.h"
#include "system/spawn.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

const std::string kForever = "while :; do :; done";

TEST(Lifeline, EndsAChildThatListensToNothingWhenItsParentIsKilled) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // so that this test can wait for the child of a child
  Pipe says = MakePipe();
  const pid_t parent = SplitProcess();
  if (parent == 0) {
    Lifeline lifeline;
    ChildProcess child;
    // In a thread that ends at once.
    std::thread([&] { child = Spawn({.words = {"sh", "-c", kForever}, .shared = {lifeline.shared()}}); }).join();
    lifeline.Tie(child.number());
    const pid_t number = child.number();
    if (write(says.writes.number(), &number, sizeof number) != sizeof number) EndNow(1);
    for (;;) pause();
  }
  pid_t child = 0;
  ASSERT_TRUE(test::AwaitInput(says.reads.number(), "the number of the child"));
  ASSERT_EQ(read(says.reads.number(), &child, sizeof child), static_cast<ssize_t>(sizeof child));
  EXPECT_EQ(kill(child, 0), 0) << "it goes on although the thread that started it has ended";
  kill(parent, SIGKILL);
  test::AwaitEndOf(parent, "the end of the parent");
  const int status = test::AwaitEndOf(child, "the end of the child");
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST(Lifeline, EndsTheChildWithItself) {
  ChildProcess child;
  {
    Lifeline lifeline;
    child = Spawn({.words = {"sh", "-c", kForever}, .shared = {lifeline.shared()}});
    lifeline.Tie(child.number());
  }
  const int status = test::AwaitEndOf(child.number(), "the end of the child");
  child.Release();
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

}  // namespace
}  // namespace mascot
