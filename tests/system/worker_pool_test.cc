#include "system/worker_pool.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <set>
#include <stdexcept>
#include <system_error>

namespace mascot {
namespace {

using namespace std::chrono_literals;

/// Runs tasks 0 .. tasks - 1. Returns their results by task.
std::map<std::size_t, WorkerPool::Done> RunAll(WorkerPool& pool, std::size_t tasks) {
  std::map<std::size_t, WorkerPool::Done> done;
  std::size_t next = 0;
  while (done.size() < tasks) {
    while (next < tasks && pool.HasIdle()) pool.Start(next++);
    const auto one = pool.Wait(60s);
    if (!one) ADD_FAILURE() << "waited 60 s in vain for a task; " << done.size() << " of " << tasks << " are done";
    if (!one) return done;
    done.emplace(one->task, *one);
  }
  EXPECT_FALSE(pool.IsBusy());
  return done;
}

TEST(WorkerPool, AnswersEveryTaskOnce) {
  WorkerPool pool(3, [](std::size_t task) { return std::to_string(task * task); });
  const auto done = RunAll(pool, 100);
  for (std::size_t task = 0; task < 100; ++task) {
    EXPECT_EQ(done.at(task).answer, std::to_string(task * task));
    EXPECT_EQ(done.at(task).failure, "");
  }
}

TEST(WorkerPool, AnswersAtAnyLength) {
  WorkerPool pool(2, [](std::size_t task) {
    const std::string text(task << 20, 'x');
    if (task % 2 == 1) throw std::runtime_error(text);
    return text;
  });
  for (const auto& [task, done] : RunAll(pool, 4)) {
    EXPECT_EQ((task % 2 == 1 ? done.failure : done.answer).size(), task << 20);
    EXPECT_EQ((task % 2 == 1 ? done.answer : done.failure), "");
  }
}

TEST(WorkerPool, WorksInProcessesOfItsOwn) {
  WorkerPool pool(2, [](std::size_t) { return std::to_string(::getpid()); });
  std::set<std::string> pids;
  for (const auto& [task, done] : RunAll(pool, 20)) pids.insert(done.answer);
  EXPECT_LE(pids.size(), 2u);
  EXPECT_FALSE(pids.contains(std::to_string(::getpid())));
}

TEST(WorkerPool, PassesOnWhatATaskThrows) {
  WorkerPool pool(1, [](std::size_t task) -> std::string {
    if (task == 1) throw std::runtime_error("tick 7: too bad");
    return "fine";
  });
  const auto done = RunAll(pool, 3);
  EXPECT_EQ(done.at(1).failure, "tick 7: too bad");
  EXPECT_EQ(done.at(2).answer, "fine");
}

TEST(WorkerPool, ContinuesWithANewProcessWhenATaskCrashesOne) {
  WorkerPool pool(2, [](std::size_t task) -> std::string {
    if (task % 5 == 3) ::kill(::getpid(), SIGKILL);
    if (task % 5 == 4) ::_exit(3);
    return "fine";
  });
  const auto done = RunAll(pool, 20);
  for (const auto& [task, one] : done) {
    if (task % 5 == 3)
      EXPECT_EQ(one.failure, "the process was killed by signal 9 (Killed)");
    else if (task % 5 == 4)
      EXPECT_EQ(one.failure, "the process exited with code 3");
    else
      EXPECT_EQ(one.answer, "fine");
  }
}

TEST(WorkerPool, LeavesNoProcessBehind) {
  pid_t pid = 0;
  {
    WorkerPool pool(1, [](std::size_t task) {
      if (task == 1) ::pause();
      return std::to_string(::getpid());
    });
    pool.Start(0);
    const auto done = pool.Wait(60s);
    ASSERT_TRUE(done) << "waited 60 s in vain for a process id";
    pid = std::stoi(done->answer);
    pool.Start(1);  // does not end by itself
  }
  EXPECT_EQ(::kill(pid, 0), -1);
}

/// While it lives, this process can open only `more` descriptors. A worker needs two at its start.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(rlim_t more) {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int next = ::open("/dev/null", O_RDONLY | O_CLOEXEC);  // all below are in use
    ::close(next);
    const rlimit few{static_cast<rlim_t>(next) + more, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  }
  ~DescriptorsLeft() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  DescriptorsLeft(const DescriptorsLeft&) = delete;
  DescriptorsLeft& operator=(const DescriptorsLeft&) = delete;

 private:
  rlimit before_{};
};

bool HasChildren() { return ::waitpid(-1, nullptr, WNOHANG) == 0; }

TEST(WorkerPool, GoesOnAfterAWorkerCouldNotBeReplaced) {
  WorkerPool pool(1, [](std::size_t task) -> std::string {
    if (task == 0) ::kill(::getpid(), SIGKILL);
    return "fine";
  });
  EXPECT_EQ(RunAll(pool, 1).at(0).failure, "the process was killed by signal 9 (Killed)");
  {
    const DescriptorsLeft none(0);
    EXPECT_THROW(pool.Start(1), std::system_error);
    EXPECT_THROW(pool.Start(1), std::system_error) << "nobody has the task";
    EXPECT_FALSE(pool.IsBusy());
    EXPECT_FALSE(HasChildren());
  }
  pool.Start(1);
  std::optional<WorkerPool::Done> done;
  while (!done) done = pool.Wait(60s);
  EXPECT_EQ(done->answer, "fine");
}

TEST(WorkerPool, ThatIsHalfMadeLeavesNoProcessBehind) {
  const DescriptorsLeft few(4);
  EXPECT_THROW(WorkerPool(8, [](std::size_t) { return ""; }), std::system_error);
  EXPECT_FALSE(HasChildren());
}

}  // namespace
}  // namespace mascot
