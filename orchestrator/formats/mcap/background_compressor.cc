#include "orchestrator/formats/mcap/background_compressor.h"

#include <cassert>
#include <utility>

namespace mascot::mcap {

BackgroundCompressor::BackgroundCompressor() : thread_([this] { Run(); }) {}

BackgroundCompressor::~BackgroundCompressor() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundCompressor::Begin(ByteSpan raw) {
  assert(!is_busy_);
  is_busy_ = true;
  {
    const std::lock_guard lock(mutex_);
    bytes_ = raw;
    is_begun_ = true;
  }
  changed_.notify_all();
}

ByteSpan BackgroundCompressor::End() {
  assert(is_busy_);
  is_busy_ = false;
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return is_done_; });
  is_done_ = false;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return bytes_;
}

void BackgroundCompressor::Run() {
  for (std::unique_lock lock(mutex_);;) {
    changed_.wait(lock, [this] { return is_begun_ || is_ending_; });
    if (is_ending_) return;
    is_begun_ = false;
    lock.unlock();
    ByteSpan compressed;
    std::exception_ptr failure;
    try {
      compressed = compressor_.Compress(bytes_);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    bytes_ = compressed;
    failure_ = failure;
    is_done_ = true;
    changed_.notify_all();
  }
}

}  // namespace mascot::mcap
