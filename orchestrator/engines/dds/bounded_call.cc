#include "orchestrator/engines/dds/bounded_call.h"

#include <future>
#include <memory>
#include <thread>
#include <utility>

namespace mascot {

using namespace std::chrono_literals;

bool ReturnsWithin(std::chrono::milliseconds limit, std::function<void()> call, StopSignal& stop) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  std::packaged_task<void()> task(std::move(call));
  std::future<void> returned = task.get_future();
  std::thread(std::move(task)).detach();
  while (returned.wait_for(10ms) != std::future_status::ready)
    if (std::chrono::steady_clock::now() > deadline || stop.Within(0ms) != 0) return false;
  returned.get();
  return true;
}

}  // namespace mascot
