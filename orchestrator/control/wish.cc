#include "orchestrator/control/wish.h"

#include <stdexcept>
#include <string_view>

#include "orchestrator/control/compact_json.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

struct Asked {
  std::string_view word;
  Wish::Kind kind;
  const char* field;  ///< what the wish needs; null: nothing
};
constexpr Asked kAsked[] = {
    {"pause", Wish::Kind::kPause, nullptr}, {"resume", Wish::Kind::kResume, nullptr},
    {"stop", Wish::Kind::kStop, nullptr},   {"step", Wish::Kind::kStep, "count"},
    {"pace", Wish::Kind::kPace, "value"},   {"seek", Wish::Kind::kSeek, "t_s"},
    {"event", Wish::Kind::kEvent, "toml"},
};

}  // namespace

Wish ReadWish(const Json& request) {
  const bool has_word = request.is_object() && request.contains("ask") && request["ask"].is_string();
  const std::string word = has_word ? request["ask"].get<std::string>() : "";
  std::string words;
  for (const Asked& row : kAsked) {
    words += (words.empty() ? "" : " | ") + std::string(row.word);
    if (row.word != word) continue;
    Wish wish{.kind = row.kind};
    if (row.field == nullptr) return wish;
    const Json value = request.contains(row.field) ? request[row.field] : Json();
    const bool is_text = row.kind == Wish::Kind::kEvent;
    if (is_text ? !value.is_string() : !value.is_number())
      throw std::invalid_argument(word + ": expected " + (is_text ? "a text" : "a number") + " as \"" + row.field +
                                  "\"");
    if (is_text)
      wish.toml = value.get<std::string>();
    else
      wish.number = value.get<double>();
    return wish;
  }
  throw std::invalid_argument("expected {\"ask\": " + words + "}");
}

Json WishJson(const Wish& wish) {
  for (const Asked& row : kAsked) {
    if (row.kind != wish.kind) continue;
    Json json{{"ask", row.word}};
    if (row.field != nullptr) json[row.field] = row.kind == Wish::Kind::kEvent ? Json(wish.toml) : Json(wish.number);
    return json;
  }
  throw std::logic_error("a wish that nobody can ask for");
}

Wish SetKey(const std::string& key, const Json& value) {
  // Keys, texts, numbers, booleans and lists of them are written alike in JSON and in TOML.
  return {.kind = Wish::Kind::kEvent, .toml = "set = { " + CompactJson(key) + " = " + CompactJson(value) + " }"};
}

}  // namespace mascot
