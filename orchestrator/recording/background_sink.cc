#include "orchestrator/recording/background_sink.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mascot {
namespace {

constexpr std::size_t kKeptBytes = std::size_t{4} << 20, kMinKept = 8, kMaxKept = 512;
constexpr auto kLongestKept = std::chrono::milliseconds(50);  // where rows come slowly, or no more
constexpr std::size_t kBatches = 8;  // of the rows that are kept: one is taken while the next ones come

std::size_t RowsKept(const Experiment& experiment) {
  const std::size_t row_bytes = experiment.agents.size() * (sizeof(Motion) + sizeof(Command));
  return std::clamp(kKeptBytes / row_bytes, kMinKept, kMaxKept);
}

}  // namespace

BackgroundSink::BackgroundSink(const Experiment& experiment, RowSink& sink)
    : sink_(sink), encoder_(experiment), batch_(RowsKept(experiment) / kBatches) {
  for (std::size_t k = 0; k < RowsKept(experiment); ++k) rows_.push_back(std::make_unique<KeptRow>(experiment.size()));
  thread_ = std::thread([this] { Run(); });
}

BackgroundSink::~BackgroundSink() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  added_.notify_one();
  thread_.join();
}

void BackgroundSink::Add(const FlownRow& row) {
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [this] { return count_ < rows_.size() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  const Row* const received = row.received();
  if (received != nullptr && !has_room_for_received_) {  // the first row: all get the room that it takes
    for (const std::unique_ptr<KeptRow>& each : rows_) each->received = *received;
    has_room_for_received_ = true;
  }
  KeptRow& kept = *rows_[(first_ + count_) % rows_.size()];
  lock.unlock();  // the thread does not look at this one yet
  kept.Keep(row);
  lock.lock();
  if (++count_ >= batch_) added_.notify_one();
}

void BackgroundSink::Finish() {
  std::unique_lock lock(mutex_);
  is_finishing_ = true;
  added_.notify_one();
  taken_.wait(lock, [this] { return count_ == 0 || failure_; });
  is_finishing_ = false;
  if (failure_) std::rethrow_exception(failure_);
}

void BackgroundSink::Run() {
  for (std::unique_lock lock(mutex_);;) {
    added_.wait_for(lock, kLongestKept,
                    [this] { return is_ending_ || count_ >= batch_ || (is_finishing_ && count_ > 0); });
    if (is_ending_) return;
    if (count_ == 0) continue;
    const std::size_t taken = count_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      for (std::size_t k = 0; k < taken; ++k)
        sink_.Add(
            KeptAsFlown(*rows_[(first_ + k) % rows_.size()], encoder_));  // first_ is changed by this thread alone
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    first_ = (first_ + taken) % rows_.size();
    count_ -= taken;
    failure_ = failure;
    taken_.notify_one();
    if (failure_) return;
  }
}

}  // namespace mascot
