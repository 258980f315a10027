#include "orchestrator/formats/outside_json.h"

#include <utility>

namespace mascot {

template <class Json>
Json ReadJson(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes) throw JsonError("JSON of more than " + std::to_string(limits.bytes) + " bytes");
  const auto refuse_depth = [&limits](int depth, nlohmann::detail::parse_event_t event, const Json& /*value*/) {
    using Event = nlohmann::detail::parse_event_t;
    if (depth >= limits.depth && (event == Event::object_start || event == Event::array_start))
      throw JsonError("JSON with more than " + std::to_string(limits.depth) + " lists and objects in each other");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), refuse_depth);
  } catch (const nlohmann::detail::parse_error& error) {
    throw JsonError("text that is no JSON (byte " + std::to_string(error.byte) + ")");
  } catch (const nlohmann::detail::out_of_range&) {
    throw JsonError("JSON with a number beyond those of a double");
  }
}

std::optional<nlohmann::ordered_json> ObjectOrNothing(std::string_view line) {
  constexpr int kDeepest = 16;
  auto json = JsonOrNull<nlohmann::ordered_json>(line, {.depth = kDeepest});
  return json.is_object() ? std::optional(std::move(json)) : std::nullopt;
}

template nlohmann::json ReadJson<nlohmann::json>(std::string_view text, const JsonLimits& limits);
template nlohmann::ordered_json ReadJson<nlohmann::ordered_json>(std::string_view text, const JsonLimits& limits);

}  // namespace mascot
