#include "orchestrator/engines/tick_requests.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

constexpr auto kLookEvery = std::chrono::milliseconds(50);  // whether to go on

}  // namespace

TickRequests::Next TickRequests::Await(std::int64_t tick, std::optional<double> new_pace,
                                       const std::function<bool()>& go_on) {
  requests_.Open();
  if (new_pace) {
    gate_.SetPace(*new_pace);
    SayStatus();
  }
  while (go_on()) {
    if (!CarryOutAll(tick)) return Next::kStop;
    const auto now = std::chrono::steady_clock::now();
    const auto opens = gate_.Opens(now);
    if (opens && now >= *opens) {
      gate_.OnTick(now);
      return Next::kTick;
    }
    requests_.WaitUntil(std::min(now + kLookEvery, opens.value_or(now + kLookEvery)));
  }
  return Next::kLeave;
}

bool TickRequests::CarryOutAll(std::int64_t tick) {
  while (const auto order = requests_.Next()) {
    switch (order->kind) {
      case Request::Kind::kPause:
        gate_.Pause();
        break;
      case Request::Kind::kResume:
        gate_.Resume();
        break;
      case Request::Kind::kStep:
        gate_.Step(std::llround(order->number));
        break;
      case Request::Kind::kPace:
        gate_.SetPace(order->number);
        break;
      case Request::Kind::kEvent:
        if (static_cast<double>(tick) >= order->number)
          requests_.CheckAgain();
        else
          Take(*order->event, tick);
        continue;
      default:
        requests_.Done(tick);
        return false;
    }
    SayStatus();
    requests_.Done(tick);
  }
  return true;
}

void TickRequests::Take(const Event& event, std::int64_t tick) try {
  take_(event);
  requests_.Done(tick);
} catch (const ConfigError& error) {
  requests_.Refuse(error);
} catch (const std::invalid_argument& error) {
  requests_.Refuse(error.what());
}

}  // namespace mascot
