#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>
#include <type_traits>
#include <vector>

namespace mascot {

/// What fewer agents do in a tick is not worth a thread.
inline constexpr int kMinAgentsPerThread = 32;

/// Threads that do jobs together: the thread that calls, and others that live as long as the crew. A job has fixed
/// parts, so what a part computes does not depend on which thread is faster. The jobs of a crew are given by one thread
/// at a time, and do not allocate.
class Crew {
 public:
  enum class Size { kExactly, kAtMost };
  /// `members`: how many threads work, with the one that calls; less than 1 is 1. If one cannot start: throws
  /// std::runtime_error, or takes those that have started.
  explicit Crew(int members = 1, Size size = Size::kExactly);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// The thread that calls, and no other.
  static Crew& Alone() {
    static Crew alone;
    return alone;
  }

  int members() const { return static_cast<int>(others_.size()) + 1; }

  /// In how many parts Share() divides `things`.
  std::size_t PartsOf(std::size_t things, std::size_t min_things) const {
    return std::clamp<std::size_t>(things / std::max<std::size_t>(min_things, 1), 1, others_.size() + 1);
  }
  /// Calls work(first, end) at once for ranges of equal size that make up 0..things - 1, each of at least `min_things`
  /// things if there are so many. Returns when all calls have returned. If some of them throw, it throws what the one
  /// with the lowest range has thrown.
  template <class Work>
  void Share(std::size_t things, std::size_t min_things, Work&& work) {
    const std::size_t parts = PartsOf(things, min_things);
    Do(parts, [&](std::size_t part) { work(part * things / parts, (part + 1) * things / parts); });
  }
  /// As Share(), with one call work(part) for each of `parts` parts, at least 1 and at most members().
  template <class Work>
  void Do(std::size_t parts, Work&& work) {
    if (parts == 1) return work(std::size_t{0});
    using Type = std::remove_reference_t<Work>;
    DoTogether(parts, {&work, [](void* it, std::size_t part) { (*static_cast<Type*>(it))(part); }});
  }

 private:
  struct Job {
    void* work = nullptr;
    void (*call)(void* work, std::size_t part) = nullptr;
  };
  struct alignas(64) Member {
    std::atomic<std::uint32_t> jobs = 0;  // that it was given; at the end of the crew one more
    std::exception_ptr failure;           // of the last job
    std::thread thread;
  };

  void DoTogether(std::size_t parts, Job job);
  void AwaitOthers();
  void RethrowFirstFailure(std::size_t parts);
  void Work(Member& member, std::size_t part);
  void End();

  Job job_;
  std::exception_ptr own_failure_;  // of the thread that calls
  bool is_ending_ = false;
  alignas(64) std::atomic<std::uint32_t> pending_ = 0;  // members that are still at the job
  std::vector<std::unique_ptr<Member>> others_;
};

}  // namespace mascot
