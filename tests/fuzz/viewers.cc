// Fuzzer: messages of viewers to the Foxglove protocol. Nothing is thrown, every question is answered, and what is sent
// back is a message of the protocol. The input is a list of messages: a byte that says whether it is text, and whether
// it repeats itself; four bytes of its length, and the message. One that repeats itself has a beginning (two bytes of
// length), what is repeated (one byte of length), how often (four bytes), and its end. Each may be as long as a socket
// lets a message be; one that repeats itself only where the first byte is 254 or 255, and else 16 KiB, so that a round
// is not spent on few long ones.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/live/server/foxglove.h"
#include "orchestrator/live/server/socket.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

constexpr ClientId kClient = 1;

/// A server whose questions are answered after each message.
class FuzzedServer final : public Foxglove::Host {
 public:
  FuzzedServer()
      : foxglove_({.name = "fuzzed",
                   .session = "1",
                   .end_ns = 1,
                   .channels = {{"/a", "json", {}}, {"/b", "cdr", {}}},
                   .connections = [] { return Foxglove::Connections(); },
                   .service = "/ask",
                   .request = {},
                   .response = {}},
                  *this) {
    foxglove_.OnOpen(kClient, {.has_playback = true});
    foxglove_.SetParameters({{"law.p_gain", 1.0}, {"law.name", "x"}});
  }

  void Send(ClientId client, Frame frame) override {
    Require(client == kClient, "a message to nobody");
    const std::string message = frame.head + (frame.body ? *frame.body : "");
    if (frame.is_text)
      Require(Foxglove::Json::parse(message).contains("op"), message);
    else
      Require(message.size() >= 9 && message[0] >= 1 && message[0] <= 5, message);
  }
  bool IsSlow(ClientId /*client*/) const override { return false; }
  void OnSubscribe(ClientId client, Foxglove::ChannelId channel) override {
    Require(foxglove_.HasSubscriber(channel), "who has just subscribed has not");
    foxglove_.PublishTo(client, channel, 1, std::make_shared<const std::string>("payload"));
  }
  void Ask(const Request& /*request*/, Foxglove::Reply reply) override { replies_.push_back(std::move(reply)); }
  void AskForGoal(const Goal& /*goal*/, Foxglove::Reply reply) override { replies_.push_back(std::move(reply)); }

  void Take(bool is_text, std::span<const std::uint8_t> message) {
    foxglove_.OnMessage(kClient, is_text, message);
    Require(replies_.size() <= Foxglove::kMaxQuestions, "too many questions");
    for (bool granted = true; !replies_.empty(); granted = !granted) {
      const Foxglove::Reply reply = std::move(replies_.back());
      replies_.pop_back();
      reply({granted, "words"});
    }
    foxglove_.Publish(0, 1, std::make_shared<const std::string>("payload"));
  }

 private:
  Foxglove foxglove_;
  std::vector<Foxglove::Reply> replies_;
};

}  // namespace
}  // namespace mascot

namespace mascot {
namespace {

constexpr int kMayBeLongest = 254;
constexpr std::size_t kLong = 1 << 14;
const std::size_t kLongest = SocketLimits().message_bytes;

std::span<const std::uint8_t> TakePart(ByteReader& input, std::size_t length) {
  return input.TakeBytes(std::min(length, input.rest().size()));
}

std::vector<std::uint8_t> TakeRepeated(ByteReader& input, std::size_t longest) {
  const auto begin = TakePart(input, input.Take<std::uint16_t>());
  const auto part = TakePart(input, input.Take<std::uint8_t>());
  const std::size_t times = input.Take<std::uint32_t>();
  const auto end = TakePart(input, input.Take<std::uint16_t>());
  std::vector<std::uint8_t> message(begin.begin(), begin.end());
  const std::size_t room = longest - std::min(longest, begin.size() + end.size());
  const std::size_t size = part.empty() ? 0 : std::min(times, room / part.size()) * part.size();
  message.reserve(begin.size() + size + end.size());
  for (std::size_t i = 0; i < size; ++i) message.push_back(part[i % part.size()]);
  message.insert(message.end(), end.begin(), end.end());
  return message;
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mascot::ByteReader input({data, size});
  mascot::FuzzedServer server;
  while (!input.rest().empty()) {
    const auto kind = input.Take<std::uint8_t>();
    const bool is_text = kind % 2 == 0, repeats = kind / 2 % 2 != 0;
    if (repeats)
      server.Take(is_text,
                  mascot::TakeRepeated(input, kind >= mascot::kMayBeLongest ? mascot::kLongest : mascot::kLong));
    else
      server.Take(is_text,
                  mascot::TakePart(input, std::min<std::size_t>(input.Take<std::uint32_t>(), mascot::kLongest)));
  }
  return 0;
}
