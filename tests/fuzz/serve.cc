// Fuzzer: what a client says to `orchestrator serve`. Each message has one answer, whose bytes are of the form that was
// agreed on; an error changes no tick, unless a law has failed. The input is a list of messages: a byte that says
// whether it is JSON (even) or a step of the binary form, two bytes of its length, and the message.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "orchestrator/live/server/foxglove_bytes.h"
#include "orchestrator/serving/binary_form.h"
#include "orchestrator/serving/conversation.h"
#include "orchestrator/serving/team_service.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

constexpr const char* kTeam = R"([run]
duration_s = 0.2
on_agent_loss = "drop"
[agents]
count = 2
model = "double_integrator"
position_m = [[0, 0, 1], [4, 0, 1]]
[graph]
topology = "complete"
[law]
name = "consensus"
)";

using Json = nlohmann::ordered_json;

/// The answer in JSON; null: it is a state of the binary form.
Json AnswerIn(std::string_view bytes, bool is_binary) {
  if (!is_binary) {
    Require(bytes.ends_with('\n') && bytes.find('\n') == bytes.size() - 1, "a line with other than one end");
    return Json::parse(bytes);
  }
  Require(bytes.size() >= kFrameHead, "a frame without a head");
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  Require(bytes.size() == kFrameLength + length, "a frame of another length");
  if (bytes[kFrameLength] == 'J') return Json::parse(bytes.substr(kFrameHead));
  Require(bytes[kFrameLength] == 'S', "a frame of another kind");
  return nullptr;
}

void Check(const TeamService& team, std::int64_t before, const Json& answer) {
  Require(answer.is_null() || answer.contains("answer") != answer.contains("error"), answer.dump());
  const std::int64_t tick = team.team().tick();
  Require(tick >= 0 && tick <= team.team().experiment().ticks(), "a tick outside of the episode");
  const bool refused = answer.is_object() && answer.contains("error") && team.team().failure().empty();
  Require(!refused || tick == before || tick == 0, "an error that has changed the tick: " + answer.dump());
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mascot;
  ByteReader input({data, size});
  TeamService team({.text = kTeam, .path = "team.toml", .ports = {1}});
  Conversation talk(team, [](const std::string& /*request*/) {}, {});
  while (!input.rest().empty() && !talk.is_over()) {
    const bool is_json = input.Take<std::uint8_t>() % 2 == 0;
    const std::size_t length = input.Take<std::uint16_t>();
    const auto part = input.TakeBytes(std::min(length, input.rest().size()));
    const std::string_view message(reinterpret_cast<const char*>(part.data()), part.size());
    const std::int64_t before = team.team().tick();
    const bool was_binary = talk.is_binary();
    if (!was_binary && (!is_json || message.find('\n') != std::string_view::npos || message.size() > talk.most()))
      continue;  // no line
    const std::string answer = was_binary ? talk.OnFrame(is_json ? 'J' : 'S', message) : talk.OnLine(message);
    Check(team, before, AnswerIn(answer, was_binary));
  }
  return 0;
}
