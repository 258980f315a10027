#include "orchestrator/control/request.h"

#include <stdexcept>
#include <string_view>

#include "orchestrator/formats/compact_json.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

struct Asked {
  std::string_view word;
  Request::Kind kind;
  const char* field;  ///< what the request needs; null: nothing
};
constexpr Asked kAsked[] = {
    {"pause", Request::Kind::kPause, nullptr}, {"resume", Request::Kind::kResume, nullptr},
    {"stop", Request::Kind::kStop, nullptr},   {"step", Request::Kind::kStep, "count"},
    {"pace", Request::Kind::kPace, "value"},   {"seek", Request::Kind::kSeek, "t_s"},
    {"event", Request::Kind::kEvent, "toml"},  {"start", Request::Kind::kStart, nullptr},
    {"land", Request::Kind::kLand, "agent"},   {"kill", Request::Kind::kKill, "agent"},
};

}  // namespace

Request ReadRequest(const Json& json) {
  const bool has_word = json.is_object() && json.contains("ask") && json["ask"].is_string();
  const std::string word = has_word ? json["ask"].get<std::string>() : "";
  std::string words;
  for (const Asked& row : kAsked) {
    words += (words.empty() ? "" : " | ") + std::string(row.word);
    if (row.word != word) continue;
    Request request{.kind = row.kind};
    if (row.field == nullptr) return request;
    const Json value = json.contains(row.field) ? json[row.field] : Json();
    const bool is_text = row.kind == Request::Kind::kEvent;
    if (is_text ? !value.is_string() : !value.is_number())
      throw std::invalid_argument(word + ": expected " + (is_text ? "a text" : "a number") + " as \"" + row.field +
                                  "\"");
    if (is_text)
      request.toml = value.get<std::string>();
    else
      request.number = value.get<double>();
    return request;
  }
  throw std::invalid_argument("expected {\"ask\": " + words + "}");
}

Json RequestJson(const Request& request) {
  for (const Asked& row : kAsked) {
    if (row.kind != request.kind) continue;
    Json json{{"ask", row.word}};
    if (row.field != nullptr)
      json[row.field] = row.kind == Request::Kind::kEvent ? Json(request.toml) : Json(request.number);
    return json;
  }
  throw std::logic_error("a request that nobody can make");
}

Request SetKey(const std::string& key, const Json& value) {
  // Keys, texts, numbers, booleans and lists of them are written alike in JSON and in TOML.
  return {.kind = Request::Kind::kEvent, .toml = "set = { " + CompactJson(key) + " = " + CompactJson(value) + " }"};
}

}  // namespace mascot
