#include "orchestrator/serving/conversation.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/serving/binary_form.h"
#include "system/failure.h"

namespace mascot {
namespace {

constexpr int kDepth = 16;

std::string ErrorJson(const TeamService::Json& request, const std::string& words) {
  TeamService::Json answer{{"error", words}};
  if (request.is_object() && request.contains("id")) answer["id"] = request["id"];
  return CompactJson(answer);
}

/// Whether the client asks for the binary form.
bool WantsBinary(const TeamService::Json& hello) {
  OutsideFields fields(hello);
  fields.Integer("protocol", kServeProtocol, kServeProtocol);
  const std::string form = hello.contains("form") ? fields.Text("form", 10) : "json";
  fields.Require();
  if (form != "json" && form != "binary")
    throw std::invalid_argument(fmt::format("expected \"json\" or \"binary\" as \"form\", got \"{}\"", form));
  return form == "binary";
}

}  // namespace

Conversation::Conversation(TeamService& team, std::function<void(const std::string& request)> drive, Limits limits)
    : team_(team), drive_(std::move(drive)), limits_(limits) {}

std::string Conversation::Framed(std::string json) const {
  return is_binary_ ? JsonFrame(json) : std::move(json) + '\n';
}

std::string Conversation::Refuse(const std::string& words) {
  is_over_ = true;
  return Framed(ErrorJson({}, words));
}

std::string Conversation::OnFrame(std::uint8_t kind, std::string_view content) {
  if (kind == static_cast<std::uint8_t>(FrameKind::kJson)) return OnJson(content);
  if (kind != static_cast<std::uint8_t>(FrameKind::kStep)) return Refuse("expected a frame of kind J or S");
  try {
    drive_("step");
    const BinaryStep step = ReadStep(AsBytes(content), team_.action_numbers());
    team_.Step(step.ticks, step.actions);
    return StateFrame(team_);
  } catch (const std::exception& failure) {
    return Framed(ErrorJson({}, InWords(failure)));
  }
}

std::string Conversation::OnJson(std::string_view text) {
  Json request;
  try {
    request = ReadJson<Json>(text, {.bytes = most(), .depth = kDepth});
    if (!request.is_object()) throw JsonError("expected an object, got another value");
  } catch (const JsonError& error) {
    const std::string words = std::string("expected a request in JSON: ") + error.what();
    return is_known_ ? Framed(ErrorJson({}, words)) : Refuse(words);
  }
  const Json kind = request.value("request", Json());
  if (!is_known_ && kind != "hello") return Refuse("expected {\"request\": \"hello\", \"protocol\": 1} first");
  std::string answer;
  bool becomes_binary = false;
  try {
    becomes_binary = kind == "hello" && WantsBinary(request);
    if (kind.is_string() && TeamService::IsChange(kind.get<std::string>())) drive_(kind.get<std::string>());
    answer = CompactJson(team_.Answer(request));
    is_known_ = true;
  } catch (const std::exception& failure) {
    becomes_binary = false;
    answer = ErrorJson(request, InWords(failure));
    is_over_ = !is_known_;
  }
  is_over_ = is_over_ || kind == "close";
  answer = Framed(std::move(answer));
  is_binary_ = is_binary_ || becomes_binary;  // from the next message on
  return answer;
}

}  // namespace mascot
