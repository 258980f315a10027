#include "base/crew.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
#define MASCOT_SANITIZED
#elif defined(__has_feature)  // clang++
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MASCOT_SANITIZED
#endif
#endif

namespace mascot {
namespace {

using ::testing::Each;
using ::testing::ThrowsMessage;

TEST(Crew, SharesThingsInPartsOfEqualSize) {
  Crew crew(3);
  EXPECT_EQ(crew.members(), 3);
  for (const std::size_t things : {1, 2, 9, 10, 11, 100}) {
    std::vector<int> calls(things);
    std::atomic<std::size_t> parts = 0, largest = 0, smallest = things;
    crew.Share(things, 3, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) ++calls[i];
      ++parts;
      for (std::size_t old = largest; old < end - first && !largest.compare_exchange_weak(old, end - first);) continue;
      for (std::size_t old = smallest; old > end - first && !smallest.compare_exchange_weak(old, end - first);)
        continue;
    });
    EXPECT_THAT(calls, Each(1)) << things;
    EXPECT_EQ(parts, things < 6 ? 1u : things < 9 ? 2u : 3u) << things;
    EXPECT_LE(largest - smallest, 1u) << things;
  }
}

TEST(Crew, GivesEachPartAThreadOfItsOwn) {
  Crew crew(4);
  std::vector<std::thread::id> threads(4);
  crew.Do(4, [&](std::size_t part) { threads[part] = std::this_thread::get_id(); });
  EXPECT_EQ(std::set(threads.begin(), threads.end()).size(), 4u);
  EXPECT_EQ(threads[0], std::this_thread::get_id());
  const std::vector<std::thread::id> first = threads;
  crew.Do(4, [&](std::size_t part) { threads[part] = std::this_thread::get_id(); });
  EXPECT_EQ(threads, first) << "they live as long as the crew";
}

TEST(Crew, OfOneWorksInTheThreadThatCalls) {
  std::vector<std::thread::id> threads;
  Crew::Alone().Share(1000, 1, [&](std::size_t, std::size_t) { threads.push_back(std::this_thread::get_id()); });
  EXPECT_THAT(threads, ::testing::ElementsAre(std::this_thread::get_id()));
  EXPECT_EQ(Crew(0).members(), 1);
}

TEST(Crew, WaitsForAllParts) {
  Crew crew(4);
  std::vector<std::int64_t> sums(4);
  for (std::int64_t job = 1; job <= 5'000; ++job) {
    crew.Do(2 + static_cast<std::size_t>(job % 3), [&](std::size_t part) { sums[part] += job; });
    if (job % 3 == 2) continue;
    ASSERT_EQ(sums[0], sums[1]) << job;
  }
  EXPECT_EQ(sums[0], 5'000 * 5'001 / 2);
}

TEST(Crew, WakesUpThreadsThatFellAsleep) {
  Crew crew(3);
  std::vector<int> calls(3);
  for (int job = 0; job < 20; ++job) {
    const auto idle_until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
    while (std::chrono::steady_clock::now() < idle_until) continue;
    crew.Do(3, [&](std::size_t part) {
      const auto busy_until = std::chrono::steady_clock::now() + std::chrono::microseconds(300 * part);
      while (std::chrono::steady_clock::now() < busy_until) continue;
      ++calls[part];
    });
    ASSERT_THAT(calls, Each(job + 1));
  }
}

TEST(Crew, ThrowsWhatTheFirstPartThrows) {
  Crew crew(3);
  for (std::size_t failing = 0; failing < 3; ++failing) {
    std::vector<int> calls(3);
    EXPECT_THAT(([&] {
                  crew.Do(3, [&](std::size_t part) {
                    ++calls[part];
                    if (part >= failing) throw std::runtime_error("part " + std::to_string(part));
                  });
                }),
                ThrowsMessage<std::runtime_error>("part " + std::to_string(failing)));
    EXPECT_THAT(calls, Each(1)) << "the others have done theirs";
  }
  int calls = 0;
  crew.Do(1, [&](std::size_t) { ++calls; });
  crew.Do(3, [&](std::size_t part) { calls += part == 0; });
  EXPECT_EQ(calls, 2) << "a failure is told once";
}

#ifndef MASCOT_SANITIZED  // sanitizers need memory for a thread themselves
TEST(CrewDeathTest, SaysWhichThreadCannotStart) {
  const auto without_memory = [](Crew::Size size = Crew::Size::kExactly) {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_AS, &none);
    try {
      Crew crew(64, size);
      std::atomic<int> calls = 0;
      crew.Do(static_cast<std::size_t>(crew.members()), [&](std::size_t) { ++calls; });
      if (crew.members() < 64 && calls == crew.members()) std::_Exit(8);
    } catch (const std::runtime_error& failure) {
      std::fputs(failure.what(), stderr);
      std::_Exit(7);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(without_memory(), ::testing::ExitedWithCode(7),
              "^cannot start thread [0-9]+ of 64 that are to compute the run: Resource temporarily unavailable$");
  EXPECT_EXIT(without_memory(Crew::Size::kAtMost), ::testing::ExitedWithCode(8), "^$") << "it works with less";
}
#endif

}  // namespace
}  // namespace mascot
