// One child process: until when signals are sent to it, and what is told of its end.
#include "system/child_process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

namespace mascot {
namespace {

int urgent = 0;

class ChildProcessTest : public testing::Test {
 protected:
  void SetUp() override { urgent = 0; }
  void TearDown() override { ::signal(SIGURG, before_); }

  /// A process that ends with this code; below 0: it waits until it is killed.
  static ChildProcess Forked(int code) {
    const pid_t number = fork();
    if (number != 0) return ChildProcess(number);
    while (code < 0) pause();
    _exit(code);
  }
  static bool IsThere(pid_t number) { return kill(number, 0) == 0; }

 private:
  sighandler_t before_ = ::signal(SIGURG, [](int) { ++urgent; });  // a process without a handler ignores this one
};

TEST_F(ChildProcessTest, ItsEndIsToldOnceAndThenItHasNoNumber) {
  ChildProcess child = Forked(3);
  EXPECT_GT(child.number(), 0);
  const auto status = child.Reap();
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(EndText(*status), "exited with code 3");
  EXPECT_EQ(child.number(), 0);
  EXPECT_EQ(child.Reap(), std::nullopt);
  EXPECT_EQ(child.ReapIfEnded(), std::nullopt);
}

TEST_F(ChildProcessTest, WhatRunsIsNotReaped) {
  ChildProcess child = Forked(-1);
  EXPECT_EQ(child.ReapIfEnded(), std::nullopt);
  EXPECT_TRUE(IsThere(child.number()));
  child.Signal(SIGKILL);
  EXPECT_EQ(EndText(child.Reap().value()), "was killed by signal 9 (Killed)");
}

TEST_F(ChildProcessTest, NoSignalReachesWhoHasTheNumberOfAReapedChild) {
  ChildProcess us(getpid());  // waitpid takes us for no child of ours: as if other code had reaped one of this number
  us.Signal(SIGURG);
  EXPECT_EQ(urgent, 1);
  EXPECT_EQ(us.ReapIfEnded(), kUnknownEnd);
  us.Signal(SIGURG);
  EXPECT_EQ(urgent, 1);
  EXPECT_EQ(EndText(kUnknownEnd), "has ended, and it cannot be told how");
}

TEST_F(ChildProcessTest, ItDoesNotOutliveItsOwner) {
  pid_t number = 0;
  {
    const ChildProcess child = Forked(-1);
    number = child.number();
  }
  EXPECT_FALSE(IsThere(number));
}

TEST_F(ChildProcessTest, MovesToOneOwnerOrIsLeftToItself) {
  ChildProcess one = Forked(-1);
  const pid_t number = one.number();
  ChildProcess other = std::move(one);
  EXPECT_EQ(other.number(), number);
  other.Release();
  EXPECT_EQ(other.number(), 0);
  EXPECT_TRUE(IsThere(number));
  EXPECT_EQ(EndText((kill(number, SIGKILL), ChildProcess(number)).Reap().value()), "was killed by signal 9 (Killed)");
}

TEST(SignalProcess, ReachesNobodyIfThereIsNoProcess) {
  urgent = 0;
  const auto before = ::signal(SIGURG, [](int) { ++urgent; });
  SignalProcess(getpid(), SIGURG);
  EXPECT_EQ(urgent, 1);
  for (const pid_t nobody : {0, -1, -getpgrp()}) SignalProcess(nobody, SIGURG);
  EXPECT_EQ(urgent, 1) << "to kill(2), 0 is all of our process group, and -1 everybody";
  ::signal(SIGURG, before);
}

}  // namespace
}  // namespace mascot
