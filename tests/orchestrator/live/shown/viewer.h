// A viewer of a live view by hand, for tests.
#pragma once

#include <gmock/gmock.h>

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "tests/orchestrator/live/server/web_client.h"
#include "tests/support/waits.h"

namespace mascot::test {

/// A viewer by hand: foxglove.sdk.v1.
class Viewer : public WebClient {
 public:
  explicit Viewer(const std::string& url, const std::string& target = "/") : WebClient(url) {
    EXPECT_THAT(Upgrade("foxglove.sdk.v1", "", target), ::testing::StartsWith("HTTP/1.1 101"));
    const auto advertised = NextWith(R"("op":"advertise")");
    if (!advertised) return;
    const nlohmann::json message = nlohmann::json::parse(advertised->payload);
    for (const nlohmann::json& channel : message["channels"])
      channels_[channel["topic"].get<std::string>()] = channel["id"];
  }
  bool Offers(const std::string& topic) const { return channels_.contains(topic); }
  void Subscribe(const std::string& topic) {
    const std::uint32_t id = channels_.at(topic);
    Send(kText, nlohmann::json({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", id}}}}}).dump());
  }
  /// The payload of the next message of a topic.
  std::string NextOf(const std::string& topic) {
    const std::string head = "\x01" + std::string(reinterpret_cast<const char*>(&channels_.at(topic)), 4);
    for (auto frame = NextKept(); frame; frame = NextKept())
      if (frame->payload.starts_with(head)) return frame->payload.substr(13);
    return {};
  }
  /// The next message of a topic, decoded, that fits; null, and a failure that says `what` was waited for, if none
  /// comes.
  nlohmann::json NextWhere(const std::string& topic, const std::string& what,
                           const std::function<bool(const nlohmann::json&)>& fits) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    for (std::string text = NextOf(topic); !text.empty(); text = NextOf(topic)) {
      if (nlohmann::json message = nlohmann::json::parse(text); fits(message)) return message;
      if (std::chrono::steady_clock::now() > deadline) break;
    }
    ADD_FAILURE() << InVain(what + " on " + topic, kPatience) << ", or until the connection was closed";
    return {};
  }
  /// The next frame of the page that is at this tick.
  nlohmann::json FrameAt(std::int64_t tick) {
    return NextWhere("/ui/frame", "a frame at tick " + std::to_string(tick),
                     [&](const nlohmann::json& frame) { return frame.value("tick", std::int64_t{-1}) == tick; });
  }
  nlohmann::json NextJsonOf(const std::string& topic) { return nlohmann::json::parse(NextOf(topic)); }
  /// Messages that come before the answer are kept for NextOf().
  nlohmann::json Ask(const nlohmann::json& request) {
    const std::uint32_t numbers[] = {0, 1, 4};
    Send(kBinary,
         "\x02" + std::string(reinterpret_cast<const char*>(numbers), sizeof numbers) + "json" + request.dump());
    for (auto frame = Next(); frame; kept_.push_back(*frame), frame = Next())
      if (frame->payload.starts_with('\3'))
        return nlohmann::json::parse(frame->payload.substr(frame->payload.find('{')));
    return {};
  }

 private:
  std::optional<Frame> NextKept() {
    if (kept_.empty()) return Next();
    Frame frame = std::move(kept_.front());
    kept_.pop_front();
    return frame;
  }

  std::map<std::string, std::uint32_t> channels_;
  std::deque<Frame> kept_;
};

}  // namespace mascot::test
