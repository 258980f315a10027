// How other programs are started: what they find open, which signals reach them, and what is said if they cannot start.
// Tested with programs that every system has.
#include "system/spawn.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>

#include "system/descriptor.h"
#include "system/stop_signal.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ThrowsMessage;

std::string AllFrom(const Descriptor& input) {
  std::string text;
  std::array<char, 4096> piece{};
  for (ssize_t got = 0; (got = read(input.number(), piece.data(), piece.size())) > 0;)
    text.append(piece.data(), static_cast<std::size_t>(got));
  return text;
}

/// What a program prints that is started so.
std::string OutputOf(Program program) {
  Pipe pipe = MakePipe();
  program.output = pipe.writes.number();
  ChildProcess child = Spawn(program);
  pipe.writes = Descriptor();
  const std::string text = AllFrom(pipe.reads);
  EXPECT_EQ(child.Reap(), 0);
  return text;
}

/// What a script prints that is started so.
std::string Prints(const std::string& script, Program program = {}) {
  program.words = {"/bin/sh", "-c", script};
  return OutputOf(program);
}

/// Whether a program that is started so has `signal` in a set of signals: "SigBlk", "SigIgn".
bool Has(const std::string& set, int signal, Program::Signals signals) {
  const std::string line = OutputOf(
      {.words = {"grep", "^" + set + ":", "/proc/self/status"}, .signals = signals});  // a shell clears its mask
  return (std::stoull(line.substr(line.find('\t')), nullptr, 16) >> (signal - 1) & 1) != 0;
}

TEST(SpawnTest, AProgramIsFoundByPathAndGetsItsWords) {
  EXPECT_EQ(OutputOf({.words = {"printf", "%s|", "a b", "", "$HOME"}}), "a b||$HOME|");
}

TEST(SpawnTest, AProgramThatIsNotThereIsNamed) {
  EXPECT_THAT(
      [] {
        Spawn({.words = {"/nowhere/agent", "--id"}, .name = "other"});
      },
      ThrowsMessage<std::runtime_error>("cannot start /nowhere/agent: No such file or directory"));
}

TEST(SpawnTest, AProgramMayHaveAnotherName) {
  EXPECT_EQ(Prints("echo $0", {.words = {}, .name = "janitor"}), "janitor\n");
}

TEST(SpawnTest, NowhereIsDevNull) {
  EXPECT_EQ(Prints("readlink /proc/$$/fd/0 /proc/$$/fd/2",
                   {.words = {}, .input = Program::kNowhere, .errors = Program::kNowhere}),
            "/dev/null\n/dev/null\n");
}

TEST(SpawnTest, AProgramGetsTheDescriptorsThatAreSharedAndNoOthers) {
  const int left_open = open("/dev/null", O_RDONLY);  // as a library does
  const Descriptor owner(left_open);
  const Pipe shared = MakePipe();
  const std::string is_there = "[ -e /proc/$$/fd/$n ] && echo $n";
  const std::string script = "for n in " + std::to_string(left_open) + " " + std::to_string(shared.reads.number()) +
                             " " + std::to_string(shared.writes.number()) + "; do " + is_there + "; done; true";
  EXPECT_EQ(Prints(script, {.words = {}, .shared = {shared.writes.number()}}),
            std::to_string(shared.writes.number()) + "\n");
}

TEST(SpawnTest, AGroupOrASessionOfItsOwnIsNotOurs) {
  const std::string group_and_session = "set -- $(sed 's/.*) //' /proc/$$/stat); echo $(($3 == $$)) $(($4 == $$))";
  EXPECT_EQ(Prints(group_and_session), "0 0\n");
  EXPECT_EQ(Prints(group_and_session, {.words = {}, .group = Program::Group::kOwn}), "1 0\n");
  EXPECT_EQ(Prints(group_and_session, {.words = {}, .group = Program::Group::kOwnSession}), "1 1\n");
}

TEST(SpawnTest, SignalsAreBlockedIgnoredOrNot) {
  using Signals = Program::Signals;
  const auto before = ::signal(SIGPIPE, SIG_IGN);
  sigset_t mask, mask_before;
  sigemptyset(&mask);
  sigaddset(&mask, SIGTERM);
  sigprocmask(SIG_BLOCK, &mask, &mask_before);
  EXPECT_FALSE(Has("SigBlk", SIGTERM, Signals::kUnblocked));
  EXPECT_TRUE(Has("SigIgn", SIGPIPE, Signals::kUnblocked)) << "as we do";
  EXPECT_FALSE(Has("SigBlk", SIGTERM, Signals::kDefault));
  EXPECT_FALSE(Has("SigIgn", SIGPIPE, Signals::kDefault));
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE}) EXPECT_TRUE(Has("SigBlk", signal, Signals::kBlocked));
  sigprocmask(SIG_SETMASK, &mask_before, nullptr);
  ::signal(SIGPIPE, before);
}

TEST(ForkTest, WorkIsDoneInAProcessAndAGroupOfItsOwn) {
  const Pipe pipe = MakePipe();
  ChildProcess child = Fork([&] {
    const pid_t said[] = {getpid(), getpgrp(), getppid()};
    if (write(pipe.writes.number(), said, sizeof said) < 0) _exit(2);
  });
  const pid_t number = child.number();
  EXPECT_EQ(child.Reap(), 0);
  std::array<pid_t, 3> said{};
  ASSERT_EQ(read(pipe.reads.number(), said.data(), sizeof said), static_cast<ssize_t>(sizeof said));
  EXPECT_EQ(said[0], number);
  EXPECT_EQ(said[1], number);
  EXPECT_EQ(said[2], getpid());
}

TEST(ForkTest, AProcessDiesWithTheOneThatStartedIt) {
  Pipe pipe = MakePipe();
  ChildProcess parent = Fork([&] {
    const ChildProcess child = Fork([] { pause(); });
    if (write(pipe.writes.number(), "x", 1) < 0) _exit(2);
    pause();
  });
  pipe.writes = Descriptor();
  char ready = 0;
  ASSERT_EQ(read(pipe.reads.number(), &ready, 1), 1);
  parent.Signal(SIGKILL);  // no destructor of its runs
  parent.Reap();
  EXPECT_EQ(read(pipe.reads.number(), &ready, 1), 0) << "the last process that had the other end has ended";
}

TEST(ForkTest, WhoseParentHasEndedIsTold) {
  EXPECT_EQ(Fork([] { _exit(DieWith(getppid()) ? 0 : 1); }).Reap(), 0);
  EXPECT_NE(Fork([] { _exit(DieWith(getpid()) ? 0 : 1); }).Reap(), 0) << "as if that one had started it";
}

TEST(PipeTest, GivesWhatWasWrittenAndSaysWhyThereIsNone) {
  Pipe pipe = MakePipe();
  ASSERT_EQ(write(pipe.writes.number(), "abc", 3), 3);
  pipe.writes = Descriptor();
  EXPECT_EQ(AllFrom(pipe.reads), "abc");
  EXPECT_NE(fcntl(pipe.reads.number(), F_GETFD) & FD_CLOEXEC, 0);
}

TEST(IsIgnoredTest, AsLongAsTheSignalIs) {
  const auto before = ::signal(SIGHUP, SIG_IGN);
  EXPECT_TRUE(IsIgnored(SIGHUP));
  ::signal(SIGHUP, [](int) {});
  EXPECT_FALSE(IsIgnored(SIGHUP));
  ::signal(SIGHUP, SIG_DFL);
  EXPECT_FALSE(IsIgnored(SIGHUP));
  ::signal(SIGHUP, before);
}

}  // namespace
}  // namespace mascot
