#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mascot {

/// What ReadJson() takes.
struct JsonLimits {
  std::size_t bytes = std::size_t{64} << 20;
  int depth = 64;  ///< levels of nested lists and objects
};

/// Thrown for text that cannot be read as JSON. what() describes the text: "text that is no JSON (byte 7)".
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The value that `text` holds. All JSON from sockets, files and pipes is read here and nowhere else. A value that is
/// nested too deeply is refused before it is built, because code that compares, copies or prints a value calls itself
/// once for each level, and a message of a megabyte can hold half a million levels. Throws JsonError. Json:
/// nlohmann::json or nlohmann::ordered_json.
template <class Json>
Json ReadJson(std::string_view text, const JsonLimits& limits = {});

/// As ReadJson(), for callers that look at the kind of a value anyway: null for text that ReadJson() refuses.
template <class Json>
Json JsonOrNull(std::string_view text, const JsonLimits& limits = {}) {
  try {
    return ReadJson<Json>(text, limits);
  } catch (const JsonError&) {
    return nullptr;
  }
}

/// The object in a line that another process sent, with few levels; nothing: the line is not such an object. The code
/// that reads lines limits their length; OutsideFields reads the fields.
std::optional<nlohmann::ordered_json> ObjectOrNothing(std::string_view line);

}  // namespace mascot
