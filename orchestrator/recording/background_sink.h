#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/recording/kept_row.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Passes rows on to a sink in a thread of its own, in their order: while that writes some, the run flies the next. It
/// keeps a few rows, none for longer than 50 ms, and lets the run wait if the sink is slower. Adopt() is not passed on.
class BackgroundSink final : public RowSink {
 public:
  /// Both must outlive this object. Throws std::system_error if there can be no thread.
  BackgroundSink(const Experiment& experiment, RowSink& sink);
  ~BackgroundSink() override;  ///< drops rows that have not been passed on
  BackgroundSink(const BackgroundSink&) = delete;
  BackgroundSink& operator=(const BackgroundSink&) = delete;

  /// Copies the row. Throws what the sink threw for an earlier row.
  void Add(const FlownRow& row) override;
  /// Waits until the sink has all rows. Throws what it threw.
  void Finish();

 private:
  void Run();

  RowSink& sink_;
  RowEncoder encoder_;  // for the thread
  std::size_t batch_;   // rows for which it is worth to wake the thread

  std::mutex mutex_;
  std::condition_variable added_, taken_;
  std::vector<std::unique_ptr<KeptRow>> rows_;  // a ring
  std::size_t first_ = 0, count_ = 0;           // of rows_, those that the sink does not have yet
  bool has_room_for_received_ = false;
  bool is_finishing_ = false, is_ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace mascot
