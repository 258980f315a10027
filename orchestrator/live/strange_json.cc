#include "orchestrator/live/strange_json.h"

#include "experiment/toml/utf8.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using StrangersJson = nlohmann::ordered_json;

constexpr int kDeepest = 16;

}  // namespace

std::optional<nlohmann::ordered_json> StrangeJson(std::string_view line) {
  auto json = JsonOrNull<StrangersJson>(line, {.depth = kDeepest});
  return json.is_object() ? std::optional(std::move(json)) : std::nullopt;
}

const nlohmann::ordered_json* StrangeFields::Find(const char* field, bool (*is_right)(const nlohmann::ordered_json&)) {
  const auto found = object_.find(field);
  if (found != object_.end() && is_right(*found)) return &*found;
  good_ = false;
  return nullptr;
}

std::string StrangeFields::Text(const char* field, std::size_t longest, bool lines) {
  const auto* value = Find(field, [](const StrangersJson& json) { return json.is_string(); });
  if (value == nullptr) return "";
  const auto& text = value->get_ref<const std::string&>();
  good_ = good_ && text.size() <= longest;
  if (!good_) return "";
  return lines ? Plain(text) : PlainLine(text);
}

bool StrangeFields::Boolean(const char* field) {
  const auto* value = Find(field, [](const StrangersJson& json) { return json.is_boolean(); });
  return value != nullptr && value->get<bool>();
}

double StrangeFields::Number(const char* field, double least, double most) {
  const auto* value = Find(field, [](const StrangersJson& json) { return json.is_number(); });
  const double number = value != nullptr ? value->get<double>() : least;
  if (!(number >= least && number <= most)) good_ = false;
  return number;
}

std::int64_t StrangeFields::Integer(const char* field, std::int64_t least, std::int64_t most) {
  // An integer beyond 2^63 is unsigned, and one beyond 2^64 a floating-point number.
  const auto* value = Find(field, [](const StrangersJson& json) {
    return json.is_number_integer() &&
           !(json.is_number_unsigned() && json.get<std::uint64_t>() > std::uint64_t{INT64_MAX});
  });
  const std::int64_t number = value != nullptr ? value->get<std::int64_t>() : least;
  if (number < least || number > most) good_ = false;
  return number;
}

}  // namespace mascot
