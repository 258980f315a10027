#include "orchestrator/control/request_queue.h"

#include <utility>

#include "system/failure.h"

namespace mascot {

void RequestQueue::Ask(const Request& request, std::function<void(const Answer&)> answered) {
  const std::lock_guard lock(mutex_);
  questions_.push_back({request, std::move(answered)});
  come_.notify_one();
}

void RequestQueue::Close() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void RequestQueue::Run(const std::stop_token& over) {
  for (;;) {
    std::unique_lock lock(mutex_);
    if (!come_.wait(lock, over, [this] { return !questions_.empty(); })) return;
    const Question question = std::move(questions_.front());
    questions_.pop_front();
    lock.unlock();
    Answer answer;
    try {
      answer = control_.Ask(question.request);
    } catch (...) {
      answer = {false, CaughtInWords()};
    }
    question.answered(answer);
  }
}

}  // namespace mascot
