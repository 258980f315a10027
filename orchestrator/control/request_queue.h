#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "orchestrator/control/run_control.h"

namespace mascot {

/// Passes requests to a RunControl, one after the other, in a thread of its own, because an answer may take a second or
/// two.
class RequestQueue {
 public:
  /// `control` must outlive this object.
  explicit RequestQueue(RunControl& control)
      : control_(control), thread_([this](const std::stop_token& over) { Run(over); }) {}

  /// `answered` gets the answer in this object's thread; it is not called if this object is closed before.
  void Ask(const Request& request, std::function<void(const Answer&)> answered);
  /// Ends the thread: from now on nobody is asked, and nothing is answered.
  void Close();

 private:
  struct Question {
    Request request;
    std::function<void(const Answer&)> answered;
  };
  void Run(const std::stop_token& over);

  RunControl& control_;
  std::mutex mutex_;
  std::condition_variable_any come_;
  std::deque<Question> questions_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace mascot
