#include "base/crew.h"

#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace mascot {
namespace {

// Jobs follow each other within microseconds, in which a thread that sleeps would not even wake up: so a thread looks
// for this long before it sleeps.
constexpr auto kLooks = std::chrono::microseconds(50);
constexpr int kLooksAtOnce = 16;  // before it asks the clock

void Relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Waits until `number` is no more `old`.
void AwaitChange(const std::atomic<std::uint32_t>& number, std::uint32_t old) {
  const auto end = std::chrono::steady_clock::now() + kLooks;
  do {
    for (int look = 0; look < kLooksAtOnce; ++look) {
      if (number.load(std::memory_order_acquire) != old) return;
      Relax();
    }
  } while (std::chrono::steady_clock::now() < end);
  number.wait(old, std::memory_order_acquire);
}

}  // namespace

Crew::Crew(int members, Size size) {
  for (int part = 1; part < members; ++part) others_.push_back(std::make_unique<Member>());
  for (std::size_t started = 0; started < others_.size(); ++started) {
    Member& member = *others_[started];
    try {
      member.thread = std::thread([this, &member, started] { Work(member, started + 1); });
    } catch (const std::system_error& failure) {
      others_.resize(started);
      if (size == Size::kAtMost) return;
      End();
      throw std::runtime_error("cannot start thread " + std::to_string(started + 2) + " of " + std::to_string(members) +
                               " that are to compute the run: " + failure.code().message());
    }
  }
}

Crew::~Crew() { End(); }

void Crew::End() {
  is_ending_ = true;
  for (const auto& member : others_) {
    member->jobs.fetch_add(1, std::memory_order_release);
    member->jobs.notify_one();
  }
  for (const auto& member : others_) member->thread.join();
}

void Crew::Work(Member& member, std::size_t part) {
  for (std::uint32_t done = 0;; ++done) {
    AwaitChange(member.jobs, done);
    if (is_ending_) return;
    try {
      job_.call(job_.work, part);
    } catch (...) {
      member.failure = std::current_exception();
    }
    if (pending_.fetch_sub(1, std::memory_order_acq_rel) == 1) pending_.notify_one();
  }
}

void Crew::DoTogether(std::size_t parts, Job job) {
  job_ = job;
  pending_.store(static_cast<std::uint32_t>(parts - 1), std::memory_order_relaxed);
  for (std::size_t part = 1; part < parts; ++part) {
    Member& member = *others_[part - 1];
    member.jobs.fetch_add(1, std::memory_order_release);
    member.jobs.notify_one();
  }
  try {
    job_.call(job_.work, 0);
  } catch (...) {
    own_failure_ = std::current_exception();
  }
  AwaitOthers();
  RethrowFirstFailure(parts);
}

void Crew::AwaitOthers() {
  while (const std::uint32_t pending = pending_.load(std::memory_order_acquire)) AwaitChange(pending_, pending);
}

void Crew::RethrowFirstFailure(std::size_t parts) {
  std::exception_ptr first = std::exchange(own_failure_, nullptr);
  for (std::size_t part = 1; part < parts; ++part) {
    std::exception_ptr failure = std::exchange(others_[part - 1]->failure, nullptr);
    if (!first) first = std::move(failure);
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace mascot
