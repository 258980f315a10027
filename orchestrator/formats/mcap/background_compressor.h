#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "orchestrator/formats/mcap/zstd.h"

namespace mascot::mcap {

/// Compresses in a thread of its own, one piece after the other, while the caller does something else. The thread lives
/// as long as the object. To be used by one other thread.
class BackgroundCompressor {
 public:
  /// Throws std::system_error if the thread cannot be started.
  BackgroundCompressor();
  ~BackgroundCompressor();
  BackgroundCompressor(const BackgroundCompressor&) = delete;
  BackgroundCompressor& operator=(const BackgroundCompressor&) = delete;

  /// Begins to compress these bytes, which must stay until End(). IsBusy() must be false.
  void Begin(ByteSpan raw);
  /// Whether something was begun, of which End() has not been called.
  bool IsBusy() const { return is_busy_; }
  /// Waits until it is compressed, and returns what Compressor::Compress() does. Throws what that throws.
  ByteSpan End();

 private:
  void Run();

  bool is_busy_ = false;  // only for the caller's thread
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_ending_ = false, is_begun_ = false, is_done_ = false;
  ByteSpan bytes_;  // those that are to be compressed, and then the compressed ones
  std::exception_ptr failure_;
  Compressor compressor_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace mascot::mcap
