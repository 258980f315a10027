// How tests wait: until a condition holds or a deadline has passed; then the test fails and says what it waited for.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace mascot::test {

/// How long tests wait for what takes milliseconds on an idle machine.
inline constexpr std::chrono::milliseconds kPatience = std::chrono::seconds(60);
/// How long tests wait for the end of a program that flies a run. ctest ends a test after 300 s, without a word.
inline constexpr std::chrono::milliseconds kPatienceForRuns = std::chrono::seconds(200);

/// Waits until `condition` holds, at most `patience`. Returns whether it does.
inline bool Until(const std::function<bool()>& condition, std::chrono::milliseconds patience = kPatience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 2);  // milliseconds
  }
  return true;
}

inline std::string InVain(const std::string& what, std::chrono::milliseconds patience) {
  return "waited " + std::to_string(patience.count()) + " ms in vain for " + what;
}

/// As Until(). The test fails if the condition does not hold; `what` completes "waited in vain for".
inline bool Await(const std::string& what, const std::function<bool()>& condition,
                  std::chrono::milliseconds patience = kPatience) {
  const bool holds = Until(condition, patience);
  if (!holds) ADD_FAILURE() << InVain(what, patience);
  return holds;
}

/// Waits until a descriptor has something to read, or its other end is closed; see Await().
inline bool AwaitInput(int descriptor, const std::string& what, std::chrono::milliseconds patience = kPatience) {
  pollfd input{descriptor, POLLIN, 0};
  const bool has = poll(&input, 1, static_cast<int>(patience.count())) == 1;
  if (!has) ADD_FAILURE() << InVain(what, patience);
  return has;
}

/// Waits for the end of a child, and takes its status, as waitpid() gives it. A child that goes on is killed; see
/// Await().
inline int AwaitEndOf(pid_t child, const std::string& what, std::chrono::milliseconds patience = kPatience) {
  const int handle = static_cast<int>(syscall(SYS_pidfd_open, child, 0));  // readable when the child has ended
  if (handle >= 0 && !AwaitInput(handle, what, patience)) kill(child, SIGKILL);
  if (handle >= 0) close(handle);
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

/// For waits without a deadline of their own, such as joining a thread: if this object lives longer than `patience`,
/// the process says what it waited for, and aborts.
class Deadline {
 public:
  explicit Deadline(std::string what, std::chrono::milliseconds patience = kPatience)
      : watch_([what = std::move(what), patience](const std::stop_token& over) {
          std::mutex mutex;
          std::unique_lock lock(mutex);
          // What it returns says nothing: libstdc++ 12 gives false also if the stop is requested as it begins to wait.
          std::condition_variable_any().wait_for(lock, over, patience, [&] { return over.stop_requested(); });
          if (over.stop_requested()) return;
          std::fprintf(stderr, "%s\n", InVain(what, patience).c_str());
          std::abort();
        }) {}

 private:
  std::jthread watch_;
};

}  // namespace mascot::test
